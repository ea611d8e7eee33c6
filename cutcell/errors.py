"""Errors for users: each says what was wrong, where, and what to do. Warnings with a finding."""

from typing import Self


class CutcellError(ValueError):
    """Base of all errors that a file, a rig or a parameter can cause."""


class FileError(CutcellError):
    """A file is missing, unreadable, or not what its name says."""


class MeshError(CutcellError):
    """A mesh cannot be used: no faces, coordinates that are not numbers, bad indices."""


class SkeletonError(CutcellError):
    """A skeleton cannot be used: no joints, a cycle, a joint in another unit."""


class WeightsError(CutcellError):
    """Weights do not fit their mesh or skeleton."""


class ParameterError(CutcellError):
    """A parameter is out of its range."""


class TooLargeError(CutcellError):
    """The requested computation would not fit in memory."""


class MissingLibraryError(CutcellError):
    """An optional library is needed and absent."""


class Cancelled(Exception):
    """Raised by a progress callback to stop a computation; never by cutcell itself."""


def comes_from_ctrl_c(error: BaseException | None) -> bool:
    """Return whether an error is Ctrl-C, or was raised because of it.

    numba's dispatcher raises `SystemError` where Ctrl-C comes while it looks at its arguments.
    """
    while error is not None and not isinstance(error, KeyboardInterrupt):
        error = error.__cause__ or error.__context__
    return error is not None


class LocatedWarning(str):
    """A warning about elements of a rig.

    `code` is that of the finding of `cutcell.diagnose` that locates them.
    """

    code: str

    def __new__(cls, text: str, code: str = "") -> Self:
        """Return the text with a code."""
        warning = super().__new__(cls, text)
        warning.code = code
        return warning
