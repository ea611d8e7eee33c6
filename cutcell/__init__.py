"""Skinning weights from geodesic cut-cell graphs (Ma et al. 2026)."""

import lazy_loader

__version__ = "0.1.0"

# Names and their modules are listed in __init__.pyi, for this and for editors and type checkers.
# Each is imported on first use: `import cutcell` stays cheap.
__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
