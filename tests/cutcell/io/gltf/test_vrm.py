"""VRM: glTF with extensions for avatars, which are kept whatever they say."""

import copy

import pytest

import cutcell
from cutcell.io.gltf.container import read_document
from tests.cutcell.io.gltf.compressed import meshopt_of
from tests.cutcell.io.gltf.gltf_builder import check_column, column
from tests.gltf_validator.validator import errors, reports

VRM0 = {
    "VRM": {
        "specVersion": "0.0",
        "meta": {"title": "Column", "author": "someone"},
        "humanoid": {
            "humanBones": [
                {"bone": "hips", "node": 0, "useDefaultValues": True},
                {"bone": "spine", "node": 1, "useDefaultValues": True},
            ]
        },
        "blendShapeMaster": {"blendShapeGroups": []},
        "secondaryAnimation": {"boneGroups": [{"bones": [1], "stiffiness": 1.0}]},
    }
}
VRM1 = {
    "VRMC_vrm": {
        "specVersion": "1.0",
        "meta": {
            "name": "Column",
            "authors": ["someone"],
            "licenseUrl": "https://vrm.dev/licenses",
        },
        "humanoid": {"humanBones": {"hips": {"node": 0}, "spine": {"node": 1}}},
    },
    "VRMC_springBone": {"specVersion": "1.0", "springs": [{"joints": [{"node": 1}]}]},
}
CONSTRAINT = {
    "VRMC_node_constraint": {
        "specVersion": "1.0",
        "constraint": {"roll": {"source": 0, "rollAxis": "Y", "weight": 0.5}},
    }
}


def avatar(extensions):
    """Return the column as a VRM; one of version 1 has a constraint on a node."""
    builder = column()
    builder.json["extensions"] = copy.deepcopy(extensions)
    builder.json["extensionsUsed"] = sorted(extensions)
    if "VRMC_vrm" in extensions:
        builder.json["nodes"][1]["extensions"] = copy.deepcopy(CONSTRAINT)
        builder.json["extensionsUsed"].append("VRMC_node_constraint")
    return builder


@pytest.mark.parametrize("extensions", [VRM0, VRM1], ids=["0", "1"])
@pytest.mark.parametrize("pack", [lambda b: b, meshopt_of], ids=["plain", "meshopt"])
def test_what_makes_it_an_avatar_is_kept(loaded, tmp_path, extensions, pack):
    rig = loaded(pack(avatar(extensions)), "avatar.vrm.glb")
    (tmp_path / "avatar.vrm.glb").rename(tmp_path / "avatar.vrm")
    rig = cutcell.load(tmp_path / "avatar.vrm")
    check_column(rig)
    for name in ("out.vrm", "out.glb"):
        cutcell.save(tmp_path / name, rig.with_weights(rig.weights[:, ::-1]))
        saved = read_document(tmp_path / name).json
        assert saved["extensions"] == extensions
        assert set(saved["extensionsUsed"]) >= set(extensions)
        assert "EXT_meshopt_compression" not in saved["extensionsUsed"]
        if extensions is VRM1:
            assert saved["nodes"][1]["extensions"] == CONSTRAINT
        assert [node.get("name") for node in saved["nodes"]] == ["root", "tip", "body"]
        assert cutcell.load(tmp_path / name).weights[0].tolist() == [0, 1]
    (report,) = reports(tmp_path / "out.glb")
    assert not errors(report)


def test_it_is_a_binary_file(tmp_path):
    (tmp_path / "a.vrm").write_bytes(b"PK\3\4 something else")
    with pytest.raises(cutcell.FileError, match=r"^a\.vrm: is not a glTF file"):
        cutcell.load(tmp_path / "a.vrm")
