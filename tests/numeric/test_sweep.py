"""Sweeps: every point of the grid answered once and in order, whatever runs them and whatever ends them."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
from collections.abc import Iterator
from concurrent.futures import BrokenExecutor, Executor, Future, ThreadPoolExecutor, wait
from dataclasses import replace
from fractions import Fraction as Q
from math import inf
from random import Random
from types import SimpleNamespace

import pytest

from driftproof import __version__
from driftproof.methods.catalogue import METHODS
from driftproof.numeric import sweep as sweeping
from driftproof.numeric.run import run_method
from driftproof.numeric.scenes import Scene
from driftproof.numeric.sweep import SweepAnswer, points_of, run_grid, run_points
from tests.looping import some
from tests.numeric.engine_runs import oscillator_run

SCENE = Scene("short", "rk4", Q(1, 4), Q(2), readouts=("final_state", "state_error", "phase_error", "evaluations"))
METHOD_KEYS = ("yoshida4", "forward_euler")
GRID = {"selected": METHOD_KEYS, "start": [(Q(1), Q(0)), (Q(0), Q(0))], "h": [Q(1, 2), Q(3, 10), Q(1, 16)]}


class Inline(Executor):
    """Runs what it is given at once, and remembers it."""

    def __init__(self) -> None:
        self.sweep_batches: list[list[dict]] = []

    def submit(self, task, scene, points):
        self.sweep_batches.append(points)
        future: Future = Future()
        future.set_result(task(scene, points))
        return future


@pytest.fixture
def expected() -> list[SweepAnswer]:
    return run_grid(SCENE, GRID, Inline())


def test_points_are_answered_in_the_order_of_the_grid_as_each_alone(expected):
    assert [answer.values for answer in expected] == [
        {"selected": key, "start": start, "h": h}
        for key in GRID["selected"]
        for start in GRID["start"]
        for h in GRID["h"]
    ]
    for values, found in expected:
        if values["h"] == Q(3, 10):
            assert "h = 3/10 does not divide t = 2" in found
            continue
        q, v = map(float, values["start"])
        steps = int(2 / values["h"])
        assert found["final_state"] == oscillator_run(METHODS[values["selected"]])(q, v, float(values["h"]), steps)
        assert found["phase_error"] is None or q == 1


def test_an_overflow_is_an_answer_and_implicit_methods_run_beside_explicit_ones():
    scene = Scene("over", "rk4", Q(1), Q(400), readouts=("energy", "steps"))
    found = run_grid(scene, {"h": [Q(1), Q(400), Q(100)], "selected": ["forward_euler", "gauss2"]}, Inline())
    assert found[0].found["steps"] == 400
    (lost,) = run_grid(scene, {"t": [Q(10_000)], "h": [Q(4)]}, Inline())
    assert "overflow: the state is no longer finite" in lost.found
    assert [answer.found["steps"] for answer in found[1::2]] == [400, 1, 4]


def test_threads_and_processes_and_one_after_the_other_find_the_same(expected, monkeypatch):
    with ThreadPoolExecutor(3) as threads:
        assert run_grid(SCENE, GRID, threads) == expected
    assert run_grid(SCENE, GRID) == expected
    monkeypatch.setattr(sweeping, "LONGEST", -1)
    monkeypatch.setattr(sweeping, "processes", lambda make=sweeping.processes: make(2))
    assert run_grid(SCENE, GRID) == expected


def test_what_is_done_within_a_second_starts_no_process(expected, monkeypatch):
    monkeypatch.setattr(sweeping, "processes", None)
    assert run_grid(SCENE, GRID) == expected
    monkeypatch.setattr(sweeping, "LONGEST", -1)
    with pytest.raises(TypeError):
        run_grid(SCENE, GRID)


def test_a_worker_hands_back_what_it_has_no_time_for(monkeypatch):
    monkeypatch.setattr(sweeping, "SHORTEST", inf)
    monkeypatch.setattr(sweeping, "LONGEST", -1)
    monkeypatch.setattr(sweeping, "WAITING", 1)
    inline, grid = Inline(), {"h": [Q(1, n) for n in range(1, 41)]}
    assert [answer.values["h"] for answer in run_grid(SCENE, grid, inline)] == grid["h"]
    assert [len(batch) for batch in inline.sweep_batches] == [1, 2] * 19 + [1, 1]
    assert run_points(SCENE, [{"h": Q(1)}, {"h": Q(2)}])[0] == [run_method(replace(SCENE, h=Q(1)), "rk4")]


@pytest.mark.parametrize(
    ("seconds", "batches"),
    [
        (0.03125, [1, 1, 2, 2, 4, 4, 8, 8, 8, 2]),  # 4 take less than 0.2 s, and 8 take more
        (0.25, [1] * 40),
    ],
)
def test_batches_are_as_long_as_the_clock_says(seconds, batches, monkeypatch):
    now = [0.0]

    def run(scene, key):
        now[0] += seconds
        return {"steps": 1}

    monkeypatch.setattr(sweeping, "run_scene", run)
    monkeypatch.setattr(sweeping, "perf_counter", lambda: now[0])
    monkeypatch.setattr(sweeping, "WAITING", 2)
    inline, came = Inline(), []
    run_grid(SCENE, {"h": [Q(1, n) for n in range(1, 41)]}, inline, answered=came.append)
    assert [len(batch) for batch in inline.sweep_batches] == came == batches
    now[0] = 128.0
    found, took = run_points(SCENE, [{"h": Q(1)}] * 200)
    assert (len(found), took) == {0.25: (5, 1.25)}.get(seconds, (len(found), took))
    assert 1 < took <= 1 + seconds + 1e-9


def test_64_batches_are_under_way_at_a_time(monkeypatch):
    under_way = []
    monkeypatch.setattr(sweeping, "wait", lambda running, **how: under_way.append(len(running)) or wait(running, **how))
    run_grid(SCENE, {"h": [Q(1, n) for n in range(1, 101)]}, Inline())
    assert under_way[0] == 64


def test_what_is_left_of_an_abandoned_sweep_is_cancelled():
    given: list[Future] = []

    class Slow(Executor):
        def submit(self, task, scene, points):
            given.append(Future())
            if len(given) == 1:
                given[0].set_result(task(scene, points))
            return given[-1]

    batches = sweeping.sweep_batches(SCENE, GRID, Slow())
    assert len(next(batches)) == 1
    batches.close()
    assert [future.cancelled() for future in given] == [False] + [True] * 11


def test_processes_of_an_abandoned_sweep_are_killed_and_hear_no_interrupt(monkeypatch):
    mask, pools = signal.pthread_sigmask(signal.SIG_BLOCK, []), []
    monkeypatch.setattr(sweeping, "LONGEST", -1)
    monkeypatch.setattr(sweeping, "processes", lambda make=sweeping.processes: pools.append(make(1)) or pools[0])
    batches = sweeping.sweep_batches(SCENE, GRID)
    assert [len(next(batches)), len(next(batches))] == [1, 1]
    (process,) = pools[0]._processes.values()
    os.kill(process.pid, signal.SIGINT)
    assert len(next(batches)) == 1
    batches.close()
    assert process.exitcode == -signal.SIGKILL
    assert signal.pthread_sigmask(signal.SIG_BLOCK, []) == mask


@pytest.mark.slow
@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGKILL])
def test_processes_of_a_sweep_that_is_killed_end_with_it(number, tmp_path):
    """They have its standard output, which is at its end only when they are. Two keep each other's queue open."""
    lines = (
        "import os, time", "from driftproof.numeric.sweep import processes", "if __name__ == '__main__':",
        "    pool = processes(2)", "    [task.result() for task in [pool.submit(time.sleep, 1) for _ in range(4)]]",
        f"    os.kill(os.getpid(), {int(number)})",
    )  # fmt: skip
    (tmp_path / "killed.py").write_text("\n".join(lines), encoding="utf-8")
    killed = subprocess.run([sys.executable, tmp_path / "killed.py"], stdout=subprocess.PIPE, timeout=60, check=False)
    assert killed.returncode == -number


