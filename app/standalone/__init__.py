"""A character as an interactive page in one file, which needs no server."""
