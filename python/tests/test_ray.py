"""Extraction, reading and tuning on Ray, in a network namespace of its own."""

import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import peelnet
import pytest

pytestmark = pytest.mark.ray
pytest.importorskip("ray", reason="pip install ./python[ray]")

NAMESPACE = ["unshare", "--map-root-user", "--net", "sh", "-c", 'ip link set lo up && exec "$0" "$@"']
SCRIPT = Path(__file__).with_name("in_namespace.py")


def there() -> bool:
    tools = shutil.which("unshare") and shutil.which("ip")
    return bool(tools) and subprocess.run([*NAMESPACE, "true"], capture_output=True, check=False).returncode == 0


@pytest.fixture
def ray_does():
    if not there():
        pytest.skip("no network namespaces here")

    def run(what, folder) -> dict:
        done = subprocess.run(
            [*NAMESPACE, sys.executable, str(SCRIPT), what, str(folder)],
            capture_output=True, text=True, timeout=300, check=False,
            env={**os.environ, "RAY_USAGE_STATS_ENABLED": "0"},
        )
        assert done.returncode == 0, done.stdout + done.stderr
        return json.loads(done.stdout.strip().splitlines()[-1])

    return run


def test_a_cluster_extracts_what_one_process_does(ray_does, folder, tmp_path):
    said = ray_does("extract", tmp_path)
    assert said["hash"] == peelnet.Dataset(folder).hash == peelnet.Dataset(tmp_path / "d").hash
    assert said["bar"] == [3, 3, 1]
    assert re.match(r"shard [12]/2 on node [0-9.]+, process \d+: .*no-such-scene", said["error"]), said["error"]
    assert "7 is not a fraction of the pixels" in said["wrong"]
    assert said["there"], "Ray was started for the call, and is gone after it"


def test_ray_data_reads_the_folder(ray_does, folder, rows):
    columns = rows.to_numpy(["view", "transmittance"])
    total = float(columns["transmittance"].astype(np.float64).sum())
    said = ray_does("read", folder)
    assert said == {"rows": len(rows), "sum": pytest.approx(total, rel=1e-4), "views": len(set(columns["view"]))}


def test_tune_finds_the_front(ray_does, folder):
    said = ray_does("tune", folder)
    assert said["trials"] == 4 and 1 <= said["finished"] <= 4
    assert max(said["epochs"]) == 6 and min(said["epochs"]) >= 2
    finished = sorted((p, e) for e, p in said["all"])
    front = [(p, e) for i, (p, e) in enumerate(finished) if all(e < other for _, other in finished[:i])]
    assert [(p, e) for e, p in said["front"]] == front
    assert said["same_seed"], "a trial trains what train() does"
