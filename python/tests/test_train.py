"""Training, models and their texts."""

import pickle

import numpy as np
import peelnet
import pytest

OPTIONS = {"recipe": "small", "epochs": 3, "seed": 5}


@pytest.fixture(scope="module")
def training(folder):
    return peelnet.train(folder, **OPTIONS)


def test_the_callback_comes_each_epoch(folder, training, bar):
    heard = []
    again = peelnet.train(peelnet.Dataset(folder), callback=heard.append, progress=bar, **OPTIONS)
    assert [e.epoch for e in heard] == [1, 2, 3]
    assert [e.train_loss for e in heard] == [e.train_loss for e in training.history]
    assert heard[-1].epochs == 3 and heard[-1].rows_per_s > 0
    assert (bar.n, bar.total, bar.closed) == (3, 3, 1)
    assert again.model == training.model, "the same seed gives the same weights"
    assert again.end == "finished" and again.model_epoch == 3


def test_an_exception_of_the_callback_ends_it_at_that_epoch(folder, tmp_path):
    heard = []

    def callback(epoch):
        heard.append(epoch.epoch)
        if epoch.epoch == 2:
            raise LookupError("enough")

    out = tmp_path / "m.safetensors"
    with pytest.raises(LookupError, match="enough"):
        peelnet.train(folder, out=out, callback=callback, **{**OPTIONS, "epochs": 50})
    assert heard == [1, 2]
    assert not out.exists() and not (tmp_path / "m.safetensors.lock").exists()
    # The checkpoint has what was finished.
    resumed = peelnet.train(folder, out=out, resume=True, **{**OPTIONS, "epochs": 50})
    assert resumed.resumed_from == 2 and len(resumed.history) == 50
    whole = peelnet.train(folder, **{**OPTIONS, "epochs": 50})
    assert resumed.model == whole.model == peelnet.Model.load(out)


def test_the_command_trains_the_same(command, folder, training, tmp_path):
    out = tmp_path / "m.safetensors"
    command("train", folder, "--recipe", "small", "--epochs", 3, "--seed", 5, "--out", out)
    theirs, ours = peelnet.Model.load(out).weights(), training.model.weights()
    assert theirs.keys() == ours.keys()
    for name, value in ours.items():
        np.testing.assert_allclose(value, theirs[name], rtol=1e-4, atol=1e-6)


def test_without_a_recipe_it_is_medium(folder):
    assert peelnet.train(folder, epochs=1).model.recipe == "medium"


def test_streamed_training_gives_the_same_bytes_again(folder, tmp_path):
    # A buffer far smaller than the dataset.
    files = []
    for name in ("a", "b"):
        out = tmp_path / f"{name}.safetensors"
        peelnet.train(folder, recipe="thesis", out=out, epochs=2, stream=True, buffer_rows=1000)
        files.append(out.read_bytes())
    assert files[0] == files[1]


def test_a_model_goes_to_a_file_and_back(training, tmp_path):
    path = tmp_path / "m.safetensors"
    training.model.save(path)
    assert peelnet.Model.load(path) == training.model
    assert path.read_bytes() == training.model.to_bytes()
    assert pickle.loads(pickle.dumps(training.model)) == training.model
    assert training.model.meta["recipe"] == training.model.recipe == "small"
    training.model.save(path)
    path.write_text("mine")
    with pytest.raises(peelnet.PeelnetError, match="the file there is not a model; choose another name, or replace it with"):
        training.model.save(path)
    assert path.read_text() == "mine"
    training.model.save(path, force=True)
    assert peelnet.Model.load(path) == training.model


class Tensor:
    """As much of a torch tensor as a state dict's reader touches; numpy refuses it before detach().cpu(), as it does torch's."""

    def __init__(self, values, ready=False):
        self.values, self.ready = values, ready

    def detach(self):
        return Tensor(self.values, None)

    def cpu(self):
        return Tensor(self.values, self.ready is None)

    def __array__(self, dtype=None, copy=None):
        if not self.ready:
            raise RuntimeError("Can't call numpy() on Tensor that requires grad")
        return self.values.astype(dtype or np.float64)


def test_a_state_dict_goes_there_and_back():
    model = peelnet.Model.shipped("medium")
    state = {name: Tensor(values.astype(np.float64)) for name, values in model.weights().items()}
    assert peelnet.Model.from_state_dict(state, like=model) == model
    weights = model.weights()
    assert weights["layers.0.weight"].shape == (13, 9) and weights["layers.0.weight"].dtype == np.float32
    weights["layers.0.bias"][3] += 1
    assert model.weights()["layers.0.bias"][3] != weights["layers.0.bias"][3], "weights are a copy"
    changed = peelnet.Model.from_state_dict(weights, like=model)
    assert changed != model and changed.meta["losses"] == {"train": None, "validation": None, "test": None}
    np.testing.assert_array_equal(changed.weights()["layers.0.bias"], weights["layers.0.bias"])
    wider = {
        "layers.0.weight": np.ones((4, 9)),
        "layers.0.bias": np.zeros(4),
        "layers.1.weight": np.ones((1, 4)),
        "layers.1.bias": np.zeros(1),
    }
    assert peelnet.Model.from_state_dict(wider, like=model).topology == "9-4-1"
    for wrong, text in [
        ({**wider, "layers.1.weight": np.ones((1, 5))}, "layer"),
        ({**wider, "extra": np.ones(1)}, "nothing else"),
        ({**wider, "layers.0.bias": np.full(4, np.nan)}, "layers.0.bias"),
        ({**wider, "layers.0.bias": np.ones((4, 1))}, "2 axes"),
    ]:
        with pytest.raises(ValueError, match=text):
            peelnet.Model.from_state_dict(wrong, like=model)


