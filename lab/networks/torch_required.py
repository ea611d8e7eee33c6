"""Say how to install torch where it is missing."""

from importlib.util import find_spec

from cutcell.errors import MissingLibraryError


def check_torch() -> None:
    """Raise MissingLibraryError, which says what to install, unless torch is there."""
    if find_spec("torch") is None:
        raise MissingLibraryError(
            "networks are trained and evaluated by torch, which is not installed; try: "
            "pip install 'cutcell[networks]' (a CPU is enough; for a small build see "
            "docs/networks.md)"
        )
