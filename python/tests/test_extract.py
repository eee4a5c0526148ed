"""Rows in memory, rows in a folder, and programs that read both."""

import numpy as np
import peelnet
import pytest

from conftest import SIZE

pyarrow = pytest.importorskip("pyarrow")


def test_the_stream_is_the_folder_s_rows(rows, folder):
    import pyarrow.parquet

    table = pyarrow.table(rows)
    parts = sorted(folder.rglob("*.parquet"))
    assert len(parts) == 6
    files = pyarrow.concat_tables([pyarrow.parquet.read_table(p) for p in parts])
    assert table.num_rows == len(rows) == files.num_rows > 1000
    assert table.column_names == files.column_names == rows.columns
    assert table.schema.types == files.schema.types
    for name in table.column_names:
        assert table[name].combine_chunks().equals(files[name].combine_chunks()), name


def test_the_stream_may_be_read_twice_and_outlives_its_rows():
    rows = peelnet.extract("cups", size=SIZE, views=1)
    a, b = pyarrow.table(rows), pyarrow.table(rows)
    count = len(rows)
    del rows
    assert a.equals(b) and a.num_rows == count
    assert int(a["fragment_count"].combine_chunks()[0].as_py()) >= 1


def test_numpy_columns(rows):
    columns = rows.to_numpy()
    table = pyarrow.table(rows)
    assert list(columns) == table.column_names
    for name, values in columns.items():
        assert values.dtype == (np.uint32 if name in {"fragment_count", "view", "x", "y", "layer"} else np.float32)
        np.testing.assert_array_equal(values, table[name].to_numpy())
    assert list(rows.to_numpy(["x"])) == ["x"]
    with pytest.raises(ValueError, match="no column 'z'; there are one_minus_alpha"):
        rows.to_numpy(["z"])


def test_the_folder_is_the_command_s(command, folder, tmp_path):
    out = tmp_path / "rows"
    command("extract", "cups", "panes", "--size", "64x48", "--out", out)
    assert peelnet.Dataset(out).hash == peelnet.Dataset(folder).hash
    peelnet.Dataset(folder).verify()


@pytest.mark.parametrize("format", ["csv", "npy"])
def test_a_folder_of_any_format_reads_back(rows, tmp_path, format):
    data = peelnet.extract(["cups", "panes"], size=SIZE, out=tmp_path / "d", format=format)
    assert data.manifest["format"] == format
    read = data.read().to_numpy()
    for name, values in rows.to_numpy().items():
        np.testing.assert_array_equal(read[name], values, err_msg=name)


def test_shards_are_one_dataset(folder, tmp_path):
    out = tmp_path / "d"
    for i in (3, 1):
        assert peelnet.extract(["cups", "panes"], size=SIZE, out=out, shard=f"{i}/3") is None
    with pytest.raises(peelnet.PeelnetError, match="missing"):
        peelnet.seal(out)
    with pytest.raises(peelnet.PeelnetError, match="another plan"):
        peelnet.extract(["cups", "panes"], size=(8, 8), out=out, shard="2/3")
    whole = peelnet.extract(["cups", "panes"], size=SIZE, out=out, shard="2/3")
    assert whole.hash == peelnet.Dataset(folder).hash == peelnet.seal(out).hash


def test_resume_does_what_is_missing(folder, tmp_path):
    out = tmp_path / "d"
    assert peelnet.extract(["cups", "panes"], size=SIZE, out=out, shard="1/2") is None
    before = {path.name: path.stat().st_mtime_ns for path in out.glob("*.parquet")}
    whole = peelnet.extract(["cups", "panes"], size=SIZE, out=out, resume=True)
    assert whole.hash == peelnet.Dataset(folder).hash
    assert before.items() <= {path.name: path.stat().st_mtime_ns for path in out.glob("*.parquet")}.items()


def test_slices_in_memory():
    part = peelnet.extract(["cups", "panes"], size=SIZE, shard="2/3").to_numpy(["view"])["view"]
    assert set(part) == {2, 5}


# Four readers of one folder. Parts are found by glob.
@pytest.fixture
def glob(folder) -> str:
    return str(folder / "**" / "*.parquet")


