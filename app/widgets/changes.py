"""Messages for the browser that turn one description of a scene into another."""

from collections.abc import Mapping
from dataclasses import replace
from operator import attrgetter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cutcell.runtime.display import printable, shown_name
from cutcell_viewers.description import Actor, Apart, Description, Legend, Reading
from cutcell_viewers.lighting import shading
from cutcell_viewers.palette import colormap, to_hex
from cutcell_viewers.skin import Skin

FEW = 0.25
"""Share of an actor's points up to which those that changed are sent one by one."""


def changes(old: Description, new: Description, sent: set[str]) -> dict[str, Any]:
    """Return the message that turns one description into another.

    `sent` has the names of the actors that the browser has, and is brought up to date: an actor is
    not sent before it is first seen.
    """
    message: dict[str, Any] = {}
    removed = [name for name in sent if name not in new.actors]
    actors: dict[str, Any] = {}
    for name, actor in new.actors.items():
        if name not in sent and not actor.visible:
            continue
        part = _part(old.actors.get(name) if name in sent else None, actor)
        if part:
            actors[name] = part
        sent.add(name)
    sent.difference_update(removed)
    if removed:
        message["remove"] = removed
    if actors:
        message["actors"] = actors
    if old.cut != new.cut:
        message["cut"] = new.cut and {"origin": new.cut.origin, "normal": new.cut.normal}
    if old.front != new.front:
        message["front"] = new.front
    if old.images is not new.images:
        message["images"] = _images(new.images)
    if old.legend != new.legend:
        message["legend"] = _legend(new.legend)
    if old.views != new.views:
        message["views"] = [printable(name) for name in new.views]
    if old.blending != new.blending:
        message["blending"] = new.blending
    if not _same(old.pose, new.pose):
        message["pose"] = None if new.pose is None else _flat(new.pose, np.float32)
    return message


def repainted(old: Actor, new: Actor, share: float = 1.0) -> tuple[dict[str, Any], Actor]:
    """Return how some points of a surface differ in colours and influences, as a message.

    Also returns the old actor with these points as they are in the new one. The message is empty
    where nothing differs, or more than a share of the points.
    """
    pairs: dict[str, tuple[Any, Any]] = {}
    if old.materials is None and new.materials is None:
        pairs["colors"] = old.colors, new.colors
        if (old.colormap, old.limits) == (new.colormap, new.limits):
            pairs["scalars"] = old.scalars, new.scalars
    if old.reading is not None and new.reading is not None and _is_alike(old.reading, new.reading):
        pairs["readings"] = old.reading.values, new.reading.values
    if old.skin is not None and new.skin is not None:
        pairs["joints"] = old.skin.joints, new.skin.joints
        pairs["weights"] = old.skin.weights, new.skin.weights
    pairs = {name: pair for name, pair in pairs.items() if _fit(*pair)}
    flags = [_rows_differ(a, b) for a, b in pairs.values() if a is not b]
    which = np.flatnonzero(np.any(flags, axis=0)) if flags else np.zeros(0, np.intp)
    if not 0 < len(which) <= share * len(new.points):
        return {}, old
    message: dict[str, Any] = {"vertices": which.astype(np.uint32)}
    message |= {name: pair[1][which].ravel() for name, pair in pairs.items()}
    if "joints" in pairs and new.skin is not None:
        message["count"] = new.skin.joints.shape[1]
        old = replace(old, skin=new.skin)
    if "readings" in pairs:
        old = replace(old, reading=new.reading)
    fields: dict[str, Any] = {n: pairs[n][1] for n in ("colors", "scalars") if n in pairs}
    return message, replace(old, **fields)


def painted(actor: Actor, rows: Mapping[str, Any]) -> Actor:
    """Return an actor with other colours and influences of some points, as in a message."""
    which, fields = rows["vertices"], dict[str, Any]()
    for name in ("colors", "scalars"):
        before = getattr(actor, name)
        if name in rows and before is not None:
            fields[name] = _with_rows(before, which, rows[name])
    if "joints" in rows and actor.skin is not None:
        skin = actor.skin
        fields["skin"] = Skin(
            _with_rows(skin.joints, which, rows["joints"]),
            _with_rows(skin.weights, which, rows["weights"]),
        )
    return replace(actor, **fields)


def _with_rows(array: NDArray, which: NDArray, rows: NDArray) -> NDArray:
    """Return a copy with other rows at some places; the narrower of both is filled with zeros."""
    before, others = array.reshape(len(array), -1), rows.reshape(len(which), -1)
    width = max(before.shape[1], others.shape[1])
    result: NDArray = np.zeros((len(array), width), array.dtype)
    result[:, : before.shape[1]] = before
    result[which] = 0
    result[which, : others.shape[1]] = others
    return result.reshape(array.shape[:1] + (width,) * (array.ndim - 1))


def _fit(a: NDArray | None, b: NDArray | None) -> bool:
    return a is not None and b is not None and a.shape == b.shape


def _rows_differ(a: NDArray, b: NDArray) -> NDArray[np.bool_]:
    return np.asarray((a != b).reshape(len(a), -1).any(axis=1))


