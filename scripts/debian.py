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
    # What apt-get says is for the log, and standard output is not: it may carry a result.
    return all(
        subprocess.run(c, env=environment, stdout=sys.stderr).returncode == 0 for c in commands
    )
