"""Edits as text for an address; those that are too long are stored among the uploads by a key."""

import base64
import binascii
import zlib

from cutcell.editing import Edits
from cutcell.errors import CutcellError

from .upload_cache import Group, PageUploads

MAX_IN_ADDRESS = 1500
"""Letters: longer addresses are cut by some programs that pass them on."""
MAX_VERTICES = 300
"""Largest number of overruled vertices that are written into an address."""
MAX_BYTES = 4 * 2**20
"""Longest edits as JSON in an address: some characters are overruled vertex by vertex."""
KEY = "~"
"""Prefix of keys; no text of edits begins with it."""


class EditsFile:
    """The file of one page's edits, if they are long."""

    def __init__(self, uploads: PageUploads) -> None:
        self._uploads = uploads
        self._group: Group | None = None
        self._key = ""
        self._last_text: tuple[Edits, str] = (Edits(), "")

    def text_of(self, edits: Edits, opening: Edits) -> str:
        """Return edits for an address: all of them, or a key; "" for those of a file just opened.

        Layers that a file holds are always in the address: its settings follow their method else.
        """
        if edits is not self._last_text[0]:
            few = vertices_named(edits) <= MAX_VERTICES
            is_new = edits != opening or bool(opening.layers)
            text = to_text(edits) if is_new and few else ""
            if not few or len(text) > MAX_IN_ADDRESS:
                self._last_text = (edits, "")  # do not try again after an error
                text = self._store(edits)
            self._last_text = (edits, text)
        return self._last_text[1]

    def read(self, text: str) -> Edits | None:
        """Return the edits of an address; None if the server no longer has them."""
        if not text.startswith(KEY):
            return from_text(text)
        paths = self._uploads.cache.take(text[1:])
        if paths is None:
            return None
        self._leave()
        self._key = text[1:]
        try:
            loaded = Edits.load(paths[0])
        except CutcellError as error:
            raise ValueError(str(error)) from None
        self._last_text = (loaded, text)
        return loaded

    def close(self) -> None:
        """Stop using the files, which are kept for a while."""
        self._leave()
        if self._group is not None:
            self._uploads.cache.leave(self._group.key)
            self._group = None

    def _leave(self) -> None:
        if self._key:
            self._uploads.cache.leave(self._key)
            self._key = ""

    def _store(self, edits: Edits) -> str:
        content = edits.to_json(indent=None).encode()
        old, self._group = self._group, None
        if old is not None:
            self._uploads.cache.leave(old.key)
        group = self._uploads.cache.begin(len(content), self._uploads)
        path = group.folder / "edits.json"
        group.written = path.write_bytes(content)
        group.paths = [path]
        self._group = group
        return KEY + group.key


def vertices_named(edits: Edits) -> int:
    """Return how many vertices layers name one by one."""
    lists = [
        one
        for layer in edits.layers
        for one in (layer.mask.vertices, getattr(layer.content, "vertices", None))
    ]
    return sum(len(one) for one in lists if one is not None)


def to_text(edits: Edits) -> str:
    """Return edits in letters that an address may hold."""
    packed = zlib.compress(edits.to_json(indent=None).encode(), 9)
    return base64.urlsafe_b64encode(packed).decode().rstrip("=")


def from_text(text: str) -> Edits:
    """Read what `to_text` returns; raise a `ValueError` for other texts."""
    try:
        packed = base64.urlsafe_b64decode(text + "=" * (-len(text) % 4))
        plain = zlib.decompressobj().decompress(packed, MAX_BYTES)
        return Edits.from_json(plain.decode())
    except (binascii.Error, zlib.error, UnicodeDecodeError, CutcellError) as error:
        raise ValueError(str(error)) from None
