"""From distances to skinning weights."""

from .skinning_weights import keep_strongest, skinning_weights

__all__ = ["keep_strongest", "skinning_weights"]
