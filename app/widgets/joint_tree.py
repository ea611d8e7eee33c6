"""The joints of the character as a tree, with what of the skin each holds."""

import param

from ..server.protocol.received import Carry, Message, Pick
from .modules import Clickable, script


class JointTree(Clickable):
    """A tree of joints; a click reports a joint, and whether it is let carry weight, or None."""

    rows = param.List([], doc="See `editing.correct.joints.joint_rows`.")
    chosen = param.Integer(-1, doc="The joint that is marked; -1 for none.")

    _esm = script("widgets/joint_tree")

    def receive(self, message: Message) -> None:
        """Report a joint, and whether it may deform the mesh where that is changed."""
        joints = {row["joint"] for row in self.rows}
        match message:
            case Carry(joint, on) if joint in joints:
                self.click((joint, on))
            case Pick(joint) if joint in joints:
                self.click((joint, None))
