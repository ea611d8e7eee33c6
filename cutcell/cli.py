"""The `cutcell` command: app, bind, graph, compare; diagnose and render have files of their own.

Nothing heavy is imported before a command runs, so that `--help` answers at once.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from . import __version__
from .console import for_people, print_json, print_table, print_warnings, progress_bars
from .diagnose_command import EPILOG as DIAGNOSE_EPILOG
from .diagnose_command import diagnose
from .errors import MissingLibraryError, ParameterError
from .joints_command import EPILOG as JOINTS_EPILOG
from .joints_command import joints
from .options import (
    Alpha,
    Connectivity,
    Deform,
    Falloff,
    Fresh,
    Json,
    Leaf,
    Lock,
    MaxInfluences,
    NoDeform,
    Orient,
    Quiet,
    Resolution,
    RigFile,
    Samples,
    SkeletonFile,
    Smoothing,
    Symmetric,
    Threshold,
    WindingThreshold,
)
from .render_command import EPILOG, render
from .report import report_rows

if TYPE_CHECKING:
    from .rig import Rig

app = typer.Typer(
    name="cutcell",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode="markdown",
    context_settings={"help_option_names": ["-h", "--help"]},
    epilog="""The method: *A Geodesic Cut-Cell Prior for Neural Skinning* (Ma et al. 2026).

Exit codes: 0 done; 2 wrong input, and one sentence says what; 130 stopped by Ctrl-C.""",
)


def _print_version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"cutcell {__version__}")
        raise typer.Exit


@app.callback()
def cutcell(
    version: Annotated[
        bool,
        typer.Option(
            "--version", callback=_print_version, is_eager=True, help="Print the version and stop."
        ),
    ] = False,
) -> None:
    """Skinning weights for any triangle mesh, from geodesic cut-cell graphs.

    A mesh and its skeleton go in, weights come out: how much each vertex follows each joint.
    The mesh may be open, in many pieces, or intersect itself.
    """


@app.command(name="app", epilog="Example: `cutcell app character.glb --port 5010`")
@for_people
def open_page(
    rig: Annotated[
        Path | None,
        typer.Argument(metavar="[RIG]", help="What to open; a demo character when left out."),
    ] = None,
    port: Annotated[
        int,
        typer.Option(
            "--port",
            help="Where the page is served; the next free one if taken, any free one if 0.",
        ),
    ] = 5006,
    address: Annotated[
        str,
        typer.Option(
            "--address",
            help="What to listen on. localhost: this machine only. 0.0.0.0, or the address of one"
            " network: everyone there can use the page, without a password or encryption.",
        ),
    ] = "localhost",
    show: Annotated[
        bool, typer.Option("--show/--no-show", help="Open a browser on the page.")
    ] = True,
) -> None:
    """Open the page: look at a character, its graph, distances and weights, and move it."""
    if not 0 <= port <= 65535:
        raise ParameterError(f"port must be a whole number from 0 to 65,535, not {port}")
    serve = _page()
    if rig is not None:
        from .io import load

        load(rig)  # a wrong file is told here, not by an empty page
    try:
        serve(rig, port=port, address=address, show=show)
    except OSError as error:
        raise ParameterError(
            f"the page cannot be served at {address}, port {port} ({error.strerror or error}); "
            "choose another --address or --port"
        ) from None


@app.command(
    epilog="""Examples:

- `cutcell bind character.glb bound.glb`

- `cutcell bind character.glb bound.glb -r 128`  (a finer lattice: close parts are told apart)

- `cutcell bind character.glb bound.glb --falloff paper --connectivity 6`  (just as in the paper)

- `cutcell bind character.glb bound.glb --lock Jaw --lock Eye.L --symmetric`  (keep these two)

- `cutcell bind character.glb bound.glb --fresh --no-deform '*_IK' --deform Tail`  (other joints)

- `cutcell bind body.obj bound.glb --skeleton body.json`  (a bare mesh)

