"""Learned order-independent transparency.

Draw scenes with every published method (:func:`render`), peel them into rows of fragments (:func:`extract`), train small
networks on those (:func:`train`), write the networks as shader text (:func:`export`), and measure what each method costs
(:func:`bench`, :func:`recommend`). :mod:`peelnet.ray` does the same on a cluster.

Long calls release the GIL, end soon after Ctrl-C with no half-written file, and show progress on anything of the tqdm protocol
(``progress=``). Images are numpy arrays of shape (height, width, 4); sizes are (width, height) in pixels; lengths are in scene
units; times are in milliseconds.
"""

from ._native import (
    Camera,
    Choice,
    Dataset,
    Epoch,
    Model,
    PeelnetError,
    Recommendation,
    Rows,
    Scene,
    Training,
    __version__,
    adapter_name,
    bench,
    export,
    extract,
    methods,
    recommend,
    render,
    samples,
    seal,
    train,
)

__all__ = [
    "Camera",
    "Choice",
    "Dataset",
    "Epoch",
    "Model",
    "PeelnetError",
    "Recommendation",
    "Rows",
    "Scene",
    "Training",
    "__version__",
    "adapter_name",
    "bench",
    "export",
    "extract",
    "methods",
    "recommend",
    "render",
    "samples",
    "seal",
    "train",
]
