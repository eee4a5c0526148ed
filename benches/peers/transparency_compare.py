"""Differences of every `*.npy` picture in a folder from our exact one, as JSON; called by transparency.py."""

import json
import pathlib
import sys

import numpy

folder = pathlib.Path(sys.argv[1])


def picture(name):
    image = numpy.load(folder / f"{name}.npy")[..., :3]
    return image / 255.0 if image.dtype == numpy.uint8 else image.astype(numpy.float64)


def away_from_silhouettes(exact):
    """Nothing is lit: colours change only where a silhouette or an intersection passes. Programs may rasterise those otherwise."""
    flat = numpy.ones(exact.shape[:2], bool)
    for dy in (-1, 0, 1):
        for dx in (-1, 0, 1):
            flat &= (numpy.abs(numpy.roll(exact, (dy, dx), (0, 1)) - exact) < 1e-4).all(axis=2)
    return flat


exact = {True: picture("peelnet-opaque"), False: picture("peelnet-abuffer")}
flat = {opaque: away_from_silhouettes(image) for opaque, image in exact.items()}
result = {"share": float(flat[False].mean())}
noise = None
for path in sorted(folder.glob("*.npy")):
    if path.stem == "mitsuba-noise":
        noise = picture(path.stem)
        continue
    image, opaque = picture(path.stem), path.stem.endswith("-opaque")
    difference = numpy.abs(image - exact[opaque]).max(axis=2)[flat[opaque]] * 255.0
    result[path.stem] = {"most": float(difference.max()), "mean": float(difference.mean()), "over": float((difference > 2.0).mean()),
                         "mse": float(((image - exact[opaque]) ** 2).mean())}
if noise is not None:
    difference = (picture("mitsuba-path-tracing") - exact[False])[flat[False]]
    noise = noise[flat[False]]
    # The product of the errors of two halves of the samples: their noise cancels in its mean, which is the squared error that is none.
    beyond = (difference**2 - noise**2).mean(axis=1)
    means = difference.mean(axis=1)
    # Channels of a pixel have the same paths, so it counts as one number.
    root = len(means) ** 0.5
    result["noise"] = {"rms": float((difference**2).mean() ** 0.5), "own": float((noise**2).mean() ** 0.5), "beyond": float(beyond.mean()),
                       "beyond_deviation": float(beyond.std() / root), "mean": float(means.mean()), "mean_deviation": float(means.std() / root)}
print(json.dumps(result))
