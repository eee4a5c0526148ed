"""What test_ray.py runs in a network namespace: prints one line of JSON."""

import json
import sys
from pathlib import Path

import peelnet
import peelnet.ray
import ray

SIZE = (64, 48)


def extract(folder: Path) -> dict:
    class Bar:
        total, n, closed = 0, 0, 0

        def update(self, n):
            self.n += n

        def close(self):
            self.closed += 1

    bar = Bar()
    data = peelnet.ray.extract(["cups", "panes"], folder / "d", shards=3, size=SIZE, progress=bar)
    try:
        peelnet.ray.extract(["cups", "no-such-scene"], folder / "e", shards=2, size=SIZE)
        error = None
    except peelnet.PeelnetError as e:
        error = str(e)
    try:
        peelnet.ray.extract("cups", folder / "f", shards=1, size=SIZE, pixels=7)
        wrong = None
    except peelnet.PeelnetError as e:
        wrong = str(e)
    return {"hash": data.hash, "bar": [bar.n, bar.total, bar.closed], "error": error, "wrong": wrong, "there": not ray.is_initialized()}


def read(folder: Path) -> dict:
    ray.init(log_to_driver=False, include_dashboard=False)
    data = ray.data.read_parquet(str(folder))
    return {"rows": data.count(), "sum": data.sum("transmittance"), "views": len(data.unique("view"))}


def tune(folder: Path) -> dict:
    from ray import tune

    space = {"recipe": "thesis", "hidden": [(4,), (12, 6)], "lr": tune.loguniform(1e-3, 1e-2), "batch": 512}
    found = peelnet.ray.tune(space, folder, samples=2, epochs=6, grace=2)
    front = found.front
    return {
        "trials": len(found.trials),
        "finished": int(found.trials["finished"].sum()),
        "epochs": found.trials["epochs"].tolist(),
        "front": front[["error", "parameters"]].values.tolist(),
        "all": found.trials[found.trials["finished"]][["error", "parameters"]].values.tolist(),
        "best": found.best.topology,
        "same_seed": found.best == peelnet.train(
            folder, recipe="thesis", epochs=6, batch=512, lr=float(front.loc[front["error"].idxmin(), "lr"]),
            hidden=list(front.loc[front["error"].idxmin(), "hidden"]),
        ).model,
    }


if __name__ == "__main__":
    print(json.dumps({"extract": extract, "read": read, "tune": tune}[sys.argv[1]](Path(sys.argv[2]))))
