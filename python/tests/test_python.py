"""What makes it a good Python package: errors, Ctrl-C, types, import time."""

import os
import pickle
import re
import signal
import subprocess
import sys
import textwrap
import time
from pathlib import Path

import peelnet
import pytest

PYTHON = sys.executable


def line(done) -> str:
    """The error of a command, without its flags' hint."""
    text = done.stderr.strip().splitlines()[-1]
    return re.sub(r" \([^()]*--[^()]*\)$", "", text.removeprefix("error: "))


@pytest.mark.parametrize(
    ("arguments", "call", "kind"),
    [
        (["render", "no-such-scene"], lambda: peelnet.render("no-such-scene"), peelnet.PeelnetError),
        (["render", "a/b.toml"], lambda: peelnet.render("a/b.toml"), peelnet.PeelnetError),
        (["extract", "cups", "cups"], lambda: peelnet.extract(["cups", "cups"]), ValueError),
        (["extract", "cups", "--views", "9"], lambda: peelnet.extract("cups", views=9), ValueError),
        (["render", "cups", "--adapter", "nobody's"], lambda: peelnet.render("cups", adapter="nobody's"), ValueError),
        (["train", "nowhere"], lambda: peelnet.train("nowhere"), peelnet.PeelnetError),
        (["export", "nothing.safetensors"], lambda: peelnet.export("nothing.safetensors"), peelnet.PeelnetError),
    ],
)
def test_errors_have_the_command_s_texts(command, tmp_path, arguments, call, kind):
    out = {"render": "a.png", "extract": "d", "train": "m.safetensors", "export": "w.wgsl"}[arguments[0]]
    done = command(*arguments, "--out", tmp_path / out, check=False)
    with pytest.raises(kind) as raised:
        call()
    assert str(raised.value) == line(done)
    assert done.returncode == (2 if kind is ValueError else 1)


@pytest.mark.parametrize(
    ("call", "text"),
    [
        (lambda: peelnet.render("cups", "mboit5"), "mboit5"),
        (lambda: peelnet.render("cups", size=(0, 4)), "a frame needs at least 1x1 pixels"),
        (lambda: peelnet.render("cups", samples=2), "a pixel has 1 or 4 samples, not '2'"),
        (lambda: peelnet.render("cups", view=9), "view 9: cups has 3 views, numbered from 0"),
        (lambda: peelnet.render("cups", dtype="int8"), "dtype 'int8': there are float32 and uint8"),
        (lambda: peelnet.extract("cups", pixels=2), "2 is not a fraction of the pixels"),
        (lambda: peelnet.extract("cups", format="xls", out="x"), "xls"),
        (lambda: peelnet.extract("cups", shard="3/2"), "3/2"),
        (lambda: peelnet.extract("cups", peel="apple"), "'apple' is not one of sbuffer, dual, single"),
        (lambda: peelnet.extract([]), "no scene to extract"),
        (lambda: peelnet.train("d", recipe="cake"), "cake"),
        (lambda: peelnet.train("d", epochs=0), "epochs"),
        (lambda: peelnet.train("d", resume=True), "resume needs out"),
        (lambda: peelnet.export(peelnet.Model.shipped("small"), "cobol"), "language 'cobol'"),
        (lambda: peelnet.recommend("cups", budget_ms=-1), "budget_ms is not a number above 0"),
    ],
)
def test_wrong_values_are_value_errors(call, text):
    with pytest.raises(ValueError, match=re.escape(text)):
        call()


@pytest.mark.parametrize(
    ("call", "text"),
    [
        (lambda: peelnet.render(3), "a scene is a Scene, a path"),
        (lambda: peelnet.extract("cups", progress=3), "progress needs update"),
        (lambda: peelnet.train(peelnet.extract("cups", size=(8, 8))), "extract(…, out=folder) makes one"),
        (lambda: peelnet.export(3), "a model is a Model or the path of its file"),
    ],
)
def test_wrong_kinds_are_type_errors(call, text):
    with pytest.raises(TypeError, match=re.escape(text)):
        call()


def test_nothing_of_a_name_reaches_a_terminal():
    for call in (lambda: peelnet.Scene("a\x1b[31m\nb.toml"), lambda: peelnet.render("cups", dtype="a\x1b[31m")):
        with pytest.raises((peelnet.PeelnetError, ValueError)) as raised:
            call()
        assert str(raised.value).isprintable(), repr(str(raised.value))


