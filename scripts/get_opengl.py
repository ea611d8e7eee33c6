"""Sees to it that VTK can render off-screen, which the tests of the scenes need.

VTK's wheel brings no OpenGL. On a machine without one it does not raise: the process dies
with a segmentation fault. So the question is put to a process of its own.
"""

import subprocess
import sys

import debian

PACKAGES = ["libegl1", "libgl1-mesa-dri"]

RENDER = """
import pyvista
plotter = pyvista.Plotter(off_screen=True, window_size=(64, 64))
plotter.add_mesh(pyvista.Sphere(), color="white", lighting=False)
plotter.background_color = "black"
raise SystemExit(not plotter.screenshot(return_img=True).max() > 200)
"""


def can_render() -> bool:
    """Tell whether VTK renders a white sphere here."""
    command = [sys.executable, "-c", RENDER]
    return subprocess.run(command, capture_output=True, timeout=120).returncode == 0


def main() -> None:
    """Install OpenGL where it is missing, or stop and say what to install."""
    if can_render():
        return
    if debian.install(PACKAGES, "OpenGL, to render scenes without a screen") and can_render():
        return
    sys.exit(
        "VTK cannot render off-screen on this machine, and the tests of the scenes need it.\n"
        f"On Debian or Ubuntu: sudo apt-get install {' '.join(PACKAGES)}\n"
        "Elsewhere install Mesa's EGL or OSMesa. Then run make test again."
    )


if __name__ == "__main__":
    main()
