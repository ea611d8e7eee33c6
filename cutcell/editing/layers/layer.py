"""Layers of weights: a content, and where and how strongly it replaces what lies below."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from typing import Any, Literal, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...checks import assign, check_choice, check_flag, check_integer, check_kind, check_number
from ...errors import ParameterError
from ...rig.checks import frozen
from .contents import (
    Attached,
    Computed,
    Content,
    Filled,
    FromFile,
    Locked,
    Mirrored,
    Remapped,
    Rename,
    Smoothed,
)
from .packing import MAX_VERTEX, ByValue, ascending, naming, numbers, packed, with_keys
from .painted import Painted

CONTENT_KINDS: dict[str, Any] = {
    one.kind: one
    for one in (
        Computed, FromFile, Filled, Attached, Painted, Smoothed, Mirrored, Remapped, Locked,
    )
}  # fmt: skip
"""Contents by the names of their kinds in JSON."""


@dataclass(frozen=True, eq=False)
class Mask(ByValue):
    """Vertices that a layer changes: all, a connected component, or some.

    Parameters
    ----------
    part : int, optional
        A connected component, by any vertex of it.
    vertices : array, shape (k,), int32, optional
        Ascending.
    strengths : array, shape (k,), float64, optional
        More than 0, at most 1, for each of the vertices; 1 when left out.
    """

    part: int | None = None
    vertices: NDArray[np.int32] | None = None
    strengths: NDArray[np.float64] | None = None

    def __init__(
        self,
        part: int | None = None,
        vertices: ArrayLike | None = None,
        strengths: ArrayLike | None = None,
    ) -> None:
        which: Any = None
        if part is not None:
            part = check_integer("the vertex of a part", part, 0, MAX_VERTEX)
        if vertices is not None:
            which = ascending("vertices of a mask", vertices)
        if (part is not None and which is not None) or (strengths is not None and which is None):
            raise ParameterError("a mask has a part, or vertices, which may have strengths")
        how: Any = None
        if strengths is not None:
            how = numbers("strengths", strengths, "f")
            if len(how) != len(which) or not ((how > 0) & (how <= 1)).all():
                raise ParameterError(
                    f"strengths must be {len(which)} numbers, one for each vertex, above 0 and at "
                    "most 1"
                )
            how = None if (how == 1).all() else frozen(how.copy())
        assign(self, part=part, vertices=which, strengths=how)

    @property
    def is_all(self) -> bool:
        """Whether it is all vertices."""
        return self.part is None and self.vertices is None

    def to_data(self) -> dict[str, Any]:
        """Return it as JSON; empty for all vertices."""
        if self.part is not None:
            return {"part": self.part}
        pairs = (("vertices", self.vertices), ("strengths", self.strengths))
        return {name: packed(array) for name, array in pairs if array is not None}

    @classmethod
    def from_data(cls, where: str, value: Any) -> Mask:
        """Read what `to_data` returns."""
        entries = with_keys(where, value, [one.name for one in fields(cls)])
        with naming(where):
            return cls(**entries)


EVERYWHERE = Mask()
Mode = Literal["replace", "add", "scale"]


@dataclass(frozen=True)
class Layer:
    """A layer over the weights below it.

    Where it is opaque, the weights are those of its content. Elsewhere they are the mean of both,
    with at most as many influences as the method has.

    Parameters
    ----------
    content : Computed, FromFile, Filled, Attached, Painted, Smoothed, Mirrored, Remapped or Locked
    mask : Mask
    name : str
    opacity : float
        0 to 1.
    on : bool
    mode : {"replace", "add", "scale"}
        The weights of the content replace those below, are added to them, or are factors of them.
    """

    content: Content
    mask: Mask = EVERYWHERE
    name: str = ""
    opacity: float = 1.0
    on: bool = True
    mode: Mode = "replace"

    def __post_init__(self) -> None:
        for name, kind in (("content", Content), ("mask", Mask), ("name", str)):
            check_kind(name, getattr(self, name), kind)
        assign(self, opacity=check_number("opacity", self.opacity, 0, 1))
        check_flag("on", self.on)
        check_choice("mode", self.mode, get_args(Mode))

    @property
    def title(self) -> str:
        """Its name, or else what it is."""
        return self.name or self.content.title

    @property
    def is_active(self) -> bool:
        """Whether it can change anything."""
        return self.on and self.opacity > 0

    @property
    def is_opaque(self) -> bool:
        """Whether it hides all that is below its content."""
        return self.opacity == 1 and self.mask.strengths is None and self.mode == "replace"

    @property
    def is_reach(self) -> bool:
        """Whether it is all weights computed with another reach of joints: a base by itself."""
        content, whole = self.content, self.mask.is_all and self.is_opaque
        return isinstance(content, Computed) and content.is_plain and whole

    def renamed(self, now: Rename) -> Layer | None:
        """Return it for joints that are called otherwise; None if its content is gone."""
        content = self.content.renamed(now)
        return None if content is None else replace(self, content=content)

    def to_data(self) -> dict[str, Any]:
        """Return it as JSON."""
        data = {"kind": self.content.kind, **self.content.to_data()}
        more = {"mask": self.mask.to_data(), "name": self.name}
        data |= {key: value for key, value in more.items() if value}
        data |= {} if self.opacity == 1 else {"opacity": self.opacity}
        data |= {} if self.mode == "replace" else {"mode": self.mode}
        return data | ({} if self.on else {"on": False})

    @classmethod
    def from_data(cls, where: str, value: Any) -> Layer:
        """Read what `to_data` returns."""
        if not isinstance(value, Mapping) or value.get("kind") not in CONTENT_KINDS:
            raise ParameterError(f'{where} must have a "kind": one of {", ".join(CONTENT_KINDS)}')
        kind = CONTENT_KINDS[value["kind"]]
        own = [one.name for one in fields(kind)]
        data = with_keys(where, value, ["kind", *own, "mask", "name", "opacity", "on", "mode"])
        try:
            with naming(where):
                mask = Mask.from_data("mask", data.pop("mask", {}))
                make = getattr(kind, "from_data", kind)
                content = make(**{key: data.pop(key) for key in own if key in data})
                data.pop("kind")
                return cls(content, mask, **data)
        except TypeError:
            raise ParameterError(f"{where} needs {' and '.join(own)}") from None
