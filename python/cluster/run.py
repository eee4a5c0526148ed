"""Ray with two nodes on one machine, killed in the middle of its work: `cargo xtask cluster`.

For 1, 2 and 5 workers: scenes are extracted by `peelnet.ray.extract`, one worker process and one node are killed midway, and the
dataset's hash is compared with that of one local process. At the end no process of Ray may be left. Runs in a network
namespace, so that addresses are this machine's alone.
"""

from __future__ import annotations

import argparse
import contextlib
import json
import logging
import os
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

os.environ.setdefault("RAY_USAGE_STATS_ENABLED", "0")
os.environ.setdefault("RAY_BACKEND_LOG_LEVEL", "fatal")
# A node that dies is noticed in seconds instead of half a minute.
os.environ.setdefault("RAY_health_check_period_ms", "500")
os.environ.setdefault("RAY_health_check_failure_threshold", "4")
# Tasks of this run bind no more threads than they have cores.
os.environ.setdefault("LP_NUM_THREADS", "1")

# By what processes of a run are known.
MARK = "PEELNET_CLUSTER_RUN"
# A file with a line for each part that was drawn.
LOG = "PEELNET_CLUSTER_LOG"

import peelnet
import peelnet.ray
import psutil
import ray
from ray.cluster_utils import Cluster

THEIRS = peelnet.ray._shard


def scenes(count: int, folder: Path) -> list[str]:
    """Writes scenes of panes, each with more of them than the one before, and two views."""
    paths = []
    for k in range(count):
        text = f"""
[camera]
position = [0, 0, 6]
target = [0, 0, 0]
near = 0.1
far = 100
[orbit]
views = 2
"""
        for layer in range(6 + k):
            z = -1.5 + 3 * layer / (6 + k)
            text += f"""
[[object]]
mesh = "pane.obj"
translate = [{0.1 * (layer % 3)}, {0.05 * k}, {z:.4f}]
material = {{ color = [{0.1 + 0.05 * k:.3f}, 0.5, {1 - 0.05 * layer:.3f}], alpha = {0.15 + 0.02 * (k % 10):.3f} }}
"""
        path = folder / f"panes-{k:02}.toml"
        path.write_text(text)
        paths.append(str(path))
    (folder / "pane.obj").write_text("v -2 -2 0\nv 2 -2 0\nv 2 2 0\nv -2 2 0\nf 1 2 3 4\n")
    return paths


def workers_of(node) -> list[psutil.Process]:
    """Worker processes of a node that run a task."""
    raylet = psutil.Process(node.all_processes["raylet"][0].process.pid)
    busy = []
    for process in raylet.children(recursive=True):
        try:
            line = " ".join(process.cmdline())
        except psutil.Error:
            continue
        if "_shard" in line:
            busy.append(process)
    return busy


def soon(look, seconds: float = 5.0) -> list:
    """What `look` finds as soon as it finds something: between two tasks no worker is busy."""
    deadline = time.monotonic() + seconds
    while not (found := look()) and time.monotonic() < deadline:
        time.sleep(0.02)
    return found


def _shard(scenes: list[str], shard: str, threads: int, options: dict) -> str | None:
    """The task of peelnet.ray under its name, with a line in a file for each part that it finished drawing."""
    import peelnet.ray

    class Log:
        total = 0

        def update(self, n: int) -> None:
            # Of a line's length, a write is whole.
            with open(os.environ[LOG], "a") as log:
                log.write(f"{shard}\n" * n)

    return THEIRS(scenes, shard, threads, {**options, "progress": Log()})


class Bar:
    """Kills a worker after a third of the shards, and a node after two thirds."""

    def __init__(self, cluster: Cluster, victim, alone: bool, kill: bool):
        self.cluster, self.victim, self.alone, self.kill = cluster, victim, alone, kill
        self.total, self.done, self.events, self.killed = 0, 0, [], 0

    def update(self, n: int) -> None:
        self.done += n
        if not self.kill:
            return
        if "worker" not in self.events and self.done >= self.total // 3:
            self.events.append("worker")
            busy = soon(lambda: [w for node in self.cluster.list_all_nodes() for w in workers_of(node)])
            if busy:
                busy[0].send_signal(signal.SIGKILL)
                self.killed += 1
                self.events.append(f"killed worker {busy[0].pid} after {self.done} of {self.total} shards")
        if "node" not in self.events and self.done >= 2 * self.total // 3:
            self.events.append("node")
            self.killed += len(soon(lambda: workers_of(self.victim)))
            # As a machine that loses its power.
            self.cluster.remove_node(self.victim, allow_graceful=False)
            if self.alone:
                # Nobody is left to work: a machine takes its place, as schedulers do it.
                self.cluster.add_node(num_cpus=1)
            self.events.append(f"killed a node after {self.done} of {self.total} shards")

    def close(self) -> None:
        pass


