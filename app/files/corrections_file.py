"""Corrections that are too long for an address: stored among the uploads by a key."""

from cutcell.editing.corrections import Corrections
from cutcell.errors import CutcellError

from ..state.corrections import MAX_IN_ADDRESS, MAX_VERTICES, from_text, to_text
from .upload_cache import Group, PageUploads

KEY = "~"
"""Prefix of keys; no text of corrections begins with it."""


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
        self._key = ""
        self._last_text: tuple[Corrections, str] = (Corrections(), "")

    def text_of(self, corrections: Corrections) -> str:
        """Return what an address says of corrections: all of them, or a key; "" for none.

        Raises
        ------
        FileError
            They are too long, and the server's storage is full.
        OSError
            They cannot be written.
        """
        if corrections is not self._last_text[0]:
            few = len(corrections.vertices) <= MAX_VERTICES
            text = to_text(corrections) if corrections and few else ""
            if not few or len(text) > MAX_IN_ADDRESS:
                self._last_text = (corrections, "")  # should it fail, then once
                text = self._store(corrections)
            self._last_text = (corrections, text)
        return self._last_text[1]

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
        self._key = text[1:]
        try:
            loaded = Corrections.load(paths[0])
        except CutcellError as error:
            raise ValueError(str(error)) from None
        self._last_text = (loaded, text)
        return loaded

    def close(self) -> None:
        """Use the files no longer; they stay for a while."""
        self._leave()
        if self._group is not None:
            self._uploads.cache.leave(self._group.key)
            self._group = None

    def _leave(self) -> None:
        if self._key:
            self._uploads.cache.leave(self._key)
            self._key = ""

    def _store(self, corrections: Corrections) -> str:
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
