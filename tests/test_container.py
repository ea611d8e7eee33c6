"""The container: built and started by Docker where it runs, else step by step in a new folder."""

import json
import shutil
import subprocess
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from benchmarks.visitors import BOUND, Visitor
from scripts import container_steps

pytestmark = pytest.mark.nightly

HEALTHY_SECONDS = 120
COMPILED = "from cutcell.runtime.compile_cache import is_complete; print(is_complete())"


def has_docker() -> bool:
    """Return whether a Docker daemon answers."""
    if shutil.which("docker") is None:
        return False
    return subprocess.run(["docker", "info"], capture_output=True).returncode == 0


def docker(*words: str) -> str:
    """Run a command of Docker; return what it prints."""
    return subprocess.run(
        ["docker", *words], check=True, capture_output=True, text=True, cwd=container_steps.ROOT
    ).stdout.strip()


@contextmanager
def container() -> Iterator[str]:
    """Build the image and run it; give the page's address."""
    docker("build", "--tag", "cutcell-test", ".")
    options = ["--rm", "--detach", "--read-only", "--tmpfs", "/tmp:size=1g"]
    name = docker("run", *options, "--publish", "7860:7860", "cutcell-test")
    try:
        end = time.monotonic() + HEALTHY_SECONDS
        while docker("inspect", "--format", "{{.State.Health.Status}}", name) != "healthy":
            assert time.monotonic() < end, docker("logs", name)
            time.sleep(1)
        assert docker("exec", name, "id", "-u") == "1000"
        assert docker("exec", name, "python", "-c", COMPILED) == "True"
        yield "http://localhost:7860"
    finally:
        docker("stop", name)


@contextmanager
def steps() -> Iterator[str]:
    """Run the steps of the Dockerfile in a new folder, which is not in /tmp: that is hidden."""
    with tempfile.TemporaryDirectory(dir="/var/tmp") as name:
        folder = Path(name)
        folder.chmod(0o755)
        with container_steps.running(folder) as address:
            assert list(folder.glob("opt/cutcell/lib/*/site-packages/cutcell/*/kernels-*/complete"))
            yield address


def test_the_server_in_the_container_binds_a_character():
    with container() if has_docker() else steps() as address:
        visitor = Visitor(address)
        visitor.wait_for(BOUND)
        visitor.close()


def test_only_known_steps_are_in_the_dockerfile():
    names = {line.partition(" ")[0] for line in container_steps.steps()}
    assert names == {"FROM", "WORKDIR", "ENV", "COPY", "RUN", "USER", "EXPOSE", "HEALTHCHECK",
                     "CMD"}  # fmt: skip
    (command,) = [line for line in container_steps.steps() if line.startswith("CMD")]
    assert json.loads(command.removeprefix("CMD ")) == ["sh", "/opt/cutcell/container.sh"]
