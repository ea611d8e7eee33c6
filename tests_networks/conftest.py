"""One thread of the processor, so that results are the same each time; characters to learn from."""

import os
from pathlib import Path

import numpy as np
import pytest

os.environ["CUDA_VISIBLE_DEVICES"] = ""

import torch

import cutcell
from cutcell_lab.networks import Sample, sample_rig

ROOT = Path(__file__).resolve().parent.parent
POINTS = 96


def pytest_sessionstart() -> None:
    torch.set_num_threads(1)


def characters(*names: str, prior: bool = True) -> list[Sample]:
    """Return samples of demo characters, with the weights of `bind` as prior or without."""
    result = []
    for k, name in enumerate(names):
        rig = cutcell.load(ROOT / "assets" / f"{name}.glb")
        sample = sample_rig(rig, POINTS + 10 * k)
        result.append(sample.with_prior(cutcell.bind(rig, 32).weights) if prior else sample)
    return result


@pytest.fixture(scope="session")
def biped() -> Sample:
    return characters("biped")[0]


@pytest.fixture(scope="session")
def two() -> list[Sample]:
    """Two characters that differ in points and in joints."""
    pair = characters("biped", "robot")
    assert len({len(sample.points) for sample in pair}) == 2
    assert len({len(sample.joints) for sample in pair}) == 2
    return pair


@pytest.fixture
def rng() -> np.random.Generator:
    return np.random.default_rng(19)
