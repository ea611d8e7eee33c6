"""Shortest paths that leave the edges of the graph where the line of sight is free."""