def test_a_torch_state_dict_goes_there_and_back():
    torch = pytest.importorskip("torch", reason="PyPI's torch for Linux brings CUDA, gigabytes: the test above stands for it")
    model = peelnet.Model.shipped("medium")
    net = torch.nn.Module()
    net.layers = torch.nn.ModuleList([torch.nn.Linear(9, 13), torch.nn.Linear(13, 1)])
    net.load_state_dict(model.state_dict())
    assert peelnet.Model.from_state_dict(net.state_dict(), like=model) == model
    assert peelnet.Model.from_state_dict(dict(net.named_parameters()), like=model) == model


def test_predictions_are_the_network_s():
    model = peelnet.Model.shipped("thesis")
    raw = np.random.default_rng(1).uniform(1, 5, (7, 3)).astype(np.float32)
    x = np.stack([(raw[:, k] - i["offset"]) * i["scale"] for k, i in enumerate(model.meta["inputs"])], 1)
    w = model.weights()
    for k in range(3):
        x = x @ w[f"layers.{k}.weight"].T + w[f"layers.{k}.bias"]
        if k < 2:
            x = np.maximum(x, 0)
    found = model.predict(raw)
    assert found.shape == (7, 1)
    np.testing.assert_allclose(found, np.clip(x, 2**-14, 1), rtol=1e-4, atol=1e-5)
    with pytest.raises(ValueError, match="the model has 3 inputs, the array has 2 columns"):
        model.predict(raw[:, :2])


@pytest.mark.parametrize("language", ["wgsl", "glsl-es", "glsl", "hlsl", "msl"])
def test_the_text_is_the_command_s(command, tmp_path, language):
    model = peelnet.Model.shipped("small")
    model.save(tmp_path / "m.safetensors")
    command("export", tmp_path / "m.safetensors", "--lang", language, "--out", tmp_path / "a.txt")
    assert peelnet.export(model, language) == (tmp_path / "a.txt").read_text()
    assert peelnet.export(tmp_path / "m.safetensors", language, verify=False) == peelnet.export(model, language)


def test_a_trained_model_draws(training):
    own = peelnet.render("cups", training.model.method, size=(32, 24), model=training.model)
    shipped = peelnet.render("cups", training.model.method, size=(32, 24))
    assert (own != shipped).any()
    with pytest.raises(ValueError, match="the model's recipe is small, but method deep-medium draws with recipe medium"):
        peelnet.render("cups", "deep-medium", size=(32, 24), model=training.model)


def test_bench_and_recommend(bar, command, tmp_path):
    pandas = pytest.importorskip("pandas")
    names = ["mboit4", "wboit-eq9"]
    frame = peelnet.bench("cups", names, size=(64, 48), views=1, frames=1, progress=bar)
    assert isinstance(frame, pandas.DataFrame)
    assert set(names) <= set(frame["method"]) and "abuffer" in set(frame["method"])
    assert (frame["scene"] == "cups").all() and bar.n == bar.total > 0 and bar.closed == 1
    command("bench", "cups", "--methods", ",".join(names), "--size", "64x48", "--views", 1, "--frames", 1, "--out", tmp_path / "b")
    import json

    theirs = {r["method"]: r for r in json.loads((tmp_path / "b" / "results.json").read_text())["rows"]}
    assert set(theirs) == set(frame["method"])
    for _, row in frame.iterrows():
        assert row["mse_linear"] == theirs[row["method"]]["mse_linear"]
    exact = peelnet.recommend("cups", results=frame)
    assert exact.best.method == "abuffer" and exact.best.mse_linear == 0
    lenient = peelnet.recommend("cups", results=tmp_path / "b", max_error=1.0)
    assert lenient.best.time_ms == pytest.approx(min(r["time_ms"] for r in theirs.values()))
    records = frame.astype(object).where(frame.notna(), None)
    columns = {name: records[name].tolist() for name in records}
    assert peelnet.recommend("cups", results=columns).best.method == "abuffer"
    with pytest.raises(peelnet.PeelnetError):
        peelnet.recommend("cups", results=frame, budget_ms=1e-9)
    with pytest.warns(UserWarning, match="scene 'panes' is not among the results"):
        peelnet.recommend("panes", results=frame)


def test_without_pandas_bench_gives_columns(monkeypatch):
    import sys

    monkeypatch.setitem(sys.modules, "pandas", None)
    columns = peelnet.bench("cups", ["wboit-eq9"], size=(32, 24), views=1, frames=0)
    assert len(set(map(len, columns.values()))) == 1
    assert "wboit-eq9" in columns["method"] and len(columns["method"]) == len(columns["mse_linear"])


def test_addresses_stand_for_folders_and_files(folder, tmp_path):
    rows, model = f"file://{tmp_path}/rows", f"file://{tmp_path}/m.safetensors"
    data = peelnet.extract(["cups", "panes"], size=(64, 48), out=rows)
    assert data.hash == peelnet.Dataset(folder).hash == peelnet.Dataset(rows).hash == peelnet.seal(rows).hash
    made = peelnet.train(rows, recipe="thesis", epochs=1, out=model).model
    assert peelnet.Model.load(model) == made
    assert [p.name for p in tmp_path.iterdir() if p.is_file()] == ["m.safetensors"]
    with pytest.raises(peelnet.PeelnetError, match="none is replaced"):
        peelnet.train(rows, recipe="thesis", epochs=2, out=model)
    made.save(model)
    with pytest.raises(peelnet.PeelnetError, match="none is replaced"):
        peelnet.Model.shipped("small").save(model)
    assert peelnet.Model.load(model) == made
    assert peelnet.export(model, "wgsl") == peelnet.export(made, "wgsl")
