"""One option of the method over several values, each measured on one character."""

from __future__ import annotations

import csv
from collections.abc import Iterable
from dataclasses import asdict, dataclass, fields, replace
from io import StringIO
from typing import Any

from numpy.typing import ArrayLike

from cutcell.binding import Binding, bind
from cutcell.binding.stages import bind_edited
from cutcell.checks import check_choice
from cutcell.editing import Edits
from cutcell.errors import Cancelled, CutcellError
from cutcell.geodesics.fallback import REACHED
from cutcell.graph.fingerprint import differences, distance_fingerprint, graph_fingerprint
from cutcell.method import ANIMATION, Method, MethodName, method_of
from cutcell.rig import Rig
from cutcell.runtime.progress import Progress, silent
from cutcell.runtime.threads import cancellable
from cutcell.weights.warm_up import warm_up

from ..metrics import METRICS, Measured, Metric

OPTIONS = tuple(field.name for field in fields(Method))
"""Options that can be swept."""


def _unreachable(one: Measured) -> float:
    return float(one.share @ (one.binding.distances.fallback != REACHED))


MEASURES: dict[str, Metric] = {
    **{name: METRICS[name] for name in ("l1", "precision", "recall", "deformation")},
    "unreachable": Metric("unreachable", _unreachable),
    "seconds": METRICS["seconds"],
}
"""The metrics by name; each is a field of `SweepPoint`."""


@dataclass(frozen=True)
class SweepPoint:
    """Measures of one setting. None: it failed, or there is nothing to take a share of.

    Parameters
    ----------
    value : int, float, str, bool or None
        Value of the swept option.
    failed : str
        Why there are no weights; empty where there are.
    l1, precision, recall, deformation : float
        See `weight_l1`, `precision_recall` and `deformation_error` of `cutcell_lab.metrics`;
        deformation in cm².
    unreachable : float
        Share of the welded vertices that no path through the body reaches.
    seconds : float
        All stages together. The time of a graph that several settings share counts for each.
    """

    value: Any
    failed: str = ""
    l1: float | None = None
    precision: float | None = None
    recall: float | None = None
    deformation: float | None = None
    unreachable: float | None = None
    seconds: float | None = None


@dataclass(frozen=True)
class Sweep:
    """Measures of one option over several values.

    Parameters
    ----------
    rig : str
        Name of the character.
    option : str
    method : Method
        All other options.
    reference : str
        "file": errors are against the file's weights. "computed": the file has none, so errors are
        against the weights of `method`.
    points : tuple of SweepPoint
    """

    rig: str
    option: str
    method: Method
    reference: str
    points: tuple[SweepPoint, ...]

    def to_dict(self) -> dict[str, Any]:
        """Return all of it as plain lists, dicts and numbers, for JSON."""
        return asdict(self)

    def to_csv(self) -> str:
        """Return the table as CSV, with its settings in lines that begin with "#"."""
        others = {name: one for name, one in asdict(self.method).items() if name != self.option}
        return points_csv(self.points, self.option, {"reference": self.reference, **others})


def points_csv(points: Iterable[SweepPoint], option: str, about: dict[str, Any]) -> str:
    """Return points of an option as CSV, below lines that begin with "#"."""
    text = StringIO(newline="")
    text.writelines(f"# {name}: {value}\r\n" for name, value in about.items())
    writer = csv.writer(text)
    writer.writerow([option, *MEASURES, "failed"])
    for point in points:
        numbers = (getattr(point, name) for name in MEASURES)
        writer.writerow([value_text(point.value), *numbers, point.failed])
    return text.getvalue()


def value_text(value: Any) -> str:
    """Return the value of an option as `parsed_values` reads it."""
    return {True: "yes", False: "no", None: "all"}[value] if _is_word(value) else str(value)


def _is_word(value: Any) -> bool:
    return value is None or isinstance(value, bool)


