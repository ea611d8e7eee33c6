"""Skeletons for meshes that have none: a template is fitted into the body by its shape."""

from .fit import fit_skeleton, names_of
from .names import TEMPLATES, Template

__all__ = ["TEMPLATES", "Template", "fit_skeleton", "names_of"]
