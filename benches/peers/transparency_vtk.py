"""Draws the scene with VTK's dual depth peeling and with its weighted blending; called by transparency.py."""

import os

# The same rasteriser for all, without a window.
os.environ.setdefault("VTK_DEFAULT_OPENGL_WINDOW", "vtkEGLRenderWindow")
os.environ.setdefault("LIBGL_ALWAYS_SOFTWARE", "1")

import numpy  # noqa: E402
import vtk  # noqa: E402
from transparency_scene import Peer  # noqa: E402
from vtk.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy  # noqa: E402

peer = Peer("vtk")
window = vtk.vtkRenderWindow()
window.SetOffScreenRendering(1)
window.SetSize(peer.width, peer.height)
window.SetMultiSamples(0)
window.SetAlphaBitPlanes(1)
renderer = vtk.vtkRenderer()
renderer.SetBackground(*peer.background)
window.AddRenderer(renderer)


def add(meshes):
    renderer.RemoveAllViewProps()
    for points, triangles, color, alpha in meshes:
        data = vtk.vtkPolyData()
        data.SetPoints(vtk.vtkPoints())
        data.GetPoints().SetData(numpy_to_vtk(points, deep=True))
        cells = vtk.vtkCellArray()
        cells.SetData(3, numpy_to_vtkIdTypeArray(triangles.astype(numpy.int64).ravel(), deep=True))
        data.SetPolys(cells)
        mapper = vtk.vtkPolyDataMapper()
        mapper.SetInputData(data)
        actor = vtk.vtkActor()
        actor.SetMapper(mapper)
        actor.GetProperty().SetColor(*color)
        actor.GetProperty().SetOpacity(alpha)
        actor.GetProperty().LightingOff()
        renderer.AddActor(actor)


camera = renderer.GetActiveCamera()
camera.SetPosition(*peer.camera["position"])
camera.SetFocalPoint(*peer.camera["target"])
camera.SetViewUp(*peer.camera["up"])
camera.SetViewAngle(peer.camera["fov_y"])
camera.SetClippingRange(peer.camera["near"], peer.camera["far"])


def picture():
    window.Render()
    pixels = vtk.vtkUnsignedCharArray()
    window.GetRGBACharPixelData(0, 0, peer.width - 1, peer.height - 1, 0, pixels)
    return vtk_to_numpy(pixels).reshape(peer.height, peer.width, 4)[::-1, :, :3] / 255.0


def peeling():
    renderer.SetUseDepthPeeling(1)
    # Until nothing is left: exact.
    renderer.SetMaximumNumberOfPeels(1000)
    renderer.SetOcclusionRatio(0.0)


def weighted():
    renderer.SetUseDepthPeeling(0)
    renderer.SetUseOIT(True)


add(peer.meshes(opaque=True))
peer.save("opaque", picture())
add(peer.meshes())
for name, use in [("dual depth peeling", peeling), ("weighted blending", weighted)]:
    use()
    peer.save(name, picture())
    peer.measure(name, picture)
adapter = next((line.split(":")[1].strip() for line in window.ReportCapabilities().splitlines() if "renderer string" in line), "unknown")
peer.answer(vtk.vtkVersion.GetVTKVersion(), adapter)
