"""Whether a person works in a notebook."""

import sys


def is_notebook() -> bool:
    """Return whether IPython runs this process, as notebooks do."""
    ipython = sys.modules.get("IPython")
    return ipython is not None and ipython.get_ipython() is not None
