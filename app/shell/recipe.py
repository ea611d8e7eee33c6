"""Code that computes the weights of the page again: a script, and a command line."""

import shlex
from dataclasses import dataclass

from cutcell.binding.resolution import method_per_character
from cutcell.cli.options import METHOD_OPTIONS
from cutcell.editing import Edits
from cutcell.method import Method
from cutcell.rig import Rig

from ..document.method import options_of

FROM_FILE = Edits(base="file")
FIND_DEMO = "import cutcell_assets; print(cutcell_assets.demo_path({!r}))"


@dataclass(frozen=True)
class Recipe:
    """All that weights follow from.

    Parameters
    ----------
    rig : Rig
    file : str
        Name of the character's file.
    demo : str
        Id of the demo character that it is instead; else empty.
    method : Method
        Its resolution counts along the longest side of the mesh.
    edits : Edits
    layers : str
        Name of the file of edits.
    is_layered : bool
        Whether the character's file holds layers over the weights that edits begin from.
    out : str
        Name of the file of the bound character.
    """

    rig: Rig
    file: str
    demo: str
    method: Method
    edits: Edits
    layers: str
    is_layered: bool
    out: str

    @property
    def options(self) -> dict[str, object]:
        """The fewest options that make the method."""
        options = options_of(self.method)
        if method_per_character(self.rig, self.method) != self.method:
            options = {"resolution": self.method.resolution, **options}  # along the whole mesh
        return options

    @property
    def has_only_base(self) -> bool:
        """Whether the file's weights as the base are the only edit."""
        return self.edits == FROM_FILE


def script_of(recipe: Recipe) -> str:
    """Return a script in Python that binds the character and saves it."""
    source, imported = repr(recipe.file), ["import cutcell"]
    if recipe.demo:
        source = f"demo_path({recipe.demo!r})"
        imported.append("from cutcell_assets import demo_path")
    arguments = ["rig", *(f"{name}={value!r}" for name, value in recipe.options.items())]
    edited = []
    if recipe.edits and recipe.is_layered:
        imported.append("from cutcell.editing.stored import with_base")
        edited = ["rig = with_base(rig)"]
    if recipe.has_only_base:
        arguments.append(f"edits=cutcell.Edits(base={FROM_FILE.base!r})")
    elif recipe.edits:
        edited += [
            f"edits = cutcell.Edits.load({recipe.layers!r})",
            "rig = cutcell.edited_rig(rig, edits)",
        ]
        arguments.append("edits=edits")
    lines = [
        *imported,
        "",
        f"rig = cutcell.load({source})",
        *edited,
        f"binding = cutcell.bind({', '.join(arguments)})",
        f"cutcell.save({recipe.out!r}, rig.with_weights(binding.weights))",
    ]
    return "\n".join(lines) + "\n"


def command_of(recipe: Recipe) -> str:
    """Return a line for a shell that binds the character and saves it."""
    source = shlex.quote(recipe.file)
    if recipe.demo:
        source = f'"$(python -c {shlex.quote(FIND_DEMO.format(recipe.demo))})"'
    words = ["cutcell bind", source, shlex.quote(recipe.out)]
    if recipe.edits:
        return " ".join([*words, "--layers", shlex.quote(recipe.layers)])  # with the method
    for name, value in recipe.options.items():
        flag, _, off = METHOD_OPTIONS[name][2].split()[0].partition("/")
        if isinstance(value, bool):
            words.append(flag if value else off)
        else:
            words += [flag, "all" if value is None else shlex.quote(f"{value}")]
    return " ".join(words)