def interrupted(tmp_path, code, after="begun", seconds=1.0) -> tuple[str, float]:
    """Runs code, presses Ctrl-C some time after it printed a word; what it printed, and how long it took to end."""
    program = "import peelnet, sys\n" + textwrap.dedent(code)
    process = subprocess.Popen(
        [PYTHON, "-c", program], cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, start_new_session=True
    )
    try:
        assert process.stdout.readline().strip() == after
        time.sleep(seconds)
        process.send_signal(signal.SIGINT)
        pressed = time.perf_counter()
        out, _ = process.communicate(timeout=60)
        return out, time.perf_counter() - pressed
    finally:
        if process.poll() is None:
            process.kill()


def test_ctrl_c_ends_an_extraction_and_keeps_whole_parts(tmp_path):
    out, seconds = interrupted(
        tmp_path,
        """
        scenes = [s for s in peelnet.samples() if s.startswith("sixteen")]
        print("begun", flush=True)
        try:
            peelnet.extract(scenes, size=(1024, 768), out="d")
        except KeyboardInterrupt:
            print("interrupted")
        """,
    )
    assert out.strip() == "interrupted", out
    assert seconds < 10, seconds
    out = tmp_path / "d"
    records = sorted(p.stem for p in (out / "_peelnet" / "parts").glob("*"))
    parts = sorted(p.name.split("-")[1] for p in out.glob("*.parquet"))
    assert parts == records
    left = {str(p.relative_to(out)) for p in out.rglob("*") if p.is_file() and p.suffix != ".parquet"}
    assert left <= {"_peelnet/plan.json", *(f"_peelnet/parts/{n}.json" for n in records)}
    # Nothing stays where not even the first part was finished, as on a busy machine.
    with pytest.raises(peelnet.PeelnetError, match="missing" if records else "no such dataset"):
        peelnet.seal(out)


def test_ctrl_c_ends_a_training_and_keeps_its_checkpoint(tmp_path, folder):
    out, seconds = interrupted(
        tmp_path,
        f"""
        def each(epoch):
            if epoch.epoch == 1:
                print("begun", flush=True)
        try:
            peelnet.train({str(folder)!r}, recipe="small", epochs=100000, out="m.safetensors", callback=each)
        except KeyboardInterrupt:
            print("interrupted")
        """,
    )
    assert out.strip() == "interrupted", out
    assert seconds < 10, seconds
    left = sorted(p.name for p in tmp_path.rglob("*") if p.is_file())
    assert "m.safetensors" not in left and not [n for n in left if n.endswith((".lock", ".tmp"))], left
    assert "state.safetensors" in left


def test_import_is_quick_and_lazy(record_property, capsys):
    code = "import time; t = time.perf_counter(); import peelnet; print(time.perf_counter() - t); import sys; print(*sys.modules)"
    times = []
    for _ in range(3):
        seconds, modules = subprocess.run([PYTHON, "-c", code], capture_output=True, text=True, check=True).stdout.splitlines()
        times.append(float(seconds))
    heavy = {"numpy", "pandas", "pyarrow", "torch", "ray", "tqdm", "polars"} & set(modules.split())
    assert not heavy, heavy
    record_property("import_seconds", min(times))
    with capsys.disabled():
        print(f"\nimport peelnet: {min(times):.3f} s (best of three)")


def test_stubs_are_what_is_there(tmp_path):
    pytest.importorskip("mypy")
    allowed = tmp_path / "allowed"
    # What every extension class has, and types are not asked about.
    allowed.write_text("peelnet._native.__all__\npeelnet._native.Model.__getstate__\npeelnet.ray.*\n")
    done = subprocess.run(
        [PYTHON, "-m", "mypy.stubtest", "peelnet._native", "--allowlist", str(allowed), "--ignore-unused-allowlist"],
        capture_output=True, text=True, cwd=tmp_path, check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr


def test_everything_public_says_what_it_is():
    for name in peelnet.__all__:
        thing = getattr(peelnet, name)
        assert name == "__version__" or (thing.__doc__ and len(thing.__doc__) > 20), name
    for function in (peelnet.render, peelnet.extract, peelnet.train, peelnet.export, peelnet.bench, peelnet.recommend):
        import inspect

        for parameter in inspect.signature(function).parameters:
            assert re.search(rf"^\s+{parameter}: ", function.__doc__, re.M), f"{function.__name__}: {parameter}"
