"""Draws a scene with VTK's dual depth peeling and with its weighted blending: `scene.json WxH frames`; called by transparency.py."""

import json
import os
import pathlib
import statistics
import sys
import time

# The same rasteriser for all, without a window.
os.environ.setdefault("VTK_DEFAULT_OPENGL_WINDOW", "vtkEGLRenderWindow")
os.environ.setdefault("LIBGL_ALWAYS_SOFTWARE", "1")

import numpy  # noqa: E402
import vtk  # noqa: E402
from vtk.util.numpy_support import vtk_to_numpy  # noqa: E402

path, size, frames = sys.argv[1:]
scene = json.loads(pathlib.Path(path).read_text())
folder = pathlib.Path(scene["folder"])
width, height = map(int, size.split("x"))
window = vtk.vtkRenderWindow()
window.SetOffScreenRendering(1)
window.SetSize(width, height)
window.SetMultiSamples(0)
window.SetAlphaBitPlanes(1)
renderer = vtk.vtkRenderer()
renderer.SetBackground(*scene["background"])
window.AddRenderer(renderer)
for mesh in scene["meshes"]:
    reader = vtk.vtkOBJReader()
    reader.SetFileName(str(folder / mesh["mesh"]))
    mapper = vtk.vtkPolyDataMapper()
    mapper.SetInputConnection(reader.GetOutputPort())
    actor = vtk.vtkActor()
    actor.SetMapper(mapper)
    actor.GetProperty().SetColor(*mesh["color"])
    actor.GetProperty().SetOpacity(mesh["alpha"])
    actor.GetProperty().LightingOff()
    renderer.AddActor(actor)
camera = renderer.GetActiveCamera()
camera.SetPosition(*scene["camera"]["position"])
camera.SetFocalPoint(*scene["camera"]["target"])
camera.SetViewUp(*scene["camera"]["up"])
camera.SetViewAngle(scene["camera"]["fov_y"])
camera.SetClippingRange(scene["camera"]["near"], scene["camera"]["far"])


def picture():
    window.Render()
    pixels = vtk.vtkUnsignedCharArray()
    window.GetRGBACharPixelData(0, 0, width - 1, height - 1, 0, pixels)
    return vtk_to_numpy(pixels).reshape(height, width, 4)[::-1, :, :3]


def peeling():
    renderer.SetUseDepthPeeling(1)
    # Until nothing is left: exact.
    renderer.SetMaximumNumberOfPeels(1000)
    renderer.SetOcclusionRatio(0.0)


def weighted():
    renderer.SetUseDepthPeeling(0)
    renderer.SetUseOIT(True)


times = {}
for name, use in [("dual depth peeling", peeling), ("weighted blending", weighted)]:
    use()
    image = picture()
    numpy.save(folder / f"vtk-{name.replace(' ', '-')}.npy", image.astype(numpy.float32) / 255.0)
    all_ms = []
    for _ in range(int(frames)):
        start = time.perf_counter()
        picture()
        all_ms.append((time.perf_counter() - start) * 1e3)
    times[name] = statistics.median(all_ms)
adapter = next((line.split(":")[1].strip() for line in window.ReportCapabilities().splitlines() if "renderer string" in line), "unknown")
print(json.dumps({"times": times, "version": vtk.vtkVersion.GetVTKVersion(), "adapter": adapter}))
