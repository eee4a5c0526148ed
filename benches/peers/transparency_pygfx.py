"""Draws a scene with pygfx's weighted blending: `scene.json WxH frames`; called by transparency.py."""

import json
import math
import os
import pathlib
import statistics
import sys
import time

import numpy
import pygfx
from rendercanvas.offscreen import OffscreenRenderCanvas

os.environ.setdefault("XDG_RUNTIME_DIR", "/tmp")
path, size, frames = sys.argv[1:]
scene = json.loads(pathlib.Path(path).read_text())
folder = pathlib.Path(scene["folder"])
width, height = map(int, size.split("x"))


def read(obj):
    """Positions and triangles of an OBJ file."""
    points, triangles = [], []
    for line in obj.read_text().splitlines():
        kind, *rest = line.split()
        if kind == "v":
            points.append([float(x) for x in rest])
        elif kind == "f":
            triangles.append([int(x) - 1 for x in rest])
    return numpy.array(points, numpy.float32), numpy.array(triangles, numpy.int32)


canvas = OffscreenRenderCanvas(size=(width, height), pixel_ratio=1)
renderer = pygfx.WgpuRenderer(canvas, pixel_scale=1, ppaa="none")
world = pygfx.Scene()


def physical(color, alpha=1.0):
    # Colours are given as they shall be blended; pygfx encodes its output for a display.
    return pygfx.Color.from_physical(*color, alpha)


world.add(pygfx.Background(None, pygfx.BackgroundMaterial(physical(scene["background"]))))
for mesh in scene["meshes"]:
    points, triangles = read(folder / mesh["mesh"])
    material = pygfx.MeshBasicMaterial(color=physical(mesh["color"]), opacity=mesh["alpha"], side="both", alpha_mode="weighted_blend")
    world.add(pygfx.Mesh(pygfx.Geometry(positions=points, indices=triangles), material))
given = scene["camera"]
# pygfx takes the angle of the mean of width and height, not of the height.
aspect = width / height
angle = 2.0 * math.degrees(math.atan(math.tan(math.radians(given["fov_y"]) / 2.0) * (1.0 + aspect) / 2.0))
camera = pygfx.PerspectiveCamera(angle, aspect, depth_range=(given["near"], given["far"]))
camera.maintain_aspect = False
camera.local.position = given["position"]
camera.look_at(given["target"])


def picture():
    renderer.render(world, camera)
    return numpy.asarray(renderer.snapshot())


canvas.request_draw(lambda: renderer.render(world, camera))
image = picture()[..., :3].astype(numpy.float32) / 255.0
linear = numpy.where(image <= 0.04045, image / 12.92, ((image + 0.055) / 1.055) ** 2.4)
numpy.save(folder / "pygfx-weighted-blending.npy", linear.astype(numpy.float32))
all_ms = []
for _ in range(int(frames)):
    start = time.perf_counter()
    picture()
    all_ms.append((time.perf_counter() - start) * 1e3)
adapter = renderer.device.adapter.info["device"]
print(json.dumps({"times": {"weighted blending": statistics.median(all_ms)}, "version": pygfx.__version__, "adapter": adapter}))
