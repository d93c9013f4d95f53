"""A sweep on a real cluster, of two workers over TCP, one of which is killed in the midst."""

from __future__ import annotations

import os
import subprocess
import sys
from fractions import Fraction as Q
from pathlib import Path

import pytest

from driftproof.numeric import sweep as sweeping
from driftproof.numeric.scenes import Scene
from driftproof.numeric.sweep import SweepAnswer, points_of, run_points, sweep_batches
from driftproof.reports.sweeps import cluster_executor

ROOT = Path(__file__).parents[2]
SCENE = Scene("long", "symplectic_euler", Q(1, 2**10), Q(16), readouts=("final_state", "state_error"))
GRID = {"start": [(Q(1), Q(n, 16)) for n in range(30)]}
WORKER = (sys.executable, "-m", "distributed.cli.dask_worker", "--no-nanny", "--nthreads", "1", "--no-dashboard")


@pytest.fixture
def cluster(tmp_path):
    """The address of a scheduler in a process of its own, and the processes of its two workers.

    All three start at once: the workers wait for the file in which the scheduler says where it is.
    """
    pytest.importorskip("distributed")
    file = tmp_path / "scheduler.json"
    # results that the dead worker holds are asked of it for so long, before they are computed anew
    settings = {**os.environ, "DASK_DISTRIBUTED__COMM__TIMEOUTS__CONNECT": "3s"}
    scheduler = (sys.executable, "-m", "distributed.cli.dask_scheduler", "--host", "127.0.0.1", "--port", "0")
    commands = [(*scheduler, "--no-dashboard", "--scheduler-file", str(file))]
    commands += [(*WORKER, "--scheduler-file", str(file), "--name", name) for name in ("first", "second")]
    started = [
        subprocess.Popen(command, cwd=tmp_path, env={**settings, "PYTHONPATH": str(ROOT)}, stderr=subprocess.DEVNULL)
        for command in commands
    ]
    try:
        yield file, started[1:]
    finally:
        for process in started:
            process.kill()
            process.wait()


def test_of_a_sweep_with_a_worker_killed_every_point_is_answered_once(cluster, tmp_path, monkeypatch):
    file, workers = cluster
    from distributed import Client

    monkeypatch.setattr(sweeping, "SHORTEST", -1)  # a point a task
    with Client(scheduler_file=str(file), set_as_default=False) as client:
        client.wait_for_workers(2, timeout=60)
        names = {worker["name"]: place for place, worker in client.scheduler_info()["workers"].items()}
        path, found, killed = tmp_path / "answers.jsonl", [], False
        with cluster_executor(client.scheduler.address) as executor:
            for batch in sweep_batches(SCENE, GRID, executor, path):
                found += batch
                if not killed and client.processing()[names["first"]] and 3 <= len(found) < 20:
                    workers[0].kill()
                    killed = True
        assert killed
        assert names["first"] not in client.scheduler_info()["workers"]
    assert sorted(i for i, _ in found) == list(range(30))
    points = points_of(SCENE, GRID)
    alone, _ = run_points(SCENE, points[:1] + points[-1:])
    kept = dict(found)
    assert [kept[0], kept[29]] == alone
    assert path.read_bytes().count(b"\n") == 1 + 30
    assert [SweepAnswer(p, kept[i]) for i, p in enumerate(points)] == sweeping.sweep(SCENE, GRID, None, path)
