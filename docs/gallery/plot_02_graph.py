"""
The cut-cell graph
==================

Mesh edges in blue, interior pieces in orange, surface edges in green, cut open at the depth of the body.
"""

import cutcell
import cutcell_viewers
from cutcell_app.headless import Choices, describe
from cutcell_assets import demo_path

rig = cutcell.load(demo_path("biped"))
scene = describe(
    rig,
    Choices(
        "graph",
        settings={
            "cut_axis": "z",
            "cut_keeps": "half",
            "mesh_edges": True,
            "surface_edges": True,
            "body": False,
            "resolution": 24,
        },
    ),
)
picture = cutcell_viewers.show(scene)
