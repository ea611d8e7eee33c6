"""Build the extension for Blender and a static repository of it, and test it with bpy.

    python scripts/blender.py build [--only linux-x64]
    python scripts/blender.py test [--bpy 4.5.15] [OPTIONS OF PYTEST]
    python scripts/blender.py pictures

What is downloaded stays in `build/blender`. Each archive holds the glue in `blender/`, the core of
cutcell, and wheels of its libraries for one platform and one Python; never numpy, which is
Blender's own.
"""

from __future__ import annotations

import argparse
import os
import platform
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).resolve().parent.parent
BUILD = ROOT / "build" / "blender"
TESTED = BUILD / "tested"
"""Repository of this platform alone, which tests and pictures use."""
REQUIREMENTS = ("lazy-loader", "numba", "platformdirs", "psutil", "scipy")
LEFT_OUT = ("numpy", "packaging")
"""Blender's own, and what lazy-loader imports only for functions that cutcell does not call."""
PLATFORMS = {
    "linux-x64": [f"manylinux_2_{minor}_x86_64" for minor in (28, 27, 17, 12)]
    + ["manylinux2014_x86_64", "manylinux2010_x86_64"],
    "macos-arm64": [f"macosx_{major}_0_arm64" for major in (14, 13, 12, 11)],
    "windows-x64": ["win_amd64"],
    "windows-arm64": ["win_arm64"],
}
"""Tags of wheels that each of Blender's platforms runs."""


class Target(NamedTuple):
    """Versions of Blender with one Python."""

    python: str
    numpy: str  # what Blender brings
    blender: tuple[str, str]  # from, and up to but not including
    platforms: tuple[str, ...]
    bpy: str  # what it is tested with


TARGETS = (
    Target("3.11", "1.26.4", ("4.5.0", "5.1.0"), tuple(PLATFORMS)[:3], "4.5.15"),
    Target("3.13", "2.3.0", ("5.1.0", ""), tuple(PLATFORMS), "5.2.3"),
)


def bpy_python(version: str, python: str) -> Path:
    """Return the Python of an environment with bpy, which is made first if need be."""
    folder = BUILD / f"bpy-{version}"
    executable = folder / ("Scripts/python.exe" if os.name == "nt" else "bin/python")
    if not (folder / "complete").exists():
        pythons = [f"python{python}", *Path.home().glob(f".pyenv/versions/{python}.*/bin/python")]
        base = next((p for p in map(shutil.which, pythons) if p), None)
        if base is None:
            sys.exit(f"bpy {version} needs Python {python}, which is not on the PATH")
        subprocess.run([base, "-m", "venv", "--clear", folder], check=True)
        numpy = "numpy<2" if python == "3.11" else "numpy"
        install = [
            executable,
            "-m",
            "pip",
            "install",
            "--quiet",
            f"bpy=={version}",
            numpy,
            "pytest",
        ]
        subprocess.run(install, check=True)
        (folder / "complete").touch()
    return executable


def blender_ext(*arguments: str | Path) -> None:
    """Run Blender's own command for extensions, of the newest bpy."""
    python = bpy_python(TARGETS[-1].bpy, TARGETS[-1].python)
    (script,) = python.parent.parent.glob("**/bl_pkg/cli/blender_ext.py")
    subprocess.run([python, script, *arguments], check=True)


def wheels(target: Target, name: str) -> list[Path]:
    """Download the wheels for a platform, unless they are there; return them."""
    folder = BUILD / "wheels" / f"{target.python}-{name}"
    if not folder.exists():
        partial = folder.with_name(f"{folder.name}.partial")
        shutil.rmtree(partial, ignore_errors=True)
        command = [sys.executable, "-m", "pip", "download", "--quiet", "--only-binary=:all:"]
        command += ["--python-version", target.python, "--implementation", "cp", "--dest", partial]
        for tag in PLATFORMS[name]:
            command += ["--platform", tag]
        subprocess.run([*command, *REQUIREMENTS, f"numpy=={target.numpy}"], check=True)
        partial.rename(folder)
    return sorted(w for w in folder.glob("*.whl") if w.name.split("-")[0] not in LEFT_OUT)


