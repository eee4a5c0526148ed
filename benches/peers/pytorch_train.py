"""The thesis's network trained with PyTorch on the CPU, as fast as PyTorch does it without compiling.

    pytorch_train.py FILE ROWS BATCH EPOCHS THREADS

FILE holds four columns of ROWS little-endian 32-bit floats: three inputs and the target. Prints rows a second and the
mean loss of each epoch. Rows are permuted once an epoch and batches are slices of the permuted tensors (a DataLoader is
many times slower), Adam is the fused one, and the loss stays a tensor until the epoch ends.
"""

import sys
import time

import numpy
import torch


def main():
    file, rows, batch, epochs, threads = sys.argv[1], *map(int, sys.argv[2:6])
    torch.set_num_threads(threads)
    torch.manual_seed(1)
    columns = torch.from_numpy(numpy.fromfile(file, dtype="<f4").reshape(4, rows))
    inputs = columns[:3].T.double()
    inputs = ((inputs - inputs.mean(0)) / inputs.std(0, unbiased=False)).float().contiguous()
    target = columns[3:].T.contiguous()
    network = torch.nn.Sequential(
        torch.nn.Linear(3, 10),
        torch.nn.ReLU(),
        torch.nn.Linear(10, 8),
        torch.nn.ReLU(),
        torch.nn.Linear(8, 1),
    )
    optimiser = torch.optim.Adam(network.parameters(), lr=1e-4, fused=True)
    loss_of = torch.nn.MSELoss()
    for _ in range(epochs):
        begin = time.perf_counter()
        order = torch.randperm(rows)
        x, y = inputs[order], target[order]
        total = torch.zeros(())
        for first in range(0, rows, batch):
            part = y[first : first + batch]
            optimiser.zero_grad(set_to_none=True)
            loss = loss_of(network(x[first : first + batch]), part)
            loss.backward()
            optimiser.step()
            total += loss.detach() * len(part)
        mean = total.item() / rows
        print(f"{rows / (time.perf_counter() - begin):.0f} {mean:e}", flush=True)


main()
