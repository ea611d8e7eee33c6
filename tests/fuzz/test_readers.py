"""A short run of the readers' fuzzer; `python -m tests.fuzz.readers READER` is the long one."""

from pathlib import Path

import pytest

from tests.fuzz.harness import try_cases
from tests.fuzz.readers import NAMES, check_files

EACH = 2
SEEDS = Path(__file__).parent / "seeds"
"""A folder for the files of each case that failed once."""
MAIN = (".txt", ".glb", ".gltf", ".vrm", ".npz", ".fbx", ".obj", ".ply", ".stl", ".off", ".usda",
        ".usdc", ".usdz")  # fmt: skip
"""Of files that belong together, the one that is loaded comes first."""


@pytest.mark.slow
def test_a_few_cases_of_each_reader_pass():
    report = try_cases("tests.fuzz.readers", range(EACH * len(NAMES)), processes=1)
    assert not report.failures, "\n".join(f"{f.number}: {f.why}" for f in report.failures)
    assert report.passed == EACH * len(NAMES)


@pytest.mark.parametrize("seed", [folder.name for folder in sorted(SEEDS.iterdir())])
def test_what_failed_once_passes(tmp_path, seed):
    files = {path.name: path.read_bytes() for path in (SEEDS / seed).iterdir()}
    first = next(name for end in MAIN for name in files if name.endswith(end))
    check_files(tmp_path, {first: files[first], **files})
