"""Options that several commands share, with the texts of `--help`."""

from __future__ import annotations

import inspect
import sys
from collections.abc import Callable, Mapping
from contextlib import redirect_stdout
from functools import wraps
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ..io.formats import described
from ..method import ANIMATION, METHODS, OPTIONS, PAPER, Method, method_of
from ..options import Option
from ..runtime.standard_output import output_errors
from .console import for_people

if TYPE_CHECKING:
    from ..editing import Edits

METHOD = "The method"
JOINTS = "Deforming joints"
TOUCH = "Refinement"
FILES = "Files and output"


def _option(panel: str, flags: str, metavar: str, text: str, show_default: bool = True) -> Any:
    """Return an option for `Annotated`."""
    return typer.Option(
        *flags.split(),
        metavar=metavar or None,
        help=text,
        show_default=show_default,
        rich_help_panel=panel,
    )


@for_people
def _stdin(context: typer.Context, path: Path | None) -> Path | None:
    """Return a file with what is on standard input in the place of "-"."""
    from ..io.files import as_file

    if path != Path("-"):
        return path
    return context.with_resource(as_file(getattr(sys.stdin, "buffer", b"")))


def _stdout(context: typer.Context, path: Path | None) -> Path | None:
    """Return a GLB in the place of "-" that goes to standard output when all else is done."""
    if path != Path("-"):
        return path
    out = Path(context.with_resource(TemporaryDirectory()), "stdout.glb")
    output = sys.stdout.buffer
    context.with_resource(redirect_stdout(sys.stderr))
    write = output_errors()(lambda: output.write(out.read_bytes() if out.exists() else b""))
    context.call_on_close(write)
    return out


OutFile = Annotated[
    Path,
    typer.Argument(
        metavar="OUT", callback=_stdout,
        help="Output file: a copy of RIG with the new weights. - is a GLB on standard output.",
    ),
]  # fmt: skip
FixFile = Annotated[
    Path | None,
    typer.Option(
        "--fix", metavar="OUT", callback=_stdout, rich_help_panel=FILES,
        help="Save a copy with all safe repairs; nothing else in it changes.",
    ),
]  # fmt: skip
_RIG = typer.Argument(
    metavar="RIG",
    callback=_stdin,
    help=f"A character: {described('read')}. - is standard input.",
)
RigFile = Annotated[Path, _RIG]
OptionalRigFile = Annotated[Path | None, _RIG]
SkeletonFile = Annotated[
    Path | None,
    _option(
        FILES, "--skeleton", "FILE",
        f"File with the skeleton of a mesh that has no skin: {described('read_skeleton')}. Default:"
        " the .json of the same name next to the mesh.",
    ),
]  # fmt: skip
Accessories = Annotated[
    bool,
    _option(
        FILES, "--accessories", "",
        "Also bind meshes that have no skin, such as a sword that hangs on a joint.",
    ),
]  # fmt: skip
TemplateName = Annotated[
    str | None,
    _option(
        FILES, "--template", "T",
        "Fit a skeleton into a mesh that has none: biped, quadruped, hand, snake or chain.",
    ),
]  # fmt: skip
Json = Annotated[bool, _option(FILES, "--json", "", "Print one JSON document.")]
Quiet = Annotated[bool, _option(FILES, "--quiet -q", "", "No bars, no table, no warnings.")]
Deform = Annotated[
    list[str] | None,
    _option(
        JOINTS, "--deform", "JOINT",
        "Joint that may carry weight although the file or the detection excludes it; * matches"
        " any letters. May be given several times.",
    ),
]  # fmt: skip
NoDeform = Annotated[
    list[str] | None,
    _option(
        JOINTS, "--no-deform", "JOINT",
        "Joint that carries no weight, such as '*_IK'. May be given several times.",
    ),
]  # fmt: skip
Fresh = Annotated[
    bool,
    _option(
        JOINTS, "--fresh", "",
        "Ignore the file's weights and detect deforming joints from names and positions."
        " `cutcell joints` lists the result.",
    ),
]  # fmt: skip
LayersFile = Annotated[
    Path | None,
    _option(
        TOUCH, "--layers", "FILE",
        "Edits of the character: layers over its weights, joints moved or excluded, and options of"
        " the method. A .json, or a .glb or .vrm that holds layers.",
    ),
]  # fmt: skip
Smoothing = Annotated[
    int, _option(TOUCH, "--smoothing", "N", "Average the weights along mesh edges N times.")
]
Symmetric = Annotated[
    bool,
    _option(
        TOUCH, "--symmetric", "", "Make left and right weights equal where the mesh is symmetric."
    ),
]
Lock = Annotated[
    list[str] | None,
    _option(
        TOUCH, "--lock", "JOINT",
        "Joint that keeps its weights of the file; the others share the rest. May be given"
        " several times.",
    ),
]  # fmt: skip


