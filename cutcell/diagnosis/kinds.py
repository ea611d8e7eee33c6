"""Kinds of findings: a code, a severity, and the texts."""

from __future__ import annotations

from typing import NamedTuple

REMOVE = "Remove this weight, from these vertices or the whole rig, or bind again."
CLEANED = "remove weight that is implausible through the body from these vertices"


class Kind(NamedTuple):
    """Title, severity and texts of the findings of a code.

    Texts are templates: `{faces:face/are}` becomes the number of faces with noun and verb.
    """

    title: str
    severity: str
    message: str
    advice: str
    repair: str = ""


FINDING_KINDS = {
    "unreadable": Kind("Unreadable file", "error", "{error}", "Correct the file as described."),
    "cyclic-joints": Kind("Cycle of joints", "error",
        "{error}", "Remove the cycle from the parents.",
    ),
    "stray-vertices": Kind("Stray vertices", "error",
        "{vertices:vertex/lie} away from the rest, up to {farthest:.0f} times its size. The "
        "lattice spans all of it, so its cells are too large for the body.",
        "Delete them, or move them back to their neighbours.",
    ),
    "no-interior": Kind("No interior", "error",
        "No point of the lattice lies inside the mesh: distances run over its surface alone "
        "(R = {resolution}).",
        "Close the mesh, or give it walls; raise the resolution if it is only thin.",
    ),
    "inverted-faces": Kind("Inverted faces", "warning",
        "{faces:face/are} turned inside out, {part} of the surface: renderers that cull back "
        "faces show holes there.",
        "Flip them. Binding already treats them as flipped.",
        "flip them, and the normals that point inward",
    ),
    "hollow-body": Kind("Hollow body", "warning",
        "{faces:face/form} a second wall inside of the body, {part} of the surface: programs that "
        "bind through the body find it empty.",
        "Delete the inner surface. Binding already fills the body, but for the paper's method.",
        "delete the inner surface",
    ),
    "cracks": Kind("Cracks", "note",
        "{edges:edge/lie} along open rims less than {width:.2g} (file units) from others that fit: "
        "seams that were not welded.",
        "Merge vertices by a distance of {width:.2g} (file units).",
    ),
    "holes": Kind("Missing faces", "warning",
        "{holes:triangle/are} missing from the surface.",
        "Fill the holes. Small ones do not harm the binding.",
    ),
    "rims": Kind("Open rims", "note",
        "{rims:open rim} with {edges:edge}: the surface is not closed there.",
        "Leave it if it is meant to be open. Large openings make the inside ambiguous.",
    ),
    "non-manifold-edges": Kind("Non-manifold edges", "note",
        "{edges:edge/are} shared by more than two faces.",
        "Harmless for binding. Editing tools may stop there: split these edges.",
    ),
    "duplicate-faces": Kind("Duplicate faces", "note",
        "{faces:face/lie} on another with the same corners.",
        "Delete them: they flicker when drawn.",
        "drop them, and keep one of each",
    ),
    "degenerate-faces": Kind("Degenerate faces", "note",
        "{faces:face/have} no area.", "Delete them.", "drop them",
    ),
    "self-intersections": Kind("Self-intersections", "note",
        "{least}{faces:face/intersect} others, {part} of the surface.",
        "Leave it if parts are meant to overlap. Where they overlap they are one body.",
    ),
    "unwelded-vertices": Kind("Unwelded vertices", "note",
        "No face shares its vertices with another: {used:,} vertices, of which welding leaves "
        "{left:,}.",
        "Harmless: binding welds them. Merge them by distance for other programs.",
    ),
    "unused-vertices": Kind("Unused vertices", "note",
        "No face uses {vertices:vertex}.",
        "Delete them if nothing needs them. They are bound by straight distances.",
    ),
    "unreachable-vertices": Kind("Unreachable vertices", "note", "{why}", "{advice}"),
    "thin-parts": Kind("Thin parts", "note",
        "Below {part} of the surface the body is too thin for a lattice point at R = {resolution}.",
        "{advice}",
    ),
    "boneless-components": Kind("Components without a bone", "note",
        "{loose:,} of {total:,} connected components {contain} no bone.",
        "No action needed if each follows the joint that is named here.",
    ),
    "joints-outside": Kind("Joints outside the body", "note",
        "{joints:joint/lie} outside of the body, up to {away:.0%} of its longest side away, and "
        "may carry weight.",
        "Move them into the body, or let them carry no weight.",
    ),
    "coincident-joints": Kind("Coincident joints", "note",
        "{number} joints that may carry weight are in the same position as others.",
        "Let one of each group carry weight: the skin is divided arbitrarily between them.",
    ),
    "zero-length-bones": Kind("Bones of zero length", "note",
        "{joints:joint/lie} exactly on the parent.",
        "Move one of the two, or let only one carry weight.",
    ),
    "flat-hierarchy": Kind("No hierarchy", "note",
        "None of the {number} joints has a parent: they span no bones, and turning one moves no "
        "other.",
        "Give the joints their parents, if the program that moves them has any.",
    ),
    "control-joints": Kind("Control joints", "note",
        "{joints:joint/move} no skin: controls, end markers, sockets and roots.",
        "No action needed. Let one carry weight if it is a bone after all.",
    ),
    "unused-joints": Kind("Unused joints", "note",
        "{joints:joint/carry} no weight in the file, though in or near the body.",
        "No action needed if they are helpers. Binding leaves them without weight, too.",
    ),
    "invalid-weights": Kind("Invalid weights", "error",
        "{vertices:vertex/have} weights in the file that are negative or no numbers; these count "
        "as none.",
        "Paint or compute them anew.",
        "leave these weights out, and scale the others to sum to one",
    ),
    "unweighted-vertices": Kind("Vertices without weight", "error",
        "{vertices:vertex/have} no weight: left behind when others move.",
        "Weight them, or bind again.",
        "give them the weights of the nearest vertex that has some",
    ),
    "unnormalised-weights": Kind("Weights that do not sum to one", "warning",
        "In the file, the weights of {vertices:vertex/do} not sum to one, but to {low:.3g} to "
        "{high:.3g}: other programs may scale or shift the skin there.",
        "Normalise them.",
        "scale them to sum to one",
    ),
    "other-side": Kind("Skin that follows the other side", "warning",
        "{vertices:vertex/follow} {joints:joint} of the other side.{better}",
        "Exchange left and right there.",
    ),
    "exchanged-joints": Kind("Exchanged joints", "warning",
        "{joints:joint/look} exchanged: the skin of each lies at the bones of another.{better}",
        "Exchange their weights.",
    ),
    "leaked-weights": Kind("Leaked weights", "warning",
        "{vertices:vertex/follow} joints that are far away through the body, past nearer ones.",
        REMOVE, CLEANED,
    ),
    "stray-weights": Kind("Stray weights", "warning",
        "{joints:joint/hold} hardly any weight, yet would get much of the skin when the rig is "
        "bound again, for no other is nearer.",
        "{advice}",
    ),
    "weight-islands": Kind("Islands of weight", "warning",
        "{vertices:vertex/follow} a joint whose influence is elsewhere: islands of it lie away "
        "from its bones, with other joints between.",
        REMOVE, CLEANED,
    ),
    "far-parts": Kind("Parts that follow a far joint", "warning",
        "{parts:part/follow} a joint that is far away, though another is near.",
        "Let each follow what it touches, an empty joint in it or the nearest one, unless it is "
        "meant to follow the other.",
    ),
    "noisy-weights": Kind("Noisy weights", "warning",
        "{vertices:vertex/differ} abruptly {whom}.",
        "Take the other side there, smooth the weights, or bind again.",
    ),
    "stretched-surface": Kind("Surface that stretches", "warning",
        "{part} of the surface stretches or shrinks to more than twice when joints turn by "
        "{degrees:g}°.",
        "Turn this joint to see it. If its weights are wrong, change which joints deform, or bind "
        "the part separately.",
    ),
    "stretched-edges": Kind("Edges that stretch", "note",
        "Edges at {vertices:vertex} become {times:g} times as long or more when a joint turns by "
        "{degrees:g}°.",
        "Blend the weights there, or bind again.",
    ),
    "flipped-faces": Kind("Faces that flip", "note",
        "Up to {most} of the surface is turned over when a joint turns by {degrees:g}°.",
        "Blend the weights there, or bind again.",
    ),
    "lost-volume": Kind("Volume that is lost", "note",
        "The body loses up to {most} of its volume when a joint turns by {degrees:g}°.",
        "Blend the weights over a longer stretch, or bind again.",
    ),
    "asymmetric-weights": Kind("Left and right differ", "note",
        "{vertices:vertex/follow} other joints than the mirror image does, though mesh and "
        "skeleton are mirrored.",
        "Mirror one side, or bind symmetrically.",
    ),
    "torn-seams": Kind("Seams that tear", "note",
        "At {torn:place} of {places:,} vertices lie together that follow different joints: the "
        "skin tears open there when it moves.",
        "Give vertices in one place the same weights.",
        "give vertices in one place the mean of their weights",
    ),
    "many-influences": Kind("More than four influences", "note",
        "{vertices:vertex/follow} up to {most} joints; game engines read {limit}.",
        "Keep the {limit} largest, if an engine is to read it.",
        "keep the {limit} largest weights of each vertex",
    ),
}  # fmt: skip
"""Each code, in the order of reports."""

TITLES = {code: kind.title for code, kind in FINDING_KINDS.items()}
"""Title of each code, in the order of reports."""
