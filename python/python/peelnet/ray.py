"""Extraction and the search of hyper-parameters on Ray: ``pip install peelnet[ray]``.

Both use the cluster that this process is connected to. Without one they start Ray on this machine; ``ray.init(address)`` before
the call is all that a cluster needs. Every node needs this package, and the folders must be reachable under the same path
from all of them.
"""

from __future__ import annotations

import contextlib
import os
import tempfile
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import ray
from ray.exceptions import RayError

import peelnet

if TYPE_CHECKING:
    import pandas

__all__ = ["Tuned", "extract", "tune"]

_Path = str | os.PathLike[str]


def extract(
    scenes: _Path | Iterable[_Path],
    out: _Path,
    *,
    shards: int | None = None,
    num_cpus: float = 1,
    num_gpus: float = 0,
    retries: int = 3,
    adapter: str | None = None,
    progress: Any = None,
    **options: Any,
) -> peelnet.Dataset:
    """Peels scenes on a cluster, shard by shard.

    Args:
        scenes: Scene files or names of shipped scenes.
        out: Folder of the dataset, which every node must be able to write.
        shards: Number of tasks; by default one a scene, but at most four for each task that fits onto the cluster at once.
        num_cpus: Cores of a task. A software rasteriser gets as many threads.
        num_gpus: GPUs of a task; a fraction lets tasks share one.
        retries: How often a task is done again after its worker or its node died.
        adapter: As in :func:`peelnet.extract`; by default "software" for tasks without a GPU. Different adapters may differ in
            the last bits of a row, so a hash holds for one kind of adapter.
        progress: A progress bar of the tqdm protocol, or True for tqdm's own; it counts shards.
        options: size, views, pixels, augment, seed, peel, max_passes and format of :func:`peelnet.extract`.

    Returns:
        The Dataset of all shards. Its hash is that of one process, however many tasks did the work.

    Raises:
        peelnet.PeelnetError: The first shard that failed, with its node and process. Shards that were finished stay.
    """
    listed = [scenes] if isinstance(scenes, (str, os.PathLike)) else list(scenes)
    names = [_anywhere(scene) for scene in listed]
    folder = _anywhere(out, exists=True)
    with _connected():
        if shards is None:
            shards = max(1, min(len(names), 4 * _slots(num_cpus, num_gpus)))
        if adapter is None:
            adapter = "software" if num_gpus == 0 else "auto"
        options = {**options, "adapter": adapter, "out": folder}
        task = ray.remote(num_cpus=num_cpus, num_gpus=num_gpus, max_retries=retries)(_shard)
        pending = {task.remote(names, f"{i}/{shards}", int(num_cpus), options): i for i in range(1, shards + 1)}
        with _bar(progress, shards) as bar:
            try:
                _gather(pending, shards, bar)
            finally:
                # Of a run that failed or was interrupted; finished ones are not pending any more.
                for reference in pending:
                    ray.cancel(reference, force=True)
    return peelnet.seal(folder)


def _anywhere(place: _Path, *, exists: bool = False) -> str:
    """A path that holds in any working directory; a scene's name and a URL as they are."""
    text = os.fspath(place)
    if "://" in text or not (exists or Path(text).exists()):
        return text
    return str(Path(text).absolute())


def _shard(scenes: list[str], shard: str, threads: int, options: dict[str, Any]) -> str | None:
    """A task: one shard. Returns what went wrong, because Ray would show the whole traceback of it."""
    # Read when the adapter opens, once a worker.
    os.environ.setdefault("LP_NUM_THREADS", str(max(1, threads)))
    try:
        peelnet.extract(scenes, shard=shard, **options)
    except (peelnet.PeelnetError, ValueError) as error:
        return f"node {ray.util.get_node_ip_address()}, process {os.getpid()}: {error}"
    return None


def _gather(pending: dict[Any, int], shards: int, bar: Any) -> None:
    while pending:
        # With a limit, so that Ctrl-C is heard.
        done, _ = ray.wait(list(pending), timeout=1.0)
        for reference in done:
            index = pending.pop(reference)
            try:
                wrong = ray.get(reference)
            except RayError as error:
                first = (str(error).strip().splitlines() or [type(error).__name__])[0]
                raise peelnet.PeelnetError(f"shard {index}/{shards}: its worker died too often: {first}") from error
            if wrong is not None:
                raise peelnet.PeelnetError(f"shard {index}/{shards} on {wrong}")
            if bar is not None:
                bar.update(1)


@dataclass(frozen=True)
class Tuned:
    """What a search came to."""

    trials: pandas.DataFrame
    """A row for each trial: the settings, ``error``, ``parameters``, ``epochs`` and whether it ``finished`` all epochs."""

    front: pandas.DataFrame
    """The finished trials that no other one beats in both error and parameters, by parameters."""

    models: dict[int, peelnet.Model]
    """Models of the finished trials, by the index of their row."""

    @property
    def best(self) -> peelnet.Model:
        """The model with the lowest error."""
        return self.models[self.front["error"].idxmin()]