def _row(name: str, option: Option) -> tuple[Any, Any, str, str, str]:
    """Return the type, default, flags, placeholder and help of an option of the method."""
    flag = f"--{name.replace('_', '-')}"
    is_text = isinstance(option.values, Mapping) or bool(option.none)
    kind: Any = str if is_text else type(getattr(PAPER, name))
    flags = f"{flag}/--no-{flag[2:]}" if kind is bool else f"{flag} {option.short}"

    def text(value: Any) -> str:
        if kind is bool:
            return flags.split("/")[not value]
        return f"{option.none}" if value is None else f"{value:g}" if kind is float else f"{value}"

    usual, paper = (text(getattr(method, name)) for method in (ANIMATION, PAPER))
    defaults = usual if usual == paper else f"{usual}; {paper} with --method paper"
    return (
        kind | None,
        None,
        flags,
        option.metavar,
        f"{option.help} Default: {defaults.strip('; ')}.",
    )


METHOD_OPTIONS: dict[str, tuple[Any, Any, str, str, str]] = {
    "method": (
        str | None, None, "--method", "M",
        "Defaults of the options below. animation: weights for animation. paper: as in the paper."
        " Default: animation.",
    ),
    **{name: _row(name, option) for name, option in OPTIONS.items()},
}  # fmt: skip
"""Type, default, flags, placeholder and help of each option of `Method`, by its field.

The default is None, so that one that is given counts, also where it equals the method's."""


def _annotated(
    kind: Any, default: Any, flags: str, metavar: str, text: str, panel: str = METHOD
) -> Any:
    """Return the annotation of an option, see `METHOD_OPTIONS`."""
    return Annotated[kind, _option(panel, flags, metavar, text, default not in (None, ""))]


if TYPE_CHECKING:
    Resolution = int
else:
    Resolution = _annotated(*METHOD_OPTIONS["resolution"])


def with_options(
    name: str, table: Mapping[str, tuple[Any, ...]]
) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Replace a command's parameter of a name by options, which it gets as a dictionary."""

    def decorate(command: Callable[..., None]) -> Callable[..., None]:
        @wraps(command)
        def run(**values: Any) -> None:
            command(**{name: {key: values.pop(key) for key in table}}, **values)

        parameters: list[inspect.Parameter] = []
        for parameter in inspect.signature(command, eval_str=True).parameters.values():
            if parameter.name != name:
                parameters.append(parameter)
                continue
            for key, row in table.items():
                kind = _annotated(*row)
                parameters.append(parameter.replace(name=key, default=row[1], annotation=kind))
        run.__signature__ = inspect.Signature(parameters)  # type: ignore[attr-defined]
        run.__annotations__ = {}
        return run

    return decorate


def with_method(*names: str) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Replace a command's parameter `options` by options of the method; all when none is named."""
    return with_options("options", {name: METHOD_OPTIONS[name] for name in names or METHOD_OPTIONS})


def chosen_method(options: Mapping[str, Any]) -> Method:
    """Return the method of that name with options from the command line, which may be texts."""
    from ..checks import check_choice

    values = {key: value for key, value in options.items() if value is not None}
    for name, option in OPTIONS.items():
        if isinstance(text := values.get(name), str):
            values[name] = None if text == option.none else int(text) if text.isdecimal() else text
    return method_of(check_choice("method", values.pop("method", "animation"), METHODS), **values)


def layered_method(options: Mapping[str, Any], edits: Edits | None) -> tuple[Method, int | None]:
    """Return the method of edits and of options that replace it, and the resolution of either."""
    chosen = {name: value for name, value in options.items() if value is not None}
    stored = {} if edits is None or "method" in chosen else edits.method
    stored = {name: "all" if value is None else value for name, value in stored.items()} | chosen
    method = chosen_method(stored)
    return method, method.resolution if "resolution" in stored else None
