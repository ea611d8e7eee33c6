"""History of documents."""

from collections.abc import Iterator
from contextlib import contextmanager

from .document import Document

TOGETHER = 0.7
"""Changes of the same things that follow each other within this many seconds are one."""

STEPS = 200


class History:
    """The documents that a person can return to, across characters.

    Only a new document drops those that were undone.
    """

    def __init__(self, first: Document | None = None) -> None:
        self._documents = [] if first is None else [first]
        self._place = 0
        self._last: tuple[frozenset[str], float] = (frozenset(), -1e9)
        self.is_restoring = False

    def __len__(self) -> int:
        """Return the number of documents up to the present one."""
        return self._place + 1

    @property
    def now(self) -> Document | None:
        """The present document; None before any."""
        return self._documents[self._place] if self._documents else None

    @property
    def can_undo(self) -> bool:
        """Whether there is anything to go back to."""
        return self._place > 0

    @property
    def can_redo(self) -> bool:
        """Whether something was undone."""
        return self._place + 1 < len(self._documents)

    @contextmanager
    def restoring(self) -> Iterator[None]:
        """Note no choices for a while: those of the past are restored."""
        before, self.is_restoring = self.is_restoring, True
        try:
            yield
        finally:
            self.is_restoring = before

    def peek(self, by: int) -> Document | None:
        """Return the document some steps away, backwards if negative; None if there is none."""
        place = self._place + by
        return self._documents[place] if 0 <= place < len(self._documents) else None

    def go(self, by: int, now: Document) -> None:
        """Go some steps; the document there is open now as given."""
        self._place += by
        self._replace(now)
        self.part()

    def note(self, now: Document, time: float) -> None:
        """Note what is chosen now. Going to another panel by itself is no step."""
        if self.is_restoring or self.now is None:
            return
        changed = now.differences(self.now)
        if not changed - {"panel"}:
            self._replace(now)
            return
        names, when = self._last
        if changed <= names and time - when < TOGETHER and self.can_undo:
            del self._documents[self._place + 1 :]
            self._replace(now)
        else:
            self._append(now)
        self._last = (changed, time)

    def open(self, now: Document) -> None:
        """Note a character that was opened; without keys of both, nobody can go back."""
        if self.now is None or not self.now.source or not now.source:
            self._documents, self._place = [now], 0
        else:
            self._append(now)
            self._replace(now)
        self.part()

    def replace_current(self, now: Document) -> None:
        """Replace the present document; where it is the one before again, there is no step."""
        self._replace(now)
        before = self.peek(-1)
        if before is not None and not now.differences(before):
            del self._documents[self._place]
            self._place -= 1

    def part(self) -> None:
        """Make the next change a separate step, however soon it follows."""
        self._last = (frozenset(), -1e9)

    def _append(self, now: Document) -> None:
        self._documents = [*self._documents[: self._place + 1], now][-STEPS - 1 :]
        self._place = len(self._documents) - 1

    def _replace(self, now: Document) -> None:
        """Replace the present document; put those of other characters away."""
        if self._documents[self._place].own is not now.own:
            self._documents = [
                one if one.own is None or one.own is now.own else one.put_away()
                for one in self._documents
            ]
        self._documents[self._place] = now
