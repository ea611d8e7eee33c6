#!/usr/bin/env bash
# Set up .venv with one of the extras of pyproject.toml, in the versions of requirements.lock.
# Usage: scripts/setup.sh app|docs|test
set -euo pipefail
cd "$(dirname "$0")/.."
venv=.venv
extra=${1:?usage: scripts/setup.sh app|docs|test}

say() { printf '%s\n' "$*" >&2; }
fail() { printf 'set-up stopped: %s\n' "$*" >&2; exit 1; }

# True for a Python that runs and that cutcell supports. A command of that name may be there
# and still not run (a shim of a version manager), so it is asked, not looked up.
supported() {
    "$1" -c 'import sys; sys.exit(not (3, 11) <= sys.version_info[:2] <= (3, 14))' 2>/dev/null
}

find_python() {
    local name
    for name in python3.14 python3.13 python3.12 python3.11 python3 python; do
        if supported "$name"; then echo "$name"; return; fi
    done
    fail "cutcell needs Python 3.11, 3.12, 3.13 or 3.14, and none was found. Install one, so that
a command such as \`python3.13\` is on the PATH, and run make again."
}

# Debian ships Python without ensurepip, which puts pip into a new environment. Then pip comes
# from the system's own, or from Debian's wheel of it, unpacked here: nothing is installed.
make_venv() {
    local python=$1
    say "Making $venv with $("$python" --version)"
    rm -rf "$venv"
    if "$python" -c 'import ensurepip' 2>/dev/null; then
        "$python" -m venv "$venv"
        return
    fi
    "$python" -m venv --without-pip "$venv"
    if "$python" -m pip --python "$venv/bin/python" install --quiet pip 2>/dev/null; then return; fi
    if pip_from_debian 2>"$venv/debian.log"; then
        say "Took pip from Debian's python3-pip-whl"
        return
    fi
    cat "$venv/debian.log" >&2
    fail "this Python cannot make environments (its module ensurepip is missing).
On Debian or Ubuntu: sudo apt-get install $("$python" -c \
    'import sys; print("python%d.%d-venv" % sys.version_info[:2])')
Then run make again."
}

pip_from_debian() {
    local wheels
    command -v apt-get >/dev/null && command -v dpkg-deb >/dev/null || return 1
    if [ "$(id -u)" = 0 ]; then apt-get update -qq || return 1; fi
    (cd "$venv" && apt-get download -qq python3-pip-whl && dpkg-deb -x python3-pip-whl_*.deb debian) \
        || return 1
    wheels=("$venv"/debian/usr/share/python-wheels/pip-*.whl)
    "$venv/bin/python" "${wheels[0]}/pip" --disable-pip-version-check install --quiet \
        --no-index --find-links "$venv/debian/usr/share/python-wheels" pip || return 1
    rm -rf "$venv"/debian "$venv"/python3-pip-whl_*.deb
}

install() {
    local pip=("$venv/bin/python" -m pip --disable-pip-version-check install --quiet
        --constraint requirements.lock)
    say "Installing cutcell[$extra] into $venv (some minutes the first time)"
    # The build tool is locked as well: put in first, and used as it is there.
    "${pip[@]}" setuptools
    # The core first: its functions are compiled while the rest is installed.
    "${pip[@]}" --no-build-isolation --editable . || return 1
    start_to_compile
    "${pip[@]}" --no-build-isolation --editable ".[$extra]"
}

# What is not compiled when the set-up ends, or fails, the first binding compiles.
start_to_compile() {
    "$venv/bin/python" -c 'from cutcell.weights.warm_up import warm_up; warm_up()' \
        </dev/null >/dev/null 2>&1 &
    trap "kill $! 2>/dev/null || true" EXIT
}

if ! supported "$venv/bin/python" || ! "$venv/bin/python" -c 'import pip' 2>/dev/null; then
    python=$(find_python)
    make_venv "$python"
fi
install || fail "pip could not install cutcell[$extra]; its own message is above.
It needs a way to a Python package index; once that is there, run make again."
# mypy does not follow the names that setup.py gives to folders.
mkdir -p "$venv/types"
for folder in app assets lab viewers; do ln -sfn "../../$folder" "$venv/types/cutcell_$folder"; done
touch "$venv/.app"
if [ "$extra" = test ]; then touch "$venv/.test"; fi
