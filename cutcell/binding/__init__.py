"""A rig bound to its skeleton: bind(), the record of a binding, and what its weights come from."""

from .bind import bind
from .binding import Binding
from .explain import Explanation, JointShare, Piece, explain

__all__ = ["Binding", "Explanation", "JointShare", "Piece", "bind", "explain"]
