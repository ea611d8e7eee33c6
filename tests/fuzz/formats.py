"""For each reader some sound files, and how to damage them."""

from __future__ import annotations

import base64
import io
import json
import zipfile
from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
from numpy.random import Generator

from tests.cutcell.io import fbx_builder
from tests.cutcell.io.gltf import compressed
from tests.cutcell.io.gltf.gltf_builder import (
    COLUMN,
    FACES,
    REST,
    SHARES,
    Builder,
    column,
    pack,
    two_skins,
)
from tests.cutcell.io.gltf.test_gltf_clips import BOTH_PARTS, FLIPPED, SPLINE, animate
from tests.cutcell.io.gltf.test_gltf_errors import sparse
from tests.cutcell.io.gltf.test_vrm import VRM0, VRM1, avatar
from tests.cutcell.io.test_articulation import arrays
from tests.cutcell.io.test_usd import text as usd_text

from . import damage

Files = dict[str, bytes]
"""Contents by name; the first is the one that is loaded."""

OBJ = "".join(f"v {x} {y} {z}\n" for x, y, z in COLUMN) + "".join(
    f"f {a} {b} {c}\n" for a, b, c in FACES + 1
)
RIGNET = "joints root 0.5 0 0.5\njoints tip 0.5 1 0.5\nroot root\nhier root tip\n" + "".join(
    f"skin {k} root {a} tip {b}\n" for k, (a, b) in enumerate(SHARES[:, :2].tolist())
)
SKELETON = {
    "joints": [
        {"name": "root", "position": REST[0].tolist()},
        {"name": "tip", "position": REST[1].tolist(), "parent": "root", "deform": True},
    ]
}


@cache
def documents() -> dict[str, list[Builder]]:
    """Return glTF documents, by what is special about them."""
    moving = column()
    animate(moving, *BOTH_PARTS)
    animate(moving, *SPLINE, name="spline")
    sparse()(moving)
    held = two_skins([0, 0, 3])
    held.node(1, name="sword", mesh=held.mesh({"POSITION": held.positions(COLUMN)}))
    animate(held, *FLIPPED)
    packed = column()
    animate(packed, *FLIPPED)
    bare = column()
    animate(bare, *FLIPPED)
    del bare.json["nodes"][2]["skin"]
    return {
        "plain": [moving, held, bare],
        "vrm": [avatar(VRM0), avatar(VRM1)],
        "meshopt": [compressed.meshopt_of(packed), compressed.meshopt_of(column(), version=1)],
        "draco": [compressed.draco_column()],
    }


def _one(rng: Generator, kind: str) -> tuple[dict[str, Any], bytes]:
    """Choose a document and damage its JSON or its buffer."""
    builder = documents()[kind][rng.integers(len(documents()[kind]))]
    document, data = builder.finished(), bytes(builder.data)
    if rng.random() < 0.75:
        document = damage.tree(rng, document)
    if rng.random() < 0.4:
        data = damage.raw(rng, data)
    return document, data


def _text(document: Any) -> bytes:
    return json.dumps(document).encode()


def glb(rng: Generator, kind: str = "plain", name: str = "fuzz.glb") -> Files:
    """Make a damaged GLB."""
    document, data = _one(rng, kind)
    packed = pack(_text(document), data)
    return {name: damage.raw(rng, packed) if rng.random() < 0.15 else packed}


def gltf(rng: Generator) -> Files:
    """Make a damaged document with its buffer in it, or beside it."""
    document, data = _one(rng, "plain")
    beside = rng.random() < 0.5
    uri = "fuzz.bin" if beside else "data:;base64," + base64.b64encode(data).decode()
    buffers = document.get("buffers") if isinstance(document, dict) else None
    for buffer in buffers if isinstance(buffers, list) else []:
        if isinstance(buffer, dict):
            buffer.setdefault("uri", uri)
    text = _text(document)
    return {"fuzz.gltf": damage.lines(rng, text) if rng.random() < 0.15 else text, "fuzz.bin": data}


def mesh(kind: str) -> Callable[[Generator], Files]:
    """Return what damages a mesh as trimesh writes it."""

    def make(rng: Generator) -> Files:
        content, is_text = _meshes()[kind][rng.integers(len(_meshes()[kind]))]
        damaged = (damage.lines if is_text else damage.raw)(rng, content)
        return {f"fuzz.{kind}": damaged, "fuzz.json": _text(SKELETON)}

    return make


