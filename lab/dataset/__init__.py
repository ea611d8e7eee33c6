"""Data sets for training on rigs: reading, binding, auditing and exporting.

Its libraries come with ``pip install 'cutcell[dataset]'``. ``docs/dataset.md`` describes all steps.
"""

import lazy_loader

# Dask and the rest are imported by what needs them.
__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
