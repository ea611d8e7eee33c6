"""Draco and meshopt: what was compressed loads as if it were not, and is saved without."""

import json
import sys

import meshopt
import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import cutcell
from cutcell.io.gltf.container import read_document
from tests.cutcell.io.gltf.compressed import DRACO, MESHOPT, draco_bytes, draco_column, meshopt_of
from tests.cutcell.io.gltf.gltf_builder import COLUMN, FACES, check_column, column
from tests.gltf_validator.validator import errors, reports

F = cutcell.FileError


def json_of(path):
    return read_document(path).json


@pytest.mark.parametrize("name", ["rig.glb", "rig.gltf"])
class TestDraco:
    def test_loads_as_if_it_were_plain(self, loaded, name):
        rig = loaded(draco_column(), name)
        check_column(rig)
        assert_array_equal(rig.mesh.faces, FACES)
        assert rig.warnings == (
            f"the file is compressed by Draco ({DRACO}); cutcell saves it uncompressed",
        )

    def test_is_saved_plainly_with_the_same_numbers(self, loaded, tmp_path, name):
        rig = loaded(draco_column(), name)
        cutcell.save(tmp_path / "out.glb", rig)
        again = cutcell.load(tmp_path / "out.glb")
        check_column(again)
        assert again.warnings == ()
        before, after = json_of(tmp_path / name), json_of(tmp_path / "out.glb")
        assert DRACO not in json.dumps(after)
        assert "extensionsUsed" not in after
        assert "extensionsRequired" not in after
        old, new = (d["meshes"][0]["primitives"][0] for d in (before, after))
        assert new["attributes"] == old["attributes"]
        assert new["indices"] == old["indices"]
        (report,) = reports(tmp_path / "out.glb")
        assert not errors(report)