def sweep(
    rig: Rig,
    option: str,
    values: Iterable[Any],
    *,
    method: Method | MethodName = ANIMATION,
    binding: Binding | None = None,
    progress: Progress = silent,
    **options: Any,
) -> Sweep:
    """Bind a rig with several values of one option, and measure each.

    Errors are measured against the file's weights, or where the file has none against those of
    `method`. Graph and distances are computed once where the option does not change them.

    Parameters
    ----------
    rig : Rig
    option : str
        Any option of `cutcell.Method`, such as "resolution" or "winding_threshold".
    values : iterable
    method : Method, "animation" or "paper"
        All other options.
    binding : Binding, optional
        Binding of the same rig; its graph and distances are reused where they fit.
    progress : callable
        See `cutcell.runtime.progress`; the stage is the value.
    **options
        Single options on top of the method.

    Returns
    -------
    Sweep
        A setting that fails has its error in `failed`.

    Raises
    ------
    ParameterError
        There is no such option, or another option is out of its range.
    SkeletonError
        The rig has no joints.

    Examples
    --------
    >>> cutcell_lab.sweep(rig, "resolution", [32, 64, 128]).to_csv()  # doctest: +SKIP
    """
    check_choice("option", option, OPTIONS)
    method = method_of(method, **options)
    rig.require_joints()
    warm_up()  # else the first setting is timed with the kernels that it loads
    reference, points, values = rig.weights, [], list(values)
    if reference is None:
        progress("reference", 0.0)
        binding = bind_setting(rig, method, binding, progress)
        reference = binding.weights
    for done, value in enumerate(values):
        stage = value_text(value)

        def report(_: str, fraction: float, done: int = done, stage: str = stage) -> None:
            progress(stage, (done + fraction) / len(values))

        try:
            setting = method.with_options(**{option: value})
            binding = bind_setting(rig, setting, binding, report)
            points.append(measure_setting(rig, value, binding, reference, report))
        except Cancelled:
            raise
        except CutcellError as error:
            points.append(SweepPoint(value, str(error)))
    return Sweep(
        rig.name, option, method, "computed" if rig.weights is None else "file", tuple(points)
    )


def bind_setting(
    rig: Rig, method: Method, earlier: Binding | None = None, progress: Progress = silent
) -> Binding:
    """Bind a rig by a method, with the graph and the distances of another binding where they fit.

    Parameters
    ----------
    rig : Rig
    method : Method
        Its resolution counts along the longest side of the mesh.
    earlier : Binding, optional
        Of any rig and any method. Its seconds count for what is reused.
    progress : callable
        See `cutcell.runtime.progress`.

    Returns
    -------
    Binding

    Raises
    ------
    CutcellError
        The rig cannot be bound so.
    """
    expected = graph_fingerprint(rig.mesh, method)
    if earlier is None or earlier.graph.fingerprint != expected:
        return bind(rig, method.resolution, method=method, progress=progress)
    spent = {"graph": earlier.seconds.get("graph", 0.0)}
    if not _measures_enough(rig, method, earlier):
        fresh = bind(rig, method.resolution, method=method, graph=earlier.graph, progress=progress)
        return replace(fresh, seconds={**fresh.seconds, **spent})
    spent["distances"] = earlier.seconds.get("distances", 0.0)

    def work(report: Progress) -> Binding:
        return bind_edited(rig, method, Edits(), distances=earlier.distances, progress=report)

    again = cancellable(work, progress, "weights")
    return replace(again, seconds={**again.seconds, **spent})


def _measures_enough(rig: Rig, method: Method, earlier: Binding) -> bool:
    """Return whether a binding has the distances that a method needs."""
    expected = distance_fingerprint(rig.skeleton, method, rig.allowed)
    before = earlier.method
    return (
        not differences(earlier.distances.fingerprint, expected)
        and before.joints_needed == method.joints_needed
        and before.reach_needed == method.reach_needed
    )


def measure_setting(
    rig: Rig, value: Any, binding: Binding, reference: ArrayLike, progress: Progress = silent
) -> SweepPoint:
    """Measure a binding against other weights.

    Parameters
    ----------
    rig : Rig
    value : object
        Value of the swept option.
    binding : Binding
    reference : array_like, shape (n, j)
    progress : callable
        See `cutcell.runtime.progress`.

    Returns
    -------
    SweepPoint

    Raises
    ------
    WeightsError
        The reference does not fit the rig.
    """
    measured = Measured(rig, binding.weights, reference, binding, progress=progress)
    return SweepPoint(value, "", **measured.values(MEASURES))
