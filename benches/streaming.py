#!/usr/bin/env python3
"""Training larger than memory: peak memory and rows a second of `peelnet train --stream` against training in memory.

    python3 benches/streaming.py --binary target/release/peelnet [--lists 100000] [--times 10] [--recipe medium] [--repeat 3]

Makes two datasets of synthetic fragment lists, one with --times the lists of the other. Trains in memory on the small one, streamed on
the small one, and streamed on the large one, in turns, --repeat times, each in a process of its own. Prints each run, then the ratios of
the medians:

- memory: peak of the process (`ru_maxrss`), streamed on the large dataset over streamed on the small one (target: at most 1.10);
- rate: training examples a second of the epochs, streamed on the large one over in memory on the small one (target: at least 0.85), by
  the clock and by seconds of CPU. Other work on the machine moves the first more than the second.

The rate by the clock is the command's own `rows_per_s`: an epoch's reading, mixing and steps, without the pass that makes the examples,
which both ways have once. The rate by CPU takes the whole process: the pass, all epochs and the judging of held-out examples.
Exit code 1 where a target is missed. Only the standard library is used.
"""

import argparse
import json
import os
import pathlib
import platform
import statistics
import subprocess
import sys
import tempfile
import time


def measured(command):
    """The JSON result of a command, its seconds, its seconds of CPU, and the peak of its memory in MiB."""
    begin = time.monotonic()
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    # The result is one line of JSON, and --quiet leaves stderr nearly empty: no pipe fills up.
    _, status, usage = os.wait4(process.pid, 0)
    seconds = time.monotonic() - begin
    process.returncode = os.waitstatus_to_exitcode(status)
    out, err = process.stdout.read(), process.stderr.read().decode()
    if process.returncode != 0:
        sys.exit(f"{' '.join(command)}\n{err}")
    return json.loads(out), seconds, usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024


def dataset(binary, folder, lists):
    if not (folder / "_peelnet/manifest.json").exists():
        subprocess.run([binary, "extract", "--synthetic", str(lists), "--out", str(folder), "--seed", "3", "--quiet"],
                       check=True, stdout=subprocess.DEVNULL)
    return json.loads((folder / "_peelnet/manifest.json").read_text())["rows"]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--binary", required=True)
    parser.add_argument("--lists", type=int, default=100_000)
    parser.add_argument("--times", type=int, default=10)
    parser.add_argument("--recipe", default="medium")
    parser.add_argument("--epochs", type=int, default=3)
    parser.add_argument("--buffer-rows", type=int, default=1 << 20)
    parser.add_argument("--repeat", type=int, default=3)
    parser.add_argument("--folder", help="keep the datasets here")
    args = parser.parse_args()
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(args.folder or temporary)
        folder.mkdir(parents=True, exist_ok=True)
        small, large = folder / f"lists-{args.lists}", folder / f"lists-{args.lists * args.times}"
        rows = {path: dataset(args.binary, path, lists)
                for path, lists in [(small, args.lists), (large, args.lists * args.times)]}
        stream = ["--stream", "--buffer-rows", str(args.buffer_rows)]
        runs = [("in memory", small, []), ("streamed", small, stream), ("streamed ×" + str(args.times), large, stream)]
        found = {name: [] for name, _, _ in runs}
        print(f"{platform.processor() or platform.machine()}, {os.cpu_count()} cores, recipe {args.recipe}, "
              f"{args.epochs} epochs, buffer of {args.buffer_rows:,} rows")
        for k in range(args.repeat):
            for name, data, flags in runs:
                command = [args.binary, "train", str(data), "--out", str(folder / "m.safetensors"), "--recipe", args.recipe,
                           "--epochs", str(args.epochs), "--quiet", "--json", *flags]
                result, seconds, cpu, memory = measured(command)
                rate = result["rows_per_s"]
                # All rows of all epochs, also those that only judge.
                by_cpu = rows[data] * args.epochs / cpu
                found[name].append((memory, rate, by_cpu))
                print(f"{k + 1} {name:14} {rows[data]:>12,} rows {memory:8.1f} MiB {rate:>10,.0f} examples/s of the epochs "
                      f"{by_cpu:>10,.0f} rows/s of CPU {seconds:7.1f} s, epochs {result['seconds']:7.1f} s", flush=True)
    memory, rate, cpu = ({name: statistics.median(run[i] for run in all_runs) for name, all_runs in found.items()}
                         for i in range(3))
    held, streamed, many = (name for name, _, _ in runs)
    ratios = {
        "memory, streamed large / streamed small": (memory[many] / memory[streamed], lambda x: x <= 1.10),
        "rate, streamed large / in memory small": (rate[many] / rate[held], lambda x: x >= 0.85),
        "rate by CPU, streamed large / in memory small": (cpu[many] / cpu[held], None),
        "memory, streamed large / in memory small": (memory[many] / memory[held], None),
    }
    missed = False
    for name, (ratio, is_reached) in ratios.items():
        said = "" if is_reached is None else ", reached" if is_reached(ratio) else ", MISSED"
        missed |= said.endswith("MISSED")
        print(f"{name}: {ratio:.3f}{said}")
    return int(missed)


if __name__ == "__main__":
    sys.exit(main())
