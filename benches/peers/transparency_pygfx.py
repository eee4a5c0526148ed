"""Draws the scene with pygfx: weighted blending, sorted blending and its two stochastic modes; called by transparency.py."""

import math
import os

import numpy
import pygfx
from rendercanvas.offscreen import OffscreenRenderCanvas
from transparency_scene import Peer, decoded

os.environ.setdefault("XDG_RUNTIME_DIR", "/tmp")
peer = Peer("pygfx")
canvas = OffscreenRenderCanvas(size=(peer.width, peer.height), pixel_ratio=1)
renderer = pygfx.WgpuRenderer(canvas, pixel_scale=1, ppaa="none")


def world(meshes, mode):
    # Colours are given as they shall be blended; pygfx encodes its output for a display.
    made = pygfx.Scene()
    made.add(pygfx.Background(None, pygfx.BackgroundMaterial(pygfx.Color.from_physical(*peer.background, 1.0))))
    for points, triangles, color, alpha in meshes:
        material = pygfx.MeshBasicMaterial(color=pygfx.Color.from_physical(*color, 1.0), opacity=alpha, side="both", alpha_mode=mode)
        # It sorts by the places of objects.
        center = (points.min(axis=0) + points.max(axis=0)) / 2.0
        mesh = pygfx.Mesh(pygfx.Geometry(positions=points - center, indices=triangles.astype(numpy.int32)), material)
        mesh.local.position = center
        made.add(mesh)
    return made


# pygfx takes the angle of the mean of width and height, not of the height.
aspect = peer.width / peer.height
angle = 2.0 * math.degrees(math.atan(math.tan(math.radians(peer.camera["fov_y"]) / 2.0) * (1.0 + aspect) / 2.0))
camera = pygfx.PerspectiveCamera(angle, aspect, depth_range=(peer.camera["near"], peer.camera["far"]))
camera.maintain_aspect = False
camera.local.position = peer.camera["position"]
camera.look_at(peer.camera["target"])


def picture(scene):
    renderer.render(scene, camera)
    return numpy.asarray(renderer.snapshot())[..., :3]


canvas.request_draw(lambda: None)
peer.save("opaque", decoded(picture(world(peer.meshes(opaque=True), "solid"))))
for name, mode in [("weighted blending", "weighted_blend"), ("sorted blending", "blend"), ("stochastic blue noise", "dither"), ("stochastic Bayer", "bayer")]:
    scene = world(peer.meshes(), mode)
    peer.save(name, decoded(picture(scene)))
    peer.measure(name, lambda: picture(scene))
peer.answer(pygfx.__version__, renderer.device.adapter.info["device"])
