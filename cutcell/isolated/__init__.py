"""Tasks that run in a subprocess, because their libraries may crash or never end.

`run.run_isolated` starts ``python -m cutcell.isolated TASK JOB.npz RESULT.npz MEMORY``. The tasks
themselves import nothing of the core but `runtime` and `geometry`.
"""
