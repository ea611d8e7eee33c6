"""
Error and time over the resolution
==================================

Twice the rays along each side halve the error, and take four to eight times as long. The error is that of the
distances to one bone, against a graph of R = 128.
"""

import time

import matplotlib.pyplot as plt
import numpy as np

import cutcell
from cutcell_assets import demo_path

rig = cutcell.load(demo_path("biped"))
joint = rig.skeleton.names.index("thigh.L")
fine = cutcell.bind(rig, 128).distances.on_mesh(joint)
resolutions, errors, seconds = [8, 16, 32, 64], [], []
for resolution in resolutions:
    start = time.perf_counter()
    distance = cutcell.bind(rig, resolution).distances.on_mesh(joint)
    seconds.append(time.perf_counter() - start)
    errors.append(np.nanmean(np.abs(distance - fine)))
figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.5), layout="constrained")
left.loglog(resolutions, errors, "o-")
left.set(xlabel="resolution R", ylabel="mean error, of the longest side")
right.loglog(resolutions, seconds, "o-")
right.set(xlabel="resolution R", ylabel="seconds to bind")
