"""Tasks that run in a subprocess, by `cutcell.isolated.run`; they import nothing of cutcell."""
