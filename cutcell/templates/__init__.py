"""Skeletons for meshes that have none: a template is fitted into the body by its shape."""

from .fit import TEMPLATES, Template, fit_skeleton, names_of

__all__ = ["TEMPLATES", "Template", "fit_skeleton", "names_of"]
