"""`driftproof scenes`, `scene`, `sweep` and `report`: the list, a scene's numbers and figures, refusals in one line."""

import os
import signal
import subprocess
import sys
import time
from fractions import Fraction as Q
from functools import partial
from pathlib import Path

import pytest

from driftproof import PRESETS, sweep
from tests.looping import some

ROOT = Path(__file__).parents[2]


def test_scene_compares_the_methods_that_are_named(answer):
    shown = answer("scene", "default", "--methods", "implicit_midpoint,rk4")
    assert shown.startswith("default: Implicit midpoint")
    assert [line.split()[0] for line in shown.splitlines()[-2:]] == ["Implicit", "Classical"]


def test_figures_of_a_scene_that_draws_none_are_refused(refusal, tmp_path):
    path = tmp_path / "bare.toml"
    path.write_text('selected = "rk4"\nh = 1\nt = 4\nreadouts = ["energy"]\npanels = ["table"]\nmethods = ["rk4"]\n')
    assert "no figure to draw: give panels position or phase_plane" in refusal("scene", str(path), "--figures", "new")
    assert not Path("new").exists()


def test_a_sweep_shows_what_the_function_finds_and_keeps_it_in_a_file(answer, refusal, tmp_path):
    found = sweep(PRESETS["default"], methods="rk4,forward_euler", h=[Q(1, 4), Q(3, 10)]).found
    words = ("sweep", "default", "--h", "1/4,0.3", "--methods", "rk4, forward_euler")
    lines = answer(*words).splitlines()
    assert lines[0] == "default: 4 points"
    assert lines[2].split("  ")[0] == "method"
    assert lines[3].split() == ["rk4", "1/4", "0.0003253", "0.4999", "-6.728e-5", "-0.01824", "40", "160"]
    assert lines[4].endswith(found[1].found)
    path = tmp_path / "new" / "answers.jsonl"
    shown = answer(*words, "--format", "json", "-o", str(path))
    assert f'"state_error": "{found[2].found["state_error"]!r}"' in shown
    assert answer(*words, "--format", "json", "--output", str(path)) == shown
    assert "belongs to another sweep" in refusal(*words, "--t", "20", "-o", str(path))
    assert answer("sweep", "default", "--h", "1/8").startswith("default: 1 point\n")


def test_a_sweep_on_a_cluster_needs_distributed(refusal, monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    assert "pip install 'driftproof[cluster]'" in refusal("sweep", "default", "--cluster", "tcp://localhost:1")


@pytest.mark.parametrize("lines", [1, pytest.param(2, marks=pytest.mark.long)], ids=["at the start", "in the midst"])
def test_interrupt_of_a_sweep_is_one_line_and_leaves_the_answers_and_no_process(lines, tmp_path):
    """As Ctrl-C in a terminal reaches all of the group, processes among them that have hardly begun."""
    scene, path = tmp_path / "s.toml", tmp_path / "answers.jsonl"
    scene.write_text('selected = "rk4"\nh = 1\nt = 40\nreadouts = ["final_state"]\n', encoding="utf-8")
    words = ("sweep", str(scene), "--h", "1/4,1/1048576,1/2097152", "--workers", "2", "-o", str(path))
    command, pipe = (sys.executable, "-m", "driftproof", *words), subprocess.PIPE
    # What a shell starts with & is deaf to SIGINT, and so are its children.
    listening = partial(signal.signal, signal.SIGINT, signal.SIG_DFL)
    with subprocess.Popen(
        command, cwd=ROOT, stdout=pipe, stderr=pipe, text=True, start_new_session=True, preexec_fn=listening
    ) as running:
        while not path.exists() or path.read_bytes().count(b"\n") < lines:
            time.sleep(0.01)
        time.sleep(0.2)  # by now the processes are being started
        os.killpg(running.pid, signal.SIGINT)
        told = f"driftproof sweep: interrupted; the same command goes on from {path}\n"
        assert (*running.communicate(timeout=60), running.returncode) == ("", told, 130)
    assert lines <= path.read_bytes().count(b"\n") <= 2  # the short run may be answered by then, the long ones are not
    for _ in range(100):  # who is killed may still be on its way out
        listed = subprocess.run(["ps", "-e", "-o", "pgid=,stat="], capture_output=True, text=True, check=True).stdout
        left = {state[0] for group, state in map(str.split, some(listed.splitlines())) if int(group) == running.pid}
        if left <= {"Z"}:
            return
        time.sleep(0.1)
    raise AssertionError(f"processes in the states {left} are left")


REFUSED = {
    ("scene", "defualt"): "unknown scene 'defualt'; did you mean default?",
    ("scene", "default", "--figures", "pyproject.toml"): "pyproject.toml is a file; name a folder",
    ("scene", "--figures", "pictures"): "--figures has no effect without a scene",
    ("scene", "--methods", "rk4"): "--methods has no effect without a scene",
    ("sweep", "default", "--workers", "0"): "'0' is not allowed: the number of processes must be from 1 to 1024",
    ("sweep", "default", "--workers", "1", "--cluster", "tcp://x:1"): "not allowed with argument --workers",
    ("sweep", "default", "--cluster", "somewhere"): "'somewhere' is not the address of a scheduler, such as tcp://",
    ("sweep", "default", "-o", "."): "is a folder",
    ("report", "default", "-o", "/proc/page.html"): "/proc/page.html: No such file or directory",
    ("report", "default", "-o", "tests"): "tests is a folder; name a file in it",
    ("report", "default"): "required: -o/--output",
    ("report", "default", "-o", "pyproject.toml/r.html"): "pyproject.toml",
}


@pytest.mark.parametrize("words", REFUSED, ids=range(len(REFUSED)))
def test_refusal_is_one_line(words, refusal):
    assert REFUSED[words] in refusal(*words)
    assert not Path("r.html").exists()
