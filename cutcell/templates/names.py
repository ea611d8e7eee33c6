"""The templates by their names."""

from __future__ import annotations

from typing import Literal, cast, get_args

from ..rig.checks import check_choice

Template = Literal["biped", "quadruped", "hand", "snake", "chain"]
TEMPLATES: tuple[Template, ...] = get_args(Template)


def check_template(name: str) -> Template:
    """Return the template of a name."""
    return cast(Template, check_choice("template", name, TEMPLATES))
