"""Draws the scene with polyscope's depth peeling ("pretty") and its "simple" blending; called by transparency.py."""

import importlib.metadata
import os

os.environ.setdefault("LIBGL_ALWAYS_SOFTWARE", "1")

import numpy  # noqa: E402
import polyscope  # noqa: E402
from transparency_scene import Peer  # noqa: E402

peer = Peer("polyscope")
polyscope.set_use_prefs_file(False)
polyscope.set_verbosity(0)
polyscope.init("openGL3_egl")
polyscope.set_window_size(peer.width, peer.height)
polyscope.set_SSAA_factor(1)
polyscope.set_ground_plane_mode("none")
# It blends light, multiplies by this exposure and encodes with a gamma of 2.2; a flat material's colour is decoded likewise before.
GAMMA, EXPOSURE = 2.2, 1.1
polyscope.set_background_color([c / EXPOSURE for c in peer.background])
camera = peer.camera
look = numpy.subtract(camera["target"], camera["position"])
# Its `up` must be perpendicular to where it looks.
up = numpy.cross(numpy.cross(look, camera["up"]), look)
polyscope.set_view_camera_parameters(polyscope.CameraParameters(
    polyscope.CameraIntrinsics(fov_vertical_deg=camera["fov_y"], aspect=peer.width / peer.height),
    polyscope.CameraExtrinsics(root=camera["position"], look_dir=look / numpy.linalg.norm(look), up_dir=up / numpy.linalg.norm(up))))


def add(meshes):
    polyscope.remove_all_structures()
    for i, (points, triangles, color, alpha) in enumerate(meshes):
        encoded = numpy.array(color) ** (1.0 / GAMMA)
        polyscope.register_surface_mesh(f"mesh-{i}", points, triangles, color=encoded, transparency=alpha, material="flat", back_face_policy="identical")


def picture():
    return polyscope.screenshot_to_buffer(transparent_bg=False)[..., :3]


def linear(image):
    return (image / 255.0) ** GAMMA


add(peer.meshes(opaque=True))
peer.save("opaque", linear(picture()))
add(peer.meshes())
for name, mode in [("depth peeling", "pretty"), ("simple blending", "simple")]:
    polyscope.set_transparency_mode(mode)
    # More layers than any pixel has: exact.
    polyscope.set_transparency_render_passes(32)
    peer.save(name, linear(picture()))
    peer.measure(name, picture)
# It does not tell the renderer's name; LIBGL_ALWAYS_SOFTWARE chooses it.
peer.answer(importlib.metadata.version("polyscope"), "llvmpipe of Mesa")
