"""Random rigged characters for training and tests."""

import lazy_loader

# The command imports this package whenever `cutcell` starts, and the generator is large.
__getattr__, __dir__, __all__ = lazy_loader.attach(
    __name__, submod_attrs={"characters": ["KINDS", "Kind", "generate"]}
)
