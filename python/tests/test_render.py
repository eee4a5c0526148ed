"""Pictures are those of the command."""

import numpy as np
import peelnet
import pytest

from conftest import ROOT, SIZE


SPLATS = ROOT / "data/splats/cloud-cards.toml"


@pytest.mark.parametrize(
    "scene, method",
    [("cups", "abuffer"), ("cups", "mboit4"), ("cups", "deep-medium"), ("cups", "wboit-eq9:targets=f16"), (SPLATS, "splat")],
)
def test_the_picture_is_the_command_s(command, tmp_path, scene, method):
    path = tmp_path / "a.npy"
    command("render", scene, "--method", method, "--size", "64x48", "--view", 1, "--out", path)
    image = peelnet.render(scene, method, size=SIZE, view=1)
    assert image.dtype == np.float32 and image.shape == (48, 64, 4)
    np.testing.assert_array_equal(image, np.load(path))
    assert image[..., 3].max() > 0.1, "nothing is covered"


def test_bytes_are_srgb_as_in_the_png(command, tmp_path):
    matplotlib = pytest.importorskip("matplotlib.image")
    path = tmp_path / "a.png"
    command("render", "cups", "--size", "64x48", "--out", path)
    image = peelnet.render("cups", size=SIZE, dtype="uint8")
    assert image.dtype == np.uint8
    png = np.round(matplotlib.imread(path)[..., :3] * 255).astype(np.uint8)
    np.testing.assert_array_equal(image[..., :3], png)
    linear = peelnet.render("cups", size=SIZE)
    np.testing.assert_array_equal(image[..., 3], np.round(linear[..., 3] * 255).astype(np.uint8))


def test_a_camera_draws_what_its_view_draws():
    scene = peelnet.Scene("cups")
    a = peelnet.render(scene, size=SIZE, view=2)
    b = peelnet.render(scene, size=SIZE, camera=scene.views[2])
    np.testing.assert_array_equal(a, b)
    turned = scene.views[2].orbited(40)
    assert (peelnet.render(scene, size=SIZE, camera=turned) != a).any()
    made = peelnet.Camera(turned.position, turned.target, up=turned.up, near=turned.near, far=turned.far)
    assert made.position == turned.position
    with pytest.raises(ValueError, match="near"):
        peelnet.Camera((0, 0, 1), (0, 0, 0), near=2, far=1)


def test_scenes_come_from_paths_names_and_bytes(tmp_path):
    files = {
        "pane.obj": b"v -1 -1 0\nv 1 -1 0\nv 0 1 0\nf 1 2 3",
    }
    text = b"""
[camera]
position = [0, 0, 4]
target = [0, 0, 0]
near = 0.1
far = 100
[[object]]
mesh = 'pane.obj'
material = { color = [1.0, 0.2, 0.1], alpha = 0.5 }
"""
    (tmp_path / "room.toml").write_bytes(text)
    (tmp_path / "pane.obj").write_bytes(files["pane.obj"])
    on_disk = peelnet.Scene(tmp_path / "room.toml")
    in_memory = peelnet.Scene.from_bytes("room.toml", text, files=files)
    assert on_disk.triangles == in_memory.triangles == 1
    a, b = (peelnet.render(s, size=SIZE) for s in (on_disk, in_memory))
    np.testing.assert_array_equal(a, b)
    assert a[..., 3].max() == pytest.approx(0.5, abs=1e-3)
    with pytest.raises(peelnet.PeelnetError, match="pane.obj"):
        peelnet.Scene.from_bytes("room.toml", text)


def test_samples_load_and_time_moves_a_timeline():
    assert {"cups", "sixteen-050"} <= set(peelnet.samples())
    vase = peelnet.Scene("vase")
    first, last = vase.timeline[0], vase.timeline[-1]
    a = peelnet.render(vase, size=SIZE, time=first)
    b = peelnet.render(vase, size=SIZE, time=last)
    assert (a != b).any()
    np.testing.assert_array_equal(peelnet.render(vase.at(last), size=SIZE), b)


def test_the_gil_is_free_while_drawing():
    import threading
    import time

    beats, done = [], threading.Event()

    def beat():
        while not done.is_set():
            beats.append(time.perf_counter())
            time.sleep(0.002)

    other = threading.Thread(target=beat)
    other.start()
    begun = time.perf_counter()
    peelnet.render("sixteen-050", size=(512, 384), samples=4)
    seconds = time.perf_counter() - begun
    done.set()
    other.join()
    longest = max(b - a for a, b in zip(beats, beats[1:]))
    assert longest < max(0.5 * seconds, 0.05), f"another thread waited {longest:.3f} s of {seconds:.3f} s"


def test_every_method_that_is_listed_has_a_name_that_parses():
    names = peelnet.methods()
    assert {"abuffer", "mboit4", "deep-medium"} <= set(names)
    for name in names:
        # A scene that is not there is found after the method's name.
        with pytest.raises(peelnet.PeelnetError, match="no-such-scene"):
            peelnet.render("no-such-scene", name)
