#!/usr/bin/env python3
"""What 10,000 scenes of 100 views cost, where the bottleneck moves, and which part size is right: a model and a small simulation.

    python3 benches/scaling.py [--scenes 10000] [--views 100] [--seed 1]

The measured figures and the assumptions are the constants below; docs/scaling-out.md says where each is from. The simulation draws the
times at which workers are killed and counts what is done twice. Only the standard library is used; the same seed gives the same output.
"""

import argparse
import math
import random

# Measured, see docs/scaling-out.md.
EXTRACT_ROWS_PER_CORE_S = 2.5e6  # cups and foliage at 640×480, llvmpipe, rows per second of CPU
ROWS_PER_VIEW = 0.69e6  # the same
BYTES_PER_ROW = 15.5  # Parquet, the same
PREPARE_ROWS_PER_S = 2.5e6  # the pass that makes the examples of `medium`, one core
EPOCH_ROWS_PER_S = 1.27e7  # an epoch of `medium`, two cores
SCRATCH_BYTES_PER_ROW = 50.0  # the scratch file of `medium`

# Assumed: an object store of the usual kind, and a cluster of preemptible machines.
REQUEST_S = 0.05  # one request, beside its bytes
REQUESTS_PER_PART = 3  # is it there, the data, the commit
STORE_BYTES_PER_S = 10e9  # all workers together
WORKER_BYTES_PER_S = 100e6  # one worker
STORE_WRITES_PER_S = 3500.0  # of one prefix
LIST_KEYS = 1000  # keys of a page
READERS = 32  # requests at a time of one process
MEAN_LIFE_S = 6 * 3600.0  # of a worker
START_S = 10.0  # of a worker after a kill


def duration(seconds):
    for unit, size in [("d", 86400), ("h", 3600), ("min", 60)]:
        if seconds >= size:
            return f"{seconds / size:.1f} {unit}"
    return f"{seconds:.1f} s"


def part_seconds(rows):
    """Work and overhead of a part, in seconds of one core."""
    work = rows / EXTRACT_ROWS_PER_CORE_S
    return work, REQUESTS_PER_PART * REQUEST_S + rows * BYTES_PER_ROW / WORKER_BYTES_PER_S


def simulated(rows, generator, parts=20_000):
    """Time of a worker over the time of the work alone, for parts of so many rows."""
    work, overhead = part_seconds(rows)
    time, kill = 0.0, generator.expovariate(1 / MEAN_LIFE_S)
    done = 0
    # As many parts as 2000 hours take, or `parts`.
    while done < parts and time < 2000 * 3600:
        if time + work + overhead <= kill:
            time += work + overhead
            done += 1
        else:
            # What was begun is lost.
            time = kill + START_S
            kill = time + generator.expovariate(1 / MEAN_LIFE_S)
    return time / (done * work) if done else math.inf


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scenes", type=int, default=10_000)
    parser.add_argument("--views", type=int, default=100)
    parser.add_argument("--seed", type=int, default=1)
    args = parser.parse_args()
    views = args.scenes * args.views
    rows = views * ROWS_PER_VIEW
    stored = rows * BYTES_PER_ROW
    print(f"{args.scenes:,} scenes × {args.views} views: {views:,} views, {rows:.3g} rows, {stored / 1e12:.1f} TB\n")

    print("| workers (one core each) | extraction | the store's bandwidth | writes, a part a view | slowest |")
    print("|---:|---:|---:|---:|---|")
    for workers in [1, 10, 100, 1000, 10_000]:
        stages = {
            "extraction": rows / EXTRACT_ROWS_PER_CORE_S / workers,
            "bandwidth": stored / min(STORE_BYTES_PER_S, workers * WORKER_BYTES_PER_S),
            "writes": 2 * views / min(STORE_WRITES_PER_S, workers / REQUEST_S),
        }
        slowest = max(stages, key=stages.get)
        print(f"| {workers:,} | " + " | ".join(duration(s) for s in stages.values()) + f" | {slowest} |")

    print("\n| views a part | rows | bytes | parts | seal: list and read the commits | time over the work alone, simulated "
          "| by the formula |")
    print("|---:|---:|---:|---:|---:|---:|---:|")
    for group in [0.01, 0.1, 1, 10, 100, 1000, 10_000]:
        of = group * ROWS_PER_VIEW
        work, overhead = part_seconds(of)
        parts = views / group
        seal = math.ceil(parts / LIST_KEYS) * REQUEST_S + parts * REQUEST_S / READERS
        # Half a part is lost with each kill, where parts are short beside a worker's life.
        formula = (work + overhead) / work * (1 + ((work + overhead) / 2 + START_S) / MEAN_LIFE_S)
        found = simulated(of, random.Random(args.seed))
        print(f"| {group:g} | {of:.2g} | {of * BYTES_PER_ROW / 1e6:.3g} MB | {parts:.2g} | {duration(seal)} "
              f"| {found:.3f} | {formula:.3f} |")
    fixed = REQUESTS_PER_PART * REQUEST_S
    best = math.sqrt(2 * fixed * MEAN_LIFE_S)
    print(f"\nLeast time (Young 1974): parts of √(2 × {fixed:g} s × {duration(MEAN_LIFE_S)}) = {duration(best)} of work, "
          f"{best * EXTRACT_ROWS_PER_CORE_S:.2g} rows, {best * EXTRACT_ROWS_PER_CORE_S * BYTES_PER_ROW / 1e9:.2g} GB.")

    print("\n| pixels kept | rows | dataset | scratch file | pass | an epoch |")
    print("|---:|---:|---:|---:|---:|---:|")
    for share in [1, 0.1, 0.01, 0.001]:
        kept = rows * share
        print(f"| {share:g} | {kept:.2g} | {kept * BYTES_PER_ROW / 1e9:,.0f} GB | {kept * SCRATCH_BYTES_PER_ROW / 1e9:,.0f} GB "
              f"| {duration(kept / PREPARE_ROWS_PER_S)} | {duration(kept / EPOCH_ROWS_PER_S)} |")


if __name__ == "__main__":
    main()
