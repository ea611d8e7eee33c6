"""The transitions of a binding, without a session."""

import pytest

from cutcell.editing.corrections import Corrections
from cutcell_app.state.bound import Binder, Bound
from tests.viewers.arm import arm_rig

COARSE, FINE = {"resolution": 16, "leaf": "fit"}, {"resolution": 32, "leaf": "fit"}
GRAPH = ("resolution",)


@pytest.fixture(scope="module")
def mesh():
    return arm_rig().mesh


@pytest.fixture
def binder(mesh):
    """Return one whose first request has arrived."""
    binder = Binder()
    assert binder.request(COARSE, mesh, GRAPH) is None
    assert not binder.is_for(COARSE)
    binder.arrived(Bound(mesh, COARSE, Corrections(), "graph"))
    return binder


def test_the_graph_is_used_again_where_only_joints_differ(binder, mesh):
    assert binder.is_for(COARSE)
    assert binder.request({**COARSE, "leaf": "point"}, mesh, GRAPH) == "graph"
    assert binder.request(FINE, mesh, GRAPH) is None
    assert binder.requested == FINE
    assert binder.is_for(COARSE), "what failed or was cancelled leaves it as it was"


def test_another_mesh_lets_go_of_what_was_bound(binder):
    assert binder.request(COARSE, arm_rig().mesh, GRAPH) is None
    assert binder.bound is None
    assert not binder.is_for(COARSE)


def test_a_notice_is_given_once_and_what_arrives_is_diagnosed_anew(binder, mesh):
    binder.notice, binder.is_diagnosed = "done", True
    bound = Bound(mesh, FINE, Corrections(), "graph")
    assert binder.arrived(bound) == "done"
    assert binder.arrived(bound) == ""
    assert not binder.is_diagnosed


def test_weights_follow_corrections_and_nothing_else_changes(binder):
    corrections = Corrections(removed=["tip"])
    before = binder.bound
    binder.reweighted(corrections)
    assert binder.bound.corrections == corrections
    assert binder.bound.graph == "graph"
    assert before.corrections == Corrections(), "what is frozen stays"
    binder.withdrawn()
    assert binder.requested == {}
