"""Work that is done in processes of its own, since its libraries may crash or never end.

`python -m cutcell.workers TASK JOB.npz RESULT.npz MEMORY`. Nothing here is imported by the rest of
cutcell, nor imports it: see `cutcell.apart` for the other side.
"""
