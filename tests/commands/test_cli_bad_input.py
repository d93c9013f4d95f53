"""Every command: one line and a non-zero exit for anything that cannot be answered."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from driftproof.commands.arguments import BAD_INPUT, REFUTED
from driftproof.texts.writing import text

Run = Callable[..., tuple[int, str, str]]

RK4 = ("rk4", "--h", "1/2")

BAD_INPUTS: list[tuple[tuple[str, ...], str]] = [
    ((), "required: COMMAND"),
    (("fly",), "unknown command 'fly'; did you mean verify? (`driftproof --help` lists all)"),
    (("step", "rk5", "--h", "1/2"), "unknown method 'rk5'; did you mean rk4 or rk38?"),
    (("step", "__import__('os')", "--h", "1"), 'unknown method "__import__'),
    (("step", "rk4"), "required: --h"),
    (("step", "rk4", "--h", "1//2"), "h: '1//2' is not a rational number; write an integer, a fraction like 1/4"),
    (("step", "rk4", "--h", "1/0"), "h: '1/0' divides by zero"),
    (("step", "rk4", "--h", "__import__('os').getpid()"), "is not a rational number"),
    (("step", "rk4", "--h", "nan"), "h: 'nan' is not a rational number"),
    (("step", "rk4", "--h", "1e999999999"), "h: '1e999999999' is too long"),
    (("step", "rk4", "--h", "1e999_999_999"), "h: '1e999_999_999' is too long"),
    (("step", "rk4", "--h", "9" * 5000), "is too long; at most 1200 characters"),
    (("step", "rk4", "--h", "0"), "a step of size 0 goes nowhere"),
    (("step", "rk4", "--h", "-0.0"), "a step of size 0 goes nowhere"),
    (("step", *RK4, "--state", "1"), "'1' is not a state; write position,velocity like 1,0"),
    (("step", *RK4, "--state", "1,0,0"), "'1,0,0' is not a state"),
    (("step", *RK4, "--state", "1,x"), "v: 'x' is not a rational number"),
    (("step", *RK4, "--state", "1e999999999,0"), "q: '1e999999999' is too long"),
    (("step", *RK4, "--digits", "0"), "'0' is not a number of digits from 1 to 10000"),
    (("step", *RK4, "--digits", "-3"), "'-3' is not a number of digits"),
    (("step", *RK4, "--digits", "1000000000"), "'1000000000' is not a number of digits"),
    (("step", *RK4, "--digits", "10001"), "'10001' is not a number of digits"),
    (("step", *RK4, "--digits", "1.5"), "'1.5' is not a number of digits"),
    (("step", *RK4, "--digits", "\u0663"), "is not a number of digits"),
    (("step", *RK4, "--rounding", "up"), "invalid choice: 'up'"),
    (("step", *RK4, "--format", "xml"), "invalid choice: 'xml'"),
    (("step", *RK4, "more\nwords"), "unrecognized arguments: more words"),
    (("run", *RK4), "required: --t"),
    (("run", "rk4", "--h", "1e-10", "--t", "1", "--budget"), "10000000000 steps are more than 100000000"),
    (("run", "rk4", "--h", "0.3", "--t", "10"), "h = 3/10 does not divide t = 10"),
    (("run", "rk4", "--h", "-1/2", "--t", "10"), "h = -1/2 leads away from t = 10"),
    (("run", "rk4", "--h", "1/2", "--t", "ten"), "t: 'ten' is not a rational number"),
    (("scene", "defualt"), "unknown scene 'defualt'; did you mean default?"),
    (("scene", "none.toml"), "none.toml: No such file or directory"),
    (("scene", "two\nlines.toml"), "No such file or directory"),
    (("scene",), "required: name"),
    (("values", "--only", "no such id"), "no published value has an id that matches 'no such id'"),
    (("values", "--format", "xml"), "invalid choice: 'xml'"),
    (("facts", "none.toml"), "none.toml: No such file or directory"),
    (("facts", "."), "unknown method '.' (`driftproof methods` lists all)"),
    (("facts", "rk4", "--terms", "0"), "'0' is not a number of terms from 1 to 1000"),
    (("check", "none.md", "--init"), "driftproof check: none.md: No such file or directory"),
    (("check", "none.md", "--init", "--run"), "--init drafts claims; --run, --coverage and --format need --claims"),
    (("stability", "nope"), "unknown problem 'nope' (`driftproof stability` lists all)"),
    (("stability", "stiff_oscillator", "--h", "1/500,x"), "h: 'x' is not a rational number"),
    (("stability", "kaps", "--h", "1e300"), "h = 1000000000000000000000000000000000000... does not divide t = 1 "),
    (("work-precision", "--time-limit", "1e400"), "'1e400' is too large a time limit"),
    (("work-precision", "--time-limit", "-1"), "'-1' is no time limit; write a number above 0"),
    (("work-precision", "-o", "pyproject.toml"), "pyproject.toml is a file; name a folder"),
    (("work-precision", "--peers", "scipi"), "unknown peer 'scipi'; did you mean scipy?"),
    (("scene", "default", "--figures", "pyproject.toml"), "pyproject.toml is a file; name a folder"),
    (("report", "default", "-o", "/proc/page.html"), "driftproof report: /proc/page.html: No such file or directory"),
    (("verify", "os:getcwd", "--method", "backward_euler", "--solver-tolerance", "-1"), "tolerance -1 is below zero"),
    (("step", *RK4, "--stage", "2"), "driftproof step: unrecognized arguments: --stage 2 (`driftproof step --help`"),
]


@pytest.mark.parametrize(("arguments", "message"), BAD_INPUTS, ids=range(len(BAD_INPUTS)))
def test_bad_input_gives_one_line_and_a_nonzero_exit(arguments: tuple[str, ...], message: str, run: Run) -> None:
    status, out, err = run(*arguments)
    assert (status, out) == (BAD_INPUT, "")
    assert message in err
    assert err.startswith("driftproof")
    assert err.count("\n") == 1
    assert err.endswith("\n")


def test_real_process_has_the_same_manners(tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-m", "driftproof", "step", "rk5", "--h", "1/2"],
        cwd=Path(__file__).parents[2],
        capture_output=True,
        text=True,
        timeout=60,
    )
    assert (done.returncode, done.stdout) == (BAD_INPUT, "")
    assert done.stderr.count("\n") == 1
    assert "Traceback" not in done.stderr


def test_answer_that_is_no_is_quiet_too_where_nobody_reads_it(tmp_path: Path) -> None:
    old, new = tmp_path / "old.json", tmp_path / "new.json"
    old.write_text('{"values": {"x": {"exact": "1", "decimal": "1"}}}', encoding="utf-8")
    new.write_text('{"values": {"x": {"exact": "2", "decimal": "2"}}}', encoding="utf-8")
    read, write = os.pipe()
    os.close(read)
    command = [sys.executable, "-m", "driftproof", "diff", str(old), str(new)]
    done = subprocess.run(
        command, cwd=Path(__file__).parents[2], stdout=write, stderr=subprocess.PIPE, text=True, timeout=60
    )
    os.close(write)
    assert (done.returncode, done.stderr) == (REFUTED, "")


def test_stepper_that_is_examined_leaves_no_folder_behind(tmp_path: Path) -> None:
    source = "def step(q, v, h):\n    return q + h * v, v - h * q\n"
    (tmp_path / "mine.py").write_text(source, encoding="utf-8")
    path = os.pathsep.join([str(Path(__file__).parents[2]), *sys.path])
    subprocess.run(
        [sys.executable, "-B", "-m", "driftproof", "verify", "mine:step", "--method", "forward_euler"],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": path, "PYTHONDONTWRITEBYTECODE": "1"},
        check=True,
        capture_output=True,
        timeout=120,
    )
    assert [path.name for path in tmp_path.iterdir()] == ["mine.py"]


def test_pictures_without_matplotlib_say_what_to_install(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    needed = "pictures need matplotlib; install it with pip install 'driftproof[report]'"
    assert run("facts", "rk4", "--plot", "x.svg") == (BAD_INPUT, "", f"driftproof facts: {needed}\n")


@pytest.mark.parametrize("name", ["region", "region.bogus"])
def test_picture_of_no_kind_is_refused_and_leaves_nothing(name: str, run: Run, tmp_path: Path) -> None:
    status, out, err = run("facts", "rk4", "--only", "order", "--plot", str(tmp_path / name))
    assert (status, out, err.count("\n")) == (BAD_INPUT, "", 1)
    assert "the name of a picture ends in one of" in err
    assert list(tmp_path.iterdir()) == []


def test_interrupted_question_says_so_in_one_line(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted() -> str:
        raise KeyboardInterrupt

    monkeypatch.setattr(text, "methods_text", interrupted)
    assert run("methods") == (130, "", "driftproof methods: interrupted\n")


def test_message_of_many_lines_is_printed_on_one(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    def broken() -> str:
        raise ValueError("one\n  two\n")

    monkeypatch.setattr(text, "methods_text", broken)
    assert run("methods") == (BAD_INPUT, "", "driftproof methods: one two\n")


def test_defect_of_the_program_is_not_dressed_as_bad_input(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    def broken() -> str:
        raise TypeError("a defect")

    monkeypatch.setattr(text, "methods_text", broken)
    with pytest.raises(TypeError):
        run("methods")