@cache
def _meshes() -> dict[str, list[tuple[bytes, bool]]]:
    import trimesh

    whole = trimesh.Trimesh(COLUMN, FACES, process=False)
    colours = trimesh.Trimesh(
        COLUMN, FACES, process=False, vertex_colors=np.full((12, 4), 99, "u1")
    )

    def written(one: Any, **kind: Any) -> bytes:
        content = one.export(**kind)
        return content if isinstance(content, bytes) else content.encode()

    return {
        "ply": [
            (written(whole, file_type="ply", encoding="ascii"), True),
            (written(whole, file_type="ply"), False),
            (written(colours, file_type="ply"), False),
        ],
        "stl": [
            (written(whole, file_type="stl_ascii"), True),
            (written(whole, file_type="stl"), False),
        ],
        "off": [(written(whole, file_type="off"), True)],
    }


def obj(rng: Generator) -> Files:
    """Make a damaged OBJ, with a sound skeleton."""
    return {"fuzz.obj": damage.lines(rng, OBJ.encode()), "fuzz.json": _text(SKELETON)}


def skeleton(rng: Generator) -> Files:
    """Make a damaged skeleton beside a sound OBJ."""
    document = damage.tree(rng, SKELETON)
    text = _text(document)
    if rng.random() < 0.3:
        text = damage.lines(rng, json.dumps(document, indent=1).encode())
    return {"fuzz.obj": OBJ.encode(), "fuzz.json": text}


def rignet(rng: Generator) -> Files:
    """Make a damaged rig file beside a sound mesh, or the other way round."""
    rig, body = RIGNET.encode(), OBJ.encode()
    if rng.random() < 0.85:
        rig = damage.lines(rng, rig)
    else:
        body = damage.lines(rng, body)
    return {"fuzz.txt": rig, "fuzz.obj": body}


def npz(rng: Generator) -> Files:
    """Make an archive of damaged arrays, damaged members, or damaged itself."""
    result = arrays()
    for _ in range(int(rng.integers(0, 3))):
        name = str(rng.choice(list(result)))
        result[name] = damage.numbers(rng, result[name])
        if rng.random() < 0.1:
            del result[name]
    packed = io.BytesIO()
    way = zipfile.ZIP_DEFLATED if rng.random() < 0.5 else zipfile.ZIP_STORED
    with zipfile.ZipFile(packed, "w", way) as archive:
        broken = str(rng.choice([*result, *[""] * len(result)]))
        for name, array in result.items():
            member = io.BytesIO()
            np.save(member, array)
            content = member.getvalue()
            archive.writestr(f"{name}.npy", _member(rng, content) if name == broken else content)
    content = packed.getvalue()
    return {"fuzz.npz": damage.raw(rng, content) if rng.random() < 0.3 else content}


def _member(rng: Generator, content: bytes) -> bytes:
    end = content.index(b"\n") if rng.random() < 0.5 else 0
    if end:  # its header is text
        return content[:10] + damage.lines(rng, content[10:end]) + content[end:]
    return damage.raw(rng, content)


def fbx(rng: Generator) -> Files:
    """Make a damaged FBX, of text or binary, old or new."""
    scene = fbx_builder.column_scene()
    way = rng.integers(4)
    if way == 0:
        content = damage.lines(rng, fbx_builder.old_text())
    elif way == 1:
        content = damage.lines(rng, fbx_builder.text(scene))
    else:
        content = damage.raw(rng, fbx_builder.binary(scene, 7400 if way == 2 else 7700))
    return {"fuzz.fbx": content}


def usd(rng: Generator) -> Files:
    """Make a damaged USD: text, a crate, or a package."""
    way = rng.integers(3)
    if way == 0:
        return {"fuzz.usda": damage.lines(rng, usd_text().encode())}
    end = ".usdc" if way == 1 else ".usdz"
    return {f"fuzz{end}": damage.raw(rng, _usd()[end])}


@cache
def _usd() -> Files:
    import tempfile
    from pathlib import Path

    from pxr import Usd, UsdUtils

    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder)
        (place / "a.usda").write_text(usd_text())
        Usd.Stage.Open(str(place / "a.usda")).Export(str(place / "a.usdc"))
        UsdUtils.CreateNewUsdzPackage(str(place / "a.usdc"), str(place / "a.usdz"))
        return {end: (place / f"a{end}").read_bytes() for end in (".usdc", ".usdz")}


READERS: dict[str, Callable[[Generator], Files]] = {
    "glb": glb,
    "gltf": gltf,
    "vrm": lambda rng: glb(rng, "vrm", "fuzz.vrm"),
    "meshopt": lambda rng: glb(rng, "meshopt"),
    "draco": lambda rng: glb(rng, "draco"),
    "obj": obj,
    "ply": mesh("ply"),
    "stl": mesh("stl"),
    "off": mesh("off"),
    "json": skeleton,
    "rignet": rignet,
    "npz": npz,
    "fbx": fbx,
    "usd": usd,
}
