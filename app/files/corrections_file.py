"""Corrections that no address has room for: kept among the uploads, by a key that it has."""

from cutcell.editing.corrections import Corrections
from cutcell.errors import CutcellError

from ..state.corrections import MAX_IN_ADDRESS, MAX_VERTICES, from_text, to_text
from .upload_cache import Group, PageUploads

KEY = "~"
"""What a key begins with; no text of corrections does."""


class CorrectionsFile:
    """The file of one page's corrections, which it has only where they are long.

    Parameters
    ----------
    uploads : PageUploads
        Of the page.
    """

    def __init__(self, uploads: PageUploads) -> None:
        self._uploads = uploads
        self._group: Group | None = None
        self._taken = ""
        self._said: tuple[Corrections, str] = (Corrections(), "")

    def said(self, corrections: Corrections) -> str:
        """Return what an address says of corrections: all of them, or a key; "" for none.

        Raises
        ------
        FileError
            They are too long, and the server has no room for them.
        OSError
            They cannot be written.
        """
        if corrections is not self._said[0]:
            few = len(corrections.vertices) <= MAX_VERTICES
            text = to_text(corrections) if corrections and few else ""
            if not few or len(text) > MAX_IN_ADDRESS:
                self._said = (corrections, "")  # should it fail, then once
                text = self._kept(corrections)
            self._said = (corrections, text)
        return self._said[1]

    def read(self, text: str) -> Corrections | None:
        """Return what an address says; None where the server no longer has it.

        Raises
        ------
        ValueError
            It says something else.
        """
        if not text.startswith(KEY):
            return from_text(text)
        paths = self._uploads.cache.take(text[1:])
        if paths is None:
            return None
        self._leave()
        self._taken = text[1:]
        try:
            loaded = Corrections.load(paths[0])
        except CutcellError as error:
            raise ValueError(str(error)) from None
        self._said = (loaded, text)
        return loaded

    def close(self) -> None:
        """Use the files no longer; they stay for a while."""
        self._leave()
        if self._group is not None:
            self._uploads.cache.leave(self._group.key)
            self._group = None

    def _leave(self) -> None:
        if self._taken:
            self._uploads.cache.leave(self._taken)
            self._taken = ""

    def _kept(self, corrections: Corrections) -> str:
        content = corrections.to_json(indent=None).encode()
        old, self._group = self._group, None
        if old is not None:
            self._uploads.cache.leave(old.key)
        group = self._uploads.cache.begin(len(content), self._uploads)
        path = group.folder / "corrections.json"
        path.write_bytes(content)
        group.paths = [path]
        self._group = group
        return KEY + group.key
