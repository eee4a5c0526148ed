#!/usr/bin/env python3
"""Drives the viewer's window as people do, and compares what it shows.

    python3 benches/window.py [--binary target/release/peelnet] [--out out/window]

Needs a program built with `--features view`, and Xvfb, xdotool and ImageMagick (`import`, `convert`). Opens a display of its own. First the
picture of `peelnet view --bare --screenshot` is compared with that of `peelnet render`, for several methods and scenes. Then a window is
driven with pointer and keys: orbit, method, comparison, divider, pixel, timeline, bad files. Screenshots stay in --out, numbered. Ends with
a line for each check, and with exit code 1 where one fails.
"""

import argparse
import os
import pathlib
import shutil
import subprocess
import sys
import threading
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
SIZE = (1280, 800)
# The display is higher than the window: below it files lie, to be dragged.
SHELF = 100
# Pictures are blended in 16-bit targets and files in 32 bits: a value at the border of two levels may fall to either side.
LEVELS = 1
# How long anything may take, seconds: a software rasteriser on a busy machine.
PATIENCE = 120
# Buttons: kinds of comparison, and the one that measures all methods, where errors of the view are listed above it.
ONE, ERROR_MAP, MEASURE = (43, 170), (62, 193), (1036, 576)
PICTURES = [
    ("cups", "abuffer"),
    ("cups", "mboit4"),
    ("cups", "deep-medium"),
    ("boxes-held", "deep-large"),
    ("foliage", "deep-small"),
    ("vase", "kbuffer-4"),
]


def pixels(path):
    """Width, height and RGB bytes of a picture."""
    size = subprocess.run(["identify", "-format", "%w %h", path], capture_output=True, text=True, check=True).stdout
    width, height = map(int, size.split())
    rgb = subprocess.run(["convert", path, "-depth", "8", "rgb:-"], capture_output=True, check=True).stdout
    return width, height, rgb


class Display:
    """A display of its own, that nobody sees."""

    def __init__(self):
        number = next(n for n in range(90, 200) if not pathlib.Path(f"/tmp/.X11-unix/X{n}").exists())
        self.name = f":{number}"
        # Without a reset when the last window closes, during which no other can connect.
        screen = f"{SIZE[0]}x{SIZE[1] + SHELF}x24"
        self.process = subprocess.Popen(["Xvfb", self.name, "-noreset", "-screen", "0", screen], stderr=subprocess.DEVNULL)
        for _ in range(100):
            if pathlib.Path(f"/tmp/.X11-unix/X{number}").exists():
                break
            time.sleep(0.05)
        self.environment = {**os.environ, "DISPLAY": self.name}
        self.environment.pop("WAYLAND_DISPLAY", None)

    def run(self, *command, **options):
        return subprocess.run(command, env=self.environment, capture_output=True, text=True, timeout=PATIENCE, **options)

    def close(self):
        self.process.terminate()
        self.process.wait()


class Window:
    """The viewer in that display, at its upper left corner."""

    def __init__(self, display, binary, out, home, *arguments):
        self.display, self.out, self.shots = display, out, 0
        environment = {**display.environment, "XDG_DATA_HOME": str(home)}
        self.process = subprocess.Popen(
            [binary, "view", "--size", f"{SIZE[0]}x{SIZE[1]}", *arguments],
            env=environment,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
        )
        begin = time.monotonic()
        while True:
            found = display.run("xdotool", "search", "--onlyvisible", "--name", "^peelnet$").stdout.split()
            if found:
                break
            if self.process.poll() is not None or time.monotonic() - begin > PATIENCE:
                raise SystemExit(f"no window: {self.process.stderr.read().decode()}")
            time.sleep(0.1)
        self.window = found[0]
        display.run("xdotool", "windowmove", self.window, "0", "0")
        display.run("xdotool", "windowfocus", self.window)
        self.last = self.rest("opened")

    def shot(self, name):
        path = self.out / f"{self.shots:02}-{name}.png"
        self.display.run("import", "-window", "root", "-crop", "%dx%d+0+0" % SIZE, "+repage", str(path), check=True)
        return path

    def rest(self, name):
        """A screenshot once nothing moves any more: a busy machine may take seconds to the first change."""
        begin, before = time.monotonic(), None
        time.sleep(1.5)
        while time.monotonic() - begin < PATIENCE:
            path = self.shot(name)
            now = pixels(path)
            if now == before:
                self.shots += 1
                self.last = now
                return now
            before = now
            time.sleep(1.5)
        raise SystemExit(f"{name}: the window never rests")

    def key(self, *keys):
        self.display.run("xdotool", "key", *keys)

    def drag(self, start, end, button=1):
        steps = [f"{start[0] + (end[0] - start[0]) * k // 8} {start[1] + (end[1] - start[1]) * k // 8}" for k in range(9)]
        self.display.run("xdotool", "mousemove", *steps[0].split())
        time.sleep(0.2)
        self.display.run("xdotool", "mousedown", str(button))
        for step in steps[1:]:
            time.sleep(0.1)
            self.display.run("xdotool", "mousemove", *step.split())
        time.sleep(0.2)
        self.display.run("xdotool", "mouseup", str(button))

    def click(self, place):
        self.display.run("xdotool", "mousemove", str(place[0]), str(place[1]))
        time.sleep(0.2)
        self.display.run("xdotool", "click", "1")

    def close(self):
        self.process.terminate()
        self.process.wait()


