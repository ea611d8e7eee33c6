# SPDX-License-Identifier: GPL-3.0-or-later
"""Operators whose work runs in the worker process: modal in the window, blocking elsewhere."""

from __future__ import annotations

import importlib.util
from pathlib import Path

import bpy

from .job import Problem, Worker

POLL_SECONDS = 0.05
NAVIGATION = {"MIDDLEMOUSE", "WHEELUPMOUSE", "WHEELDOWNMOUSE", "TRACKPADPAN", "TRACKPADZOOM"}
"""Events that pass while a job runs; others could change what it computes from."""

_workers: list[Worker] = []


def worker() -> Worker:
    """Return the worker; its process is kept from job to job."""
    if not _workers:
        numba = importlib.util.find_spec("numba")
        if numba is None or numba.origin is None:
            raise Problem("The extension's libraries are missing. Install the extension again")
        core = Path(__file__).with_name("core")
        _workers.append(Worker([str(core), str(Path(numba.origin).parent.parent)]))
    return _workers[0]


def stop_worker() -> None:
    """End the worker process."""
    for running in _workers:
        running.stop()


class WorkerOperator:
    """Base of operators.

    `request(context)` returns a task, its arrays and its options; `finish(context, arrays, result)`
    writes the result into the scene and returns a message. Either may raise a `Problem`.
    """

    bl_options = {"REGISTER", "UNDO"}  # noqa: RUF012

    def execute(self, context):
        """Run the job while Blender waits: in scripts, and when an option of the panel changes."""
        self._job = self._steps(context, POLL_SECONDS)
        try:
            while (state := self._step(context)) is None:
                pass
        except BaseException:
            stop_worker()
            raise
        return state

    def invoke(self, context, event):
        """Start the job and return to Blender, which calls `modal`."""
        if bpy.app.background:
            return self.execute(context)
        self._job = self._steps(context, 0.0)
        if (state := self._step(context)) is not None:
            return state
        manager = context.window_manager
        self._timer = manager.event_timer_add(POLL_SECONDS, window=context.window)
        manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        """Poll the job, or cancel it."""
        if event.type in NAVIGATION:
            return {"PASS_THROUGH"}
        state = None
        try:
            if event.type == "ESC" and event.value == "PRESS":
                stop_worker()
                self._job.close()
                self.report({"WARNING"}, "Cancelled. Nothing was changed")
                state = {"CANCELLED"}
            elif event.type == "TIMER":
                state = self._step(context)
        except BaseException:
            self._end(context)
            raise
        if state is None:
            return {"RUNNING_MODAL"}
        self._end(context)
        return state

    def _end(self, context):
        context.window_manager.event_timer_remove(self._timer)
        context.workspace.status_text_set(None)

    def _steps(self, context, wait):
        return (yield from worker().run(*self.request(context), wait))

    def _step(self, context):
        """Poll the job; return the operator's state at its end, else None."""
        try:
            status, fraction = next(self._job)
        except StopIteration as done:
            try:
                self.report({"INFO"}, self.finish(context, *done.value))
            except Problem as problem:
                self.report({"ERROR"}, str(problem))
                return {"CANCELLED"}
            return {"FINISHED"}
        except (Problem, OSError) as problem:
            self.report({"ERROR"}, str(problem))
            return {"CANCELLED"}
        if context.workspace is not None and not bpy.app.background:
            text = f"{self.bl_label}: {status} ({fraction:.0%})    Esc: Cancel"
            context.workspace.status_text_set(text)
        return None
