"""Finds a Chromium for the browser tests, or gets one.

In this order: the one that CUTCELL_CHROMIUM names, one on the PATH, Playwright's own, a
download of Playwright's own, Debian's package. One counts only if it opens a page. Run as a
script it prints the path, or stops and says what to do.
"""

import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

from playwright.sync_api import Error, sync_playwright

VARIABLE = "CUTCELL_CHROMIUM"
NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome")
FLAGS = (
    "--no-sandbox",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
)
"""Software rendering, no request of the browser's own, and it may run as root."""

DOWNLOAD_SECONDS = 600


class NoChromiumError(RuntimeError):
    """There is no Chromium that opens a page; the message says what to do."""


def find() -> str:
    """Return the path of a Chromium on this machine that opens a page.

    Raises
    ------
    NoChromiumError
        None does, or the one that CUTCELL_CHROMIUM names does not.
    """
    tried = []
    for path in _candidates():
        problem = _problem(path)
        if problem is None:
            return path
        tried.append(f"  {path}: {problem}")
        if path == os.environ.get(VARIABLE):
            break  # a person chose it: taking another one in silence would mislead
    refused = "\n".join(["These were found and do not open a page:", *tried]) if tried else ""
    raise NoChromiumError(
        "The browser tests need a Chromium, and there is none that works. Do one of these:\n"
        "  sudo apt-get install chromium\n"
        "  .venv/bin/playwright install --with-deps chromium\n"
        f"  export {VARIABLE}=/path/to/chromium\n" + refused
    )


def get() -> str:
    """Return the path of a Chromium that opens a page, fetching one if need be."""
    _check_playwright()
    try:
        return find()
    except NoChromiumError:
        if os.environ.get(VARIABLE):
            raise
    for fetch in (_download, _install_package):
        if fetch():
            try:
                return find()
            except NoChromiumError:
                continue
    return find()


def _check_playwright() -> None:
    """See that Playwright itself runs: its Node needs a library that bare systems lack."""
    command = [sys.executable, "-m", "playwright", "--version"]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode != 0:
        import debian

        debian.install(["libatomic1"], "for Playwright, which drives the browser")
        done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode != 0:
        raise NoChromiumError(
            "Playwright, which drives the browser, does not run on this machine:\n"
            f"{done.stderr.strip()}\n"
            "On Debian or Ubuntu: sudo apt-get install libatomic1\n"
        )


def _candidates() -> Iterator[str]:
    if chosen := os.environ.get(VARIABLE):
        yield chosen
    for name in NAMES:
        if path := shutil.which(name):
            yield path
    with sync_playwright() as playwright:
        own = playwright.chromium.executable_path
    if Path(own).exists():
        yield own


def _problem(path: str) -> str | None:
    """Why this Chromium does not open a page, in a line; None if it does."""
    with sync_playwright() as playwright:
        try:
            browser = playwright.chromium.launch(executable_path=path, args=list(FLAGS))
            page = browser.new_page()
            page.goto("data:text/html,<title>cutcell</title>")
            title = page.title()
            browser.close()
        except Error as error:
            lines = [line.strip() for line in error.message.splitlines() if line.strip()]
            telling = [line for line in lines if "error while loading" in line]
            return (telling or lines or ["it failed without a word"])[0]
    return None if title == "cutcell" else "the page came out wrong"


def _download() -> bool:
    print("Downloading Playwright's Chromium", file=sys.stderr, flush=True)
    command = [sys.executable, "-m", "playwright", "install", "chromium"]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=DOWNLOAD_SECONDS)
    except subprocess.TimeoutExpired:
        print("  it did not come within ten minutes", file=sys.stderr)
        return False
    if done.returncode != 0:
        reason = (done.stderr or done.stdout).strip().splitlines()[:1]
        print(f"  not possible: {''.join(reason)}", file=sys.stderr)
    return done.returncode == 0


def _install_package() -> bool:
    import debian

    return debian.install(["chromium"], "for the browser tests")


if __name__ == "__main__":
    try:
        print(get())
    except NoChromiumError as error:
        sys.exit(str(error))