def test_a_worker_that_dies_is_told_of_in_one_line_and_a_defect_of_the_program_is_no_answer(monkeypatch):
    class Dying(Executor):
        def submit(self, task, *arguments):
            future: Future = Future()
            future.set_exception(BrokenExecutor("a child\nwas killed"))
            return future

    with pytest.raises(OSError, match="a process of the sweep ended before it answered") as caught:
        run_grid(SCENE, GRID, Dying())
    assert "\n" not in str(caught.value)
    monkeypatch.setattr(sweeping, "run_scene", None)
    with pytest.raises(TypeError):
        run_grid(SCENE, GRID, Inline())


# Files


def test_a_file_says_what_it_is_of_and_has_every_line_on_the_disk_before_the_next(tmp_path, monkeypatch):
    path, sizes = tmp_path / "new" / "folder" / "answers.jsonl", []
    synchronise = lambda file: sizes.append(path.stat().st_size)
    monkeypatch.setattr(sweeping, "os", SimpleNamespace(fsync=synchronise))
    run_grid(replace(SCENE, name="é", readouts=("steps",)), {"h": [Q(1, 2)]}, Inline(), path)
    head, line = path.read_text(encoding="utf-8").splitlines(keepends=True)
    definition = sweeping.digest((None, [METHODS["rk4"]]))
    assert head == (
        f'{{"sweep": "é", "driftproof": "{__version__}", "selected": "rk4", "h": "1/4", "t": "2", '
        f'"start": ["1", "0"], "readouts": ["steps"], "definition": "{definition}", "grid": [["h", ["1/2"]]]}}\n'
    )
    assert re.fullmatch(r'\{"point": 0, "h": "1/2", "readouts": \{"steps": 4\}, "checksum": "[0-9a-f]{16}"\}\n', line)
    assert sizes[:2] == [len(head.encode()), len((head + line).encode())]


