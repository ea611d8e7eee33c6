"""Run the steps of the Dockerfile without Docker, in a new folder.

The image's folders are below FOLDER, packages of the system are left out, and the base image is
this Python. The server is started as the image's user; as root, all but /tmp is read-only where
folders can be mounted. The script ends with an error unless the health check succeeds and the page
is answered.
"""

import argparse
import json
import os
import re
import shutil
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from urllib.error import URLError
from urllib.request import urlopen

ROOT = Path(__file__).resolve().parents[1]
PAGE = "http://localhost:7860/"
START_SECONDS = 120
READ_ONLY = (
    "mount --make-rprivate / && mount --bind / / && mount -o remount,bind,ro / "
    "&& mount -t tmpfs tmpfs /tmp && chmod 1777 /tmp "
)
STAGE_FOLDERS = ("/source", "/opt/cutcell")


class Image:
    """The steps of a Dockerfile, with the image's folders below another folder."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.environment = {"PATH": os.environ["PATH"], "LANG": "C.UTF-8"}
        self.working = folder
        self.user, self.command, self.check = "0", [], ""

    def at(self, text: str) -> str:
        """Return a step with the image's folders replaced."""
        for name in STAGE_FOLDERS:
            text = re.sub(rf"(?<![\w.]){name}\b", str(self.folder) + name, text)
        return text

    def run(self, line: str) -> None:
        """Run a step of the image."""
        step, _, rest = line.partition(" ")
        print(line, flush=True)
        if step == "FROM":
            self.environment.pop("NUMBA_CPU_NAME", None)
        elif step == "WORKDIR":
            self.working = Path(self.at(rest))
            self.working.mkdir(parents=True, exist_ok=True)
        elif step == "ENV":
            self.environment |= dict(pair.split("=", 1) for pair in self.at(rest).split())
        elif step == "COPY":
            self.copy(self.at(rest))
        elif step == "RUN" and "apt-get" not in rest:
            subprocess.run(
                self.at(rest), shell=True, check=True, cwd=self.working, env=self.environment
            )
        elif step == "USER":
            self.user = rest.partition(":")[0]
        elif step == "HEALTHCHECK":
            self.check = rest.partition("CMD ")[2]
        elif step == "CMD":
            self.command = json.loads(self.at(rest))
        elif step not in ("RUN", "EXPOSE"):
            raise ValueError(f"unknown step: {line}")

    def copy(self, rest: str) -> None:
        """Copy what .dockerignore leaves, or one file; stages share their folders."""
        if rest.startswith("--from"):
            return
        source, target = rest.split()
        if source != ".":
            shutil.copy(ROOT / source, self.working / target)
            return
        for name in (ROOT / ".dockerignore").read_text(encoding="utf-8").splitlines():
            path = ROOT / name.removeprefix("!")
            if name.startswith("!") and path.is_dir():
                ignored = shutil.ignore_patterns("__pycache__")
                shutil.copytree(path, self.working / path.name, ignore=ignored)
            elif name.startswith("!"):
                (self.working / path.relative_to(ROOT)).parent.mkdir(exist_ok=True)
                shutil.copy(path, self.working / path.relative_to(ROOT))

    def start(self) -> subprocess.Popen:
        """Start the server as the image's user."""
        command = self.command
        if os.getuid() == 0:
            words = ["setpriv", "--reuid", self.user, "--regid", self.user, "--clear-groups"]
            if can_mount():
                script = f'{READ_ONLY} {shown_python()} && cd /tmp && exec {" ".join(words)} "$@"'
                command = ["unshare", "--mount", "sh", "-c", script, "sh", *command]
            elif not shown_python():
                command = [*words, *command]
        # The base image's Python comes last, as there.
        path = f"{self.environment['PATH']}:{Path(sys.executable).parent}"
        return subprocess.Popen(command, cwd="/tmp", env={**self.environment, "PATH": path})


def can_mount() -> bool:
    """Return whether folders can be mounted, which many containers refuse even to root."""
    trial = ["unshare", "--mount", "sh", "-c", "mount --make-rprivate / && mount --bind / /"]
    return subprocess.run(trial, capture_output=True).returncode == 0


def shown_python() -> str:
    """Return commands that let all users run this Python, where it is in a folder of root's."""
    base = Path(sys.base_prefix).resolve()
    hidden = [folder for folder in reversed(base.parents) if not folder.stat().st_mode & 1]
    if not hidden:
        return ""
    return (
        f"&& mkdir /tmp/base && mount --bind {base} /tmp/base "
        f"&& mount -t tmpfs -o mode=755 tmpfs {hidden[0]} "
        f"&& mkdir -p {base} && mount --bind /tmp/base {base}"
    )


def steps() -> list[str]:
    """Return the steps of the Dockerfile, one a line."""
    text = (ROOT / "Dockerfile").read_text(encoding="utf-8").replace("\\\n", "")
    return [line for line in text.splitlines() if line.strip() and not line.startswith("#")]


def answers() -> bool:
    """Return whether the page is answered."""
    try:
        with urlopen(PAGE, timeout=5) as answer:
            return b"bokeh" in answer.read()
    except (URLError, OSError):
        return False


@contextmanager
def running(folder: Path) -> Iterator[str]:
    """Build the image's folders, and run the server in them; give the page's address."""
    image = Image(folder)
    for line in steps():
        image.run(line)
    server = image.start()
    try:
        end = time.monotonic() + START_SECONDS
        while not answers():
            if server.poll() is not None or time.monotonic() > end:
                sys.exit("The server does not answer.")
            time.sleep(0.5)
        subprocess.run(image.check, shell=True, check=True, env=image.environment)
        (uid,) = re.findall(r"^Uid:\t(\d+)", Path(f"/proc/{server.pid}/status").read_text(), re.M)
        if uid == "0":
            sys.exit("The server runs as root.")
        print(f"The server is healthy and runs as user {uid}.")
        yield PAGE.rstrip("/")
    finally:
        server.terminate()
        server.wait(30)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    with running(parser.parse_args().folder.resolve()):
        pass
