"""Differences of every `*.npy` picture in a folder from `peelnet-abuffer.npy`, as JSON; called by transparency.py."""

import json
import pathlib
import sys

import numpy

folder = pathlib.Path(sys.argv[1])
exact = numpy.load(folder / "peelnet-abuffer.npy")[..., :3]
# Nothing is lit: colours change only where a silhouette or an intersection passes. Programs may rasterise those otherwise.
flat = numpy.ones(exact.shape[:2], bool)
for dy in (-1, 0, 1):
    for dx in (-1, 0, 1):
        moved = numpy.roll(exact, (dy, dx), (0, 1))
        flat &= (numpy.abs(moved - exact) < 1e-4).all(axis=2)
result = {"share": float(flat.mean())}
for path in sorted(folder.glob("*.npy")):
    image = numpy.load(path)[..., :3]
    difference = numpy.abs(image - exact).max(axis=2)[flat] * 255.0
    result[path.stem] = {"most": float(difference.max()), "mean": float(difference.mean()), "over": float((difference > 2.0).mean()),
                         "mse": float(((image - exact) ** 2).mean())}
print(json.dumps(result))