def expected(rows):
    columns = rows.to_numpy(["view", "transmittance"])
    return len(rows), float(columns["transmittance"].astype(np.float64).sum()), len(set(columns["view"]))


def test_duckdb_reads_the_folder(glob, rows):
    duckdb = pytest.importorskip("duckdb")
    query = f"select count(*), sum(transmittance::double), count(distinct view) from read_parquet('{glob}')"
    count, total, views = duckdb.sql(query).fetchall()[0]
    assert (count, pytest.approx(total), views) == expected(rows)


def test_polars_reads_the_folder_and_the_stream(glob, rows):
    polars = pytest.importorskip("polars")
    of_folder = polars.scan_parquet(glob).collect()
    of_stream = polars.DataFrame(rows)
    assert of_stream.equals(of_folder)
    assert (of_folder.height, pytest.approx(float(of_folder["transmittance"].cast(polars.Float64).sum())), of_folder["view"].n_unique()) == expected(rows)


def test_pyarrow_reads_the_folder(folder, rows):
    import pyarrow.compute
    import pyarrow.dataset

    # A folder alone would be read with its README.md.
    table = pyarrow.dataset.dataset([str(p) for p in sorted(folder.glob("*.parquet"))]).to_table()
    total = pyarrow.compute.sum(table["transmittance"].cast("float64")).as_py()
    views = len(pyarrow.compute.unique(table["view"]))
    assert (table.num_rows, pytest.approx(total), views) == expected(rows)


def test_pandas_takes_the_stream(rows):
    pytest.importorskip("pandas")
    frame = pyarrow.table(rows).to_pandas()
    assert (len(frame), pytest.approx(float(frame["transmittance"].astype("float64").sum())), frame["view"].nunique()) == expected(rows)


def test_statistics_are_numpy_s(folder, rows):
    statistics = peelnet.Dataset(folder).manifest["statistics"]
    for column, (name, values) in zip(statistics, rows.to_numpy().items(), strict=True):
        values = values.astype(np.float64)
        assert column["name"] == name
        assert (column["min"], column["max"]) == (values.min(), values.max())
        assert (column["mean"], column["deviation"]) == pytest.approx((values.mean(), values.std()), abs=1e-12 * values.max())
        assert np.histogram(values, column["edges"])[0].tolist() == column["counts"]


def test_a_readme_of_others_is_reported(tmp_path):
    out = tmp_path / "d"
    assert peelnet.extract(["cups", "panes"], size=(8, 8), out=out, shard="1/2") is None
    (out / "README.md").write_text("mine")
    with pytest.warns(UserWarning, match="README.md is not as peelnet writes it"):
        peelnet.extract(["cups", "panes"], size=(8, 8), out=out, shard="2/2")
    with pytest.warns(UserWarning, match="README.md is not as peelnet writes it"):
        peelnet.seal(out)
    assert (out / "README.md").read_text() == "mine"


def test_progress_counts_views(bar, tmp_path):
    peelnet.extract("cups", size=SIZE, progress=bar)
    assert (bar.n, bar.total, bar.closed) == (3, 3, 1)
    other = type(bar)()
    peelnet.extract("cups", size=SIZE, out=tmp_path / "d", progress=other)
    assert (other.n, other.total, other.closed) == (3, 3, 1)


def test_tqdm_shows_it(capfd):
    tqdm = pytest.importorskip("tqdm")
    bar = tqdm.tqdm()
    peelnet.extract("cups", size=SIZE, progress=bar)
    assert bar.n == bar.total == 3
    assert "3/3" in capfd.readouterr().err


def test_a_bar_that_fails_ends_the_work_and_leaves_nothing(bar, tmp_path):
    def update(n):
        raise RuntimeError("full")

    bar.update = update
    with pytest.raises(RuntimeError, match="full"):
        peelnet.extract(["cups", "sixteen-050"], size=(512, 384), out=tmp_path / "d", progress=bar)
    assert bar.closed == 1
    left = list((tmp_path / "d").rglob("*")) if (tmp_path / "d").exists() else []
    assert left == []
