"""Whatever happens to a file, only an error of ours that names it comes out."""

import json

from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

import cutcell
from tests.cutcell.io.gltf.gltf_builder import column, pack
from tests.cutcell.io.gltf.test_gltf_clips import LINEAR, animate
from tests.cutcell.io.gltf.test_gltf_errors import sparse


def with_clip_and_skins():
    builder = column()
    animate(builder, *LINEAR)
    sparse()(builder)
    return builder.glb()


VICTIM = with_clip_and_skins()


@settings(
    max_examples=120,
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow],
)
@given(
    flips=st.lists(
        st.tuples(st.integers(0, len(VICTIM) - 1), st.integers(1, 255)), min_size=1, max_size=8
    ),
    end=st.none() | st.integers(0, len(VICTIM)),
)
def test_damaged_bytes_never_escape_as_anything_else(tmp_path, flips, end):
    content = bytearray(VICTIM)
    for at, change in flips:
        content[at] ^= change
    check_only_our_errors(tmp_path, bytes(content[:end]))


def json_paths(value, path=()):
    yield path
    children = value.items() if isinstance(value, dict) else enumerate(value)
    if isinstance(value, dict | list):
        for key, child in list(children):
            yield from (
                json_paths(child, (*path, key))
                if isinstance(child, dict | list)
                else [(*path, key)]
            )


LENGTH = int.from_bytes(VICTIM[12:16], "little")
DOCUMENT = json.loads(VICTIM[20 : 20 + LENGTH])
BODY = VICTIM[20 + LENGTH + 8 :]
ODD = st.sampled_from(
    [
        None,
        -1,
        0,
        1,
        3,
        5125,
        10**18,
        0.5,
        1e300,
        True,
        "",
        "x",
        [],
        [1],
        [None],
        {},
        [[]],
        {"a": 1},
    ]
)


@settings(
    max_examples=120,
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow],
)
@given(
    changes=st.lists(
        st.tuples(st.sampled_from(list(json_paths(DOCUMENT))[1:]), ODD), min_size=1, max_size=3
    )
)
@example([(("nodes", 1, "translation", 0), -1), (("meshes", 0, "primitives", 0, "mode"), None)])
def test_odd_fields_never_escape_as_anything_else(tmp_path, changes):
    document = json.loads(json.dumps(DOCUMENT))
    for path, value in changes:
        owner = document
        try:
            for key in path[:-1]:
                owner = owner[key]
            owner[path[-1]] = json.loads(json.dumps(value))
        except (KeyError, IndexError, TypeError):
            continue  # an earlier change took the place away
    check_only_our_errors(tmp_path, pack(json.dumps(document).encode(), BODY))


def check_only_our_errors(tmp_path, content):
    """Load, and save what could be loaded: all or a cutcell error that names the file."""
    path, out = tmp_path / "fuzz.glb", tmp_path / "out.glb"
    path.write_bytes(content)
    rig = ours(lambda: cutcell.load(path), "fuzz.glb")
    if rig is not None and ours(lambda: cutcell.save(out, rig) or out, "out.glb"):
        assert_allclose(cutcell.load(out).weights, rig.weights, atol=1e-6)


def ours(do, name):
    """Return what `do` returns, or None after an error of ours that names the file."""
    try:
        return do()
    except cutcell.CutcellError as error:
        message = str(error)
    assert name in message
    return None
