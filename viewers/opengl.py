"""Whether this machine can draw pictures."""

import subprocess
import sys
from functools import cache

from cutcell.errors import MissingLibraryError
from cutcell.runtime.subprocesses import python_environment

TRIAL = """
import cutcell_viewers.scene, pyvista
plotter = pyvista.Plotter(off_screen=True, window_size=(16, 16))
plotter.add_mesh(pyvista.Sphere())
plotter.screenshot(return_img=True)
"""


def require_opengl() -> None:
    """Make sure that VTK can draw without a screen.

    Raises
    ------
    MissingLibraryError
        It cannot; the sentence says what to install.
    """
    if not _can_draw():
        raise MissingLibraryError(
            "this machine has no OpenGL to draw a picture with; on Debian or Ubuntu install "
            "it by: apt-get install libegl1 libgl1-mesa-dri"
        )


@cache
def _can_draw() -> bool:
    # Without OpenGL VTK does not raise, the process dies: so another one is asked, once.
    command = [sys.executable, "-c", TRIAL]
    done = subprocess.run(command, capture_output=True, timeout=120, env=python_environment())
    return done.returncode == 0