# A window that offers a file to whoever it is dragged to, as file managers do.
SOURCE = """
import pathlib, sys
import gi
gi.require_version("Gtk", "3.0")
from gi.repository import Gdk, Gtk
window = Gtk.Window(title="source")
window.set_default_size(200, 60)
label = Gtk.EventBox()
label.add(Gtk.Label(label="drag me"))
label.drag_source_set(Gdk.ModifierType.BUTTON1_MASK, [], Gdk.DragAction.COPY)
label.drag_source_add_uri_targets()
uri = pathlib.Path(sys.argv[1]).resolve().as_uri()
label.connect("drag-data-get", lambda _w, _c, data, _i, _t: data.set_uris([uri]))
window.add(label)
window.show_all()
Gtk.main()
"""


def drop(window, path):
    """Drags a file onto the window with the pointer."""
    display = window.display
    # Debian's own Python: it has GTK's bindings.
    source = subprocess.Popen(["/usr/bin/python3", "-c", SOURCE, str(path)], env=display.environment, stderr=subprocess.PIPE)
    found, begin = [], time.monotonic()
    while not found:
        found = display.run("xdotool", "search", "--onlyvisible", "--name", "^source$").stdout.split()
        if source.poll() is not None or time.monotonic() - begin > PATIENCE:
            raise SystemExit(f"nothing to drag (python3-gi and gir1.2-gtk-3.0 are needed): {source.stderr.read().decode()}")
        time.sleep(0.1)
    display.run("xdotool", "windowmove", found[0], "20", str(SIZE[1] + 20))
    time.sleep(0.5)
    window.drag((80, SIZE[1] + 50), (640, 400))
    time.sleep(0.5)
    source.terminate()
    source.wait()


class Checks:
    def __init__(self):
        self.failed = 0

    def say(self, holds, text):
        print(f"{'ok    ' if holds else 'FAILED'} {text}", flush=True)
        self.failed += not holds


def differs(a, b, box):
    """Pixels that differ inside of a box: left, top, right, bottom."""
    (width, _, x), (_, _, y) = a, b
    left, top, right, bottom = box
    count = 0
    for row in range(top, bottom):
        begin, end = 3 * (row * width + left), 3 * (row * width + right)
        if x[begin:end] != y[begin:end]:
            count += sum(x[k : k + 3] != y[k : k + 3] for k in range(begin, end, 3))
    return count


def pictures(checks, display, binary, out, home):
    for scene, method in PICTURES:
        shot, file = out / f"{scene}-{method}-window.png", out / f"{scene}-{method}-file.png"
        size = ["--size", "640x480", "--method", method]
        environment = {**display.environment, "XDG_DATA_HOME": str(home)}
        command = [binary, "view", scene, *size, "--bare", "--frames", "2", "--screenshot", str(shot)]
        done = subprocess.run(command, env=environment, timeout=PATIENCE, capture_output=True, text=True)
        if done.returncode != 0:
            checks.say(False, f"{scene} with {method}: {done.stderr.strip()}")
            continue
        subprocess.run([binary, "render", scene, *size, "--out", str(file)], check=True, capture_output=True)
        (w, h, a), (_, _, b) = pixels(shot), pixels(file)
        worst = max(abs(x - y) for x, y in zip(a, b, strict=True))
        checks.say((w, h) == (640, 480) and worst <= LEVELS, f"{scene} with {method}: at most {worst} of 255 from the file")