- `cutcell bind character.glb bound.glb --json | jq .seconds`  (for a script)"""
)
@for_people
def bind(
    rig: RigFile,
    out: Annotated[
        Path,
        typer.Argument(
            metavar="OUT",
            help="Where to save it with the new weights; all else in the file stays as it was.",
        ),
    ],
    resolution: Resolution = 64,
    connectivity: Connectivity = "any",
    winding_threshold: WindingThreshold = 0.5,
    orient: Orient = True,
    samples: Samples = 5,
    leaf: Leaf = None,
    falloff: Falloff = "rig",
    alpha: Alpha = 0.5,
    max_influences: MaxInfluences = 4,
    threshold: Threshold = 0.0,
    smoothing: Smoothing = 0,
    symmetric: Symmetric = False,
    lock: Lock = None,
    deform: Deform = None,
    no_deform: NoDeform = None,
    fresh: Fresh = False,
    skeleton: SkeletonFile = None,
    json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Compute skinning weights for RIG and save it with them as OUT.

    Weights follow the shortest path through the inside of the mesh from each bone to each
    vertex, so that a hand beside a hip does not follow the hip. The paths are found in a
    graph: rays along x, y and z cut the mesh, and the pieces inside become edges.
    """
    from . import summary
    from .checks import check_has_joints
    from .deform import choose_deform
    from .io import check_output, save
    from .io.files import naming
    from .skinning import DEFAULT_LEAF
    from .skinning import bind as compute

    parameters: dict[str, Any] = {
        "resolution": resolution,
        "connectivity": _neighbours(connectivity),
        "winding_threshold": winding_threshold,
        "orient": orient,
        "samples": samples,
        "leaf": leaf or DEFAULT_LEAF.get(falloff),
        "falloff": falloff,
        "alpha": alpha,
        "max_influences": max_influences,
        "threshold": threshold,
        "smoothing": smoothing,
        "symmetric": symmetric,
        "locked": lock or [],
    }
    check_output(out)
    loaded = _load(rig, skeleton)
    with naming(rig):
        check_has_joints(loaded.skeleton)
        loaded = choose_deform(loaded, deform or (), no_deform or (), fresh=fresh)
    check_output(out, loaded)
    with progress_bars(quiet) as progress:
        binding = compute(loaded, **parameters, progress=progress)
    files = save(out, loaded.with_weights(binding.weights))
    seconds = {name: round(value, 4) for name, value in binding.seconds.items()}
    document = {
        "input": str(rig),
        "output": str(out),
        "files": [str(file) for file in files],
        "parameters": parameters,
        "mesh": summary.summarize_mesh(loaded.mesh, binding.graph),
        "meshes": summary.summarize_parts(loaded),
        "skeleton": summary.summarize_skeleton(loaded.skeleton),
        "graph": summary.summarize_graph(binding.graph),
        "fallback": summary.summarize_fallback(binding.distances),
        "influences": summary.summarize_weights(binding.weights),
        "seconds": seconds,
        "warnings": [*loaded.warnings, *binding.warnings],
    }
    if not quiet:
        print_warnings(document["warnings"])
    if json:
        print_json(document)
    elif not quiet:
        print_table(f"{rig.name} -> {out}", report_rows(document))


@app.command(
    epilog="""Examples:

- `cutcell graph character.glb`

- `cutcell graph scan.ply -r 128`  (a mesh alone: no skeleton is needed)

- `cutcell graph character.glb --json | jq .graph.edges.total`"""
)
@for_people
def graph(
    rig: RigFile,
    resolution: Resolution = 64,
    connectivity: Connectivity = "6",
    winding_threshold: WindingThreshold = 0.5,
    orient: Orient = True,
    samples: Samples = 5,
    leaf: Leaf = None,
    deform: Deform = None,
    no_deform: NoDeform = None,
    fresh: Fresh = False,
    skeleton: SkeletonFile = None,
    json: Json = False,
) -> None:
    """Build the cut-cell graph of RIG and say what it holds; nothing is written.

    Counts nodes and edges (of the mesh, inside, on the surface), pieces that hang together,
    and the share of vertices that no bone reaches through the graph.
    """
    from . import summary
    from .deform import choose_deform
    from .geodesics import bone_distances
    from .graph import build_graph
    from .io.files import naming

    loaded = _load(rig, skeleton)
    with naming(rig):
        loaded = choose_deform(loaded, deform or (), no_deform or (), fresh=fresh)
    seconds: dict[str, float] = {}
    start = time.perf_counter()
    with progress_bars(quiet=json) as progress:
        built = build_graph(
            loaded.mesh,
            resolution,
            connectivity=_neighbours(connectivity),
            winding_threshold=winding_threshold,
            orient=orient,
            progress=progress,
        )
        seconds["graph"] = round(time.perf_counter() - start, 4)
        distances = None
        if len(loaded.skeleton.joints):
            start = time.perf_counter()
            distances = bone_distances(
                built,
                loaded.skeleton,
                samples=samples,
                leaf=leaf or "point",
                allowed=loaded.allowed,
                progress=progress,
            )
            seconds["distances"] = round(time.perf_counter() - start, 4)
    document = {
        "input": str(rig),
        "parameters": {
            "resolution": resolution,
            "connectivity": _neighbours(connectivity),
            "winding_threshold": winding_threshold,
            "orient": orient,
            "samples": samples,
            "leaf": leaf or "point",
        },
        "mesh": summary.summarize_mesh(loaded.mesh, built),
        "meshes": summary.summarize_parts(loaded),
        "skeleton": distances and summary.summarize_skeleton(loaded.skeleton),
        "graph": summary.summarize_graph(built),
        "fallback": distances and summary.summarize_fallback(distances),
        "seconds": seconds,
        "warnings": list(loaded.warnings),
    }
    if json:
        print_json(document)
    else:
        print_warnings(loaded.warnings)
        print_table(rig.name, report_rows(document))


