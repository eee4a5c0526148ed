"""The scene for peers in Python: transparency.py wrote it, each peer reads it with this and answers in one line of JSON."""

import json
import pathlib
import statistics
import struct
import sys
import time

import numpy


def read_glb(path):
    """Positions, triangles, linear colour and opacity of every mesh; only what transparency.py writes."""
    data = path.read_bytes()
    length = struct.unpack_from("<I", data, 12)[0]
    gltf, binary = json.loads(data[20:20 + length]), data[28 + length:]

    def values(accessor, kind, width):
        accessor = gltf["accessors"][accessor]
        start = gltf["bufferViews"][accessor["bufferView"]]["byteOffset"]
        return numpy.frombuffer(binary, kind, accessor["count"] * width, start).reshape(-1, width)

    meshes = []
    for mesh in gltf["meshes"]:
        part = mesh["primitives"][0]
        *color, alpha = gltf["materials"][part["material"]]["pbrMetallicRoughness"]["baseColorFactor"]
        points = values(part["attributes"]["POSITION"], "<f4", 3)
        meshes.append((points, values(part["indices"], "<u4", 1).reshape(-1, 3), color, alpha))
    return meshes


class Peer:
    def __init__(self, name):
        scene = json.loads(pathlib.Path(sys.argv[1]).read_text())
        self.name, self.folder, self.camera, self.background = name, pathlib.Path(sys.argv[1]).parent, scene["camera"], scene["background"]
        self.width, self.height, self.frames = scene["width"], scene["height"], scene["frames"]
        self.times = {}

    def meshes(self, opaque=False):
        return read_glb(self.folder / ("opaque.glb" if opaque else "scene.glb"))

    def save(self, method, linear):
        numpy.save(self.folder / f"{self.name}-{method.replace(' ', '-')}.npy", linear.astype(numpy.float32))

    def measure(self, method, draw):
        """The median of the times that `draw` takes; its first call has been."""
        all_ms = []
        for _ in range(self.frames):
            start = time.perf_counter()
            draw()
            all_ms.append((time.perf_counter() - start) * 1e3)
        self.times[method] = statistics.median(all_ms)

    def answer(self, version, adapter):
        print(json.dumps({"times": self.times, "version": version, "adapter": adapter}))


def decoded(image):
    """Linear colours of an sRGB picture of 8 bits."""
    image = image.astype(numpy.float32) / 255.0
    return numpy.where(image <= 0.04045, image / 12.92, ((image + 0.055) / 1.055) ** 2.4)
