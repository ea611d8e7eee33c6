"""Installs Debian packages where that is possible: as root, with apt-get."""

import os
import shutil
import subprocess
import sys


def install(packages: list[str], what_for: str) -> bool:
    """Install packages by apt-get; False where that is not possible or did not work."""
    if not shutil.which("apt-get") or os.geteuid() != 0:
        return False
    print(f"Installing Debian's {', '.join(packages)} ({what_for})", file=sys.stderr, flush=True)
    environment = os.environ | {"DEBIAN_FRONTEND": "noninteractive"}
    quiet = ["-qq", "-o", "Dpkg::Use-Pty=0"]
    commands = [
        ["apt-get", "update", *quiet],
        ["apt-get", "install", "-y", "--no-install-recommends", *quiet, *packages],
    ]
    for command in commands:
        done = subprocess.run(command, env=environment, capture_output=True, text=True)
        if done.returncode != 0:
            print(done.stdout, done.stderr, sep="", file=sys.stderr)
            return False
    return True
