#!/usr/bin/env python3
"""The same transparent scene drawn by peelnet and by other programs, where they can be had on the same software rasteriser: pictures, errors and
frame times.

    python3 benches/peers/transparency.py [--peers vtk,three] [--meshes 16] [--frames 11] [--rounds 3] [--size 512x384]

Needs Python with venv, node, Chromium, and cargo or PEELNET_BINARY (a built peelnet). The first run installs the peers from PyPI and npm into
out/peers; one that cannot be installed or drawn is named, and the others go on. This script writes the meshes as a GLB file; camera, colours and
opacities are the same everywhere, nothing is lit, and linear colours are compared. Each program draws in turn, round after round, so that a
busy machine slows all of them; times are medians of clock times from the command to the finished picture.
"""

import argparse
import json
import math
import os
import pathlib
import platform
import shutil
import statistics
import struct
import subprocess
import sys
import venv

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
CAMERA = {"position": [0.0, 0.4, 6.0], "target": [0.0, 0.0, 0.0], "up": [0.0, 1.0, 0.0], "fov_y": 45.0, "near": 0.1, "far": 100.0}
BACKGROUND = [0.1, 0.2, 0.3]
OURS = ["abuffer", "linked-list", "dual-peel", "depth-peel", "wboit-eq7", "wboit-eq9", "wboit-eq10", "mboit4", "deep-anchored-medium", "deep-medium"]
# What each peer is installed from; versions are in the table.
PYTHON = {"vtk": ["vtk"], "pygfx": ["pygfx", "rendercanvas"], "polyscope": ["polyscope"], "mitsuba": ["mitsuba"]}
NODE = {"three": ["three"], "babylon": ["@babylonjs/core", "@babylonjs/loaders"], "cesium": ["@cesium/engine"], "molstar": ["molstar"]}
# Bytes a pixel of the targets that a method has for itself, by the source of the version drawn (VTK: of its repository): nothing but the picture
# where blending goes into that, else sums and their depth, or the depths and colours that are peeled.
BYTES = {
    ("vtk", "dual depth peeling"): 36, ("vtk", "weighted blending"): 14, ("pygfx", "weighted blending"): 9, ("pygfx", "sorted blending"): 0,
    ("three", "sorted blending"): 0, ("three", "weighted blending"): 9, ("babylon", "sorted blending"): 0, ("babylon", "dual depth peeling"): 48,
    ("cesium", "weighted blending"): 32, ("cesium", "sorted blending"): 0, ("molstar", "weighted blending"): 36, ("molstar", "blending"): 0,
}


def run(*command, **options):
    return subprocess.run([str(part) for part in command], check=True, **options)


def python_for(peer, out):
    """The interpreter of a virtual environment that can import the peer."""
    folder = out.parent / (out.name + "-venv")
    python = folder / ("Scripts/python.exe" if os.name == "nt" else "bin/python")
    if not python.exists():
        venv.create(folder, with_pip=True)
    works = [python, "-c", f"import numpy, {', '.join(PYTHON.get(peer, []))}".rstrip(", ")]
    if subprocess.run(works, capture_output=True).returncode != 0:
        run(python, "-m", "pip", "install", "--quiet", "numpy", *PYTHON.get(peer, []))
        run(*works)
    return python


def node_for(peer, out):
    """A folder of npm packages with the peer."""
    folder = out.parent / (out.name + "-npm")
    folder.mkdir(exist_ok=True)
    (folder / "package.json").exists() or (folder / "package.json").write_text('{"private": true, "type": "module"}')
    # The last of puppeteer-core that runs with Node.js 20.
    packages = {"puppeteer-core": "puppeteer-core@24", **{name: name for name in ["esbuild", *NODE[peer]]}}
    missing = [wanted for name, wanted in packages.items() if not (folder / "node_modules" / name).exists()]
    if missing:
        run(shutil.which("npm"), "install", "--silent", "--no-audit", "--no-fund", *missing, cwd=folder)
    return folder


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


def meshes(count):
    """Positions, triangles, linear colour and opacity."""
    made = []
    for i in range(count):
        points, triangles = (sphere if i % 2 else torus)(16)
        # A golden-angle spiral, every mesh turned otherwise, so that they reach through one another.
        angle, radius = 2.39996 * i, 1.6 * math.sqrt((i + 0.5) / count)
        size, turn = 0.55 + 0.25 * math.sin(3.0 * i), 0.7 * i
        place = (radius * math.cos(angle), radius * math.sin(angle), 1.2 * math.sin(1.7 * i))
        placed = [(x, y * math.cos(turn) - z * math.sin(turn), y * math.sin(turn) + z * math.cos(turn)) for x, y, z in points]
        placed = [tuple(size * c + p for c, p in zip(point, place)) for point in placed]
        color = [round(0.5 + 0.5 * math.cos(1.3 * i + k), 3) for k in (0.0, 2.1, 4.2)]
        made.append((placed, triangles, color, round(0.3 + 0.4 * ((i * 7) % count) / count, 3)))
    return made


