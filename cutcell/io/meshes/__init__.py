"""Mesh files without a skin, and skeletons in JSON beside them."""
