"""What Python costs: the import, the wheel, and extraction into numpy against the program's own extraction.

    python python/benches/extract.py --binary target/release/peelnet

Both must be release builds. Runs alternate, so that a drifting machine hits both alike.
"""

import argparse
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import peelnet


def main() -> None:
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("--binary", required=True)
    arguments.add_argument("--scene", default="sixteen-050")
    arguments.add_argument("--size", default="1024x768")
    arguments.add_argument("--runs", type=int, default=5)
    arguments.add_argument("--format", default="npy", help="of the program's files; npy is what numpy opens")
    options = arguments.parse_args()
    size = tuple(int(n) for n in options.size.split("x"))

    code = "import time; t = time.perf_counter(); import peelnet; print(time.perf_counter() - t)"
    imports = [float(subprocess.run([sys.executable, "-c", code], capture_output=True, check=True).stdout) for _ in range(5)]
    print(f"import peelnet: {min(imports) * 1e3:.1f} ms")

    times: dict[str, list[float]] = {}

    def timed(name, work):
        start = time.perf_counter()
        result = work()
        times.setdefault(name, []).append(time.perf_counter() - start)
        return result

    # The adapter and its pipelines are opened by every process of the program; here once, in the first run, which does not count.
    peelnet.extract(options.scene, size=size)
    rows = 0
    for _ in range(options.runs):
        columns = timed("extract into numpy", lambda: peelnet.extract(options.scene, size=size).to_numpy())
        rows = len(columns["view"])
        del columns
        for form in dict.fromkeys([options.format, "parquet"]):
            with tempfile.TemporaryDirectory() as folder:
                program = [options.binary, "extract", options.scene, "--size", options.size, "--format", form, "--out", f"{folder}/d", "-q"]
                timed(f"the program, {form} files", lambda: subprocess.run(program, check=True, capture_output=True))
                timed(f"extract(out=…), {form} files", lambda: peelnet.extract(options.scene, size=size, out=Path(folder) / "e", format=form))
    code = (
        f"import peelnet, time; t = time.perf_counter(); peelnet.extract({options.scene!r}, size={size}).to_numpy(); "
        "print(time.perf_counter() - t)"
    )
    for _ in range(options.runs):
        timed("a fresh Python that extracts into numpy", lambda: subprocess.run([sys.executable, "-c", code], check=True, capture_output=True))
    print(f"{rows:,} rows of {options.scene} at {options.size}, {options.runs} runs each")
    for name, seconds in times.items():
        print(f"{statistics.median(seconds):7.3f} s (from {min(seconds):.3f} s)  {name}")


if __name__ == "__main__":
    main()
