#!/usr/bin/env bash
# Set up .venv with one of the extras of pyproject.toml, in the versions of requirements.lock.
# Usage: scripts/setup.sh app|test
set -euo pipefail
cd "$(dirname "$0")/.."
venv=.venv
extra=${1:?usage: scripts/setup.sh app|test}

say() { printf '%s\n' "$*" >&2; }
fail() { printf 'set-up stopped: %s\n' "$*" >&2; exit 1; }

# True for a Python that runs and that cutcell supports. A command of that name may be there
# and still not run (a shim of a version manager), so it is asked, not looked up.
supported() {
    "$1" -c 'import sys; sys.exit(not (3, 11) <= sys.version_info[:2] <= (3, 12))' 2>/dev/null
}

find_python() {
    local name
    for name in python3.12 python3.11 python3 python; do
        if supported "$name"; then echo "$name"; return; fi
    done
    fail "cutcell needs Python 3.11 or 3.12, and none was found. Install one, so that
\`python3.12\` or \`python3.11\` is on the PATH, and run make again."
}

# Debian ships Python without ensurepip, which puts pip into a new environment.
make_venv() {
    local python=$1
    say "Making $venv with $("$python" --version)"
    rm -rf "$venv"
    if "$python" -c 'import ensurepip' 2>/dev/null; then
        "$python" -m venv "$venv"
    elif "$python" -m pip --python "$python" --version >/dev/null 2>&1; then
        "$python" -m venv --without-pip "$venv"
        "$python" -m pip --python "$venv/bin/python" install --quiet pip
    elif [ "$(id -u)" = 0 ] && command -v apt-get >/dev/null; then
        install_venv_package "$python"
        "$python" -m venv "$venv"
    else
        fail "this Python cannot make environments (its module ensurepip is missing).
On Debian or Ubuntu: sudo apt-get install $(venv_package "$python")
Then run make again."
    fi
}

venv_package() { "$1" -c 'import sys; print("python%d.%d-venv" % sys.version_info[:2])'; }

install_venv_package() {
    local package
    package=$(venv_package "$1")
    say "Installing Debian's $package, which makes environments"
    export DEBIAN_FRONTEND=noninteractive
    { apt-get update -qq && apt-get install -y -qq --no-install-recommends "$package"; } >&2 \
        || fail "apt-get could not install $package; install it by hand and run make again."
}

install() {
    local pip=("$venv/bin/python" -m pip --disable-pip-version-check install --quiet
        --constraint requirements.lock)
    say "Installing cutcell[$extra] into $venv (some minutes the first time)"
    # The build tool is locked as well: put in first, and used as it is there.
    "${pip[@]}" setuptools
    "${pip[@]}" --no-build-isolation --editable ".[$extra]"
}

if ! supported "$venv/bin/python" || ! "$venv/bin/python" -c 'import pip' 2>/dev/null; then
    python=$(find_python)
    make_venv "$python"
fi
install || fail "pip could not install cutcell[$extra]; its own message is above.
It needs a way to a Python package index; once that is there, run make again."
touch "$venv/.app"
if [ "$extra" = test ]; then touch "$venv/.test"; fi
