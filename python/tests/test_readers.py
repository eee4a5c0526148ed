"""Datasets in programs from PyPI that know nothing of peelnet: `pip install ./python[readers]`, or these tests are skipped."""

import hashlib
import json
import os
import socket
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import peelnet
import pytest

from conftest import SIZE

# Before the import: nothing is asked of the hub.
os.environ["HF_HUB_OFFLINE"] = "1"
datasets = pytest.importorskip("datasets", reason="pip install ./python[readers]")
mlcroissant = pytest.importorskip("mlcroissant", reason="pip install ./python[readers]")

HELD_OUT = "cups-held"


@pytest.fixture(scope="module", params=["parquet", "csv"])
def data(request, tmp_path_factory) -> Path:
    out = tmp_path_factory.mktemp("readers") / "rows"
    peelnet.extract(["cups", HELD_OUT], size=SIZE, views=2, out=out, format=request.param)
    return out


@pytest.fixture(scope="module")
def columns(data):
    """All columns, and which rows are of the scene that is held out."""
    columns = peelnet.Dataset(data).read().to_numpy()
    return columns, columns["view"] >= 2


def loaded(data, tmp_path):
    return datasets.load_dataset(str(data), cache_dir=str(tmp_path))


def test_load_dataset(data, columns, tmp_path):
    values, held_out = columns
    found = loaded(data, tmp_path)
    assert set(found) == {"train", "held_out"}
    for split, is_in in (("train", ~held_out), ("held_out", held_out)):
        rows = found[split].with_format("numpy")[:]
        assert list(rows) == list(values)
        for name, expected in values.items():
            assert found[split].features[name].dtype == expected.dtype.name
            np.testing.assert_array_equal(rows[name], expected[is_in], err_msg=name)


def test_pytorch(data, columns, tmp_path):
    torch = pytest.importorskip("torch")
    values, held_out = columns
    rows = loaded(data, tmp_path)["train"].select_columns(["transmittance", "view"]).with_format("torch")
    batches = list(torch.utils.data.DataLoader(rows, batch_size=1000))
    for name in ("transmittance", "view"):
        assert np.array_equal(torch.cat([batch[name] for batch in batches]).numpy(), values[name][~held_out])


def test_croissant(data, columns):
    file = data / "croissant.json"
    command = [Path(sys.executable).with_name("mlcroissant"), "validate", "--jsonld", file]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    # It has no date: the same rows have the same bytes.
    warned = [line for line in done.stderr.splitlines() if "  -  " in line or "not standard" in line]
    assert all("datePublished" in line for line in warned), done.stderr
    values, _ = columns
    records = list(mlcroissant.Dataset(str(file)).records("fragments"))
    for name, expected in values.items():
        found = np.array([record[f"fragments/{name}"] for record in records], expected.dtype)
        np.testing.assert_array_equal(found, expected, err_msg=name)
    files = [f for f in json.loads(file.read_text())["distribution"] if "sha256" in f]
    assert len(files) == 4
    for f in files:
        assert hashlib.sha256((data / f["contentUrl"]).read_bytes()).hexdigest() == f["sha256"]


def test_duckdb_and_polars(data, columns):
    duckdb, polars = pytest.importorskip("duckdb"), pytest.importorskip("polars")
    values, _ = columns
    kind = peelnet.Dataset(data).manifest["format"]
    of_polars = getattr(polars, f"scan_{kind}")(f"{data}/fragments-*.{kind}").collect()
    of_duckdb = duckdb.sql(f"from read_{kind}('{data}/fragments-*.{kind}')").fetchnumpy()
    for name, expected in values.items():
        for found in (of_polars[name].to_numpy(), of_duckdb[name]):
            np.testing.assert_array_equal(found.astype(expected.dtype), expected, err_msg=name)


@pytest.fixture
def bucket(monkeypatch):
    """The address of a bucket on an S3 server of this machine, which the environment names."""
    pytest.importorskip("moto", reason="pip install ./python[readers]")
    boto3 = pytest.importorskip("boto3")
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    settings = {
        "AWS_ENDPOINT_URL": f"http://127.0.0.1:{port}",
        "AWS_ALLOW_HTTP": "true",
        "AWS_REGION": "us-east-1",
        "AWS_DEFAULT_REGION": "us-east-1",
        "AWS_ACCESS_KEY_ID": "readers",
        "AWS_SECRET_ACCESS_KEY": "readers",
    }
    for name, value in settings.items():
        monkeypatch.setenv(name, value)
    with subprocess.Popen(
        [sys.executable, "-m", "moto.server", "-H", "127.0.0.1", "-p", str(port)],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    ) as server:
        try:
            for _ in range(300):
                try:
                    socket.create_connection(("127.0.0.1", port), 1).close()
                    break
                except OSError:
                    time.sleep(0.1)
            boto3.client("s3").create_bucket(Bucket="rows")
            yield "s3://rows"
        finally:
            server.terminate()


# In a process of its own: offline, `datasets` takes `s3://` for the hub's.
OF_DATASETS = """
import sys, datasets
rows = datasets.load_dataset("parquet", data_files=sys.argv[1], cache_dir=sys.argv[2])["train"]
print(len(rows), sum(rows["layer"]))
"""


def test_object_stores(bucket, tmp_path):
    duckdb, polars = pytest.importorskip("duckdb"), pytest.importorskip("polars")
    fs, arrow = pytest.importorskip("pyarrow.fs"), pytest.importorskip("pyarrow.dataset")
    s3fs = pytest.importorskip("s3fs", reason="pip install ./python[readers]")
    out = f"{bucket}/a"
    peelnet.extract(["cups"], size=SIZE, views=2, out=out)
    expected = peelnet.Dataset(out).read().to_numpy()
    parts = f"{out}/fragments-*.parquet"
    of_polars = polars.scan_parquet(parts).collect()
    connection = duckdb.connect()
    connection.register_filesystem(s3fs.S3FileSystem())
    of_duckdb = connection.sql(f"from read_parquet('{parts}')").fetchnumpy()
    store, root = fs.FileSystem.from_uri(out)
    found = store.get_file_info(fs.FileSelector(root))
    of_arrow = arrow.dataset([f.path for f in found if f.extension == "parquet"], filesystem=store).to_table()
    for name, values in expected.items():
        for found in (of_polars[name].to_numpy(), of_duckdb[name], of_arrow[name].to_numpy()):
            np.testing.assert_array_equal(found.astype(values.dtype), values, err_msg=name)
    command = [sys.executable, "-c", OF_DATASETS, parts, tmp_path]
    environment = os.environ | {"HF_HUB_OFFLINE": "0"}
    done = subprocess.run(command, capture_output=True, text=True, check=False, env=environment)
    assert done.returncode == 0, done.stderr
    assert done.stdout.split() == [str(len(expected["layer"])), str(expected["layer"].sum())]
