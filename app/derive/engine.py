"""The engine of derived results: it computes what is wanted and out of date.

It is also what tells everything else of a change: what follows the state is called once all results
hold again, and only where it has read what changed.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Set
from functools import partial
from typing import Any

from param.parameterized import batch_call_watchers

from cutcell.runtime.progress import silent

from .derived import Derived, Inputs
from .jobs import WAITING
from .reading import ReadOnlyState, Recorded
from .work import Work

RULES, VIEW, WIDGETS = range(3)
"""Levels of what follows the state: choices that follow others, the view, the page around it."""

Follow = Callable[[Set[str], bool], None]
"""Takes the names of parameters that have changed, and whether all widgets are to be reset."""


class _Entry:
    """A result, or a part of one, as the engine knows it."""

    def __init__(self, derived: Derived, part: tuple[Hashable, ...]) -> None:
        self.derived, self.part, self.key = derived, part, (derived.name, *part)
        self.inputs: Recorded[Inputs | None] = Recorded(derived.inputs, *part)
        self.wanted: Recorded[bool] = Recorded(derived.wanted, *part)
        self.values: list[tuple[Inputs, Any]] = []
        self.shown: Any = None
        self.computed: Inputs = ()  # inputs of the computation that runs
        self.refused: Inputs | None = None  # inputs that failed, or that a person cancelled
        self.awaited: Inputs | None = None  # inputs that wait for a pause

    def holds(self, inputs: Inputs) -> bool:
        """Return whether the newest value holds for some inputs."""
        return any(self.derived.current(old, inputs) for old, _ in self.values[:1])

    def refuses(self, inputs: Inputs) -> bool:
        """Return whether these inputs are not to be tried again."""
        return self.refused is not None and self.derived.current(self.refused, inputs)

    def choose(self, inputs: Inputs | None) -> Any:
        """Return the value to show, or None; forget values that can no longer be shown."""
        current, keeps = self.derived.current, self.derived.keeps
        if inputs is None:
            self.values = []
            return None
        values = [one for one in self.values if current(one[0], inputs)]
        rest = [one for one in self.values if not current(one[0], inputs) and keeps(one[0], inputs)]
        self.values = [*values, *rest][: self.derived.cached]
        return self.values[0][1] if self.values else None


class _Current(ReadOnlyState):
    """The state for results: each one that is read is brought up to the state first."""

    def __init__(self, state: Any, refresh: Callable[[str], None]) -> None:
        super().__init__(type(state), state)
        self.__dict__["_refresh"] = refresh

    def __getattr__(self, name: str) -> Any:
        self._refresh(name)
        return super().__getattr__(name)


class Engine:
    """Keeps the results of one page up to its state; all methods belong to the page's thread.

    Values that no longer hold are taken away, what is no longer wanted is stopped, and what is
    missing is computed. What failed, or was refused, is not tried again with the same inputs.

    Parameters
    ----------
    state : param.Parameterized
        It holds the results, and in `computing` the keys of those that are being computed: the
        name, and the part if there are parts; in `queued` of those that wait for other pages.
    work : Work
        Computations run there by their keys, beside the work that a person starts.
    owner : object
        Argument of `Derived.failed`.
    """

    def __init__(self, state: Any, work: Work, owner: Any = None) -> None:
        self._state, self._work, self._owner = state, work, owner
        self._declared: dict[str, Derived] = {}
        self._due: dict[str, Derived] = {}
        self._rested: Hashable = None
        self._current = _Current(state, self._refresh_result)
        self._parts: dict[str, Recorded[tuple[Hashable, ...]]] = {}
        self._entries: dict[tuple[Hashable, ...], _Entry] = {}
        self._failures: list[Callable[[], None]] = []
        self._updating = self._again = False
        self._followers: list[tuple[int, Follow, set[str]]] = []
        self._is_reset = self._following = False
        # Results come before all other watchers, and what is shown of the state after them.
        names = [name for name in state.param if name != "name"]
        state.param.watch(self._changed, names)
        state.param.watch(self._noted, names, precedence=1)

    def declare(self, results: Iterable[Derived]) -> None:
        """Keep results up to the state from now on."""
        self._declared = {one.name: one for one in results}
        self._parts = {
            name: Recorded(lambda state, parts=one.parts: tuple(parts(state)))
            for name, one in self._declared.items()
            if one.parts is not None
        }

    def follow(self, act: Follow, level: int) -> None:
        """Call a function after changes, when all results hold and lower levels have acted."""
        self._followers.append((level, act, set()))
        self._followers.sort(key=lambda one: one[0])

    def when(self, function: Callable[[Any], Any], act: Callable[[Any], Any]) -> None:
        """Call `act` with the value of a function of the state after each change of it."""
        cell = Recorded(function)
        before = cell.read(self._state)

        def changed(names: Set[str], is_reset: bool) -> None:
            nonlocal before
            if cell.forget(names) and (value := cell.read(self._state)) is not before:
                before = value
                act(value)

        self.follow(changed, RULES)

    def update(self, *, rested: Hashable = None) -> None:
        """Hide what no longer holds, stop what is not wanted, start what is missing.

        The inputs of the result with the key `rested` have not changed for a while.
        """
        self._update(rested)
        self._follow()

    def _changed(self, *events: Any) -> None:
        if self._forget({event.name for event in events}):
            self._update()

    def _forget(self, names: Set[str]) -> bool:
        """Drop what was read of some parameters; return whether there was anything."""
        cells: list[Recorded[Any]] = [*self._parts.values()]
        cells += [cell for one in self._entries.values() for cell in (one.inputs, one.wanted)]
        stale = [one.forget(names) for one in cells]
        return any(stale) or not self._entries

    def _noted(self, *events: Any) -> None:
        self._is_reset |= any(event.type == "triggered" for event in events)
        for _, _, names in self._followers:
            names.update(event.name for event in events)
        self._follow()

    def _follow(self) -> None:
        """Tell all followers what has changed, lower levels first."""
        if self._updating or self._following:
            return
        self._following = True
        try:
            while due := [one for one in self._followers if one[2]][:1]:
                _, act, names = due[0]
                changed, is_reset = frozenset(names), self._is_reset
                names.clear()
                act(changed, is_reset)
            self._is_reset = False
        finally:
            self._following = False

    def _update(self, rested: Hashable = None) -> None:
        self._again = True
        if self._updating or self._work.closed:
            return
        self._updating, self._rested = True, rested
        try:
            while self._again:
                self._again = False
                with batch_call_watchers(self._state):
                    self._due = dict(self._declared)
                    for name in self._declared:
                        self._refresh_result(name)
                    keys = self._work.running() & frozenset(self._entries)
                    if keys != self._state.computing:
                        self._state.param.update(computing=keys, queued=self._state.queued & keys)
                failures, self._failures = self._failures, []
                for report in failures:
                    report()
        finally:
            self._updating, self._due = False, {}
        self._work.rest()

    def is_fresh(self, name: str) -> bool:
        """Return whether a result, and all that it follows, is up to date, or cannot be."""
        derived = self._declared[name]
        inputs = [(one, self._inputs(one)) for one in self._entries_of(derived)]
        return all(map(self.is_fresh, derived.after)) and all(
            now is None or entry.holds(now) for entry, now in inputs
        )

    def is_pending(self, name: str) -> bool:
        """Return whether a result is out of date, and is about to be computed."""
        derived = self._declared[name]
        late = [one for one in derived.after if not self.is_fresh(one)]
        if late:
            return any(map(self.is_pending, late))
        return any(map(self._is_missing, self._entries_of(derived)))

    def refuse(self, *names: str) -> bool:
        """Stop computing some results until their inputs change; return whether any was due."""
        missing = [
            entry
            for name in names
            for entry in self._entries_of(self._declared[name])
            if self._is_missing(entry)
        ]
        for entry in missing:
            entry.refused = self._inputs(entry)
        self.update()
        return bool(missing)

    def retry(self, *names: str) -> None:
        """Compute some results though that failed, or was refused, with the same inputs."""
        for name in names:
            for entry in self._entries_of(self._declared[name]):
                entry.refused = None
        self.update()

    def _entries_of(self, derived: Derived) -> list[_Entry]:
        """Return the entries of a result: one for each part that is or was wanted."""
        name = derived.name
        keys: list[tuple[Hashable, ...]] = [(name,)]
        if derived.parts is not None:
            keys = [(name, part) for part in self._parts[name].read(self._current)]
            keys += [key for key in self._entries if key[0] == name and key not in keys]
        for key in keys:
            if key not in self._entries:
                self._entries[key] = _Entry(derived, key[1:])
        return [self._entries[key] for key in keys]

    def _inputs(self, entry: _Entry) -> Inputs | None:
        return entry.inputs.read(self._current)

    def _wants(self, entry: _Entry) -> bool:
        parts = self._parts.get(entry.derived.name)
        is_offered = parts is None or entry.part[0] in parts.read(self._current)
        return is_offered and entry.wanted.read(self._current)

    def _is_missing(self, entry: _Entry) -> bool:
        inputs = self._inputs(entry)
        if inputs is None or entry.holds(inputs) or entry.refuses(inputs):
            return False
        return self._wants(entry)

    def _is_ready(self, derived: Derived) -> bool:
        """Return whether a result may be computed from those that it follows as they are now.

        Patient results that follow each other may use older values.
        """
        for one in map(self._declared.__getitem__, derived.after):
            has_older = derived.patient and one.patient and self._entries_of(one)[0].values
            if not (has_older and self._is_ready(one)) and not self.is_fresh(one.name):
                return False
        return True

    def _refresh_result(self, name: str) -> None:
        """Bring a result up to the state, after those that it follows or reads."""
        derived = self._due.pop(name, None)
        if derived is not None:
            for earlier in derived.after:
                self._refresh_result(earlier)
            for entry in self._entries_of(derived):
                self._refresh(entry, entry.key == self._rested)

    def _refresh(self, entry: _Entry, rested: bool) -> None:
        derived, work = entry.derived, self._work
        inputs = self._inputs(entry)
        self._show(entry, inputs)
        runs = work.is_running(entry.key)
        if inputs is None or not self._is_missing(entry):
            self._stop(entry)
        elif runs and (derived.patient or derived.current(entry.computed, inputs)):
            pass
        elif not self._is_ready(derived) or self._is_lane_taken(entry):
            self._stop(entry)
        elif not rested and derived.pause(entry.values[0][0] if entry.values else None, inputs):
            if entry.awaited is None or not derived.current(entry.awaited, inputs):
                self._stop(entry)
                entry.awaited = inputs
                work.after_a_pause(lambda: self.update(rested=entry.key), entry.key)
        else:
            self._start(entry, inputs)

    def _show(self, entry: _Entry, inputs: Inputs | None) -> None:
        """Set the value that is shown."""
        value = entry.choose(inputs)
        if value is not entry.shown:
            entry.shown = value
            entry.derived.put(self._state, value, *entry.part)
            self._forget({entry.derived.name})  # its event may come only after the last entry
            self._again = True

    def _is_lane_taken(self, entry: _Entry) -> bool:
        lane = entry.derived.lane
        return bool(lane) and any(
            one is not entry and one.derived.lane == lane and self._work.is_running(one.key)
            for one in self._entries.values()
        )

    def _start(self, entry: _Entry, inputs: Inputs) -> None:
        self._stop(entry)
        derived, state = entry.derived, self._state
        compute = derived.work(state, inputs, *entry.part)
        entry.computed = inputs

        def done(value: Any) -> None:
            entry.values.insert(0, (inputs, value))
            # Nobody sees the new value beside older ones that followed the value before.
            with batch_call_watchers(state):
                self._show(entry, self._inputs(entry))
                self._update()
            self._follow()

        def failed() -> None:
            entry.refused = inputs
            if derived.failed is not None:
                derived.failed(self._owner, *entry.part)
            self.update()

        if not derived.immediate(state, *entry.part):
            report = None if derived.reported else partial(self._queue, entry.key)
            self._work.start(entry.key, compute, done, failed, derived.slots(state), report)
            return
        try:
            done(compute(silent))
        except Exception as error:
            entry.refused = inputs
            self._failures.append(partial(self._work.fail, error, failed))

    def _queue(self, key: Hashable, stage: str, fraction: float) -> None:
        """Show whether a computation waits for those of other pages."""
        queued = self._state.queued - {key} | ({key} if stage == WAITING else frozenset())
        if queued != self._state.queued:
            self._state.queued = queued

    def _stop(self, entry: _Entry) -> None:
        entry.awaited = None
        self._work.cancel_pause(entry.key)
        self._work.cancel(entry.key)
