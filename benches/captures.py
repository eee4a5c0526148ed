"""`cargo xtask captures`: Gaussian splats captured by others, fetched from GitHub, with scenes of them, alone and with two panes among them.

Nothing of it is committed. Addresses name a commit, so what lies there cannot change; that a file is whole shows by its count of splats. Without a
network, put the files into out/captures by hand.
"""

import gzip
import re
import sys
import urllib.request
from pathlib import Path

# git ignores it.
FOLDER = Path("out/captures")
PLAYCANVAS = "https://raw.githubusercontent.com/playcanvas/engine"
# Name here: address, splats (None where we have not seen the file), whose it is and what is allowed, whether y is downwards.
SOURCES = {
    "biker": (
        f"{PLAYCANVAS}/800c7b588dd99f09f156b0b1ef50f50be07f8004/examples/assets/splats/biker.compressed.ply",
        152_746, "PlayCanvas, an example of its engine: MIT", True,
    ),
    "guitar": (
        f"{PLAYCANVAS}/b1f0b7d39e4607c23604a3f545a62a199843d9f4/examples/assets/splats/guitar.compressed.ply",
        None, "PlayCanvas, an example of its engine: MIT", True,
    ),
    "racoons": (
        "https://raw.githubusercontent.com/nianticlabs/spz/cc5671d716740e02d57816d4a4a38d164926e695/samples/racoonfamily.spz",
        932_560, "Niantic Labs, a sample of its format: MIT", False,
    ),
}  # fmt: skip

PANES = """
[[object]]
name = "red pane"
mesh = { shape = "quad", size = [1.6, 1.2] }
rotate = [0.0, 35.0, 0.0]
material = { color = [0.8, 0.08, 0.03], alpha = 0.5 }

[[object]]
name = "blue pane"
mesh = { shape = "quad", size = [1.6, 1.2] }
rotate = [0.0, -40.0, 10.0]
material = { color = [0.03, 0.2, 0.8], alpha = 0.35 }
"""


def fetch(address):
    """The file, fetched if it is not there."""
    file = FOLDER / address.rsplit("/", 1)[1]
    if not file.exists():
        part = file.with_name(file.name + ".part")
        try:
            with urllib.request.urlopen(address, timeout=60) as answer:
                part.write_bytes(answer.read())
        except OSError as error:
            sys.exit(f"error: {address}: {error}; without a network, put the file into {FOLDER} yourself")
        part.rename(file)
    return file


def count(file):
    """How many splats its header names."""
    if file.suffix == ".spz":
        with gzip.open(file) as content:
            return int.from_bytes(content.read(12)[8:], "little")
    with open(file, "rb") as content:
        return int(re.search(rb"element vertex (\d+)", content.read(4096))[1])


def scene(name, file, what, is_down, panes):
    turned = "rotate = [180.0, 0.0, 0.0]\n" if is_down else ""
    return f"""# {what}; fetched by `cargo xtask captures`.
name = "{name}"
held_out = true        # never trained on

[camera]
position = [0.0, 0.5, 2.4]
target = [0.0, 0.0, 0.0]
fov_y = 45.0
near = 0.05
far = 30.0

[orbit]
views = 4

[[object]]
name = "capture"
mesh = "{file.name}"
fit = 2.0
{turned}{panes}"""


def main():
    FOLDER.mkdir(parents=True, exist_ok=True)
    for name, (address, splats, what, is_down) in SOURCES.items():
        file = fetch(address)
        try:
            found = count(file)
        except (OSError, EOFError, TypeError) as error:
            sys.exit(f"error: {file}: no file of splats ({error}); delete it to fetch it again")
        if splats and found != splats:
            sys.exit(f"error: {file}: {found} splats, not {splats}: it is not the file that was chosen; delete it to fetch it again")
        for suffix, panes in (("", ""), ("-panes", PANES)):
            (FOLDER / f"{name}{suffix}.toml").write_text(scene(name + suffix, file, what, is_down, panes))
        print(f"{file}: {found} splats; {what}")
    print(
        f"\nAs docs/splats.md measures its own: peelnet bench {FOLDER}/*.toml --size 256x192 --methods abuffer,painter-triangle,mboit4,splat "
        "--out out/bench-captures"
    )


main()
