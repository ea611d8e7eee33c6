"""Binding in voxels and tetrahedra."""
