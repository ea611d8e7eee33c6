"""The heads of the paper's networks."""