@app.command(
    epilog="""Examples:

- `cutcell compare character.glb`

- `cutcell compare *.glb --methods cutcell_any,bone_heat`  (medians, means and the worst rig)

- `cutcell compare *.glb --plot errors.svg --markdown > errors.md`"""
)
@for_people
def compare(
    rigs: Annotated[
        list[Path], typer.Argument(metavar="RIG...", help="Characters with an artist's weights.")
    ],
    methods: Annotated[
        str | None,
        typer.Option(
            "--methods", metavar="A,B,...", help="Which methods; all that there are if left out."
        ),
    ] = None,
    resolution: Resolution = 64,
    markdown: Annotated[
        bool, typer.Option("--markdown", help="Print Markdown, with a table for each measure.")
    ] = False,
    plot: Annotated[
        Path | None,
        typer.Option(
            "--plot", metavar="FILE", help="Draw the errors of all methods: .png, .svg or .pdf."
        ),
    ] = None,
    json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Bind characters by several methods and measure each against the artist's weights.

    L1 is the paper's weight error, cm² its deformation error: the squared distance between
    the skins as joints turn by 30°, with the mesh scaled to one metre. Only joints to which
    the artist gave weight take part. A method that fails on a rig says why; the others go on.
    """
    from .compare import compare as measure
    from .compare import comparison_markdown
    from .compare.plot import check_plot, plot_comparison
    from .compare.terminal import print_comparison

    if plot is not None:
        check_plot(plot)
    names = None if methods is None else [name.strip() for name in methods.split(",")]
    warnings: list[str] = []

    def load_each() -> Iterator[Rig]:
        for path in rigs:
            loaded = _load(path, None)
            warnings.extend(f"{path.name}: {text}" for text in loaded.warnings)
            yield loaded

    with progress_bars(quiet) as progress:
        comparison = measure(load_each(), names, resolution=resolution, progress=progress)
    if not quiet:
        print_warnings(warnings)
    if plot is not None:
        plot_comparison(comparison, plot)
    if json:
        print_json(comparison.to_dict())
    elif markdown:
        typer.echo(comparison_markdown(comparison))
    else:
        print_comparison(comparison)


app.command(epilog=DIAGNOSE_EPILOG)(diagnose)
app.command(epilog=EPILOG)(render)
app.command(epilog=JOINTS_EPILOG)(joints)


def main() -> None:
    """Run the command line."""
    app()


def _page() -> Any:
    """Fetch the page, or say how to install what it needs."""
    try:
        return import_module("app.serve").serve
    except ModuleNotFoundError as error:
        raise MissingLibraryError(
            f"the page needs libraries that are not installed ({error.name} is missing); "
            "install them by: pip install 'cutcell[app]'"
        ) from None


def _neighbours(text: str) -> int | str:
    return int(text) if text.isdecimal() else text


def _load(path: Path, skeleton: Path | None) -> Rig:
    from .io import load

    return load(path, skeleton=skeleton)
