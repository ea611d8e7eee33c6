"""Meshes, skeletons, rigs and clips, and the checks of what a caller passes."""
