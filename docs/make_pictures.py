"""Makes the pictures of the README and the docs: `python docs/make_pictures.py`.

`scenes`, `figures` or `page` behind the command make these alone.

Those of the page need a Chromium; see scripts/get_chromium.py.
"""

from __future__ import annotations

import re
import shlex
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from PIL import Image
from playwright.sync_api import expect, sync_playwright

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT))

import cutcell  # noqa: E402
from cutcell.rig import Rig  # noqa: E402
from cutcell_assets import demo_path  # noqa: E402
from cutcell_lab.benchmarks.transfer import part_of  # noqa: E402
from cutcell_viewers.camera import Camera, framing  # noqa: E402
from cutcell_viewers.character import body  # noqa: E402
from cutcell_viewers.description import Description  # noqa: E402
from cutcell_viewers.distance_scene import distance_scene  # noqa: E402
from cutcell_viewers.encoders import palette_of  # noqa: E402
from cutcell_viewers.graph_scene import cut_at, graph_scene  # noqa: E402
from cutcell_viewers.palette import DARK, LIGHT  # noqa: E402
from cutcell_viewers.pose_scene import pose_scene  # noqa: E402
from cutcell_viewers.scene import render_png  # noqa: E402
from cutcell_viewers.weights_scene import weights_scene  # noqa: E402
from scripts.get_chromium import FLAGS, find  # noqa: E402
from tests.app.browser import Visit, served  # noqa: E402
from tests.cutcell.cli.files import write_obj  # noqa: E402

PICTURES = ROOT / "docs" / "pictures"
SIZE = (1080, 810)
SHELL = (0.13, 0.16, 0.21)
WALK = "biped.glb walk.gif --panel pose --clip walk --no-bones --no-legend"
WALK_SIZE = (560, 420)
MAX_BYTES = 400_000
OCTOPUS_ARM = "armA4"
TOE, CHEST = 10876, 4911
"""Vertices of the walker."""
CAPE = 1
"""Connected component of the walker in a cape."""


def main() -> None:
    """Make the pictures that the command line names, or all."""
    PICTURES.mkdir(exist_ok=True)
    for name in sys.argv[1:] or ["scenes", "figures", "page"]:
        {"scenes": scenes, "figures": figures, "page": page}[name]()
    for path in sorted(PICTURES.glob("*.png")):
        shrink(path)
        print(f"{path.relative_to(ROOT)}  {path.stat().st_size // 1024} kB")


