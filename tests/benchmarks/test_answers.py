"""The answers of README: what is counted for a character, and attacks that would run."""

import pytest

import cutcell
from cutcell_assets import demo_path
from cutcell_lab.benchmarks import answers


@pytest.mark.slow
def test_attacks_run_in_pythons_reader_and_not_in_ours():
    made, by_python, by_us = answers.run_by_attacks()
    assert made == by_python > 100
    assert by_us == 0


@pytest.mark.slow
def test_facts_of_a_character(monkeypatch):
    monkeypatch.setattr(answers, "REPEATS", 1)
    facts = answers.examine(cutcell.load(demo_path("biped_cape")))
    assert (facts.components, facts.joints, facts.vertices) == (2, 52, 13_777)
    assert facts.split > 0
    assert facts.torn == facts.meeting == facts.empty == 0
    assert facts.explained == answers.EXPLAINED


def test_numbers_of_documents_are_read():
    free, resolved = answers.wheels()
    assert 0 < free <= resolved
    assert all(
        float(value) > 0 for name in ("cutcell_rig", "voxel") for value in answers.medians(name)
    )
