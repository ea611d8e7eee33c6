"""State that all panels share: the character, the chosen bone and vertex, and progress."""

from __future__ import annotations

from typing import Any

import param

from cutcell_viewers.palette import COLORMAPS

MOMENT = -1.0
"""`precedence` of parameters that belong to one person or moment: undo leaves them, and the address
has no entry with their names; it may have entries of its own for them."""

CUTS = ("auto", "off", "x", "y", "z", "free")
"""Cuts through the body; a free plane has any direction, and auto is z on the panel graph."""


class Common(param.Parameterized):
    """The part of the state that belongs to no panel."""

    panel: str  # a parameter of the class that has all panels

    demo = param.String("", doc="Id of the demo character that was chosen; else empty.")
    rig: Any = param.Parameter(None, doc="The character: a cutcell.Rig, or None at first.")
    binding: Any = param.Parameter(None, doc="What was computed for it, or None so far.")
    binding_warnings: Any = param.Parameter(None, doc="Warnings about it, or None so far.")
    built_graph: Any = param.Parameter(None, doc="The graph that was built, or None so far.")

    joint = param.Integer(0, doc="The chosen joint.", precedence=MOMENT)
    vertex = param.Integer(
        None, allow_None=True, doc="The clicked vertex, or None.", precedence=MOMENT
    )
    skeleton = param.Boolean(True, label="Skeleton")
    faint_skeleton = param.Boolean(False, doc="Whether bones are see-through.")
    wireframe = param.Boolean(False, doc="Whether edges of the mesh are drawn on the body.")

    cut_axis: param.Selector[str] = param.Selector(default="auto", objects=list(CUTS))
    cut_position = param.Number(0.5, bounds=(0, 1), step=0.005, label="Position")
    cut_yaw = param.Number(
        30.0, bounds=(-180, 180), label="Yaw",
        doc="Direction of a free plane around the upright axis, in degrees.",
    )  # fmt: skip
    cut_pitch = param.Number(20.0, bounds=(-90, 90), label="Pitch", doc="And upwards.")
    cut_face: param.Selector[str] = param.Selector(
        default="field",
        objects={"Distance": "field", "Winding number": "winding"},
        doc="What is seen on it, of distances.",
    )
    graph_face: param.Selector[str] = param.Selector(
        default="open",
        objects={"Open": "open", "Distance": "field", "Winding": "winding"},
        doc="The same, of the graph.",
    )
    colormap: param.Selector[str] = param.Selector(
        default="default",
        objects={name.capitalize(): name for name in COLORMAPS},
        label="Colour map",
        doc="Of distances, depths and the weights of one bone: one of `palette.COLORMAPS`.",
    )

    actors = param.Dict({}, doc="Meshes that the server was started with: name to `Actor`.")
    rendered = param.Boolean(
        False, doc="Whether PyVista draws the view on the server when it rests."
    )

    dark = param.Boolean(False, precedence=MOMENT)

    bound: Any = param.Parameter(None, doc="Distances, with weights of many influences, or None.")
    influences: Any = param.Parameter(None, doc="Weights of many influences, or None so far.")
    recomputed = param.Dict({}, doc="Weights of layers that are computed otherwise: by their keys.")
    computing: Any = param.Parameter(
        frozenset(), doc="Keys of the results that are being computed; see `Engine`."
    )
    queued: Any = param.Parameter(frozenset(), doc="Of these, keys that wait for other pages.")

    busy = param.Boolean(False, doc="Whether something is being computed.", precedence=MOMENT)
    stage = param.String("", doc="What is being computed.")
    fraction = param.Number(
        0.0, doc="How much of the stage is done, from 0 to 1.", precedence=MOMENT
    )
    exporting = param.String("", doc="Stage of an export while something else is computed.")
    message: Any = param.Parameter(None, doc="(severity, sentence) to show, or None.")

    @property
    def bare(self) -> bool:
        """Whether the character is a mesh without a skeleton: it has a graph, and no more."""
        return self.rig is not None and not len(self.rig.skeleton.joints)

    @property
    def cut_across(self) -> str:
        """Axis that the body is cut across on this panel; "off" for none."""
        auto = "z" if self.panel == "graph" else "off"
        return auto if self.cut_axis == "auto" else str(self.cut_axis)

    @property
    def graph(self) -> Any:
        """The graph of the character; None so far."""
        if self.binding is not None:
            return self.binding.graph
        return self.built_graph if self.bare else None

    @property
    def weights(self) -> Any:
        """Weights that pose the character: the computed ones, else the file's."""
        if self.binding is not None:
            return self.binding.weights
        return None if self.rig is None else self.rig.weights

    @property
    def rows(self) -> Any:
        """`weights`, sparse where they are computed: the array takes long after each change."""
        return self.weights if self.binding is None else self.binding.rows
