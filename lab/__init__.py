"""A laboratory beside cutcell: other methods, data sets for training, and networks.

It uses `cutcell`, which does not know of it. Its commands, `cutcell compare`, `cutcell dataset`,
`cutcell evaluate`, `cutcell networks` and `cutcell sweep`, come to the command line by an entry
point.
"""

import lazy_loader

# Each is imported on first use.
__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
