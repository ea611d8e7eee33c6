"""A file takes memory and time in proportion to what it holds, whatever it asks for."""

import pickle
import time
import tracemalloc

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import cutcell
from tests.cutcell.io.gltf.gltf_builder import COLUMN, REST, column, moved
from tests.cutcell.io.gltf.test_gltf_clips import LINEAR, animate, quaternions

CHAIN = 6_000
FEW_SECONDS = 5


def chained(count, as_joints):
    """Return the column with a chain of nodes below its last joint."""
    builder = column()
    nodes, above = builder.json["nodes"], 1
    for _ in range(count):
        nodes.append({"translation": [0, 1e-5, 0]})
        nodes[above].setdefault("children", []).append(len(nodes) - 1)
        above = len(nodes) - 1
    chain = range(len(nodes) - count, len(nodes))
    inverse = [moved(*-REST[0])]
    inverse += [moved(-0.5, -1 - 1e-5 * k, -0.5) for k in range(count + 1)]
    skin = builder.json["skins"][0]
    skin["joints"] = [0, 1, *chain] if as_joints else [0, above]
    inverse = inverse if as_joints else [inverse[0], inverse[-1]]
    skin["inverseBindMatrices"] = builder.accessor(np.array(inverse))
    return builder


@pytest.mark.parametrize("as_joints", [True, False])
def test_a_chain_of_thousands_of_nodes_loads_at_once(loaded, as_joints):
    builder = chained(2000 if as_joints else CHAIN, as_joints)
    animate(builder, (1, "rotation", [0, 600], quaternions(0, 90), "LINEAR"))
    begin = time.process_time()
    rig = loaded(builder)
    (clip,) = rig.clips
    frames = len(clip.times)
    assert time.process_time() - begin < FEW_SECONDS
    assert 2 < frames < 3601
    end = clip.sample(600)[1]
    assert_allclose(end @ [0.5, 2, 0.5, 1], [-0.5, 1, 0.5, 1], atol=1e-5)


def test_many_long_clips_take_what_their_keys_take(loaded):
    builder = chained(200, as_joints=True)
    for k in range(40):
        animate(builder, (k + 3, "rotation", [0, 3600], quaternions(0, 45), "LINEAR"))
    size = len(builder.glb())
    tracemalloc.start()
    rig = loaded(builder)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert len(rig.clips) == 40
    assert {len(clip.times) for clip in rig.clips} == {3601}
    assert peak < 10e6 + 50 * size


def test_a_clip_is_what_it_was_after_a_journey_between_processes(loaded):
    builder = column()
    animate(builder, *LINEAR)
    rig = loaded(builder)
    (clip,) = pickle.loads(pickle.dumps(rig)).clips
    assert_array_equal(clip.transforms, rig.clips[0].transforms)


def without_data(builder, count, kind="VEC3"):
    return builder.add("accessors", {"componentType": 5126, "count": count, "type": kind})


def many_accessors(builder):
    """Ask for a little in each of them, and together more than any file of this size may take."""
    primitive = builder.json["meshes"][0]["primitives"][0]
    for _ in range(40):
        zeros = dict(primitive["attributes"], POSITION=without_data(builder, 200_000))
        del zeros["JOINTS_0"], zeros["WEIGHTS_0"]
        builder.json["meshes"][0]["primitives"].append(
            {"attributes": zeros, "indices": primitive["indices"]}
        )


def many_joints(builder):
    """Ask for a matrix of weights of 160 MB."""
    count = 20_000
    nodes = [builder.node(1) for _ in range(1000)]
    builder.json["skins"][0]["joints"] = [0, 1, *nodes]
    del builder.json["skins"][0]["inverseBindMatrices"]
    attributes = builder.json["meshes"][0]["primitives"][0]["attributes"]
    attributes["POSITION"] = without_data(builder, count)
    joints = {"componentType": 5121, "count": count, "type": "VEC4"}
    attributes["JOINTS_0"] = builder.add("accessors", joints)
    attributes["WEIGHTS_0"] = without_data(builder, count, "VEC4")


def many_places(builder):
    """Hang one mesh on a joint many times."""
    positions = without_data(builder, 60_000)
    builder.json["accessors"][positions]["sparse"] = {
        "count": 12,
        "indices": {
            "bufferView": builder.view(np.arange(12, dtype="u2").tobytes()),
            "componentType": 5123,
        },
        "values": {"bufferView": builder.view(COLUMN.tobytes())},
    }
    mesh = builder.mesh({"POSITION": positions})
    for _ in range(20):
        builder.node(1, mesh=mesh)


def many_scenery(builder):
    """Do the same without any skeleton."""
    builder.json["nodes"][2].pop("skin")
    many_places(builder)


@pytest.mark.parametrize("ask", [many_accessors, many_joints, many_places, many_scenery])
def test_what_a_file_asks_for_without_holding_it_is_refused_before_it_is_taken(
    loaded, ask, monkeypatch
):
    monkeypatch.setattr("cutcell.io.files.LEAST", 2**24)
    builder = column()
    ask(builder)
    tracemalloc.start()
    with pytest.raises(cutcell.FileError, match=r"of memory, and a file of .* may take .* in all"):
        loaded(builder)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 80e6
