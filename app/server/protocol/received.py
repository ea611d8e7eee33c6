"""Messages from the browser: a class each, whose name and fields are those of the message."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import Any, ClassVar, TypedDict, dataclass_transform

Vector = tuple[float, float, float]


@dataclass_transform(frozen_default=True, field_specifiers=(field,))
class Message:
    """A message; its type is the name of its class, in lower case with hyphens."""

    type: ClassVar[str]

    def __init_subclass__(cls) -> None:
        dataclass(frozen=True)(cls)
        cls.type = re.sub(r"(?<=[a-z])(?=[A-Z])", "-", cls.__name__).lower()


class Ready(Message):
    """The view is there; `page` is the key of the page before a reload."""

    width: int = 0
    page: str | None = None
    dark: str | None = None
    calm: bool = False
    pictures: bool = False


class CameraMoved(Message):
    """The view rests."""

    position: Vector
    focal_point: Vector
    aspect: float | None = None
    height: float | None = None
    home: bool = False


class Time(Message):
    """Time of the motion."""

    time: float


class Pick(Message):
    """A joint is chosen: in the view, in the tree, or on a card."""

    joint: int


class PickVertex(Message):
    """A vertex is chosen: in one of the views side by side, or in a table."""

    vertex: int
    view: int = 0


class PickNode(Message):
    """A node of the graph is chosen: in the view, or on a card."""

    node: int


class PickStrongest(Message):
    """The strongest joint at a vertex is to be chosen."""

    vertex: int


class Turn(Message):
    """A ring is dragged."""

    joint: int
    axis: int
    degrees: float
    begin: bool = False


class MoveJoint(Message):
    """A joint is dragged in the scene."""

    joint: int
    position: Vector
    done: bool = False


class MovePoint(Message):
    """A point that a feature declares is dragged in the scene."""

    name: str
    position: Vector
    done: bool = False


class MoveCut(Message):
    """The cutting plane is dragged."""

    origin: Vector
    normal: Vector


class Paint(Message):
    """A piece of a stroke, or its end.

    Each point of the surface has six numbers: the three corners around it, and what each counts
    for. `mode` is another one than the brush's.
    """

    points: list[float] = field(default_factory=list)
    mode: str | None = None
    first: bool = False
    done: bool = False
    cancelled: bool = False


class Lasso(Message):
    """A line was drawn around vertices."""

    vertices: list[int]
    mode: str


class HaltWave(Message):
    """The wavefront is halted at a part of the greatest distance."""

    front: float


class Play(Message):
    """The motion is played or paused."""

    on: bool


class Act(Message):
    """A key is pressed."""

    act: str


class Visit(Message):
    """The browser goes back or forward."""

    query: str


class DrawFrame(Message):
    """A picture of the view is wanted."""

    count: int
    size: tuple[float, float]
    ratio: float
    fine: bool
    position: Vector
    focal_point: Vector
    centre: tuple[float, float]
    tiles: list[list[float]]


class AskIdle(Message):
    """A test wants to know when no work is left."""

    number: int


class Announced(TypedDict):
    """A file that follows."""

    name: str
    size: int


class UploadBegin(Message):
    """Files follow."""

    files: list[Announced]


class UploadPiece(Message):
    """A part of a file."""

    index: int
    data: bytes


class UploadEnd(Message):
    """All files are sent."""


class UploadCancel(Message):
    """The upload ends without its files."""

    unreadable: bool = False


class Close(Message):
    """The card of a vertex is closed."""


class Explain(Message):
    """The explanation of its weights is shown or hidden."""


class ShowPart(Message):
    """Its part of the mesh is shown alone."""


class Override(Message):
    """Its weights are set, pairs of joint and weight; null: computed."""

    weights: list[tuple[int, float]] | None


class Carry(Message):
    """A joint may deform the mesh or not."""

    joint: int
    on: bool


class ShowStep(Message):
    """A step of the lesson is shown."""

    step: int


class Answer(Message):
    """A person answers the step."""

    value: str | int | float


class Offer(Message):
    """A button of the step is pressed."""

    index: int


class ChooseValue(Message):
    """A number in the step's text is changed."""

    name: str
    value: Any


class Stage(Message):
    """The lesson is presented or not."""

    on: bool


class PickRow(Message):
    """A row is chosen: the nth of a name, since rows may move meanwhile."""

    name: str
    nth: int = 0


class PointAtRow(Message):
    """The pointer comes to a row, the nth of a name; null: it leaves."""

    name: str | None
    nth: int = 0


class Sort(Message):
    """A heading of the table of weights is clicked: of a joint, or of a column below zero."""

    column: int


class Page(Message):
    """Another page of it is wanted."""

    page: int


class EditWeight(Message):
    """A weight is edited."""

    vertex: int
    joint: int
    value: float


class PickBars(Message):
    """Bars of the histogram are chosen."""

    first: int
    last: int


class PickPoint(Message):
    """A point of a curve is chosen."""

    id: str


class ShowMethod(Message):
    """A method is shown or not."""

    id: str
    on: bool


RECEIVED: dict[str, type[Message]] = {one.type: one for one in Message.__subclasses__()}
"""By their types."""
