"""Files that a file names: links out of the folder, pipes and devices are not opened."""

import json
import os
import tracemalloc

import numpy as np
import pytest

import cutcell
from cutcell.io.files import read_beside, read_bytes, regular_file
from cutcell.io.gltf.container import read_document
from tests.cutcell.io.gltf.gltf_builder import check_column, column

SECRET = b"of somebody else"
KINDS = ("link", "pipe", "device", "linked pipe")


@pytest.fixture
def folder(tmp_path):
    """Return a folder with one name for each kind of what is not to be opened."""
    inner = tmp_path / "inner"
    inner.mkdir()
    (tmp_path / "secret").write_bytes(SECRET + bytes(column().data))
    os.mkfifo(inner / "pipe")  # whoever opens it waits
    (inner / "link").symlink_to(tmp_path / "secret")
    (inner / "device").symlink_to("/dev/zero")
    (inner / "linked pipe").symlink_to(inner / "pipe")
    return inner


def document_with(folder, buffer="data.bin", image=None):
    builder = column()
    builder.json["buffers"] = [{"uri": buffer}]
    if image is not None:
        builder.json["images"] = [{"uri": image}]
    (folder / "data.bin").write_bytes(builder.data)
    path = folder / "rig.gltf"
    path.write_text(json.dumps(builder.finished()))
    return path


@pytest.mark.parametrize("name", KINDS)
@pytest.mark.parametrize("owner", ["buffer", "image"])
def test_a_gltf_is_refused(folder, owner, name):
    path = document_with(folder, **{owner: name})
    with pytest.raises(cutcell.FileError, match=rf"^rig\.gltf: .*{name}.* put a copy") as caught:
        cutcell.load(path)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("name", KINDS)
def test_what_takes_a_file_beside_another_refuses_it(folder, name):
    with pytest.raises(cutcell.FileError, match="put a copy"):
        regular_file(folder / name, folder)
    with pytest.raises(cutcell.FileError, match="put a copy"):
        read_beside(folder / "mesh.obj", [name], "its image")


@pytest.mark.parametrize("name", KINDS)
def test_an_image_that_became_one_after_loading_is_not_saved(folder, tmp_path, name):
    (folder / "skin.png").write_bytes(b"image")
    rig = cutcell.load(document_with(folder, image="skin.png"))
    (folder / "skin.png").unlink()
    (folder / name).rename(folder / "skin.png")
    with pytest.raises(cutcell.FileError, match="put a copy"):
        cutcell.save(tmp_path / "out.glb", rig)
    assert not (tmp_path / "out.glb").exists()


def test_links_within_the_folder_and_missing_images_are_fine(folder):
    (folder / "below").mkdir()
    path = document_with(folder, buffer="linked.bin", image="gone.png")
    (folder / "data.bin").rename(folder / "below" / "data.bin")
    (folder / "linked.bin").symlink_to(folder / "below" / "data.bin")
    check_column(cutcell.load(path))


def test_a_folder_may_be_a_link_itself(folder, tmp_path):
    path = document_with(folder)
    (tmp_path / "elsewhere").symlink_to(folder)
    check_column(cutcell.load(tmp_path / "elsewhere" / path.name))


def test_no_more_is_read_than_a_buffer_announces(folder):
    path = document_with(folder)
    announced = json.loads(path.read_text())["buffers"][0]["byteLength"]
    with (folder / "data.bin").open("ab") as file:
        file.truncate(2**36)  # takes no space
    assert len(read_document(path).buffers[0]) == announced
    assert len(read_bytes(folder / "data.bin", 7)) == 7


def test_buffers_of_one_file_take_it_once(folder):
    path = document_with(folder)
    with (folder / "data.bin").open("ab") as file:
        file.truncate(10**6)
    document = json.loads(path.read_text())
    names = ["data.bin", "./data.bin", "%64ata.bin"]
    document["buffers"] = [
        {"uri": names[i % 3], "byteLength": 10**6 - abs(50 - i)} for i in range(100)
    ]
    path.write_text(json.dumps(document))
    tracemalloc.start()
    check_column(cutcell.load(path))
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 2e7


def test_a_buffer_may_be_shorter_than_another_of_its_file(folder):
    path = document_with(folder)
    document = json.loads(path.read_text())
    whole = document["buffers"][0]
    document["buffers"] = [whole | {"byteLength": 4}, whole]
    for view in document["bufferViews"]:
        view["buffer"] = 1
    path.write_text(json.dumps(document))
    check_column(cutcell.load(path))


def test_the_dataset_reads_what_loading_reads(folder):
    from cutcell_lab.dataset.read.sources import find_sources

    path = document_with(folder, image="link")
    with pytest.raises(cutcell.FileError, match="put a copy"):
        find_sources([path])[0].content()
    path = document_with(folder, image="/etc/hostname")
    files = find_sources([path])[0].content().files
    assert list(files) == ["rig.gltf", "data.bin"]
    assert np.array_equal(files["data.bin"], (folder / "data.bin").read_bytes())
