#!/usr/bin/env python3
"""The same transparent scene drawn by peelnet, VTK and pygfx on the same software rasteriser: pictures and frame times.

    python3 benches/peers/transparency.py [--meshes 16] [--frames 11] [--size 512x384] [--out out/peers/transparency]

Needs cargo and Python with venv. The first run installs VTK and pygfx from PyPI into out/peers/transparency-venv. Meshes are
written as OBJ by this script; camera, colours and opacities are the same everywhere, nothing is lit, and all blend the numbers
as they are, without a transfer function. Each program draws in turn, round after round, so that a busy machine slows all of
them; times are medians of clock times from the command to the finished picture.
"""

import argparse
import json
import math
import os
import pathlib
import platform
import statistics
import subprocess
import sys
import venv

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
CAMERA = {"position": [0.0, 0.4, 6.0], "target": [0.0, 0.0, 0.0], "up": [0.0, 1.0, 0.0], "fov_y": 45.0, "near": 0.1, "far": 100.0}
BACKGROUND = [0.1, 0.2, 0.3]
OURS = ["abuffer", "linked-list", "dual-peel", "depth-peel", "wboit-eq7", "wboit-eq9", "wboit-eq10", "mboit4", "deep-anchored-medium", "deep-medium"]
PEERS = {"vtk": ["dual depth peeling", "weighted blending"], "pygfx": ["weighted blending"]}


def run(*command, **options):
    return subprocess.run([str(part) for part in command], check=True, **options)


def python_with_peers(out):
    """The interpreter of a virtual environment that can import the peers."""
    folder = out.parent / (out.name + "-venv")
    python = folder / ("Scripts/python.exe" if os.name == "nt" else "bin/python")
    if not python.exists():
        venv.create(folder, with_pip=True)
    works = [python, "-c", "import vtk, pygfx, rendercanvas, numpy"]
    if subprocess.run(works, capture_output=True).returncode != 0:
        run(python, "-m", "pip", "install", "--quiet", "vtk", "pygfx", "rendercanvas", "numpy")
        run(*works)
    return python


def sphere(steps):
    """A unit sphere of quads in rings, cut into triangles."""
    points = [(math.sin(b) * math.cos(a), math.cos(b), math.sin(b) * math.sin(a))
              for i in range(steps + 1) for b in [math.pi * i / steps]
              for j in range(2 * steps) for a in [math.pi * j / steps]]
    ring = 2 * steps
    triangles = []
    for i in range(steps):
        for j in range(ring):
            a, b = i * ring + j, i * ring + (j + 1) % ring
            triangles += [(a, b, b + ring)] if i < steps - 1 else []
            triangles += [(a, b + ring, a + ring)] if i < steps - 1 else [(a, b, a + ring)]
    return points, triangles


def torus(steps, thickness=0.35):
    points = [((1 + thickness * math.cos(b)) * math.cos(a), thickness * math.sin(b), (1 + thickness * math.cos(b)) * math.sin(a))
              for i in range(2 * steps) for a in [math.pi * i / steps]
              for j in range(steps) for b in [2 * math.pi * j / steps]]
    triangles = []
    for i in range(2 * steps):
        for j in range(steps):
            k = (i + 1) % (2 * steps)
            a, b, c, d = i * steps + j, i * steps + (j + 1) % steps, k * steps + (j + 1) % steps, k * steps + j
            triangles += [(a, b, c), (a, c, d)]
    return points, triangles


def write_scene(out, count):
    """OBJ files and a scene of them; returns what the peers need."""
    meshes = []
    for i in range(count):
        points, triangles = (sphere if i % 2 else torus)(16)
        # A golden-angle spiral, every mesh turned otherwise, so that they reach through one another.
        angle, radius = 2.39996 * i, 1.6 * math.sqrt((i + 0.5) / count)
        size, turn = 0.55 + 0.25 * math.sin(3.0 * i), 0.7 * i
        place = (radius * math.cos(angle), radius * math.sin(angle), 1.2 * math.sin(1.7 * i))
        name = f"mesh-{i:02}.obj"
        with open(out / name, "w") as file:
            for x, y, z in points:
                y, z = y * math.cos(turn) - z * math.sin(turn), y * math.sin(turn) + z * math.cos(turn)
                print("v", *(f"{size * c + p:.6f}" for c, p in zip((x, y, z), place)), file=file)
            for triangle in triangles:
                print("f", *(k + 1 for k in triangle), file=file)
        color = [round(0.5 + 0.5 * math.cos(1.3 * i + k), 3) for k in (0.0, 2.1, 4.2)]
        meshes.append({"mesh": name, "color": color, "alpha": round(0.3 + 0.4 * ((i * 7) % count) / count, 3)})
    lines = ['name = "peers"', f"background = {BACKGROUND}", "[camera]"]
    lines += [f"{key} = {value}" for key, value in CAMERA.items()]
    for mesh in meshes:
        lines += ["[[object]]", f'mesh = "{mesh["mesh"]}"',
                  f'material = {{ color = {mesh["color"]}, alpha = {mesh["alpha"]}, lighting = "unlit", double_sided = true }}']
    (out / "peers.toml").write_text("\n".join(lines) + "\n")
    scene = {"camera": CAMERA, "background": BACKGROUND, "meshes": meshes, "folder": str(out)}
    (out / "peers.json").write_text(json.dumps(scene))


