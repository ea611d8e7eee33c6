"""Work that is done in processes of its own, since its libraries may crash or never end.

`python -m cutcell.isolated TASK JOB.npz RESULT.npz MEMORY`. Nothing here is imported by the rest of
cutcell, nor imports it: see `cutcell.isolated.run` for the other side.
"""
