"""A sweep on a real cluster, of two workers over TCP: a worker is killed in the midst, or the scheduler is."""

import json
import logging
import os
import re
import signal
import subprocess
import sys
import time
from concurrent.futures import CancelledError
from contextlib import nullcontext
from dataclasses import replace
from fractions import Fraction as Q
from pathlib import Path
from types import SimpleNamespace

import pytest

from driftproof.numeric import sweep as sweeping
from driftproof.numeric.scenes import Scene
from driftproof.numeric.sweep import SweepAnswer, points_of, run_points, sweep_batches
from driftproof.reports import sweeps
from driftproof.reports.sweeps import cluster_executor

ROOT = Path(__file__).parents[2]
SCENE = Scene("long", "symplectic_euler", Q(1, 2**10), Q(16), readouts=("final_state", "state_error"))
GRID = {"start": [(Q(1), Q(n, 16)) for n in range(30)]}
WORKER = (sys.executable, "-m", "distributed.cli.dask_worker", "--no-nanny", "--nthreads", "1", "--no-dashboard")


@pytest.fixture
def cluster(tmp_path):
    """The file of a scheduler in a process of its own, and the processes of it and of its two workers.

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
        yield file, started
    finally:
        for process in started:
            process.kill()
            process.wait()


@pytest.mark.slow
def test_of_a_sweep_with_a_worker_killed_every_point_is_answered_once(cluster, tmp_path, monkeypatch):
    file, (_, *workers) = cluster
    from distributed import Client

    monkeypatch.setattr(sweeping, "SHORTEST", -1)  # a point a task
    with Client(scheduler_file=str(file), set_as_default=False) as client:
        client.wait_for_workers(2, timeout=60)
        first = next(at for at, worker in client.scheduler_info()["workers"].items() if worker["name"] == "first")
        workers[0].send_signal(signal.SIGSTOP)  # what it is given from here on it never ends
        path, found, held = tmp_path / "answers.jsonl", [], 0
        with cluster_executor(client.scheduler.address) as executor:
            for batch in sweep_batches(SCENE, GRID, executor, path):
                found += batch
                if not held and len(found) >= 3:
                    held = len(client.processing()[first])
                    workers[0].kill()
        assert held
        assert first not in client.scheduler_info()["workers"]
    assert sorted(i for i, _ in found) == list(range(30))
    points = points_of(SCENE, GRID)
    alone, _ = run_points(SCENE, points[:1] + points[-1:])
    kept = dict(found)
    assert [kept[0], kept[29]] == alone
    assert path.read_bytes().count(b"\n") == 1 + 30
    assert [SweepAnswer(p, kept[i]) for i, p in enumerate(points)] == sweeping.run_grid(SCENE, GRID, None, path)


def test_a_row_says_the_point_and_four_digits_of_what_is_not_a_state_or_why_there_are_none():
    scene = replace(SCENE, readouts=("final_state", "state_error", "steps", "phase_error"))
    points = [{"selected": "rk4", "start": (Q(1), Q(1, 2))}, {"selected": "rk4", "start": (Q(1), Q(0))}]
    outcomes = [{"state_error": 2 / 3, "steps": 40, "phase_error": None}, "overflow"]
    answers = list(map(SweepAnswer, points, outcomes))
    assert [re.split("  +", row.strip()) for row in sweeps.sweep_text(scene, answers).splitlines()[2:]] == [
        ["method", "start", "state error", "steps", "phase error (degrees)"],
        ["rk4", "1, 1/2", "0.6667", "40", "undefined"],
        ["rk4", "1, 0", "overflow"],
    ]
    assert sweeps.sweep_text(scene, answers).startswith("long: 2 points\n")
    assert sweeps.sweep_text(scene, answers[:1]).startswith("long: 1 point\n")


class Task:
    """What a dask client gives for a task that has ended: its result, or the error that fetching it raises."""

    def __init__(self, outcome):
        self.outcome, self.cancelled, self.status = outcome, False, "lost"

    def add_done_callback(self, call):
        self.deliver = lambda: call(self)

    def cancel(self):
        self.cancelled = True

    def result(self):
        if isinstance(self.outcome, Exception):
            raise self.outcome
        return self.outcome


@pytest.mark.parametrize("outcome", [(["an answer"], 0.5), KeyError("of the worker"), CancelledError()])
def test_a_result_is_delivered_whatever_the_status_of_its_task_has_become(outcome):
    task = Task(outcome)
    future = sweeps._ClusterExecutor(SimpleNamespace(submit=lambda *_, **__: task)).submit(print)
    assert not future.done()
    task.deliver()
    delivered = future.exception() if isinstance(outcome, Exception) else future.result()
    assert (delivered, task.cancelled) == (outcome, False)


def test_a_cancelled_future_cancels_its_task_and_takes_no_result():
    task = Task("too late")
    future = sweeps._ClusterExecutor(SimpleNamespace(submit=lambda *_, **__: task)).submit(print)
    assert future.cancel()
    assert task.cancelled
    task.deliver()
    assert future.cancelled()


@pytest.mark.parametrize(
    ("error", "kind", "line"),
    [
        (CancelledError, ConnectionError, "the connection to the cluster at tcp://a:1 was lost"),
        (KeyError, ChildProcessError, "a batch killed the workers at tcp://a:1: 'of what'"),
    ],
)
def test_what_distributed_logs_of_its_end_is_not_said_twice(error, kind, line, monkeypatch, caplog):
    given, loggers = [], [logging.getLogger(name) for name in ("distributed.client", "of.a.user")]
    fake = SimpleNamespace(Client=lambda *_, **options: nullcontext(given.append(options)), KilledWorker=KeyError)
    monkeypatch.setitem(sys.modules, "distributed", fake)
    monkeypatch.setattr(sweeps, "require_package", lambda *_: None)

    def ends():
        with cluster_executor("tcp://a:1"):
            for each in loggers:
                each.error("a traceback")
            raise error("of what")

    with pytest.raises(kind) as raised:
        ends()
    assert (str(raised.value), [each.name for each in caplog.records]) == (line, ["of.a.user"])
    assert [options["set_as_default"] for options in given] == [False]
    loggers[0].error("heard again")
    assert caplog.messages[1:] == ["heard again"]


@pytest.mark.long
def test_scheduler_that_goes_away_is_told_of_in_one_line_and_the_answers_are_kept(cluster, tmp_path):
    file, (scheduler, *_) = cluster
    while not file.exists():
        time.sleep(0.1)
    address = json.loads(file.read_text(encoding="utf-8"))["address"]
    scene, path = tmp_path / "s.toml", tmp_path / "answers.jsonl"
    scene.write_text('selected = "rk4"\nh = 1\nt = 40\nreadouts = ["final_state"]\n', encoding="utf-8")
    words = ("sweep", str(scene), "--h", "1/4,1/8,1/262144,1/524288", "--cluster", address, "-o", str(path))
    command = (sys.executable, "-m", "driftproof", *words)
    with subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as running:
        while not path.exists() or path.read_bytes().count(b"\n") < 3:
            time.sleep(0.1)
        scheduler.kill()
        out, err = running.communicate(timeout=60)
    lost = f"driftproof sweep: the connection to the cluster at {address} was lost\n"
    assert (running.returncode, out, err) == (2, "", lost)
    assert path.read_bytes().count(b"\n") == 3
