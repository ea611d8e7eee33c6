"""The joints of the character as a tree, with what of the skin each holds."""

from collections.abc import Callable
from typing import Any

import param
from panel.custom import JSComponent

from .modules import script


class JointTree(JSComponent):
    """A tree in which a joint is chosen, and let carry weight or not.

    Parameters
    ----------
    on_choose : callable
        Called with the joint that is chosen.
    on_carry : callable
        Called with a joint and whether it shall carry weight.
    """

    rows = param.List([], doc="See `scenes.joints.joint_rows`.")
    chosen = param.Integer(-1, doc="The joint that is marked; -1 for none.")

    _esm = script("joint_tree")

    def __init__(
        self,
        on_choose: Callable[[int], None],
        on_carry: Callable[[int, bool], None],
        **params: Any,
    ) -> None:
        super().__init__(**params)
        self._on_choose = on_choose
        self._on_carry = on_carry

    def _handle_msg(self, data: dict[str, Any]) -> None:
        joint = int(data["joint"])
        if joint not in {row["joint"] for row in self.rows}:
            return
        if data.get("type") == "carry":
            self._on_carry(joint, bool(data["on"]))
        else:
            self._on_choose(joint)