def test_a_sweep_cut_off_anywhere_goes_on_and_leaves_the_same_bytes(expected, tmp_path):
    path, whole = tmp_path / "answers.jsonl", tmp_path / "whole.jsonl"
    assert run_grid(SCENE, GRID, Inline(), whole) == expected
    text = whole.read_bytes()
    assert text.count(b"\n") == 1 + len(expected)
    for cut in [*range(0, len(text), 97), len(text) - 1, len(text)]:
        path.write_bytes(text[:cut])
        inline = Inline()
        assert run_grid(SCENE, GRID, inline, path) == expected
        assert path.read_bytes() == text
        assert sum(map(len, inline.sweep_batches)) == len(expected) - max(0, text[:cut].count(b"\n") - 1)


def test_answers_are_kept_as_they_come(expected, tmp_path, monkeypatch):
    """Of a sweep that fails in its midst, what was found until then is there."""

    class Failing(Inline):
        def submit(self, task, scene, points):
            if len(self.sweep_batches) == 5:
                raise MemoryError
            return super().submit(task, scene, points)

    path = tmp_path / "answers.jsonl"
    monkeypatch.setattr(sweeping, "WAITING", 1)
    monkeypatch.setattr(sweeping, "SHORTEST", -1)
    with pytest.raises(MemoryError):
        run_grid(SCENE, GRID, Failing(), path)
    assert path.read_bytes().count(b"\n") == 1 + 5
    path.write_bytes(path.read_bytes()[:-9])  # the last line is cut off, and what comes next stands in its place
    with pytest.raises(MemoryError):
        run_grid(SCENE, GRID, Failing(), path)
    inline = Inline()
    assert run_grid(SCENE, GRID, inline, path) == expected
    assert sum(map(len, inline.sweep_batches)) == len(expected) - 4 - 5


def test_lines_in_any_order_are_read_and_put_in_the_order_of_the_grid(expected, tmp_path):
    path = tmp_path / "answers.jsonl"
    run_grid(SCENE, GRID, Inline(), path)
    head, *lines = path.read_bytes().splitlines(keepends=True)
    path.write_bytes(head + b"".join(reversed(lines)))
    assert run_grid(SCENE, GRID, Inline(), path) == expected
    assert path.read_bytes() == head + b"".join(lines)


def damaged(text: bytes) -> Iterator[tuple[bytes, str]]:
    head, first, *_ = text.splitlines(keepends=True)
    yield b"my notes\n" + first, "belongs to another sweep"
    yield b"my notes", "belongs to another sweep"
    yield head.replace(b"1/16", b"1/32") + first, "belongs to another sweep"
    yield head + first + first, "line 3: not an answer of this sweep, or a duplicate"
    yield head + b"{}\n" + first, "line 2: not an answer"
    yield head + b"\n" + first, "line 2: not an answer"
    yield head + first[:-9] + b"\n", "line 2: not an answer"
    yield head + first.replace(b'"point": 0', b'"point": 99'), "line 2: not an answer"
    yield head + first.replace(b'"point": 0', b'"point": 1'), "line 2: not an answer"
    yield head + first.replace(b"evaluations", b"calls"), "line 2: not an answer"
    yield head + b"[" * 10**5 + b"\n" + first, "line 2: not an answer"
    yield head + b'{"point": 0, "message": 3}\n', "line 2: not an answer"


