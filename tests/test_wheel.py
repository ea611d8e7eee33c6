"""What a wheel installs works without a checkout, whatever lies in the folder it is started in."""

import os
import re
import shutil
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from pathlib import Path
from urllib.request import Request, urlopen

import pytest

from tests.signals import reset_signals

pytestmark = pytest.mark.nightly

ROOT = Path(__file__).resolve().parent.parent
SOURCES = ("app", "assets", "cutcell", "lab", "viewers")
FILES = ("LICENSE", "NOTICE", "README.md", "pyproject.toml", "setup.py")
TRAP = 'raise RuntimeError("imported from the working directory")\n'
START_SECONDS = 120
COPYLEFT = {"av", "imageio-ffmpeg", "libigl", "pytetwild", "tetgen"}
"""Packages whose wheels have parts under the GPL, the LGPL or the AGPL: see NOTICE."""


@pytest.fixture(scope="module")
def installed(tmp_path_factory) -> Path:
    """Install the wheel alone into a folder; its libraries are those of the tests."""
    source, site = tmp_path_factory.mktemp("source"), tmp_path_factory.mktemp("site")
    for name in SOURCES:
        ignored = shutil.ignore_patterns("__pycache__")
        shutil.copytree(ROOT / name, source / name, ignore=ignored)
    for name in FILES:
        shutil.copy(ROOT / name, source)
    pip = [sys.executable, "-m", "pip", "install", "--quiet", "--no-deps", "--no-build-isolation"]
    pip += ["--disable-pip-version-check", "--target", str(site), str(source)]
    subprocess.run(pip, check=True, capture_output=True)
    return site


@pytest.fixture
def folder(tmp_path, monkeypatch) -> Path:
    """Stand in a folder with files that are called like packages."""
    for name in ("app", "lab", "viewers", "assets"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "__init__.py").write_text(TRAP)
    for name in ("numba", "panel", "multiprocessing"):
        (tmp_path / f"{name}.py").write_text(TRAP)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def environment(installed: Path) -> dict[str, str]:
    cache = os.environ.get("NUMBA_CACHE_DIR") or str(ROOT / "cutcell" / "__pycache__")
    return {**os.environ, "PYTHONPATH": str(installed), "NUMBA_CACHE_DIR": cache}


def command(installed: Path, *words: str) -> subprocess.CompletedProcess:
    script = [sys.executable, "-P", str(installed / "bin" / "cutcell"), *words]
    return subprocess.run(script, env=environment(installed), capture_output=True, text=True)


def test_all_that_it_installs_is_called_cutcell(installed):
    names = {path.name for path in installed.iterdir()} - {"bin"}
    assert names
    assert all(name.startswith("cutcell") for name in names), names


def test_it_has_the_licences_of_all_that_it_contains(installed):
    licenses = next(installed.glob("cutcell-*.dist-info")) / "licenses"
    assert {path.name for path in licenses.iterdir()} == {"LICENSE", "NOTICE"}


def test_all_its_packages_are_typed(installed):
    packages = [path.parent for path in installed.glob("cutcell*/__init__.py")]
    assert len(packages) == len(SOURCES)
    assert [path.name for path in packages if not (path / "py.typed").exists()] == []


def test_copyleft_is_installed_by_extras_of_its_own():
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    extras = settings["optional-dependencies"]
    allowed = {"films": {"imageio-ffmpeg"}, "copyleft": {"libigl", "pytetwild"}, "test": set()}
    for name, wanted in {"": settings["dependencies"], **extras}.items():
        packages = {re.match(r"[\w-]+", one)[0] for one in wanted}
        assert packages & COPYLEFT == allowed.get(name, set()), name
        others = {extra for one in wanted for extra in re.findall(r"cutcell\[(.+)\]", one)}
        within = {part for extra in others for part in extra.split(",")}
        assert name == "test" or not within & {"copyleft", "films", "test"}


def test_it_binds_and_draws(installed, folder):
    demo = str(installed / "cutcell_assets" / "robot.glb")
    done = command(installed, "bind", demo, "bound.glb", "--resolution", "16")
    assert done.returncode == 0, done.stderr
    assert (folder / "bound.glb").stat().st_size > 1000
    done = command(installed, "render", demo, "robot.png", "--size", "64x64", "--resolution", "16")
    assert done.returncode == 0, done.stderr
    assert (folder / "robot.png").read_bytes().startswith(b"\x89PNG")


@pytest.fixture
def page(installed, folder) -> Iterator[str]:
    words = ["app", "--no-show", "--port", "0"]
    with subprocess.Popen(
        [sys.executable, "-P", str(installed / "bin" / "cutcell"), *words],
        env=environment(installed),
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        preexec_fn=reset_signals,
    ) as process:
        try:
            reports = []
            for line in process.stdout or ():
                reports.append(line)
                if result := re.search(r"http://\S+", line):
                    yield result[0].rstrip("/.")
                    return
            pytest.fail("".join(reports))
        finally:
            process.terminate()


def test_it_serves_the_page_with_its_scripts(page):
    html = read(page + "/")
    assert "cutcell" in html
    scripts = re.findall(r'href="([^"]*scripts-[^"]*\.js)"', html)
    assert scripts
    assert all("export" in read(f"{page}/{script.lstrip('./')}") for script in scripts)


def read(address: str) -> str:
    with urlopen(Request(address), timeout=START_SECONDS) as answer:
        return answer.read().decode()