def tune(
    search_space: Mapping[str, Any],
    data: _Path | Iterable[_Path],
    *,
    samples: int = 1,
    epochs: int = 24,
    grace: int = 4,
    reduction: int = 3,
    score: Callable[[peelnet.Model], float] | None = None,
    num_cpus: float = 1,
    num_gpus: float = 0,
    seed: int = 1,
    storage: _Path | None = None,
) -> Tuned:
    """Searches recipes, widths, rates, seeds and whatever else :func:`peelnet.train` takes, with early stopping (ASHA).

    Args:
        search_space: By name of an argument of :func:`peelnet.train`: a value, a list of values that are all tried, or a
            distribution of ``ray.tune`` such as ``tune.loguniform(1e-4, 1e-1)``.
        data: Folders of datasets, which every node must be able to read.
        samples: Trials for each combination of the lists.
        epochs: Epochs of a trial that is not stopped.
        grace: Epochs before a trial may be stopped.
        reduction: Of the trials that come to a decision, one in so many goes on.
        score: The error of a finished model. By default the held-out loss (the training loss where nothing is held out), which
            compares widths, rates and seeds, but not recipes with different losses.
        num_cpus: Cores of a trial, and threads of its training.
        num_gpus: GPUs of a trial, for a ``score`` that draws.
        seed: Of the draws from distributions.
        storage: Folder for Ray's files, shared by all nodes; by default a temporary one that is removed.

    Returns:
        All trials, the front of error against parameters, and the models.
    """
    from ray import tune as ray_tune

    folders = [data] if isinstance(data, (str, os.PathLike)) else list(data)
    names = [_anywhere(folder, exists=True) for folder in folders]
    space = {
        name: ray_tune.grid_search(value) if isinstance(value, list) else value for name, value in search_space.items()
    }
    threads = max(1, int(num_cpus))

    def trial(settings: dict[str, Any]) -> None:
        _trial(settings, names, epochs, threads, score)

    scheduler = ray_tune.schedulers.ASHAScheduler(
        time_attr="epochs", max_t=epochs + 1, grace_period=grace, reduction_factor=reduction
    )
    with contextlib.ExitStack() as stack:
        stack.enter_context(_connected())
        if storage is None:
            storage = stack.enter_context(tempfile.TemporaryDirectory(prefix="peelnet-tune-"))
        tuner = ray_tune.Tuner(
            ray_tune.with_resources(trial, {"cpu": num_cpus, "gpu": num_gpus}),
            param_space=space,
            tune_config=ray_tune.TuneConfig(
                metric="error",
                mode="min",
                scheduler=scheduler,
                num_samples=samples,
                search_alg=ray_tune.search.basic_variant.BasicVariantGenerator(random_state=seed),
            ),
            run_config=ray_tune.RunConfig(storage_path=str(Path(storage).absolute()), name="peelnet", verbose=0),
        )
        return _tuned(tuner.fit())


def _trial(
    settings: dict[str, Any],
    data: list[str],
    epochs: int,
    threads: int,
    score: Callable[[peelnet.Model], float] | None,
) -> None:
    """One training, reported epoch by epoch."""
    from ray import tune as ray_tune

    def error_of(epoch: peelnet.Epoch) -> float:
        return epoch.train_loss if epoch.held_out_loss is None else epoch.held_out_loss

    def each(epoch: peelnet.Epoch) -> None:
        ray_tune.report({"epochs": epoch.epoch, "error": error_of(epoch), "finished": False})

    # A list cannot be told from a grid, so widths are tuples.
    settings = {name: list(value) if isinstance(value, tuple) else value for name, value in settings.items()}
    training = peelnet.train(data, epochs=epochs, threads=threads, callback=each, **settings)
    model = training.model
    error = error_of(training.history[training.model_epoch - 1]) if score is None else score(model)
    with tempfile.TemporaryDirectory() as folder:
        model.save(Path(folder) / "model.safetensors")
        last = {"epochs": len(training.history), "error": error, "finished": True, "parameters": model.parameters}
        ray_tune.report(last, checkpoint=ray_tune.Checkpoint.from_directory(folder))


def _tuned(results: Any) -> Tuned:
    import pandas

    rows, models = [], {}
    for index, result in enumerate(results):
        if result.error is not None:
            raise peelnet.PeelnetError(f"trial {index} with {result.config}: {_last_line(result.error)}") from result.error
        metrics = result.metrics or {}
        row = {**(result.config or {}), **{k: metrics.get(k) for k in ("error", "parameters", "epochs", "finished")}}
        if result.checkpoint is not None:
            with result.checkpoint.as_directory() as folder:
                models[index] = peelnet.Model.load(Path(folder) / "model.safetensors")
        rows.append(row)
    trials = pandas.DataFrame(rows)
    finished = trials[[index in models for index in trials.index]].sort_values(["parameters", "error"])
    best = finished["error"].cummin()
    front = finished[(finished["error"] <= best) & ~finished["error"].eq(best.shift())]
    return Tuned(trials, front, models)


def _last_line(error: BaseException) -> str:
    lines = str(error).strip().splitlines()
    return lines[-1] if lines else type(error).__name__


@contextlib.contextmanager
def _connected() -> Iterator[None]:
    """Ray as it is, or one on this machine for as long as it is needed."""
    if ray.is_initialized():
        yield
        return
    ray.init(log_to_driver=False, include_dashboard=False)
    try:
        yield
    finally:
        ray.shutdown()


def _slots(num_cpus: float, num_gpus: float) -> int:
    """Tasks that fit onto the cluster at once."""
    there = ray.cluster_resources()
    of = [there.get(name, 0) / need for name, need in (("CPU", num_cpus), ("GPU", num_gpus)) if need > 0]
    return max(1, int(min(of, default=1)))


@contextlib.contextmanager
def _bar(progress: Any, total: int) -> Iterator[Any]:
    bar = progress
    if progress is True:
        from tqdm.auto import tqdm

        bar = tqdm(unit="shard")
    elif progress is False:
        bar = None
    if bar is not None:
        bar.total = total
    try:
        yield bar
    finally:
        if bar is not None:
            bar.close()