def ours(out, size, frames):
    """Times of our methods in this round, and pictures as arrays."""
    peelnet = ["cargo", "run", "--release", "--quiet", "--package", "peelnet", "--", "--adapter", "software", "--quiet"]
    run(*peelnet, "bench", out / "peers.toml", "--methods", ",".join(OURS), "--size", size, "--frames", frames,
        "--out", out / "ours", cwd=ROOT, stdout=subprocess.DEVNULL)
    rows = json.loads((out / "ours/results.json").read_text())["rows"]
    return {row["method"]: row["wall_ms"] for row in rows}


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--meshes", type=int, default=16)
    arguments.add_argument("--frames", type=int, default=11)
    arguments.add_argument("--rounds", type=int, default=3)
    arguments.add_argument("--size", default="512x384")
    arguments.add_argument("--out", type=pathlib.Path, default=ROOT / "out/peers/transparency")
    given = arguments.parse_args()
    out = given.out.resolve()
    out.mkdir(parents=True, exist_ok=True)
    python = python_with_peers(out)
    write_scene(out, given.meshes)
    times = {}
    adapters = {}
    for _ in range(given.rounds):
        for name, ms in ours(out, given.size, given.frames).items():
            times.setdefault(("peelnet", name), []).append(ms)
        for peer in PEERS:
            text = subprocess.run([python, HERE / f"transparency_{peer}.py", out / "peers.json", given.size, str(given.frames)],
                                  check=True, capture_output=True, text=True).stdout
            answer = json.loads(text.splitlines()[-1])
            adapters[peer] = answer["adapter"]
            for name, ms in answer["times"].items():
                times.setdefault((f"{peer} {answer['version']}", name), []).append(ms)
    for name in OURS:
        run("cargo", "run", "--release", "--quiet", "--package", "peelnet", "--", "--adapter", "software", "--quiet", "render",
            out / "peers.toml", "--method", name, "--size", given.size, "--out", out / f"peelnet-{name}.npy", cwd=ROOT, stdout=subprocess.DEVNULL)
    differences = json.loads(run(python, HERE / "transparency_compare.py", out, capture_output=True, text=True).stdout)
    reference = statistics.median(times["peelnet", "abuffer"])
    lines = [
        "| program | method | frame time, ms | / our abuffer | differs from our exact image, /255, away from silhouettes: most (mean) | by more than 2/255 | MSE, whole frame |",
        "|---|---|---:|---:|---:|---:|---:|",
    ]
    for (program, name), all_ms in times.items():
        ms = statistics.median(all_ms)
        found = differences.get(f"{program.split()[0]}-{name.replace(' ', '-')}")
        shown = f"{found['most']:.2f} ({found['mean']:.3f})" if found else "–"
        over = f"{found['over']:.1%}" if found else "–"
        mse = f"{found['mse']:.2e}" if found else "–"
        lines.append(f"| {program} | {name} | {ms:.1f} | {ms / reference:.2f} | {shown} | {over} | {mse} |")
    cpu = next((line.split(":")[1].strip() for line in open("/proc/cpuinfo") if line.startswith("model name")), "") \
        if os.path.exists("/proc/cpuinfo") else platform.processor()
    share = differences["share"]
    lines += ["", f"{given.meshes} meshes, {given.size}, {given.rounds} rounds of {given.frames} frames in turn. {share:.0%} of the pixels lie "
              f"away from silhouettes. Machine: {cpu}, {os.cpu_count()} cores; "
              + "; ".join(f"{peer} drew with {name}" for peer, name in adapters.items())
              + ". Command: `python3 " + " ".join(["benches/peers/transparency.py", *sys.argv[1:]]) + "`."]
    text = "\n".join(lines) + "\n"
    (out / "transparency.md").write_text(text)
    print(text)


if __name__ == "__main__":
    main()
