"""
A data set
==========

`cutcell_lab.dataset` binds a folder of characters in parallel and stores distances, weights and metrics in one store.
"""

from pathlib import Path
from tempfile import mkdtemp

from cutcell_assets import demo_path
from cutcell_lab.dataset import Store, bind_all

# %%
# Two characters take the place of a folder of thousands. Each is bound in a subprocess, so that a broken file stops
# nothing. A second call skips what is there.

folder = Path(mkdtemp(prefix="store-"))
report = bind_all([demo_path("robot"), demo_path("rabbit")], folder, workers=1)
print(report.bound, "bound,", report.failed, "failed")

# %%
# The store holds one entry per character. `cutcell_lab.dataset.RigDataset` reads it in PyTorch, and
# ``cutcell dataset export`` writes it in the formats of RigNet, UniRig and Puppeteer.

for name, entry in Store(folder).entries():
    print(name, entry.weights.shape)
