"""Loading what a builder made."""

import pytest

import cutcell


@pytest.fixture
def loaded(tmp_path):
    """Return a function that writes a builder's document and loads it."""

    def load(builder, name="rig.glb"):
        return cutcell.load(builder.save(tmp_path / name))

    return load
