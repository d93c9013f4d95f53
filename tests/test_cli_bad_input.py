"""Every command: one line and a non-zero exit for anything that cannot be answered."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from driftproof import text
from driftproof.arguments import BAD_INPUT

Run = Callable[..., tuple[int, str, str]]

RK4 = ("rk4", "--h", "1/2")

BAD_INPUTS: list[tuple[tuple[str, ...], str]] = [
    ((), "required: COMMAND"),
    (("fly",), "invalid choice: 'fly'"),
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
    (("run", "rk4", "--h", "0.3", "--t", "10"), "h = 3/10 does not divide t = 10"),
    (("run", "rk4", "--h", "-1/2", "--t", "10"), "h = -1/2 leads away from t = 10"),
    (("run", "rk4", "--h", "1/2", "--t", "ten"), "t: 'ten' is not a rational number"),
    (("scene", "defualt"), "unknown scene 'defualt'; did you mean default?"),
    (("scene", "none.toml"), "none.toml: No such file or directory"),
    (("scene", "two\nlines.toml"), "No such file or directory"),
    (("scene",), "required: name"),
    (("values", "--only", "no such id"), "no published value has an id that matches 'no such id'"),
    (("values", "--format", "xml"), "invalid choice: 'xml'"),
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
        cwd=Path(__file__).parents[1],
        capture_output=True,
        text=True,
        timeout=60,
    )
    assert (done.returncode, done.stdout) == (BAD_INPUT, "")
    assert done.stderr.count("\n") == 1
    assert "Traceback" not in done.stderr


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
