"""The method for animation: paths at any angle, bone extents, and a falloff for rigs."""