def _part(old: Actor | None, new: Actor) -> dict[str, Any]:
    part: dict[str, Any] = {}
    if old is None or old.kind != new.kind:
        part["kind"] = new.kind
        old = None
    elif new.kind == "surface" and _fit(old.points, new.points):
        rows, old = repainted(old, new, FEW)
        part |= {"repainted": rows} if rows else {}
    for name, dtype in (("points", np.float32), ("normals", np.float32), ("cells", np.uint32)):
        value = getattr(new, name)
        if value is not None and (old is None or not _same(getattr(old, name), value)):
            part[name] = _flat(value, dtype)
    if new.skin is not None and (old is None or not _same_skin(old, new)):
        part["skin"] = _skin(new.skin)
    if old is None or old.apart is not new.apart:
        part["apart"] = _reference_skin(new.apart)
    part.update(_colouring(old, new))
    if (old is not None and old.follows_wavefront) != new.follows_wavefront:
        part["animation"] = new.follows_wavefront
    if not _same_reading(None if old is None else old.reading, new.reading):
        part["reading"] = _reading(new.reading)
    for name, value in _settings(new).items():
        if old is None or _settings(old)[name] != value:
            part[name] = value
    if old is None or (old.clipped, old.slab) != (new.clipped, new.slab):
        part["clipped"], part["slab"] = new.clipped, new.slab
    return part


def _images(images: NDArray[np.uint8] | None) -> dict[str, Any] | None:
    if images is None:
        return None
    return {"count": len(images), "side": images.shape[1], "pixels": _flat(images, np.uint8)}


def _reference_skin(reference: Apart | None) -> dict[str, Any] | None:
    if reference is None:
        return None
    return {**_skin(reference.skin), "unit": reference.unit}


def _skin(skin: Skin) -> dict[str, Any]:
    return {
        "joints": _flat(skin.joints, np.uint16),
        "weights": _flat(skin.weights, np.float32),
        "count": skin.joints.shape[1],
    }


def _colouring(old: Actor | None, new: Actor) -> dict[str, Any]:
    """Return what colours an actor, if it is not what colours it already."""
    if new.materials is not None:
        if old is not None and old.materials is new.materials:
            return {}
        materials = new.materials
        tints = np.concatenate([materials.tints, materials.opacity[..., None]], axis=2)
        return {
            "materials": {
                "corners": _flat(materials.corners, np.float32), "tints": _flat(tints, np.uint8)
            }
        }  # fmt: skip
    old = None if old is not None and old.materials is not None else old
    if new.colors is not None:
        if old is None or not _same(old.colors, new.colors):
            return {"colors": _flat(new.colors, np.uint8)}
        return {}
    if new.scalars is None:
        return {}
    same = old is not None and old.colors is None and _same(old.scalars, new.scalars)
    if same and old is not None and (old.colormap, old.limits) == (new.colormap, new.limits):
        return {}
    table = _flat(colormap(new.colormap), np.uint8)
    return {"scalars": _flat(new.scalars, np.float32), "table": table, "limits": new.limits}


def _settings(actor: Actor) -> dict[str, Any]:
    ambient, diffuse = shading(actor)
    paint = {
        "color": actor.color,
        "opacity": actor.opacity,
        "width": actor.width,
        "thick": actor.thick,
        "dash": actor.dash,
        "form": actor.form,
        "ambient": ambient,
        "diffuse": diffuse,
        "behind": actor.behind,
        "closed": actor.closed and actor.opacity == 1,
        "hull": actor.hull,
        "edges": actor.edges,
        "coloured": any(x is not None for x in (actor.colors, actor.scalars, actor.materials)),
    }
    place = {"overlay": actor.overlay, "view": actor.view}
    return {"paint": paint, "place": place, "visible": actor.visible}


def _reading(reading: Reading | None) -> dict[str, Any] | None:
    if reading is None:
        return None
    values = None if reading.values is None else _flat(reading.values, np.float32)
    names = [shown_name(name) for name in reading.names]
    text = printable(reading.text)
    scale = {"percent": reading.percent, "unit": reading.unit}
    return {"text": text, "values": values, "names": names, **scale}


def _legend(legend: Legend | None) -> dict[str, Any] | None:
    if legend is None:
        return None
    table = _flat(colormap(legend.colormap), np.uint8) if legend.colormap else None
    swatches = [(to_hex(color), printable(text)) for color, text in legend.swatches]
    ends = {"low": legend.low, "high": legend.high}
    return {"title": printable(legend.title), "table": table, "swatches": swatches, **ends}


def _flat(array: NDArray, dtype: Any) -> NDArray:
    return np.ascontiguousarray(array, dtype).ravel()


def _same(a: NDArray | None, b: NDArray | None) -> bool:
    if a is None or b is None:
        return a is b
    return a is b or (a.shape == b.shape and np.array_equal(a, b))


def _same_reading(old: Reading | None, new: Reading | None) -> bool:
    if old is None or new is None:
        return old is new
    return _is_alike(old, new) and _same(old.values, new.values)


def _is_alike(old: Reading, new: Reading) -> bool:
    fields = attrgetter("text", "names", "percent", "unit")
    return bool(fields(old) == fields(new))


def _same_skin(old: Actor, new: Actor) -> bool:
    if old.skin is None or new.skin is None:
        return old.skin is new.skin
    return _same(old.skin.joints, new.skin.joints) and _same(old.skin.weights, new.skin.weights)
