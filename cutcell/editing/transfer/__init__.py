"""Transfer of weights from one mesh to others that lie on it: clothes, levels of detail."""

from .transfer import MATCHED, REFUSED, STATES, Transfer, transfer

__all__ = ["MATCHED", "REFUSED", "STATES", "Transfer", "transfer"]