def one_run(workers: int, names: list[str], out: str, size: tuple[int, int], kill: bool) -> dict:
    """Extracts with so many workers on two nodes."""
    on_head = workers // 2
    cluster = Cluster(initialize_head=True, head_node_args={"num_cpus": on_head, "include_dashboard": False})
    victim = cluster.add_node(num_cpus=workers - on_head)
    ray.init(address=cluster.address, log_to_driver=False, logging_level=logging.ERROR)
    bar = Bar(cluster, victim, on_head == 0, kill)
    Path(os.environ[LOG]).write_text("")
    start = time.perf_counter()
    try:
        data = peelnet.ray.extract(names, out, shards=len(names), size=size, progress=bar, retries=5)
        seconds = time.perf_counter() - start
    finally:
        ray.shutdown()
        cluster.shutdown()
    drawn = len(Path(os.environ[LOG]).read_text().splitlines())
    twice = drawn - len(data.manifest["parts"])
    return {"workers": workers, "hash": data.hash, "twice": twice, "killed": bar.killed, "rows": len(data), "seconds": round(seconds, 1), "events": [e for e in bar.events if " " in e]}


@contextlib.contextmanager
def bucket() -> Iterator[str]:
    """An S3 server of this run, in its network namespace, with a bucket."""
    import boto3
    from botocore.exceptions import BotoCoreError

    port = "5555"
    unmarked = {name: value for name, value in os.environ.items() if name != MARK}
    command = [sys.executable, "-m", "moto.server", "-H", "127.0.0.1", "-p", port]
    server = subprocess.Popen(command, env=unmarked, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    os.environ.update(
        AWS_ENDPOINT_URL=f"http://127.0.0.1:{port}", AWS_ALLOW_HTTP="true", AWS_REGION="us-east-1", AWS_DEFAULT_REGION="us-east-1",
        AWS_ACCESS_KEY_ID="cluster", AWS_SECRET_ACCESS_KEY="cluster",
    )
    try:
        for attempt in range(60):
            try:
                boto3.client("s3").create_bucket(Bucket="cluster")
                break
            except (OSError, BotoCoreError):
                if attempt == 59:
                    raise
                time.sleep(0.5)
        yield "s3://cluster"
    finally:
        server.terminate()
        server.wait()


def orphans() -> list[str]:
    """Processes that this run started, whoever their parent is now: they inherited its mark."""
    left = []
    for process in psutil.process_iter(["pid", "cmdline"]):
        try:
            marked = process.environ().get(MARK) == str(os.getpid())
        except psutil.Error:
            continue
        if marked and process.pid != os.getpid() and process.status() != psutil.STATUS_ZOMBIE:
            left.append(f"{process.pid} {' '.join(process.info['cmdline'] or [])[:80]}")
    return left


def main() -> int:
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("--workers", default="1,2,5", help="numbers of workers, separated by commas")
    arguments.add_argument("--scenes", type=int, default=16)
    arguments.add_argument("--size", default="512x384")
    arguments.add_argument("--no-kill", action="store_true", help="kill nothing: for times")
    arguments.add_argument("--folders", action="store_true", help="write to folders instead of an S3 server (moto)")
    arguments.add_argument("--out", type=Path, help="also write the results here, JSON")
    options = arguments.parse_args()
    size = tuple(int(n) for n in options.size.split("x"))
    # Processes that are started from here on are counted, also those that lose their parent.
    os.environ[MARK] = str(os.getpid())
    peelnet.ray._shard = _shard
    with contextlib.ExitStack() as stack:
        folder = stack.enter_context(tempfile.TemporaryDirectory(prefix="peelnet-cluster-"))
        os.environ[LOG] = str(Path(folder) / "drawn")
        place = Path(folder) if options.folders else stack.enter_context(bucket())
        names = scenes(options.scenes, Path(folder))
        start = time.perf_counter()
        local = peelnet.extract(names, size=size, out=Path(folder) / "local", adapter="software")
        seconds = time.perf_counter() - start
        print(f"one process: {len(local):,} rows, {seconds:.1f} s, {local.hash[:16]}", flush=True)
        runs, right = [], True
        for workers in (int(n) for n in options.workers.split(",")):
            out = f"{place}/of-{workers}"
            run = one_run(workers, names, out, size, not options.no_kill)
            run["same"] = run["hash"] == local.hash
            # Processes that were killed are gone once their parent has waited for them.
            deadline = time.monotonic() + 10
            while orphans() and time.monotonic() < deadline:
                time.sleep(0.2)
            run["orphans"] = orphans()
            right &= run["same"] and not run["orphans"] and run["twice"] <= run["killed"] and (options.no_kill or len(run["events"]) == 2)
            runs.append(run)
            print(f"{workers} workers: {run['rows']:,} rows, {run['seconds']} s, {run['hash'][:16]}, "
                  f"{'the same' if run['same'] else 'ANOTHER hash'}; {'; '.join(run['events']) or 'nothing killed'}; "
                  f"parts drawn twice: {run['twice']} (processes killed: {run['killed']}); orphans: {', '.join(run['orphans']) or 'none'}", flush=True)
    if options.out:
        options.out.write_text(json.dumps({"local": {"hash": local.hash, "seconds": seconds}, "runs": runs}, indent=1))
    if not right:
        print("error: not as one process does it, see above", file=sys.stderr)
    return 0 if right else 1


if __name__ == "__main__":
    sys.exit(main())
