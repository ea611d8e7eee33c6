"""Sentences about the map of symmetry, and the joints that it cannot pair."""

from typing import Any

from ...widgets import controls as ui
from .results import is_wanted

MAX_NAMES = 6
"""Number of joints that a sentence names."""


def about(state: Any) -> str:
    """Return how the joints were paired, and which have no partner."""
    image = state.mirror_image
    if image is None:
        return "The mirror image is computed."
    if isinstance(image, str):
        return f"{image[:1].upper()}{image[1:]}."
    pairs = image.joints
    sentences = ["Part of each vertex's weight that its mirror image gives to other joints."]
    for joints, text in (
        (pairs.unpaired, "Joints without a partner: {}."),
        (pairs.by_name, "Paired by name, as their places are not mirrored: {}."),
        (pairs.contradicting, "Paired by place, as their names say something else: {}."),
    ):
        if joints:
            names = [ui.joint_title(state.rig, joint) for joint in joints[:MAX_NAMES]]
            more = len(joints) - MAX_NAMES
            names += [f"and {more} more"] if more > 0 else []
            sentences.append(text.format(", ".join(names)))
    return " ".join(sentences)


SYMMETRY = ui.caption(about, visible=lambda state: is_wanted(state))
