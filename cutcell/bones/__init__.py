"""Bones, and the nodes of the graph that are nearest to them (paper, algorithm 2)."""
