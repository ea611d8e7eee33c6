"""The command `cutcell bind`: compute weights and save them."""

from __future__ import annotations

from dataclasses import asdict, replace
from typing import TYPE_CHECKING, Any

from ..errors import ParameterError
from ..io.formats import GLTF
from . import options as given
from .console import for_people, print_result, progress_bars

if TYPE_CHECKING:
    from ..binding import Binding
    from ..editing import Edits
    from ..graph import CutCellGraph
    from ..method import Method
    from ..rig import Rig
    from ..runtime.progress import Progress
    from ..templates import Template

EPILOG = """Examples:

- `cutcell bind character.glb bound.glb`

- `cutcell bind character.glb bound.glb -r 128`  (a finer lattice keeps close parts apart)

- `cutcell bind character.glb bound.npz --method paper`  (just as in the paper, every influence)

- `cutcell bind character.glb bound.glb --method paper --connectivity any --alpha 0.3`

- `cutcell bind character.glb bound.glb --lock Jaw --lock Eye.L --symmetric`  (keep these two)

- `cutcell bind character.glb bound.glb --fresh --no-deform '*_IK' --deform Tail`  (other joints)

- `cutcell bind character.glb bound.glb --layers character.layers.json`  (edits of the page)

- `cutcell bind body.obj bound.glb --skeleton rigged.fbx`  (the skeleton of another file)

- `cutcell bind statue.obj bound.glb --template biped`  (a skeleton is fitted into the body)

- `cutcell bind character.glb bound.glb --json | jq .seconds`  (for a script)"""

GLTF_INFLUENCES = 4
"""Default number of influences saved in glTF, which is the number that engines read."""


@for_people
@given.with_method()
def bind(
    rig: given.RigFile,
    out: given.OutFile,
    options: dict[str, Any],
    smoothing: given.Smoothing = 0,
    symmetric: given.Symmetric = False,
    lock: given.Lock = None,
    deform: given.Deform = None,
    no_deform: given.NoDeform = None,
    fresh: given.Fresh = False,
    layers: given.LayersFile = None,
    skeleton: given.SkeletonFile = None,
    accessories: given.Accessories = False,
    template: given.TemplateName = None,
    json: given.Json = False,
    quiet: given.Quiet = False,
) -> None:
    """Compute skinning weights for RIG and save it with them as OUT.

    Weights follow the shortest path through the inside of the mesh from each bone to each
    vertex, so that a hand next to a hip does not follow the hip. The paths are found in a
    graph: rays along x, y and z cut the mesh, and the intervals inside become edges.
    """
    from ..binding import bind as compute
    from ..editing import edited_rig, stored
    from ..editing.refine import refinement
    from ..io import check_output, load, save, saving_notes
    from ..io.files import naming
    from ..rig.deform_joints import choose_deform
    from ..templates.fit import check_template
    from .summary import described, report_rows, summarize_weights

    edits = None if layers is None else stored.load_edits(layers)
    how, resolution = given.layered_method(options, edits)
    touches: dict[str, Any] = {"smoothing": smoothing, "symmetric": symmetric, "locked": lock or []}
    fits = None if template is None else check_template(template)
    check_output(out)
    loaded, graph = load(rig, skeleton, accessories), None
    with naming(rig):
        if fits is not None:
            with progress_bars(quiet) as progress:
                loaded, graph = _with_template(loaded, fits, how, progress)
        unused = stored.stored_edits(loaded) if edits is None else None
        if edits is not None:
            loaded = stored.with_base(loaded)
            if not len(loaded.skeleton.joints):
                loaded = edited_rig(loaded, edits)  # they may bring a skeleton
        loaded.require_joints()
        loaded = choose_deform(loaded, deform or (), no_deform or (), fresh=fresh)
        if edits is not None:
            loaded = edited_rig(loaded, edits)
    check_output(out, loaded)
    with progress_bars(quiet) as progress:
        binding = compute(
            loaded, resolution, method=how, **touches, edits=edits, graph=graph, progress=progress
        )
    dropped: list[str] = []
    how = binding.method
    is_open = options["max_influences"] is None and how.max_influences is None
    if is_open and out.suffix.lower() in GLTF:
        binding, dropped = _limited(loaded, binding, edits, touches)
        how = how.with_options(max_influences=GLTF_INFLUENCES)
    warnings = [*loaded.warnings, *binding.warnings, *dropped]
    if unused is not None and unused.layers:
        warnings.append(
            f"{rig.name} holds {len(unused.layers)} layers, which were not applied; apply them "
            f"with --layers {rig}"
        )
    result = loaded.with_weights(binding.weights)
    if edits is not None and out.suffix.lower() in GLTF:
        touched = refinement(loaded, **touches)
        settings = stored.settings_with_layers(
            loaded, binding.method, binding.weights, edits, touched
        )
        files = stored.save_bound(out, result, settings)
    else:
        files = save(out, result)
    warnings += saving_notes(out, loaded)
    document = {
        "input": str(rig),
        "output": str(out),
        "files": [str(file) for file in files],
        "method": options["method"] or "animation",
        "parameters": {**asdict(how), **touches},
        "layers": None if layers is None else str(layers),
        "template": template,
        **described(loaded, binding.graph, binding.distances, binding.seconds),
        "influences": summarize_weights(binding.weights),
        "warnings": warnings,
    }
    print_result(document, f"{rig.name} -> {out}", report_rows(document), json, quiet)


def _with_template(
    rig: Rig, template: Template, method: Method, progress: Progress
) -> tuple[Rig, CutCellGraph]:
    """Return the rig with a skeleton fitted into its mesh, and the graph of the mesh."""
    from ..graph import build_graph
    from ..templates import fit_skeleton

    if len(rig.skeleton.joints):
        raise ParameterError(
            f"the rig has a skeleton of {len(rig.skeleton.joints)} joints already; --template is "
            "for meshes without one"
        )
    graph = build_graph(rig.mesh, method=method, progress=progress)
    skeleton = fit_skeleton(rig.mesh, template, graph=graph)
    return replace(rig, skeleton=skeleton), graph


def _limited(
    rig: Rig, binding: Binding, edits: Edits | None, touches: dict[str, Any]
) -> tuple[Binding, list[str]]:
    """Limit the influences to those of glTF; return a warning about the dropped weight."""
    from ..binding.bind import limit_influences
    from ..editing import Edits

    every = binding.weights
    most = int((every > 0).sum(axis=1).max())
    if most <= GLTF_INFLUENCES:
        return binding, []
    limited = limit_influences(
        rig, binding, edits or Edits(), max_influences=GLTF_INFLUENCES, **touches
    )
    dropped = every.sum(axis=1, where=limited.weights == 0)
    sentence = (
        f"of up to {most} influences a vertex the {GLTF_INFLUENCES} largest are saved, as "
        f"glTF files are read; this drops {dropped.mean():.1%} of the weight on average and "
        f"{dropped.max():.1%} at most. --max-influences sets another number, or all"
    )
    return limited, [sentence]
