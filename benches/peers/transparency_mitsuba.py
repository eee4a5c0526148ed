"""Path traces the scene with Mitsuba, whose image is exact in expectation: an independent reference; called by transparency.py."""

import time

import mitsuba
import numpy
from transparency_scene import Peer

# Needs no LLVM; Dr.Jit's code does not compile with every version of it.
mitsuba.set_variant("scalar_rgb")
peer = Peer("mitsuba")
SAMPLES = 256
eye = numpy.array(peer.camera["position"])


def world(meshes):
    given = peer.camera
    rgb = lambda color: {"type": "rgb", "value": list(color)}  # noqa: E731
    scene = {
        "type": "scene",
        # Its first bounces are the surfaces one behind another, so paths must not be ended at random.
        "integrator": {"type": "path", "max_depth": 256, "rr_depth": 256},
        "background": {"type": "constant", "radiance": rgb(peer.background)},
        "camera": {
            "type": "perspective", "fov": given["fov_y"], "fov_axis": "y", "near_clip": given["near"], "far_clip": given["far"],
            "to_world": mitsuba.ScalarTransform4f().look_at(given["position"], given["target"], given["up"]),
            "film": {"type": "hdrfilm", "width": peer.width, "height": peer.height, "rfilter": {"type": "box"}, "pixel_format": "rgb"},
        },
    }
    for i, (points, triangles, color, alpha) in enumerate(meshes):
        # An area light shines on one side of a triangle: all are turned towards the eye, from which each is seen from one side only.
        corners = points[triangles].astype(numpy.float64)
        away = (numpy.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) * (eye - corners[:, 0])).sum(axis=1) < 0.0
        triangles = numpy.where(away[:, None], triangles[:, ::-1], triangles)
        # It shines also where the mask lets a path through, so it has the light that the surface adds: alpha times its colour.
        properties = mitsuba.Properties()
        properties["emitter"] = mitsuba.load_dict({"type": "area", "radiance": rgb(alpha * c for c in color)})
        properties["bsdf"] = mitsuba.load_dict({"type": "mask", "opacity": alpha, "black": {"type": "diffuse", "reflectance": rgb([0, 0, 0])}})
        properties["face_normals"] = True
        mesh = mitsuba.Mesh(f"mesh-{i}", len(points), len(triangles), props=properties)
        parameters = mitsuba.traverse(mesh)
        parameters["vertex_positions"] = points.ravel()
        parameters["faces"] = triangles.astype(numpy.uint32).ravel()
        parameters.update()
        scene[f"mesh-{i}"] = mesh
    return mitsuba.load_dict(scene)


def picture(scene, seed, samples):
    return numpy.array(mitsuba.render(scene, spp=samples, seed=seed))


peer.save("opaque", picture(world(peer.meshes(opaque=True)), 0, 4))
scene = world(peer.meshes())
start = time.perf_counter()
halves = [picture(scene, seed, SAMPLES // 2) for seed in (1, 2)]
peer.times["path tracing"] = (time.perf_counter() - start) * 1e3
peer.save("path tracing", sum(halves) / 2.0)
# Half of their difference has the noise of their mean.
peer.save("noise", (halves[0] - halves[1]) / 2.0)
peer.answer(mitsuba.__version__, f"its own ray tracer ({mitsuba.variant()}, {SAMPLES} samples a pixel)")
