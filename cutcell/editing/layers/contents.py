"""Contents of layers: what a layer makes of the weights below it, as data."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from typing import Any, ClassVar, Literal

from ...checks import assign, check_choice, check_flag, check_integer, check_number
from ...errors import ParameterError
from ...method import ANIMATION, METHODS, Method, method_of
from .packing import joint_name, joint_names, mapping, with_keys

MIN_GAIN, MAX_GAIN = 0.05, 20.0
MAX_STEPS = 1000
SUM_TOLERANCE = 1e-9
"""Tolerance for sums of weights."""

Side = Literal["both", "left", "right"]
Rename = Callable[[str], str | None]
"""Returns the new name of a joint; None for one that is gone."""


class Content:
    """What a layer makes of the weights below it."""

    kind: ClassVar[str]
    title: ClassVar[str]
    by_joint: ClassVar[tuple[str, ...]] = ()
    """Fields that name joints: mappings of them, or lists."""
    by_rows: ClassVar[bool] = False
    """Whether each row follows from the one below it: some are made at a time, to save memory."""
    reads_others: ClassVar[bool] = False
    """Whether a row follows from others below it, too."""

    def to_data(self) -> dict[str, Any]:
        """Return the fields that differ from their defaults, as JSON."""
        values = {one.name: getattr(self, one.name) for one in fields(self)}  # type: ignore[arg-type]
        return {key: value for key, value in values.items() if value}

    def joints_named(self) -> tuple[str, ...]:
        """Return the joints that it names."""
        return tuple(joint for name in self.by_joint for joint in getattr(self, name))

    def renamed(self, now: Rename) -> Content | None:
        """Return it for joints that are called otherwise; None if it has lost its meaning."""
        return self


@dataclass(frozen=True)
class Computed(Content):
    """Weights that are computed again.

    Parameters
    ----------
    options : mapping of str to values
        Options of `Method` that differ from the method of the other weights, "method" among them:
        {"falloff": "paper"}, {"method": "paper", "resolution": 128}.
    gain : mapping of str to float
        By joint: the factor that its distances are divided by, 0.05 to 20.
    radius : mapping of str to float
        By joint, in the file's units: beyond it, distances grow by their square. Measured from the
        body when left out. The paper's falloff has none.
    as_skin : bool
        The components that the mask touches are bound as any other skin, even if they are small or
        hold bones of one joint only.
    """

    options: Mapping[str, Any] = field(default_factory=dict)
    gain: Mapping[str, float] = field(default_factory=dict)
    radius: Mapping[str, float] = field(default_factory=dict)
    as_skin: bool = False

    kind = "computed"
    title = "Recomputed"
    by_joint = "gain", "radius"

    def __post_init__(self) -> None:
        options = checked_options("options", self.options)
        gain = numbers_by_joint("gain", self.gain, MIN_GAIN, MAX_GAIN)
        radius = numbers_by_joint("radius", self.radius, 0, 1e30)
        if 0 in radius.values():
            raise ParameterError("radius must be more than 0; leave it out to have it measured")
        check_flag("as_skin", self.as_skin)
        assign(self, options=options, gain=gain, radius=radius)

    def method(self, method: Method) -> Method:
        """Return a method with these options."""
        return with_method_options(method, self.options)

    @property
    def is_plain(self) -> bool:
        """Whether it is computed by the method of the other weights."""
        return not self.options and not self.as_skin

    def renamed(self, now: Rename) -> Content:
        gain, radius = (
            {new: value for joint, value in values.items() if (new := now(joint)) is not None}
            for values in (self.gain, self.radius)
        )
        return replace(self, gain=gain, radius=radius)


@dataclass(frozen=True)
class FromFile(Content):
    """Weights of the file; vertices without any there stay as they are below."""

    kind = "file"
    title = "From file"


@dataclass(frozen=True)
class Filled(Content):
    """The same weights everywhere.

    Parameters
    ----------
    weights : mapping of str to float
        By joint; they are scaled to sum to one.
    """

    weights: Mapping[str, float]

    kind = "filled"
    title = "Filled"
    by_joint = ("weights",)

    def __post_init__(self) -> None:
        entries = numbers_by_joint("weights", self.weights, 0, 1e9, 'the weight of "{}"')
        total = sum(entries.values())
        if not total > 0:
            raise ParameterError("weights must name at least one joint with a weight above 0")
        if abs(total - 1) > SUM_TOLERANCE:
            entries = {joint: weight / total for joint, weight in entries.items()}
        assign(self, weights=entries)

    def renamed(self, now: Rename) -> Content | None:
        weights: dict[str, float] = {}
        for joint, weight in self.weights.items():
            if (new := now(joint)) is not None:
                weights[new] = weights.get(new, 0.0) + weight
        return Filled(weights) if any(weights.values()) else None


@dataclass(frozen=True)
class Attached(Content):
    """Components that follow the body rigidly where they touch it."""

    kind = "attached"
    title = "With the body"
    reads_others = True


@dataclass(frozen=True)
class Smoothed(Content):
    """Weights below, smoothed.

    Parameters
    ----------
    steps : int
        Passes, each half the vertex and half the mean of its neighbours; 1 to 1000.
    through : bool
        Across shells that lie close to each other, too, instead of only over the surface.
    """

    steps: int
    through: bool = False

    kind = "smoothed"
    title = "Smoothed"
    reads_others = True

    def __post_init__(self) -> None:
        assign(self, steps=check_integer("steps", self.steps, 1, MAX_STEPS))
        check_flag("through", self.through)


@dataclass(frozen=True)
class Mirrored(Content):
    """Weights below, the same on both sides.

    Parameters
    ----------
    side : {"both", "left", "right"}
        The mean of both sides, or the left or the right one in place of the other. Left is where
        the coordinate along the mirror's axis is larger.
    """

    side: Side = "both"

    kind = "mirrored"
    title = "Mirrored"
    reads_others = True

    def __post_init__(self) -> None:
        check_choice("side", self.side, ("both", "left", "right"))


@dataclass(frozen=True)
class Remapped(Content):
    """Weights below, moved from joints to others, all at once: two may exchange theirs.

    Parameters
    ----------
    joints : mapping of str to str
        The joint that gets the weight of each; those that are left out keep theirs. Rows for which
        the file cannot store the result stay as they are below.
    """

    joints: Mapping[str, str]

    kind = "remapped"
    title = "Joints replaced"
    by_rows = True

    def __post_init__(self) -> None:
        entries = {
            joint_name("joints", joint): joint_name("joints", target)
            for joint, target in mapping("joints", self.joints).items()
        }
        moved = {joint: target for joint, target in entries.items() if joint != target}
        if not moved:
            raise ParameterError("joints must name at least one with another that gets its weight")
        assign(self, joints=moved)

    def joints_named(self) -> tuple[str, ...]:
        return tuple(dict.fromkeys([*self.joints, *self.joints.values()]))

    def renamed(self, now: Rename) -> Content | None:
        pairs = {now(joint): now(target) for joint, target in self.joints.items()}
        joints = {one: other for one, other in pairs.items() if one and other and one != other}
        return Remapped(joints) if joints else None


@dataclass(frozen=True)
class Locked(Content):
    """Joints keep the file's weights; the others share what is left.

    Parameters
    ----------
    joints : sequence of str
    """

    joints: Sequence[str]

    kind = "locked"
    title = "Locked"
    by_joint = ("joints",)
    by_rows = True

    def __post_init__(self) -> None:
        assign(self, joints=joint_names("joints", self.joints))

    def renamed(self, now: Rename) -> Content | None:
        names = [name for name in map(now, self.joints) if name is not None]
        return Locked(names) if names else None


def numbers_by_joint(
    name: str, values: Any, low: float, high: float, called: str = ""
) -> dict[str, float]:
    """Return checked numbers by joint; an error calls the value of one otherwise than `name`."""
    return {
        joint_name(name, joint): check_number((called or name).format(joint), value, low, high)
        for joint, value in mapping(name, values).items()
    }


def checked_options(where: str, options: Any) -> dict[str, Any]:
    """Return options of a method that differ from another one's, checked as far as they can be."""
    entries = with_keys(where, options, ["method", *(one.name for one in fields(Method))])
    likely = {"falloff": "paper"} if entries.get("alpha") is not None else {}
    with_method_options(ANIMATION, {**likely, **entries})
    return entries


def with_method_options(method: Method, options: Mapping[str, Any]) -> Method:
    """Return a method with other options; "method" among them replaces it but for R."""
    rest = dict(options)
    name = rest.pop("method", None)
    if name is None:
        return method.with_options(**rest)
    check_choice("method", name, METHODS)
    return method_of(name, **{"resolution": method.resolution, **rest})
