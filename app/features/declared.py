"""The results of all features, which the page and its pictures compute."""

from importlib import import_module
from importlib.util import find_spec
from typing import Any

from ..derive.derived import Derived
from . import FEATURES

_NAMES = [f"{__package__}.{name}.results" for name in FEATURES]
MODULES: tuple[Any, ...] = tuple(import_module(name) for name in _NAMES if find_spec(name))

RESULTS: tuple[Derived, ...] = tuple(
    one for module in MODULES for one in getattr(module, "RESULTS", ())
)
