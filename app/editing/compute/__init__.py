"""Computations of edits on arrays: strokes, operations on selections, joints in limbs."""
