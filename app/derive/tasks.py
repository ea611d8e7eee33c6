"""What a person starts: one task after the other, none of them lost."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from cutcell.runtime.progress import Progress

from .jobs import COMPUTING, Slots
from .work import Work


class Task:
    """Something that a person starts and that may take long.

    Attributes
    ----------
    name : str
        Name of its work.
    title : str
        What the page says while it waits.
    supersedes : bool
        Whether it takes the place of tasks of its name.
    slots : Slots
    """

    name = ""
    title = ""
    supersedes = False
    slots: Slots = COMPUTING

    def begin(self) -> Callable[[Progress], Any] | None:
        """Return what has to be computed, when its turn comes; None if all is done."""
        raise NotImplementedError

    def finish(self, result: Any) -> None:
        """Take what was computed."""

    def drop(self) -> None:
        """End without a result: after an error, or when a person cancels."""


class Tasks:
    """Tasks of one page, which follow each other.

    Parameters
    ----------
    work : Work
        Where they compute.
    failed : callable
        Takes what goes wrong on the page's own thread.
    changed : callable
        Called when other tasks wait.
    """

    def __init__(
        self,
        work: Work,
        failed: Callable[[Exception], None],
        changed: Callable[[], None] = lambda: None,
    ) -> None:
        self._work, self._failed, self._changed = work, failed, changed
        self._waiting: list[Task] = []
        self._running: Task | None = None

    @property
    def titles(self) -> list[str]:
        """What waits."""
        return [task.title for task in self._waiting]

    @property
    def running(self) -> str:
        """Name of the work of the task that runs, or empty."""
        return "" if self._running is None else self._running.name

    def add(self, task: Task) -> None:
        """Begin a task as soon as those before it have ended."""
        if task.supersedes:
            self._drop(lambda other: other.name == task.name)
        self._waiting.append(task)
        self._proceed()

    def cancel(self) -> bool:
        """Stop what runs and drop what waits; return whether there was anything."""
        return self._drop(lambda task: True)

    def _drop(self, chosen: Callable[[Task], bool]) -> bool:
        dropped = [task for task in self._waiting if chosen(task)]
        self._waiting = [task for task in self._waiting if not chosen(task)]
        running = self._running
        if running is not None and chosen(running):
            self._running = None
            self._work.cancel(running.name)
            dropped.append(running)
        for task in dropped:
            task.drop()
        self._changed()
        return bool(dropped)

    def _proceed(self) -> None:
        while self._waiting and self._running is None:
            self._running = task = self._waiting.pop(0)
            try:
                compute = task.begin()
            except Exception as error:
                self._running = None
                self._failed(error)
                task.drop()
                continue
            if compute is None:
                self._running = None
            else:
                self._compute(task, compute)
        self._changed()

    def _compute(self, task: Task, compute: Callable[[Progress], Any]) -> None:
        def done(result: Any) -> None:
            self._running = None
            try:
                task.finish(result)
            except Exception:
                task.drop()
                raise
            finally:
                self._proceed()

        def failed() -> None:
            self._running = None
            task.drop()
            self._proceed()

        self._work.start(task.name, compute, done, failed, task.slots)
