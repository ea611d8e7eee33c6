"""The welded surface in the unit cube, the lattice around it, and the rays that hit it."""
