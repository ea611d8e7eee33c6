"""Sees to it that VTK can render off-screen and that Open3D loads: the tests need both.

Their wheels leave out some system libraries. On a machine without OpenGL, VTK does not raise: the
process dies with a segmentation fault. So each question is put to a process of its own.
"""

import subprocess
import sys

import debian

RENDER = """
import pyvista
plotter = pyvista.Plotter(off_screen=True, window_size=(64, 64))
plotter.add_mesh(pyvista.Sphere(), color="white", lighting=False)
plotter.background_color = "black"
raise SystemExit(not plotter.screenshot(return_img=True).max() > 200)
"""
LOAD = "import open3d"

NEEDS = (
    (RENDER, "OpenGL, to render scenes without a screen", ["libegl1", "libgl1-mesa-dri"]),
    (LOAD, "what Open3D loads", ["libegl1", "libgl1", "libgomp1", "libusb-1.0-0", "libx11-6"]),
)
"""What must run without an error, what it is good for, and the Debian packages it takes."""


def works(code: str) -> bool:
    """Tell whether a program runs here to its end."""
    return subprocess.run([sys.executable, "-c", code], capture_output=True).returncode == 0


def main() -> None:
    """Install what is missing, or stop and say what to install."""
    for code, what, packages in NEEDS:
        if works(code) or (debian.install(packages, what) and works(code)):
            continue
        sys.exit(
            f"The tests need {what}, and this machine lacks it.\n"
            f"On Debian or Ubuntu: sudo apt-get install {' '.join(packages)}\n"
            "Elsewhere install the same libraries. Then run make test again."
        )


if __name__ == "__main__":
    main()
