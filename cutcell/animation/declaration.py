"""What the method for animation chooses, and how many distances it needs."""

from typing import Final

CONNECTIVITY: Final = "any"
"""Paths run at any angle, so that distances converge to geodesic ones."""
LEAF: Final = "fit"
"""The ends of bones are fitted to the body."""
FALLOFF: Final = "rig"
"""Weights decrease as those that artists paint (docs/falloff.md)."""
NEAREST_JOINTS = 3
"""Nearest joints of each vertex that the falloff divides the surface among, at least: a fourth is
rare. It follows more joints only as the surface around it does."""
REACH = 6.0
"""Times as far as its nearest joint: whatever is farther gets no weight."""
