"""Each character has a maker, and a name without one is an error."""

import pytest

from cutcell.errors import ParameterError
from cutcell_lab.benchmarks.makers import maker_of
from cutcell_lab.benchmarks.wild import files_of


def test_a_name_without_a_maker_is_an_error():
    with pytest.raises(ParameterError, match=r'"unseen_pack__Horse".*makers'):
        maker_of("unseen_pack__Horse")


def test_the_longest_beginning_counts():
    assert maker_of("godot_hand") == "Godot XR" != maker_of("godot_enemy")
    assert maker_of("X_NHPI_F_1_Casual") == maker_of("White_F_1_Casual") == "VALID"


@pytest.mark.parametrize("group", ["rigs", "wild", "train", "more"])
def test_all_characters_have_makers(group):
    for path in files_of(group):
        assert maker_of(path.parent.name if path.suffix == ".gltf" else path.stem)
