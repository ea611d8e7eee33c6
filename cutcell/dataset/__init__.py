"""Data sets for training on rigs: reading, binding, auditing, exporting and generating them.

Its libraries come with ``pip install 'cutcell[dataset]'``. ``docs/dataset.md`` tells the whole way.
"""

import lazy_loader

# Dask and the rest are imported by what needs them.
__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