def write_glb(path, scene, opaque):
    """Unlit and double-sided; without textures and normals."""
    binary, views, accessors, nodes, files_meshes, materials = bytearray(), [], [], [], [], []

    def accessor(numbers, kind, code, **more):
        views.append({"buffer": 0, "byteOffset": len(binary), "byteLength": 4 * len(numbers)})
        binary.extend(struct.pack(f"<{len(numbers)}{code}", *numbers))
        accessors.append({"bufferView": len(views) - 1, "componentType": 5126 if code == "f" else 5125, "type": kind,
                          "count": len(numbers) // (3 if kind == "VEC3" else 1), **more})
        return len(accessors) - 1

    for points, triangles, color, alpha in scene:
        bounds = {name: [best(axis) for axis in zip(*points)] for name, best in (("min", min), ("max", max))}
        position = accessor([c for point in points for c in point], "VEC3", "f", **bounds)
        indices = accessor([k for triangle in triangles for k in triangle], "SCALAR", "I")
        nodes.append({"mesh": len(nodes)})
        files_meshes.append({"primitives": [{"attributes": {"POSITION": position}, "indices": indices, "material": len(materials)}]})
        materials.append({"pbrMetallicRoughness": {"baseColorFactor": [*color, 1.0 if opaque else alpha], "metallicFactor": 0.0},
                          "alphaMode": "OPAQUE" if opaque else "BLEND", "doubleSided": True, "extensions": {"KHR_materials_unlit": {}}})
    gltf = {"asset": {"version": "2.0"}, "extensionsUsed": ["KHR_materials_unlit"], "scene": 0, "scenes": [{"nodes": list(range(len(nodes)))}],
            "nodes": nodes, "meshes": files_meshes, "materials": materials, "accessors": accessors, "bufferViews": views,
            "buffers": [{"byteLength": len(binary)}]}
    text = json.dumps(gltf).encode()
    text += b" " * (-len(text) % 4)
    path.write_bytes(struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(binary)) + struct.pack("<I4s", len(text), b"JSON") + text
                     + struct.pack("<I4s", len(binary), b"BIN\0") + binary)


def write_scene(out, count, size, frames):
    """The scene as it is, and with everything opaque, which shows whether cameras and colours agree."""
    for name in ("scene", "opaque"):
        write_glb(out / f"{name}.glb", meshes(count), name == "opaque")
        lines = [f"background = {BACKGROUND}", "[camera]", *(f"{key} = {value}" for key, value in CAMERA.items()), "[[object]]", f'mesh = "{name}.glb"']
        (out / f"{name}.toml").write_text("\n".join(lines) + "\n")
    width, height = map(int, size.split("x"))
    scene = {"camera": CAMERA, "background": BACKGROUND, "width": width, "height": height, "frames": frames}
    (out / "scene.json").write_text(json.dumps(scene))


def peelnet(*arguments):
    built = [os.environ["PEELNET_BINARY"]] if "PEELNET_BINARY" in os.environ else ["cargo", "run", "--release", "--quiet", "--package", "peelnet", "--"]
    run(*built, "--adapter", "software", "--quiet", *arguments, cwd=ROOT, stdout=subprocess.DEVNULL)


def draw_ours(out, size, frames):
    peelnet("bench", out / "scene.toml", "--methods", ",".join(OURS), "--size", size, "--frames", frames, "--out", out / "ours")
    rows = [row for row in json.loads((out / "ours/results.json").read_text())["rows"] if row["method"] in OURS]
    return {"times": {row["method"]: row["wall_ms"] for row in rows}, "bytes": {row["method"]: row["bytes_per_pixel"] for row in rows},
            "adapter": rows[0]["adapter"]}


def draw_peer(peer, out):
    """What the peer's script answers in its last line."""
    if peer in PYTHON:
        command = [python_for(peer, out), HERE / f"transparency_{peer}.py", out / "scene.json"]
    else:
        command = ["node", HERE / "transparency_browser.mjs", peer, out / "scene.json", node_for(peer, out)]
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True, timeout=1800)
    if done.returncode != 0:
        raise RuntimeError(f"{peer} did not draw:\n{done.stderr[-2000:]}")
    answer = json.loads(done.stdout.splitlines()[-1])
    if peer in NODE:
        answer["version"] = json.loads((node_for(peer, out) / "node_modules" / NODE[peer][0] / "package.json").read_text())["version"]
    return answer


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--peers", default=",".join([*PYTHON, *NODE]), help="which of them to draw, separated by commas")
    arguments.add_argument("--meshes", type=int, default=16)
    arguments.add_argument("--frames", type=int, default=11)
    arguments.add_argument("--rounds", type=int, default=3)
    arguments.add_argument("--size", default="512x384")
    arguments.add_argument("--out", type=pathlib.Path, default=ROOT / "out/peers/transparency")
    given = arguments.parse_args()
    peers = given.peers.split(",")
    if unknown := set(peers) - {*PYTHON, *NODE}:
        arguments.error(f"no peer is called {', '.join(sorted(unknown))}; there are {', '.join([*PYTHON, *NODE])}")
    out = given.out.resolve()
    out.mkdir(parents=True, exist_ok=True)
    # Pictures of an earlier run would be compared with this one's.
    for picture in out.glob("*.npy"):
        picture.unlink()
    write_scene(out, given.meshes, given.size, given.frames)
    times, answers, failed = {}, {}, {}
    for round_ in range(given.rounds):
        for program in ["peelnet", *peers]:
            # A reference, whose time is not compared.
            if program == "mitsuba" and round_ > 0:
                continue
            try:
                answer = draw_ours(out, given.size, given.frames) if program == "peelnet" else draw_peer(program, out)
            except (RuntimeError, subprocess.SubprocessError, OSError, ValueError, IndexError) as error:
                if program == "peelnet":
                    raise
                failed[program] = error
                print(error, file=sys.stderr)
                continue
            answers[program] = answer
            for method, ms in answer["times"].items():
                times.setdefault((program, method), []).append(ms)
        # Not again in the next round.
        peers = [peer for peer in peers if peer not in failed]
    for method in answers["peelnet"]["times"]:
        peelnet("render", out / "scene.toml", "--method", method, "--size", given.size, "--out", out / f"peelnet-{method}.npy")
    peelnet("render", out / "opaque.toml", "--size", given.size, "--out", out / "peelnet-opaque.npy")
    compared = run(python_for(None, out), HERE / "transparency_compare.py", out, capture_output=True, text=True).stdout
    text = table(given, times, answers, failed, json.loads(compared))
    (out / "transparency.md").write_text(text)
    print(text)


