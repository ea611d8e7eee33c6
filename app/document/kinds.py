"""Kinds of parameters of the state, which each declares where it is made."""

MOMENT = -1.0
"""`precedence` of what belongs to one person or moment: undo leaves it, and the address has no
entry of its name and value; it may have one of its own kind."""
