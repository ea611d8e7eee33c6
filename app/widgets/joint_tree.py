"""The joints of the character as a tree, with what of the skin each holds."""

from typing import Any

import param

from .modules import Clickable, script


class JointTree(Clickable):
    """A tree of joints; a click reports a joint, and whether it is let carry weight, or None."""

    rows = param.List([], doc="See `editing.correct.joints.joint_rows`.")
    chosen = param.Integer(-1, doc="The joint that is marked; -1 for none.")

    _esm = script("joint_tree")

    def _handle_msg(self, data: dict[str, Any]) -> None:
        joint = int(data["joint"])
        if joint in {row["joint"] for row in self.rows}:
            self.click((joint, bool(data["on"]) if data.get("type") == "carry" else None))
