"""Transfer of weights from one mesh to others that lie on it: clothes, levels of detail."""

from .transfer import INPAINTED, MATCHED, REFUSED, STATES, UNCHANGED, Transfer, transfer

__all__ = ["INPAINTED", "MATCHED", "REFUSED", "STATES", "UNCHANGED", "Transfer", "transfer"]