def corruptions(text: bytes, other: bytes) -> Iterator[bytes]:
    """Bits flipped, digits changed, cuts, bytes and lines doubled and exchanged, and lines of another sweep."""
    random, lines = Random(13), text.splitlines(keepends=True)
    for _ in range(300):
        at = random.randrange(len(text))
        yield text[:at] + bytes([text[at] ^ 1 << random.randrange(8)]) + text[at + 1 :]
        yield text[:at] + bytes([random.choice(b"0123456789")]) + text[at + 1 :]
        yield text[:at] + text[at + 1 + random.randrange(9) :]
        yield text[:at] + text[at : at + 1] + text[at:]
        yield text[:at] + text[at + 1 : at + 2] + text[at : at + 1] + text[at + 2 :]
        i, k = random.randrange(1, len(lines)), random.randrange(1, len(lines))
        yield b"".join([*lines[:i], lines[k], *lines[i + 1 :]])
    yield from (b"".join([*lines[:i], line, *lines[i + 1 :]]) for i, line in enumerate(other.splitlines(keepends=True)))


@pytest.mark.slow
def test_no_corruption_of_a_file_is_taken_for_a_result(expected, tmp_path):
    """A damaged or foreign line is refused in one line, or its point is computed anew."""
    path, lines, taken = tmp_path / "answers.jsonl", list[str](), 0
    run_grid(SCENE, GRID, Inline(), path)
    whole = path.read_bytes()
    path.unlink()
    run_grid(replace(SCENE, start=(Q(1), Q(1, 3))), {**GRID, "start": [(Q(1), Q(0)), (Q(0), Q(1))]}, Inline(), path)
    for text in corruptions(whole, path.read_bytes()):
        path.write_bytes(text)
        try:
            kept = run_grid(SCENE, GRID, Inline(), path)
        except ValueError as refused:
            lines.append(str(refused))
        else:
            assert kept == expected
            taken += 1
    assert all(str(path) in line and "\n" not in line for line in lines)
    assert len(lines) > 1500
    assert len(lines) + taken == 1813


def test_two_sweeps_do_not_write_one_file(tmp_path):
    path = tmp_path / "answers.jsonl"
    batches = sweeping.sweep_batches(SCENE, GRID, Inline(), path)
    next(batches)
    with pytest.raises(BlockingIOError, match="another process is writing it"):
        run_grid(SCENE, GRID, Inline(), path)
    list(batches)
    run_grid(SCENE, GRID, Inline(), path)


def test_a_link_is_written_through_and_the_mode_and_a_draft_of_the_users_are_kept(tmp_path):
    path, link = tmp_path / "answers.jsonl", tmp_path / "link"
    drafts = [tmp_path / f"{name}.draft" for name in ("link", "answers.jsonl")]
    for draft in drafts:
        draft.write_bytes(b"mine")
    path.touch(0o600)
    link.symlink_to(path)
    run_grid(SCENE, GRID, Inline(), link)
    assert link.is_symlink()
    assert path.read_bytes().count(b"\n") == 13
    assert path.stat().st_mode & 0o777 == 0o600
    assert [draft.read_bytes() for draft in drafts] == [b"mine"] * 2


def test_a_file_that_is_not_of_this_sweep_is_refused_and_left_as_it_is(tmp_path):
    path = tmp_path / "answers.jsonl"
    run_grid(SCENE, GRID, Inline(), path)
    for text, message in some(damaged(path.read_bytes())):
        path.write_bytes(text)
        with pytest.raises(ValueError, match=message) as caught:
            run_grid(SCENE, GRID, Inline(), path)
        assert "\n" not in str(caught.value)
        assert path.read_bytes() == text


@pytest.mark.parametrize(
    ("grid", "message"),
    [
        ({"step": [Q(1)]}, "no axis 'step'; choose from selected, h, t, start"), ({"h": []}, "the axis 'h' is"),
        ({"h": [0.1]}, "the axis 'h' has 0.1; write Fractions"), ({"selected": ["rk5"]}, "unknown method 'rk5'"),
        ({"selected": "rk4"}, "the axis 'selected' is 'rk4'; write a list"),
        *(({"start": [x]}, "write pairs of F") for x in (Q(1), (1.0, Q(0)), (Q(1), Q(0), Q(0)), [Q(1), Q(0)])),
    ],
)  # fmt: skip
def test_a_grid_that_is_none_is_refused_in_one_line(grid, message):
    with pytest.raises(ValueError, match=message) as caught:
        points_of(SCENE, grid)
    assert "\n" not in str(caught.value)


def test_a_scene_without_readouts_or_with_a_trajectory_is_not_swept():
    for readouts in ((), ("trajectory",)):
        scene = Scene("none", "rk4", Q(1), Q(2), readouts=readouts, panels=("phase_plane",))
        with pytest.raises(ValueError, match="a sweep needs readouts, and trajectory cannot be one"):
            points_of(scene, GRID)
