"""Reading whole files, with errors that name them."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from ..errors import CutcellError, FileError
from ..runtime.writing import reason

LONGEST = 200
"""Characters of what another library says."""
LONGEST_SENTENCE = 1000


@contextmanager
def naming(path: Path) -> Iterator[None]:
    """Put the file's name in front of every cutcell error raised inside.

    Where several of these stand inside each other, the innermost knows best.
    """
    try:
        yield
    except CutcellError as e:
        if "named" in vars(e):
            raise
        named, sentence = e, str(e)
        if not sentence.startswith((f"{path}:", f"{path.name}:")):
            sentence = f"{path.name}: {sentence}"
        sentence = _short(sentence)
        if sentence != str(e):
            named = type(e)(sentence)
        vars(named)["named"] = True
        if named is e:
            raise
        raise named from e


def _short(sentence: str) -> str:
    """Return a sentence on one line, cut in the middle: files hold words of any kind and length."""
    sentence = " ".join(sentence.splitlines())
    if len(sentence) <= LONGEST_SENTENCE:
        return sentence
    half = LONGEST_SENTENCE // 2
    return f"{sentence[:half]} ... {sentence[-half:]}"


def read_bytes(path: Path) -> bytes:
    """Read a file that must exist, be a file, and hold something."""
    try:
        data = path.read_bytes()
    except FileNotFoundError:
        raise FileError(f"{path}: there is no such file") from None
    except IsADirectoryError:
        raise FileError(f"{path}: is a folder; give a file in it") from None
    except (OSError, ValueError) as e:  # ValueError: a null byte in the path
        raise FileError(f"{path}: cannot be read ({reason(e)})") from None
    if not data:
        raise FileError(f"{path.name}: the file is empty")
    return data


def one_line(error: Exception) -> str:
    """Return what another library says of a file, as part of a sentence."""
    said = " ".join(str(error).split()) or type(error).__name__
    return said if len(said) <= LONGEST else f"{said[:LONGEST]}..."


def read_text(path: Path) -> str:
    """Read a text file in UTF-8."""
    try:
        return read_bytes(path).decode("utf-8-sig")
    except UnicodeDecodeError as e:
        raise FileError(f"{path.name}: is not a text file (byte {e.start} is not UTF-8)") from None