class TestDracoDetails:
    def test_a_plain_copy_beside_it_is_taken_and_the_other_forgotten(self, loaded):
        builder = column()
        view = builder.view(b"not Draco at all")
        primitive = builder.json["meshes"][0]["primitives"][0]
        primitive["extensions"] = {DRACO: {"bufferView": view, "attributes": {"POSITION": 0}}}
        check_column(loaded(builder))

    def test_two_primitives_may_share_what_is_compressed(self, loaded):
        builder = draco_column()
        primitives = builder.json["meshes"][0]["primitives"]
        primitives.append(json.loads(json.dumps(primitives[0])))
        rig = loaded(builder)
        assert_allclose(rig.mesh.vertices, COLUMN, atol=1e-6)
        assert_array_equal(rig.mesh.faces, np.concatenate([FACES, FACES]))

    def test_two_meshes_that_claim_the_same_accessors_get_their_own(self, loaded):
        builder = draco_column()
        primitives = builder.json["meshes"][0]["primitives"]
        primitives.append(json.loads(json.dumps(primitives[0])))
        moved = builder.view(draco_bytes(COLUMN + np.float32([3, 0, 0])))
        primitives[1]["extensions"][DRACO]["bufferView"] = moved
        rig = loaded(builder)
        both = np.concatenate([COLUMN, COLUMN + np.array([3, 0, 0])])
        assert_allclose(rig.mesh.vertices, both, atol=1e-5)

    def test_more_vertices_than_announced_are_taken_as_they_are(self, loaded):
        check_column(loaded(draco_column(POSITION=8, JOINTS_0=8, WEIGHTS_0=8)))

    @pytest.mark.parametrize(
        ("change", "message"),
        [
            (lambda e: e.update(attributes=3), "must name attributes and a bufferView"),
            (lambda e: e.update(bufferView=99), r"refers to bufferViews\[99\]"),
            (lambda e: e["attributes"].update(WEIGHTS_0=55), "WEIGHTS_0 is not in its Draco data"),
            (lambda e: e["attributes"].update(TANGENT=9), "TANGENT is not in its Draco data"),
            (lambda e: e["attributes"].update(WEIGHTS_0=10), "WEIGHTS_0: is announced as VEC4"),
            (lambda e: e["attributes"].update(JOINTS_0=[7]), "JOINTS_0 is not in its Draco data"),
        ],
    )
    def test_what_it_says_wrongly_is_named(self, loaded, change, message):
        builder = draco_column()
        change(builder.json["meshes"][0]["primitives"][0]["extensions"][DRACO])
        with pytest.raises(F, match=rf"^rig\.glb: .*{message}"):
            loaded(builder)

    @pytest.mark.isolated
    @pytest.mark.parametrize(
        "spoil",
        [
            lambda data: data[: len(data) // 2],
            lambda data: b"DRACO" + bytes(40),
            lambda data: b"LETTER" + data[6:],
            lambda data: data[:11] + b"\xff\xff\xff\xff\x0f" * 4 + data[31:],
        ],
        ids=["cut", "zeros", "magic", "counts"],
    )
    def test_damage_is_a_sentence(self, loaded, spoil):
        with pytest.raises(F, match=r"^rig\.glb: its Draco compression cannot be undone: mesh 0"):
            loaded(draco_column(spoil(draco_bytes())))

    @pytest.mark.isolated
    def test_a_decoder_that_crashes_or_hangs_is_a_sentence(self, loaded, monkeypatch):
        code = "import os, signal; os.kill(os.getpid(), signal.SIGSEGV)"
        monkeypatch.setattr("cutcell.isolated.run.COMMAND", (sys.executable, "-c", code))
        with pytest.raises(F, match=r"^rig\.glb: its Draco .* crashed \(signal 11\)"):
            loaded(draco_column())
        code = "import time; time.sleep(600)"
        monkeypatch.setattr("cutcell.isolated.run.COMMAND", (sys.executable, "-c", code))
        monkeypatch.setattr("cutcell.io.gltf.read.compressed.MIN_SECONDS", 0.2)
        with pytest.raises(F, match=r"^rig\.glb: its Draco .* took longer than"):
            loaded(draco_column())


class TestMeshopt:
    @pytest.mark.parametrize(
        ("name", "version"),
        [(MESHOPT, 0), ("KHR_meshopt_compression", 1)],
    )
    @pytest.mark.parametrize("file", ["rig.glb", "rig.gltf"])
    def test_loads_as_if_it_were_plain(self, loaded, name, version, file):
        rig = loaded(meshopt_of(column(), name, version), file)
        check_column(rig)
        assert_array_equal(rig.mesh.faces, turned_as_stored(FACES))
        assert rig.warnings == (
            f"the file is compressed by meshopt ({name}); cutcell saves it uncompressed",
        )

    @pytest.mark.parametrize("file", ["out.glb", "out.gltf"])
    def test_is_saved_plainly_with_the_same_numbers(self, loaded, tmp_path, file):
        rig = loaded(meshopt_of(column()))
        cutcell.save(tmp_path / file, rig)
        check_column(cutcell.load(tmp_path / file))
        after = json_of(tmp_path / file)
        assert "meshopt" not in json.dumps(after)
        assert len(after["buffers"]) == 1
        plain = column().finished()
        assert after["meshes"] == plain["meshes"]
        assert len(after["accessors"]) == len(plain["accessors"])
        (report,) = reports(tmp_path / file)
        assert not errors(report)

    def test_filters_are_undone(self, loaded):
        builder = column()
        spin = builder.accessor(np.array([[0, 0, 0, 1], [0, 0, np.sqrt(0.5), np.sqrt(0.5)]], "f4"))
        times = builder.accessor(np.array([0.0, 1.0]), min=[0], max=[1])
        quaternions = np.array([[0, 0, 0, 1], [0, 0, np.sqrt(0.5), np.sqrt(0.5)]])
        builder.json["accessors"][spin] |= {"componentType": 5122, "normalized": True}
        channel = {"sampler": 0, "target": {"node": 1, "path": "rotation"}}
        sampler = {"input": times, "output": spin, "interpolation": "LINEAR"}
        builder.add("animations", {"channels": [channel], "samplers": [sampler]})
        view = builder.json["accessors"][spin]["bufferView"]
        position = builder.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"]
        of_position = builder.json["accessors"][position]["bufferView"]
        filters = {
            view: ("QUATERNION", 8, meshopt.encode_filter_quat(quaternions, 8, 16).tobytes()),
            of_position: ("EXPONENTIAL", 12, meshopt.encode_filter_exp(COLUMN, 24).tobytes()),
        }
        rig = loaded(meshopt_of(builder, filters=filters))
        check_column(rig)
        last = rig.clips[0].transforms[-1, 1]
        assert_allclose(last[:3, 0], [0, 1, 0], atol=1e-3)

    @pytest.mark.parametrize(
        ("change", "message"),
        [
            ({"count": 4_000_000_000}, "compressed bytes cannot hold 4000000000 elements"),
            ({"count": -1}, '"count" must be a whole number'),
            ({"count": 13}, "are damaged|cannot hold"),
            ({"mode": "POINTS"}, "mode 'POINTS' is none of ATTRIBUTES"),
            ({"filter": "SHARPEN"}, "are damaged .filter must be"),
            ({"filter": ["NONE"]}, "are damaged"),
            ({"byteStride": 3}, "are damaged .a row must be"),
            ({"buffer": 7}, r"refers to buffers\[7\]"),
            ({"byteOffset": 10**9}, "ends at byte"),
            ({"byteLength": 2}, "are damaged|cannot hold"),
        ],
    )
    def test_what_it_says_wrongly_is_named(self, loaded, change, message):
        builder = meshopt_of(column())
        attributes = builder.json["meshes"][0]["primitives"][0]["attributes"]
        view = builder.json["accessors"][attributes["POSITION"]]["bufferView"]
        builder.json["bufferViews"][view]["extensions"][MESHOPT].update(change)
        with pytest.raises(F, match=rf"^rig\.glb: bufferViews\[{view}\].*({message})"):
            loaded(builder)

    def test_damaged_streams_are_sentences(self, loaded):
        random = np.random.default_rng(3)
        for _ in range(60):
            builder = meshopt_of(column())
            for at in random.integers(0, len(builder.data), 4):
                builder.data[at] ^= 1 << random.integers(8)
            reported = "rig.glb: "
            try:
                assert np.isfinite(loaded(builder).mesh.vertices).all()
            except cutcell.CutcellError as error:
                reported = str(error)
            assert reported.startswith("rig.glb: ")

    def test_a_decoder_that_is_not_installed_is_named(self, loaded, monkeypatch):
        monkeypatch.setitem(sys.modules, "meshopt", None)
        with pytest.raises(cutcell.MissingLibraryError, match=r"^rig\.glb: .*pip install meshopt"):
            loaded(meshopt_of(column()))

    def test_a_view_without_any_bytes_is_named(self, loaded):
        builder = meshopt_of(column())
        del builder.json["bufferViews"][1]["extensions"]
        with pytest.raises(F, match=r"bytes .* of buffers\[1\]"):
            loaded(builder)


def turned_as_stored(faces):
    """Return faces as the codec gives them back: it may begin each at another corner."""
    return meshopt.decode_index_buffer(
        meshopt.encode_index_buffer(np.asarray(faces, "u4").reshape(-1)), faces.size, 4
    ).reshape(-1, 3)


def test_texture_extensions_stay(loaded, tmp_path):
    builder = meshopt_of(column())
    builder.json["extensionsUsed"] += ["EXT_texture_webp", "KHR_texture_transform"]
    material = {"extensions": {"KHR_texture_transform": {"offset": [0.5, 0]}}}
    builder.add("materials", material)
    cutcell.save(tmp_path / "out.glb", loaded(builder))
    after = json_of(tmp_path / "out.glb")
    assert after["extensionsUsed"] == ["EXT_texture_webp", "KHR_texture_transform"]
    assert after["materials"] == [material]
