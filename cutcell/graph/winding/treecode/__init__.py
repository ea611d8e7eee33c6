"""Winding numbers of many points at once, by clusters of boundary caps."""
