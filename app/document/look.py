"""Choose a bone or a vertex, look from somewhere; the view shows the scene of the state."""

from cutcell_viewers.camera import Camera, framing

from ..server.protocol.received import Pick, PickNode, PickVertex
from .framing import bounds_of, camera_part
from .session import Session


def watch(session: Session) -> None:
    """Connect the state to picks in the view."""
    view = session.view
    view.listen(Pick, lambda message: pick(session, message.joint))
    view.listen(PickVertex, lambda message: pick_vertex(session, message.vertex, message.view))
    view.listen(PickNode, lambda message: pick_node(session, message.node))
    session.engine.when(lambda state: state.shown_graph, lambda graph: pick_node(session, None))


def pick_node(session: Session, node: int | None) -> None:
    """Choose a node of the graph to look at closely; None for no more."""
    graph = session.state.shown_graph
    if node is not None and (graph is None or not 0 <= node < len(graph.nodes)):
        return
    session.state.node = node
    if node is not None:
        session.state.vertex = None  # one card at a time


def pick(session: Session, joint: int) -> None:
    """Choose a joint; show its weights where the colours showed all joints."""
    state = session.state
    if state.rig is None or not 0 <= joint < len(state.rig.skeleton.joints):
        return
    state.param.update(joint=joint, weights_shown="bone")


def pick_vertex(session: Session, vertex: int | None, view: int = 0) -> None:
    """Choose a vertex to look at closely, in one of the views side by side; None for no more."""
    state = session.state
    count = 0 if state.rig is None or state.bare else len(state.rig.mesh.vertices)
    if vertex is not None and not 0 <= vertex < count:
        return
    method = state.methods[view] if 0 <= view < len(state.methods) else ""
    state.param.update(vertex=vertex, node=None, clicked_method=method)


def set_camera(session: Session, camera: Camera | None) -> None:
    """Look from somewhere; None for the view that one begins with."""
    view, home = session.view, framing(bounds_of(session.state), 1.2)
    view.camera, view.at_home = camera or home, camera is None
    now = None if camera is None else camera_part(camera)
    view.send(camera={**camera_part(home), "now": now})
