"""Decide for each patch of the surface which side is outside."""
