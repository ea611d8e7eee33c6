"""Measurements of time and memory that print tables in docs/."""

import cutcell_lab.benchmarks  # noqa: F401  first: it loads numba's threads before Embree is loaded