def scenes() -> None:
    """Draw one picture of each scene, off-screen."""
    walker, octopus = cutcell.load(demo_path("biped")), cutcell.load(demo_path("octopus"))
    bound, held = cutcell.bind(walker, 64), cutcell.bind(octopus, 96)
    write("graph", cutaway(walker, 48), closer(walker, 0.4, 0.76), DARK)
    arm = octopus.skeleton.names.index(OCTOPUS_ARM)
    distance = distance_scene(octopus, held.distances.on_mesh(arm), arm)
    write("distance", distance, closer(octopus, 0.8), LIGHT)
    thigh = walker.skeleton.names.index("thigh.L")
    write("weights", weights_scene(walker, bound.weights, thigh), closer(walker, 0.62, 0.42), DARK)
    write("bones", weights_scene(octopus, held.weights), closer(octopus, 0.8), LIGHT)
    clip = walker.clips[0]
    transforms = clip.transforms[len(clip.times) // 4]
    pose = pose_scene(walker, bound.weights, transforms)
    write("pose", pose, closer(walker, 0.9), LIGHT)


def figures() -> None:
    """Run the commands of docs/pictures.md whose pictures are shown there, and README's."""
    document = (ROOT / "docs" / "pictures.md").read_text(encoding="utf-8")
    for command in re.findall(r"^cutcell render (.* figure-.*)$", document, re.MULTILINE):
        render(command, SIZE)
    render(WALK, WALK_SIZE)


def render(command: str, size: tuple[int, int]) -> None:
    """Run `cutcell render` with the options of a command, on a demo."""
    rig, out, *options = shlex.split(command)
    argv = [str(demo_path(rig.removesuffix(".glb"))), str(PICTURES / out), *options]
    shape = "x".join(map(str, size))
    done = [sys.executable, "-m", "cutcell", "render", *argv, "--quiet", "--size", shape]
    subprocess.run(done, check=True, cwd=ROOT)


def cutaway(rig: Rig, resolution: int) -> Description:
    """Return the graph, cut open from the front."""
    shell = body(rig, color=SHELL)
    bounds = np.stack([shell.points.min(axis=0), shell.points.max(axis=0)])
    slab = 2.5 * float(np.ptp(bounds, axis=0).max()) / resolution
    graph = graph_scene(
        rig,
        cutcell.build_graph(rig.mesh, resolution, connectivity=6),
        cut=cut_at(bounds, "z", 0.6),
        slab=slab,
        theme=DARK,
    )
    widths = {"mesh edges": 1.0, "interior edges": 2.4, "surface edges": 1.6}
    lines = {name: replace(graph.actors[name], width=width) for name, width in widths.items()}
    return replace(graph, actors={"body": shell, **lines})


def closer(rig: Rig, reach: float, height: float = 0.5) -> Camera:
    """Return a camera that comes closer to a character, at some part of its height."""
    points = body(rig).points
    bounds = np.stack([points.min(axis=0), points.max(axis=0)]).astype(float)
    whole = framing(bounds, SIZE[0] / SIZE[1])
    target = np.array(whole.focal_point)
    offset = np.array(whole.position) - target
    target[1] = bounds[0, 1] + height * (bounds[1, 1] - bounds[0, 1])
    return Camera(tuple(target + reach * offset), tuple(target))


def write(name: str, scene: Description, camera: Camera | None, theme: object) -> None:
    """Draw a scene into a file."""
    render_png(scene, PICTURES / f"{name}.png", theme=theme, size=SIZE, camera=camera)


def page() -> None:
    """Take pictures of the page, light and dark."""
    chromium = find()
    with sync_playwright() as playwright, served() as url:
        browser = playwright.chromium.launch(executable_path=chromium, args=list(FLAGS))
        visit = Visit(
            browser, url + "?panel=weights", smooth=True, viewport={"width": 1440, "height": 900}
        )
        visit.wait_until_bound()
        visit.page.mouse.move(700, 895)
        for name in ("light", "dark"):
            visit.settle()
            visit.page.wait_for_timeout(800)
            visit.page.screenshot(path=PICTURES / f"page-{name}.png")
            visit.button("Toggle theme").click()
            visit.page.mouse.move(700, 895)
        panels(visit)
        comparisons(visit)
        poses(visit)
        check(visit)
        clothes(visit)
        lesson(visit)
        visit.close()
        browser.close()


def panels(visit: Visit) -> None:
    """Take a picture of each thing that docs/page/ shows."""
    visit.panel("Graph")
    visit.switch("One slice and its rays")
    visit.page.mouse.move(860, 330)
    for _ in range(5):
        visit.page.mouse.wheel(0, -300)
    take(visit, "slice")
    visit.page.mouse.dblclick(1300, 800)
    visit.panel("Distance")
    click_vertex(visit, TOE)
    take(visit, "distance")
    visit.page.keyboard.press("Escape")
    visit.button("Cut Z").click()
    visit.switch("Wavefront")
    take(visit, "wave")
    visit.button("Whole").click()
    visit.panel("Weights")
    visit.choose("Colour by", "Difference from the file's")
    click_vertex(visit, CHEST)
    take(visit, "weights")
    visit.page.keyboard.press("Escape")
    mask(visit)


def mask(visit: Visit) -> None:
    """Take a picture of a layer's mask that fades out over the surface."""
    where = visit.reach(visit.page.get_by_label("Vertices where"))
    where.fill("weight of upper_arm.L > 0.3")
    where.press("Enter")
    menu(visit, "Add layer", "Smoothed")
    visit.slide("Smoothing passes", "ArrowRight", 6)
    menu(visit, "Mask", "Feather")
    visit.page.keyboard.press("Shift+A")
    heading = visit.page.get_by_role("heading", name="Selection", exact=True)
    heading.click()  # its section above takes most of the sidebar
    visit.settle()
    heading.evaluate("part => part.scrollIntoView()")
    take(visit, "mask")
    visit.button("Delete").click()


def menu(visit: Visit, name: str, entry: str) -> None:
    """Take an entry of a menu button."""
    visit.button(name).click()
    visit.page.get_by_role("menuitem", name=entry, exact=True).click()
    visit.settle()


def comparisons(visit: Visit) -> None:
    """Take a picture of each panel that holds other weights against ours."""
    visit.page.keyboard.press("Escape")
    visit.panel("Pose")
    worst = visit.page.get_by_role("list", name="Largest errors").get_by_role("button")
    worst.first.click()
    visit.button("Side by side").click()
    take(visit, "pose")
    visit.button("Rest pose").click()
    visit.panel("Compare")
    row = visit.page.get_by_role("row").filter(has_text="Euclidean")
    expect(row.get_by_role("cell").nth(3)).not_to_have_text("", timeout=60_000)
    visit.choose("Bone", "upper_arm.L")
    take(visit, "compare")


def poses(visit: Visit) -> None:
    """Take a picture of saved poses, and of the vertex where one stretches most."""
    open_address(visit, "?rig=biped&panel=pose")
    for name, bone, slider in (("arm up", "upper_arm.L", "Z"), ("knee up", "thigh.R", "X")):
        visit.choose("Bone", bone)
        visit.slide(f"About {slider}", "PageUp", 6)
        visit.settle()
        field = visit.page.get_by_role("textbox", name="Save pose as")
        field.fill(name)
        field.press("Enter")
        visit.button("Rest pose").click()
    rows = visit.page.get_by_role("list", name="Poses and clips").get_by_role("button")
    expect(rows.filter(has_text="→")).to_have_count(3)
    rows.filter(has_text="arm up").click()
    visit.button("Worst vertex").click()
    visit.button("Side by side").click()
    rows.first.scroll_into_view_if_needed()
    take(visit, "poses")


def check(visit: Visit) -> None:
    """Take a picture of a finding that is looked at."""
    open_address(visit, "?rig=biped_cape&panel=check")
    visit.dismiss()
    visit.page.get_by_role("button", name="Unreachable vertices").click()
    take(visit, "check")


def clothes(visit: Visit) -> None:
    """Take a picture of a cape that has got the weights of the walker below it."""
    cape = part_of(cutcell.load(demo_path("biped_cape")), CAPE).mesh
    open_address(visit, "?rig=biped&panel=weights")
    with TemporaryDirectory() as folder:
        path = write_obj(Path(folder, "cape.obj"), cape.vertices.tolist(), cape.faces.tolist())
        visit.page.get_by_label("Drop a mesh here, or browse").set_input_files(path)
        visit.page.get_by_text("cape.obj:").wait_for()
    take(visit, "transfer")


def lesson(visit: Visit) -> None:
    """Take a picture of the step that shows why straight distance does not do."""
    open_address(visit, "?step=1&answer=0.5")
    visit.page.wait_for_function("__cutcell.renderer.views.length === 2")
    take(visit, "learn")


def open_address(visit: Visit, query: str) -> None:
    """Load the page again with other choices."""
    visit.page.goto(visit.url.partition("?")[0] + query)
    visit.wait_until_bound()


def click_vertex(visit: Visit, vertex: int) -> None:
    """Click where a vertex of the body is in the canvas."""
    visit.settle()
    x, y = visit.page.evaluate("vertex => __cutcell.vertexPoint(vertex)", vertex)
    visit.page.mouse.click(x, y)


def take(visit: Visit, name: str) -> None:
    """Take a picture of a panel once it has come to rest."""
    visit.page.mouse.move(700, 895)
    visit.settle()
    visit.page.wait_for_timeout(1200)
    visit.page.screenshot(path=PICTURES / f"panel-{name}.png")


def shrink(path: Path) -> None:
    """Store a picture in as few bytes as it takes; with fewer colours if they are too many."""
    with Image.open(path) as image:
        if image.mode == "P":
            return
        whole = image.convert("RGB")
    whole.save(path, optimize=True)
    if path.stat().st_size > MAX_BYTES:
        palette = palette_of(np.asarray(whole))
        few = whole.quantize(palette=palette, dither=Image.Dither.FLOYDSTEINBERG)
        few.save(path, optimize=True)


if __name__ == "__main__":
    main()
