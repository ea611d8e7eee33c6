"""How other processes of the same Python are started."""

import os
import sys


def python_environment() -> dict[str, str]:
    """Return an environment in which another Python finds the packages that this one does.

    Whatever lies in the folder that it is started in takes the place of none.
    """
    path = os.pathsep.join(filter(None, sys.path))
    return {**os.environ, "PYTHONPATH": path, "PYTHONSAFEPATH": "1"}
