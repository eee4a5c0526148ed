#!/usr/bin/env python3
"""Rows a second of training: PyTorch, a loop written for the thesis's network alone, and peelnet's trainer, side by side on this machine.

    python3 benches/peers/train.py [--rows 262144] [--rounds 5] [--out out/peers]

Needs cargo and Python with venv. The first run installs PyTorch into out/peers/venv. Every round runs every
contestant once in turn, so that a busy machine slows all of them; the table shows medians over the rounds.
"""

import argparse
import os
import pathlib
import platform
import statistics
import struct
import subprocess
import sys
import venv

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
BATCHES = [128, 1024, 8192]


def run(*command, **options):
    return subprocess.run([str(part) for part in command], check=True, **options)


def python_with_torch(out):
    """The interpreter of a virtual environment that can import torch."""
    folder = out / "venv"
    python = folder / ("Scripts/python.exe" if os.name == "nt" else "bin/python")
    if not python.exists():
        venv.create(folder, with_pip=True)

    def works():
        return subprocess.run([python, "-c", "import torch, numpy"], capture_output=True).returncode == 0

    if not works():
        pip = [python, "-m", "pip", "install", "--quiet"]
        run(*pip, "numpy", "safetensors")
        # PyPI's Linux wheel wants gigabytes of CUDA libraries merely to be imported: PyTorch's own index has one without.
        index = "https://download.pytorch.org/whl/cpu"
        if subprocess.run([*pip, "--retries", "1", "--index-url", index, "torch"]).returncode != 0:
            print(f"{index} cannot be reached: installing the large wheel from PyPI", file=sys.stderr)
            run(*pip, "--no-cache-dir", "torch")
        if not works():
            sys.exit(f"{python} cannot import torch: delete {folder} and run this again")
    return python


def synthetic(path, rows):
    """Columns like a dataset's: depth, sum of alphas, count, and a transmittance that depends on them."""
    import math
    import random

    source = random.Random(1)
    columns = [[], [], [], []]
    for _ in range(rows):
        count = source.randint(1, 30)
        alpha = source.uniform(0.05, 0.9)
        depth = source.uniform(1.0, 20.0)
        share = (depth - 1.0) / 19.0
        values = (depth, alpha * count, float(count), math.pow(1.0 - alpha, share * (count - 1)))
        for column, value in zip(columns, values):
            column.append(value)
    with open(path, "wb") as file:
        for column in columns:
            file.write(struct.pack(f"<{rows}f", *column))


def measure(command, epochs):
    """Rows a second (median of the epochs but the first, which warms up) and the last epoch's loss."""
    text = run(*command, capture_output=True, text=True).stdout
    lines = [line.split() for line in text.splitlines()]
    if len(lines) != epochs:
        sys.exit(f"{command}: expected {epochs} lines, got {text!r}")
    return statistics.median(float(rate) for rate, _ in lines[1:]), float(lines[-1][1])


def processor():
    try:
        for line in pathlib.Path("/proc/cpuinfo").read_text().splitlines():
            if line.startswith("model name"):
                return line.split(":", 1)[1].strip()
    except OSError:
        pass
    return platform.processor() or platform.machine()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rows", type=int, default=262_144)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--epochs", type=int, default=4, help="epochs a measurement, the first not counted")
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "out" / "peers")
    arguments = parser.parse_args()
    if arguments.rows < 1 or arguments.rounds < 1 or arguments.epochs < 2:
        parser.error("--rows and --rounds must be at least 1, --epochs at least 2")
    out = arguments.out.resolve()
    out.mkdir(parents=True, exist_ok=True)

    python = python_with_torch(out)
    run("cargo", "build", "--release", "--quiet", "-p", "peelnet_train", "--example", "throughput", cwd=ROOT)
    target = pathlib.Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
    ours = target / "release" / "examples" / "throughput"
    loop = out / "simd_loop"
    # Without this all of its arrays stay in memory, at a third of the speed.
    unroll = "llvm-args=-unroll-threshold=2000"
    rustc = ["rustc", "--edition", "2024", "-C", "opt-level=3", "-C", "target-cpu=native", "-C", unroll]
    run(*rustc, "-o", loop, HERE / "simd_loop.rs")
    data = out / f"rows-{arguments.rows}.f32"
    if not data.exists():
        synthetic(data, arguments.rows)

    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    threads = sorted({1, 2, cores} & set(range(1, cores + 1)))
    torch_script = HERE / "pytorch_train.py"
    epochs = arguments.epochs

    def contestants(batch):
        common = [data, arguments.rows, batch, epochs]
        yield from ((("pytorch", n), [python, torch_script, *common, n]) for n in threads)
        yield from ((("peelnet", n), [ours, *common, n]) for n in threads)
        yield ("loop", 1), [loop, *common]

    rates, losses = {}, {}
    for round_number in range(arguments.rounds):
        for batch in BATCHES:
            for who, command in contestants(batch):
                rate, loss = measure(command, epochs)
                rates.setdefault((batch, who), []).append(rate)
                losses[batch, who] = loss
        print(f"round {round_number + 1} of {arguments.rounds}", file=sys.stderr)

    version = run(python, "-c", "import torch; print(torch.__version__)", capture_output=True, text=True).stdout.strip()
    print(f"{processor()}, {cores} cores; PyTorch {version}; {arguments.rows:,} rows, medians of {arguments.rounds} rounds;")
    print("million rows a second, the best number of threads in brackets.\n")
    print("| batch | PyTorch | the loop | peelnet | on one thread | peelnet / PyTorch | one thread / the loop |")
    print("|---|---|---|---|---|---|---|")
    for batch in BATCHES:

        def best(name):
            return max((statistics.median(v), who[1]) for (b, who), v in rates.items() if b == batch and who[0] == name)

        torch, peelnet, (loop, _) = best("pytorch"), best("peelnet"), best("loop")
        single = statistics.median(rates[batch, ("peelnet", 1)])
        print(
            f"| {batch:,} | {torch[0] / 1e6:.2f} ({torch[1]}) | {loop / 1e6:.2f} | {peelnet[0] / 1e6:.2f} ({peelnet[1]}) "
            f"| {single / 1e6:.2f} | {peelnet[0] / torch[0]:.2f} | {single / loop:.2f} |"
        )
    print(f"\nMean squared error in epoch {epochs}, to see that all of them train (initial weights differ):")
    for batch in BATCHES:
        shown = ", ".join(f"{who[0]} {loss:.4f}" for (b, who), loss in losses.items() if b == batch and who[1] == 1)
        print(f"batch {batch:,}: {shown}")


main()
