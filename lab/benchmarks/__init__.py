"""Measurements of quality that print tables in docs/; they need a checkout."""

from numba import get_num_threads

# Numba looks for its threading library when threads are first needed. Embree and Open3D bring a
# TBB that is too old for it, and it warns if that one is there already: be first.
get_num_threads()