def interactions(checks, display, binary, out, home):
    # The picture between the panels, and a place in it away from the divider.
    inner = (400, 100, 880, 700)
    w = Window(display, binary, out, home, "cups", "--method", "wboit-eq9")
    before = w.last
    w.drag((640, 400), (720, 430))
    after = w.rest("orbited")
    checks.say(differs(before, after, inner) > 1000, "a drag orbits")
    w.key("1")
    back = w.rest("view-0")
    checks.say(differs(before, back, inner) == 0, "1 goes back to the scene's first view")
    w.key("m")
    other = w.rest("next-method")
    checks.say(differs(back, other, inner) > 1000, "M draws with the next method")
    w.key("shift+m")
    w.rest("method-before")
    w.key("c")
    split = w.rest("split")
    left, right = (400, 100, 590, 700), (680, 100, 880, 700)
    checks.say(differs(back, split, left) == 0, "split: the method is left of the divider")
    checks.say(differs(back, split, right) > 100, "split: another is right of it")
    middle = divider_of(split)
    w.drag((middle, 600), (middle - 150, 600))
    moved = w.rest("divider")
    checks.say(abs(divider_of(moved) - (middle - 150)) <= 2, "the divider follows the pointer")
    w.click((700, 450))
    pixel = w.rest("pixel")
    checks.say(differs(moved, pixel, (960, 430, 1270, 790)) > 300, "a click lists the pixel's fragments")
    for name in ["beside", "flicker", "error", "layers"]:
        w.key("c")
        if name == "flicker":
            # It never rests.
            time.sleep(1.5)
            w.shot(name)
            w.shots += 1
            continue
        shown = w.rest(name)
        checks.say(differs(pixel, shown, inner) > 1000, f"C shows the next comparison: {name}")
    w.key("Tab")
    bare = w.rest("bare")
    checks.say(differs(shown, bare, (0, 0, 250, 799)) > 1000, "Tab hides the panels")
    checks.say(w.process.poll() is None, "the window is still open")
    w.close()
    w = Window(display, binary, out, home, "vase", "--method", "wboit-eq9")
    before = w.last
    w.key("space")
    time.sleep(3)
    w.key("space")
    after = w.rest("played")
    checks.say(differs(before, after, inner) > 300, "Space plays the timeline")
    w.close()
    bad = out / "bad.glb"
    bad.write_text("no mesh")
    w = Window(display, binary, out, home, str(bad))
    checks.say(w.process.poll() is None, "a file that is none is a message in the window")
    before = w.last
    drop(w, ROOT / "data/scenes/cups.toml")
    opened = w.rest("dropped")
    checks.say(differs(before, opened, inner) > 1000, "a dropped scene opens")
    drop(w, bad)
    after = w.rest("dropped-bad")
    checks.say(differs(opened, after, inner) == 0, "a dropped file that is none leaves the view")
    checks.say(differs(opened, after, (0, 0, *SIZE)) > 100, "and is a message")
    w.close()


class Film:
    """Numbered screenshots while something else goes on."""

    def __init__(self, display, folder):
        self.display, self.folder, self.ended = display, folder, threading.Event()
        folder.mkdir(parents=True)
        self.thread = threading.Thread(target=self.run)
        self.thread.start()

    def run(self):
        number = 0
        while not self.ended.wait(0.4):
            path = str(self.folder / f"{number:05}.png")
            self.display.run("import", "-window", "root", "-crop", "%dx%d+0+0" % SIZE, "+repage", path)
            number += 1

    def close(self):
        self.ended.set()
        self.thread.join()


def film(display, binary, out, home):
    """One use from a dropped scene to a chosen method, as numbered frames."""
    w = Window(display, binary, out, home, "cups", "--method", "wboit-eq9")
    recorder = Film(display, out / "film")
    try:
        drop(w, ROOT / "data/effects/vase.toml")
        w.rest("film-dropped")
        w.drag((640, 400), (760, 430))
        w.rest("film-orbited")
        w.key("c")
        split = w.rest("film-split")
        w.drag((divider_of(split), 600), (divider_of(split) - 150, 600))
        w.rest("film-divider")
        w.click(ERROR_MAP)
        w.rest("film-error-map")
        w.click(ONE)
        w.rest("film-one")
        w.key("space")
        time.sleep(6)
        w.key("space")
        w.rest("film-timeline")
        w.click(MEASURE)
        # Sixty methods and settings, one after the other.
        time.sleep(PATIENCE)
    finally:
        recorder.close()
        w.close()


def divider_of(shot):
    """The column of the white line: the brightest of the lower rows, where the scene's background is not white."""
    width, _, rgb = shot
    brightness = lambda x: sum(min(rgb[3 * (y * width + x) : 3 * (y * width + x) + 3]) for y in range(700, 780))
    return max(range(310, 930), key=brightness)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--binary", default=str(ROOT / "target/release/peelnet"))
    parser.add_argument("--out", default=str(ROOT / "out/window"), type=pathlib.Path)
    parser.add_argument("--film", action="store_true", help="record one use as numbered frames in OUT/film, and check nothing")
    options = parser.parse_args()
    for tool in ["Xvfb", "xdotool", "import", "convert"]:
        if shutil.which(tool) is None:
            raise SystemExit(f"{tool} is missing; install xvfb, xdotool and imagemagick")
    shutil.rmtree(options.out, ignore_errors=True)
    options.out.mkdir(parents=True)
    # Of its own: what people's windows remember stays as it is. The name must be absolute.
    home = (options.out / "home").resolve()
    display, checks = Display(), Checks()
    try:
        if options.film:
            film(display, options.binary, options.out, home)
            return 0
        pictures(checks, display, options.binary, options.out, home)
        interactions(checks, display, options.binary, options.out, home)
    finally:
        display.close()
    print(f"screenshots: {options.out}")
    return 1 if checks.failed else 0


if __name__ == "__main__":
    sys.exit(main())
