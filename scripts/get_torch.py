"""Sees to it that torch is there, in the smallest build that can be had: one for CPUs.

PyPI's build for Linux brings gigabytes for GPUs. A build for CPUs has "+cpu" in its version: it is
looked for where pip looks, then in PyTorch's own index. Elsewhere PyPI's build is one for CPUs.
Only where no such build is found, PyPI's large one is installed, and it is said.
"""

import subprocess
import sys

VERSION = "2.13.0"
INDEX = "https://download.pytorch.org/whl/cpu"
QUICK = ["--retries", "1", "--timeout", "20"]
"""For what may not be there."""


def choices(platform: str) -> list[list[str]]:
    """Return what pip is asked for, one after the other until one can be had."""
    plain = [f"torch=={VERSION}"]
    if not platform.startswith("linux"):
        return [plain]
    small = [f"torch=={VERSION}+cpu", *QUICK]
    # The index has torch alone of this version; the rest comes from where it always does.
    return [small, [*small, "--extra-index-url", INDEX], plain]


def there() -> bool:
    """Tell whether torch can be imported here, of whichever build."""
    code = f"import torch; raise SystemExit(torch.__version__.split('+')[0] != '{VERSION}')"
    return subprocess.run([sys.executable, "-c", code], capture_output=True).returncode == 0


def main() -> None:
    """Install torch unless it is there, or stop and say what to do."""
    if there():
        return
    pip = [sys.executable, "-m", "pip", "--disable-pip-version-check", "install", "--quiet"]
    wanted = choices(sys.platform)
    for number, arguments in enumerate(wanted):
        large = number > 0 and arguments == wanted[-1]
        what = f"{arguments[0]}, which brings gigabytes for GPUs" if large else arguments[0]
        print(f"Installing {what} (some minutes the first time)", file=sys.stderr, flush=True)
        done = subprocess.run([*pip, *arguments], capture_output=not large, text=True)
        if done.returncode == 0 and there():
            return
    sys.exit(
        f"torch {VERSION} could not be installed; the tests of networks need it, nothing else does."
        f"\nInstall a build for CPUs: pip install torch=={VERSION} --index-url {INDEX}\n"
        "Then run make test-networks again."
    )


if __name__ == "__main__":
    main()
