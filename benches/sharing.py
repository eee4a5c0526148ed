#!/usr/bin/env python3
"""What it costs that several workers write one dataset, and what a second worker brings.

    python3 benches/sharing.py --binary target/release/peelnet [--scenes cups,foliage] [--size 1024x768] [--augment 7] [--repeat 3]
        [--folder /dev/shm]

Extracts the same views four ways, in turns, the order reversed from one turn to the next, each process pinned to one core
with one thread of the software rasteriser. Only a folder in memory shows what workers cost: a disk that writes back what an earlier run wrote
slows whoever comes next.

- alone: one process, one folder;
- two shards: one process after the other, into one folder;
- two workers: both shards at once, on two cores, into one folder;
- two folders: both shards at once, on two cores, each into a folder of its own.

All datasets that are whole have the same hash, or the script ends with an error. Prints medians and their ratios; exit code 1 where a
target is missed: two workers at least 1.7 times as fast as one, and sharing at most 3 % of the time. Only the standard library is used.
"""

import argparse
import json
import os
import pathlib
import shutil
import statistics
import subprocess
import sys
import tempfile
import time


def start(core, command):
    env = {**os.environ, "LP_NUM_THREADS": "1"}
    return subprocess.Popen(["taskset", "-c", str(core), *command], env=env, stdout=subprocess.PIPE, stderr=subprocess.PIPE)


def ended(processes):
    said = []
    for process in processes:
        out, err = process.communicate()
        if process.returncode != 0:
            sys.exit(err.decode())
        said.append(json.loads(out))
    return said


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--binary", required=True)
    parser.add_argument("--scenes", default="cups,foliage")
    parser.add_argument("--size", default="1024x768")
    parser.add_argument("--augment", default="7")
    parser.add_argument("--repeat", type=int, default=3)
    parser.add_argument("--folder", help="where the datasets are, for as long as they are needed")
    args = parser.parse_args()
    times, hashes, rows = {}, set(), 0

    with tempfile.TemporaryDirectory(dir=args.folder) as temporary:
        def extract(out, *more, size=args.size, augment=args.augment):
            return [args.binary, "extract", *args.scenes.split(","), "--size", size, "--augment", augment, "--quiet",
                    "--json", "--adapter", "software", "--out", str(out), *more]

        def timed(name, work):
            nonlocal rows
            begin = time.monotonic()
            said = work()
            times.setdefault(name, []).append(time.monotonic() - begin)
            for one in said:
                if one.get("sealed"):
                    hashes.add(one["hash"])
                    rows = one["rows"]

        for k in range(args.repeat):
            place = pathlib.Path(temporary) / str(k)
            shards = ["--shard", "1/2"], ["--shard", "2/2"]
            ways = {
                "start": lambda: ended([start(0, extract(place / "s", "--views", "1", size="8x8", augment="0"))]) and [],
                "alone": lambda: ended([start(0, extract(place / "a"))]),
                "two shards": lambda: [x for s in shards for x in ended([start(0, extract(place / "b", *s))])],
                "two workers": lambda: ended([start(c, extract(place / "c", *s)) for c, s in enumerate(shards)]),
                "two folders": lambda: ended([start(c, extract(place / f"d{c}", *s)) for c, s in enumerate(shards)]),
            }
            for name in list(ways)[:: 1 if k % 2 == 0 else -1]:
                place.mkdir()
                timed(name, ways[name])
                shutil.rmtree(place)
    if len(hashes) != 1:
        sys.exit(f"the datasets differ: {hashes}")
    medians = {name: statistics.median(all_times) for name, all_times in times.items()}
    print(f"{rows:,} rows, {args.repeat} runs each, {hashes.pop()[:16]}")
    for name, seconds in medians.items():
        print(f"{name:12} {seconds:7.2f} s  (from {min(times[name]):.2f} to {max(times[name]):.2f})")
    faster = medians["alone"] / medians["two workers"]
    apart = (medians["two shards"] - medians["start"]) / medians["alone"]
    shared = medians["two workers"] / medians["two folders"]
    missed = False
    for name, ratio, is_reached in [
        ("two workers over one, rows a second", faster, faster >= 1.7),
        ("time of two shards without one start over alone (scenes are prepared twice)", apart, None),
        ("time of two workers in one folder over two folders", shared, shared <= 1.03),
    ]:
        missed |= is_reached is False
        said = {None: "", True: ", reached", False: ", MISSED"}[is_reached]
        print(f"{name}: {ratio:.3f}{said}")
    return int(missed)


if __name__ == "__main__":
    sys.exit(main())
