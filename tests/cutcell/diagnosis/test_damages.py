"""Each kind of damage is named, with its elements; a sound character is called sound."""

import numpy as np
import pytest

import cutcell
from cutcell.diagnosis import SEVERITIES, TITLES
from cutcell_lab.benchmarks.damages import DAMAGES, READING
from tests.cutcell.diagnosis.worm import SWEEP, worm

WORM = worm()
LIMBLESS = "a limb pressed flat"


@pytest.fixture(scope="module")
def sound():
    return cutcell.diagnose(WORM, 24)


def test_nothing_is_found_in_a_sound_character(sound):
    assert sound.findings == ()
    assert sound.counts == {"error": 0, "warning": 0, "note": 0}
    assert sound.rig is WORM


@pytest.mark.parametrize("name", sorted(DAMAGES.keys() - {LIMBLESS}))
def test_damage_is_named_with_its_elements(name, tmp_path):
    code, damage = DAMAGES[name]
    damaged = damage(WORM, 7, *([tmp_path] if damage in READING else []))
    finding = cutcell.diagnose(damaged.rig, 24)[code]
    named = getattr(finding, damaged.kind)
    assert np.isin(damaged.elements, named).mean() > 0.8
    assert finding.severity in SEVERITIES
    assert finding.title == TITLES[code]
    assert finding.message.endswith(".")
    assert finding.advice.endswith(".")
    for elements in (finding.vertices, finding.faces, finding.joints):
        assert (np.diff(elements) > 0).all()
    assert finding.vertices.max(initial=0) < len(damaged.rig.mesh.vertices)
    assert finding.faces.max(initial=0) < len(damaged.rig.mesh.faces)
    assert finding.joints.max(initial=0) < len(damaged.rig.skeleton.joints)


def test_every_kind_of_finding_has_a_damage_or_is_known_to_have_none():
    tried = {code for code, _ in DAMAGES.values()}
    elsewhere = {"unreadable", "cyclic-joints", "boneless-components"}  # see test_diagnose.py
    elsewhere |= {"exchanged-joints", "other-side"}  # see test_exchanged.py
    elsewhere |= {"far-parts", "hollow-body"}  # see test_far_parts.py and test_omitted.py
    suspicious = {"stray-weights", "weight-islands", "asymmetric-weights", *SWEEP}  # test_leaks.py
    suspicious |= {"noisy-weights"}  # see test_noise.py
    assert tried | elsewhere | suspicious == set(TITLES)