def stage(target: Target, platforms: list[str], folder: Path) -> None:
    """Put together what the archives of one Python hold."""
    for file in (ROOT / "blender").glob("*.py"):
        shutil.copy(file, folder)
    shutil.copy(ROOT / "blender" / "LICENSE", folder)
    core = folder / "core"
    leave = shutil.ignore_patterns("__pycache__", "cli", "__main__.py")
    shutil.copytree(ROOT / "cutcell", core / "cutcell", ignore=leave)
    for name in ("LICENSE", "NOTICE"):
        shutil.copy(ROOT / name, core)
    (folder / "wheels").mkdir()
    names = set()
    for name in platforms:
        for wheel in wheels(target, name):
            shutil.copy(wheel, folder / "wheels")
            names.add(wheel.name)
    manifest = (ROOT / "blender" / "blender_manifest.toml").read_text(encoding="utf-8")
    low, high = target.blender
    versions = f'blender_version_min = "{low}"\n' + f'blender_version_max = "{high}"\n' * bool(high)
    listed = "".join(f'  "./wheels/{name}",\n' for name in sorted(names))
    generated = f"{versions}platforms = {platforms!r}\nwheels = [\n{listed}]\n"
    manifest = manifest.replace("# GENERATED\n", generated)
    (folder / "blender_manifest.toml").write_text(manifest, encoding="utf-8")


def build(only: list[str], repository: Path) -> None:
    """Build the archives and the repository."""
    shutil.rmtree(repository, ignore_errors=True)
    repository.mkdir(parents=True)
    for target in TARGETS:
        platforms = [name for name in target.platforms if not only or name in only]
        if not platforms:
            continue
        with tempfile.TemporaryDirectory() as folder:
            source, made = Path(folder, "source"), Path(folder, "made")
            source.mkdir()
            made.mkdir()
            stage(target, platforms, source)
            blender_ext("build", "--split-platforms", "--source-dir", source, "--output-dir", made)
            for archive in made.glob("*.zip"):
                blender_ext("validate", archive)
                tag = f"cp{target.python.replace('.', '')}"
                shutil.move(archive, repository / f"{archive.stem}-{tag}.zip")
    blender_ext("server-generate", "--html", "--repo-dir", repository)
    archives = sorted(repository.glob("*.zip"))
    print(f"\n{'archive':<44} {'MB':>6}")
    for archive in archives:
        print(f"{archive.name:<44} {archive.stat().st_size / 1e6:>6.1f}")
    print(f"The repository is {repository}: index.json, index.html and the archives")


def own_platform() -> str:
    """Return Blender's name of this platform."""
    system = {"Linux": "linux", "Darwin": "macos", "Windows": "windows"}[platform.system()]
    is_arm = platform.machine().lower() in ("arm64", "aarch64")
    return f"{system}-{'arm64' if is_arm else 'x64'}"


def run_in_bpy(target: Target, *command: str | Path) -> int:
    """Run a command of Blender's Python, with a temporary home and the archive to install."""
    tag = f"cp{target.python.replace('.', '')}.zip"
    (archive,) = TESTED.glob(f"*{own_platform().replace('-', '_')}-{tag}")
    print(f"\nbpy {target.bpy}, Python {target.python}", flush=True)
    with tempfile.TemporaryDirectory() as home:
        environment = {
            **os.environ,
            "BLENDER_USER_RESOURCES": home,
            "CUTCELL_ARCHIVE": str(archive),
            "NUMBA_CACHE_DIR": str(BUILD / "kernels"),  # else each run compiles
            "CUTCELL_COMMAND": str(Path(sys.executable).with_name("cutcell")),
        }
        python = bpy_python(target.bpy, target.python)
        return subprocess.run([python, *command], env=environment, cwd=home).returncode


def test(versions: list[str], arguments: list[str]) -> int:
    """Install the extension into a temporary home, for each bpy, and test it there."""
    build([own_platform()], TESTED)
    tests = ROOT / "blender" / "tests"
    pytest = ["-m", "pytest", "-q", "-p", "no:cacheprovider", "-rs", "-c", os.devnull]
    pytest += ["--rootdir", str(tests), str(tests), *arguments]
    chosen = [target for target in TARGETS if not versions or target.bpy in versions]
    return max(run_in_bpy(target, *pytest) for target in chosen)


def main() -> None:
    """Run the command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("action", choices=("build", "test", "pictures"))
    parser.add_argument("--only", action="append", default=[], help="a platform to build for")
    parser.add_argument("--bpy", action="append", default=[], help="a version of bpy to test with")
    options, arguments = parser.parse_known_args()
    if options.action == "build":
        build(options.only, BUILD / "repository")
    elif options.action == "pictures":
        build([own_platform()], TESTED)
        sys.exit(run_in_bpy(TARGETS[-1], ROOT / "docs" / "blender_pictures.py"))
    else:
        sys.exit(test(options.bpy, arguments))


if __name__ == "__main__":
    main()