def table(given, times, answers, failed, differences):
    lines = [
        "| program | method | frame time, ms | / our abuffer | bytes a pixel | differs from our exact image, /255, away from silhouettes: most (mean) | by more than 2/255 | MSE, whole frame |",
        "|---|---|---:|---:|---:|---:|---:|---:|",
    ]
    reference = statistics.median(times["peelnet", "abuffer"])
    for (program, method), all_ms in times.items():
        answer, ms = answers[program], statistics.median(all_ms)
        found = differences[f"{program}-{method.replace(' ', '-')}"]
        # Times of another rasteriser say nothing about ours.
        ratio = f"{ms / reference:.2f}" if "llvmpipe" in answer["adapter"] else "–"
        size = answer["bytes"].get(method) if program == "peelnet" else BYTES.get((program, method))
        lines.append(f"| {program} {answer.get('version', '')} | {method} | {ms:.1f} | {ratio} | {'–' if size is None else f'{size:.0f}'} "
                     f"| {found['most']:.2f} ({found['mean']:.3f}) | {found['over']:.1%} | {found['mse']:.2e} |")
    lines += ["", "Drawn opaque, pixels away from silhouettes that differ from ours by more than 2/255: "
              + "; ".join(f"{peer} {differences[f'{peer}-opaque']['over']:.2%}" for peer in answers if f"{peer}-opaque" in differences and peer != "peelnet") + "."]
    if noise := differences.get("noise"):
        lines += ["", "Our exact image and Mitsuba's, away from silhouettes, linear: they differ by {rms:.5f} (root of the mean square), the noise of Mitsuba's own is "
                  "{own:.5f}; the mean square beyond that noise is {beyond:.1e} ± {beyond_deviation:.1e}; the mean difference is {mean:.1e} ± "
                  "{mean_deviation:.1e} (one standard deviation).".format(**noise)]
    lines += [f"\n{peer} is left out: {str(error).splitlines()[0]}" for peer, error in failed.items()]
    cpu = next((line.split(":")[1].strip() for line in open("/proc/cpuinfo") if line.startswith("model name")), "") \
        if os.path.exists("/proc/cpuinfo") else platform.processor()
    lines += ["", f"{given.meshes} meshes, {given.size}, {given.rounds} rounds of {given.frames} frames in turn. {differences['share']:.0%} of the pixels "
              f"lie away from silhouettes. Machine: {cpu}, {os.cpu_count()} cores, load {os.getloadavg()[2]:.1f}; "
              + "; ".join(f"{program} drew with {answer['adapter']}" for program, answer in answers.items())
              + ". Command: `python3 " + " ".join(["benches/peers/transparency.py", *sys.argv[1:]]) + "`."]
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    main()
