"""What the tests share: a small size, the command's binary, a dataset."""

import os
import shutil
import subprocess
from pathlib import Path

import peelnet
import pytest

ROOT = Path(__file__).resolve().parents[2]
SIZE = (64, 48)


def _binary() -> str | None:
    named = os.environ.get("PEELNET")
    if named:
        return named
    built = [ROOT / "target" / kind / "peelnet" for kind in ("release", "debug")]
    return next((str(b) for b in built if b.is_file()), shutil.which("peelnet"))


@pytest.fixture(scope="session")
def command():
    """Runs the command `peelnet` with arguments."""
    binary = _binary()
    if binary is None:
        pytest.skip("no binary: cargo build, or PEELNET=/path/to/peelnet")

    def run(*arguments, check=True):
        done = subprocess.run([binary, *map(str, arguments)], capture_output=True, text=True, check=False)
        assert not check or done.returncode == 0, done.stderr
        return done

    return run


@pytest.fixture(scope="session")
def folder(tmp_path_factory) -> Path:
    """A dataset of two small scenes."""
    out = tmp_path_factory.mktemp("data") / "rows"
    peelnet.extract(["cups", "panes"], size=SIZE, out=out)
    return out


@pytest.fixture(scope="session")
def rows() -> peelnet.Rows:
    """The same rows in memory."""
    return peelnet.extract(["cups", "panes"], size=SIZE)


class Bar:
    """The least of the tqdm protocol."""

    def __init__(self):
        self.total = None
        self.n = 0
        self.closed = 0

    def update(self, n):
        self.n += n

    def close(self):
        self.closed += 1


@pytest.fixture
def bar() -> Bar:
    return Bar()
