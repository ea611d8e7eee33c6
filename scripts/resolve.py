"""Resolve cutcell's dependencies for systems that people have, from wheels alone.

    .venv/bin/python scripts/resolve.py

It prints a table: "yes" where every dependency has a wheel, else the first one that has none.
Markers are evaluated for the other system, which pip's own `--platform` does not do: uv does, from
an environment that is thrown away. The indexes of pip's configuration are asked.
"""

import re
import subprocess
import sys
import tempfile
import venv
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
SYSTEMS = {
    "Linux x64": "x86_64-manylinux_2_28",
    "Linux arm64": "aarch64-manylinux_2_28",
    "macOS arm64": "aarch64-apple-darwin",
    "Windows x64": "x86_64-pc-windows-msvc",
    "Windows arm64": "aarch64-pc-windows-msvc",
}
PYTHONS = ("3.11", "3.12", "3.13", "3.14")
PARTS = {"core": (), "app": ("--extra", "app")}
NO_WHEEL = re.compile(r"[Bb]ecause ([\w.-]+)(?:[=<>!~][^ ]*)* has no (?:usable )?wheels")


def answer(uv: Path, system: str, python: str, options: tuple[str, ...]) -> str:
    """Resolve one combination; return "yes" or what has no wheel."""
    command = [uv, "pip", "compile", "--quiet", "pyproject.toml", *options, "--no-header"]
    command += ["--python-platform", system, "--python-version", python, "--only-binary", ":all:"]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    if done.returncode == 0:
        return "yes"
    missing = NO_WHEEL.search(" ".join(done.stderr.split()))
    return missing[1] if missing else f"failed: {done.stderr.strip()[:60]}"


def main() -> None:
    """Print the table."""
    with tempfile.TemporaryDirectory() as folder:
        venv.create(folder, with_pip=True)
        tools = Path(folder, "Scripts" if sys.platform == "win32" else "bin")
        subprocess.run([tools / "python", "-m", "pip", "install", "--quiet", "uv"], check=True)
        print(f"| system | part | {' | '.join(PYTHONS)} |\n|---|---|{'---|' * len(PYTHONS)}")
        for name, system in SYSTEMS.items():
            for part, options in PARTS.items():
                cells = [answer(tools / "uv", system, python, options) for python in PYTHONS]
                print(f"| {name} | {part} | {' | '.join(cells)} |", flush=True)


if __name__ == "__main__":
    main()
