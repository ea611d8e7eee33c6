"""
A figure of four moments
========================

The same wave with one camera and one scale. A file that ends in .pdf or .svg keeps its text as text.
"""

from pathlib import Path
from tempfile import mkdtemp

from PIL import Image

import cutcell
import cutcell_viewers
from cutcell_app.headless import Choices, describe
from cutcell_assets import demo_path

rig = cutcell.load(demo_path("rabbit"))
binding = cutcell.bind(rig)
moments = [0.2, 0.4, 0.6, 1.0]
waves = [{"wave": True, "front": moment} for moment in moments]
scenes = [
    describe(rig, Choices("distance", bone="hips", settings=wave), binding=binding)
    for wave in waves
]
path = Path(mkdtemp()) / "wave.png"
cutcell_viewers.figure(scenes, path, captions=[f"{moment:.0%} of the way" for moment in moments])
picture = Image.open(path)
