"""Losses and their gradients as PyTorch forms them, in 64 bits, for the test `gradients_are_pytorchs` of peelnet_train.

Reads a list of cases from standard input as JSON, and writes for each case a list with the loss and the gradient of every example.
The losses are those at the head of crates/peelnet_train/src/loss.rs.
"""

import json
import sys

import torch

torch.set_default_dtype(torch.float64)

ACTIVATIONS = {"relu": torch.relu, "sigmoid": torch.sigmoid, "identity": lambda x: x}


def forward(case, parameters, rows):
    """Answers for rows `[rows, inputs]`, from parameters in the order of the model file."""
    x, at = rows, 0
    widths = case["widths"]
    for k, (inputs, outputs) in enumerate(zip(widths, widths[1:])):
        weights = parameters[at : at + inputs * outputs].reshape(outputs, inputs)
        at += inputs * outputs
        bias = parameters[at : at + outputs]
        at += outputs
        last = k + 2 == len(widths)
        x = ACTIVATIONS[case["output" if last else "hidden"]](torch.nn.functional.linear(x, weights, bias))
    return x


def loss(case, parameters, example):
    weight = 1.0 if case["weights"] is None else case["weights"][example]
    size = 1 if case["rows"] is None else case["rows_of_a_pixel"]
    rows = slice(example * size, (example + 1) * size)
    answer = forward(case, parameters, torch.tensor(case["inputs"])[:, rows].T)
    target = torch.tensor(case["targets"])[:, rows].T
    if case["rows"] is None:
        return weight * torch.sum((answer - target) ** 2)
    residual, alpha, *color = torch.tensor(case["rows"])[:, rows]
    left, total, *ends = (column[example] for column in case["fixed"])
    answer, exact = answer[:, 0], target[:, 0]
    through = answer if case["answers_transmittance"] else torch.exp(-residual * answer)
    seen = alpha * through
    if case["loss"] == "transmittance":
        return weight * torch.sum((through - torch.clamp(exact / alpha, max=1.0)) ** 2)
    if case["loss"] == "weighted-transmittance":
        return weight * torch.sum((seen - exact) ** 2)
    scale = left / (total + case["floor"] + torch.sum(seen))
    errors = seen * scale - exact
    if case["loss"] == "contributions":
        return weight * torch.sum(errors**2)
    image = torch.stack([torch.sum(errors * channel) for channel in color])
    known, exact_ends = torch.tensor(ends[:3]), torch.tensor(ends[3:])
    return weight * torch.sum((image + known * scale - exact_ends) ** 2) / 3.0


def answer(case):
    parameters = torch.tensor(case["parameters"], requires_grad=True)
    examples = len(case["targets"][0]) // (1 if case["rows"] is None else case["rows_of_a_pixel"])
    for example in range(examples):
        value = loss(case, parameters, example)
        (gradient,) = torch.autograd.grad(value, parameters)
        yield [value.item(), gradient.tolist()]


json.dump([list(answer(case)) for case in json.load(sys.stdin)], sys.stdout)
