#!/usr/bin/env bash
# Choose again the versions that the targets of make install, for Python 3.11 to 3.14. The
# extras `test` and `docs` have all others but networks: scripts/get_torch.py says which torch is
# installed.
set -euo pipefail
cd "$(dirname "$0")/.."
.venv/bin/python -m pip --disable-pip-version-check install --quiet uv
{
    echo '# Versions that make installs. Made by `make lock`; do not edit by hand.'
    echo 'setuptools>=77' | .venv/bin/python -m uv --quiet pip compile --upgrade --universal \
        --extra test --extra docs --no-emit-index-url --no-header --no-annotate pyproject.toml -
} >requirements.new
mv requirements.new requirements.lock
