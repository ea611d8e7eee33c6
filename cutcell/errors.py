"""Every error a user can meet: each says what was wrong, where, and what to do."""


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
    """What was asked for would not fit in memory."""


class MissingLibraryError(CutcellError):
    """An optional library is needed and absent."""


class Cancelled(Exception):
    """Raised by a progress callback to stop a computation; never by cutcell itself."""
