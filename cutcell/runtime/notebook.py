"""Whether a person works in a notebook."""

import sys
from contextlib import suppress


def is_notebook() -> bool:
    """Return whether IPython runs this process, as notebooks do."""
    ipython = sys.modules.get("IPython")
    return ipython is not None and ipython.get_ipython() is not None


def is_attended() -> bool:
    """Return whether a notebook's cell is run for a person, and not by a program for later readers.

    Programs that run notebooks, such as nbconvert, answer no input.
    """
    if not is_notebook():
        return False
    with suppress(Exception):  # another kernel than Jupyter's
        request = sys.modules["IPython"].get_ipython().kernel.get_parent()
        return bool(request["content"].get("allow_stdin", True))
    return True
