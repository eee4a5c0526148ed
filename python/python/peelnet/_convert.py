"""Rows of measurements as data frames, weights as torch's `state_dict`, and back."""

import json


def frame(records):
    """A DataFrame; a dict from column to list where pandas is not installed."""
    try:
        import pandas
    except ImportError:
        names = dict.fromkeys(name for record in records for name in record)
        return {name: [record.get(name) for record in records] for name in names}
    return pandas.DataFrame(records)


def text(results):
    """What `frame` returned, or records, as JSON."""
    if hasattr(results, "to_json"):
        # Its NaN becomes null again.
        text = results.to_json(orient="records", double_precision=15)
    else:
        if isinstance(results, dict):
            results = [dict(zip(results, row)) for row in zip(*results.values())]
        text = json.dumps(results)
    return json.dumps(json.loads(text, parse_float=_number))


def _number(text):
    """Pandas keeps counts as floats where one of them is missing."""
    number = float(text)
    return int(number) if number.is_integer() else number


def state_dict(weights):
    """Arrays as torch tensors."""
    import torch

    return {name: torch.from_numpy(array) for name, array in weights.items()}


def layers(state):
    """Weights and biases of a `state_dict` or another mapping from names to arrays, as float32 arrays."""
    found = []
    while f"layers.{len(found)}.weight" in state:
        name = f"layers.{len(found)}"
        found.append((_array(state, f"{name}.weight", 2), _array(state, f"{name}.bias", 1)))
    if len(state) != 2 * len(found):
        raise ValueError(
            "a state dict of a model holds layers.0.weight, layers.0.bias, layers.1.weight, … and nothing else; "
            f"this one holds {', '.join(map(repr, state))}"
        )
    return found


def _array(state, name, axes):
    import numpy

    value = state[name]
    if hasattr(value, "detach"):
        value = value.detach().cpu()
    array = numpy.asarray(value, dtype="float32")
    if array.ndim != axes:
        raise ValueError(f"{name} has {array.ndim} axes instead of {axes}")
    return array
