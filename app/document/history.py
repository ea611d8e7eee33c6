"""History of choices."""

from collections.abc import Collection
from typing import Any

Choices = dict[str, Any]

TOGETHER = 0.7
"""Changes of the same things that follow each other within this many seconds are one."""

STEPS = 200


class History:
    """The choices that a person can go back to; `now` is what is chosen at first."""

    def __init__(self, now: Choices) -> None:
        self._now = now
        self._past: list[Choices] = []
        self._future: list[Choices] = []
        self._last: tuple[frozenset[str], float] = (frozenset(), -1e9)

    @property
    def now(self) -> Choices:
        """The present choices."""
        return self._now

    def replace_current(self, now: Choices) -> None:
        """Note what is chosen now in place of what was; it is no step."""
        self._now = now

    def turn(self, now: Choices, without: Collection[str]) -> None:
        """Note another character: what was chosen is kept, without what only the old one has."""
        self._past = [*self._past, self._now][-STEPS:]
        self._future.clear()
        self.drop(without)
        self._now = now
        self.part()

    def drop(self, without: Collection[str]) -> None:
        """Forget choices that only applied to the character that was open."""
        for steps in (self._past, self._future):
            steps[:] = [{k: v for k, v in one.items() if k not in without} for one in steps]

    @property
    def can_undo(self) -> bool:
        """Whether there is anything to go back to."""
        return bool(self._past)

    @property
    def can_redo(self) -> bool:
        """Whether something was undone."""
        return bool(self._future)

    def note(self, now: Choices, time: float) -> None:
        """Note what is chosen now. Going to another panel by itself is no step."""
        changed = frozenset(name for name in now if now[name] != self._now.get(name))
        if not changed - {"panel"}:
            self._now = now
            return
        names, when = self._last
        if not (changed <= names and time - when < TOGETHER and self._past):
            self._past.append(self._now)
            del self._past[:-STEPS]
        self._future.clear()
        self._now, self._last = now, (changed, time)

    def part(self) -> None:
        """Make the next change a separate step, however soon it follows."""
        self._last = (frozenset(), -1e9)

    def withdraw(self, now: Choices) -> None:
        """Take a choice back that could not be: what is chosen now was so before it."""
        self._now = now
        if self._past and self._past[-1] == now:
            self._past.pop()

    def undo(self) -> Choices | None:
        """Return what was chosen before, and make it what is chosen now."""
        return self._go(self._past, self._future)

    def redo(self) -> Choices | None:
        """Return what was undone last, and make it what is chosen now."""
        return self._go(self._future, self._past)

    def _go(self, source: list[Choices], other: list[Choices]) -> Choices | None:
        if not source:
            return None
        other.append(self._now)
        self._now = source.pop()
        self.part()
        return self._now
