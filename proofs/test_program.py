"""The experiment as a program, ours and the lesson's own if available: what it imports, prints and refuses."""

from __future__ import annotations

import re
import runpy
import subprocess
import sys
from fractions import Fraction as Q
from itertools import permutations
from pathlib import Path

import pytest

from driftproof.methods.catalogue import entry_named
from driftproof.methods.numbers.rationals import step_count
from driftproof.methods.programs.stepping import oscillator
from driftproof.numeric.run import run_method
from driftproof.numeric.scenes import PRESETS
from driftproof.numeric.steppers import HAND_WRITTEN
from driftproof.symbolic.derivation.one_step import STATE_H, STATE_Q, STATE_V
from proofs import program
from proofs.claims import COUNTED, PROVED, claim
from proofs.printed import ROWS
from proofs.setting import DEFAULT_H, END, LESSON_METHODS

PROGRAM = Path(program.__file__)
LESSON = Path(__file__).parents[2] / "shared" / "lesson" / "lesson.txt"
# Runs a file as a program, then prints the modules that it imported from outside the standard library.
AUDIT = """\
import runpy, sys
before = set(sys.modules)
runpy.run_path(sys.argv[1], run_name="__main__")
tops = {name.partition(".")[0] for name in set(sys.modules) - before}
print("foreign:", sorted(tops - set(sys.stdlib_module_names) - {"__main__"}))
"""


def output(file: Path) -> list[str]:
    """The output of the file and then of AUDIT, in an interpreter that sees neither this checkout nor any package."""
    command = [sys.executable, "-I", "-S", "-c", AUDIT, str(file)]
    return subprocess.run(command, capture_output=True, text=True, check=True, timeout=60).stdout.splitlines()


def numbers(line: str) -> list[str]:
    """The decimal numbers of a line."""
    return re.findall(r"-?\d+\.\d+", line)


def listing(folder: Path) -> Path:
    """The lesson's own program, from its first import to the words before its output, as a file in `folder`."""
    text = LESSON.read_text(encoding="utf-8")
    start = text.index("from math import")
    path = folder / "listing.py"
    path.write_text(text[start : text.index("Expected output:")], encoding="utf-8")
    return path


@claim("L202", evidence=COUNTED, by="program run, imports counted")
def test_program_needs_only_the_standard_library(tmp_path: Path) -> None:
    """Our program of the standard library alone implements all three updates: it runs without any other package."""
    assert output(PROGRAM)[-1] == "foreign: []"
    for key, name in zip(LESSON_METHODS, program.METHODS, strict=True):  # bit for bit, h being a power of two
        assert program.step(name, (0.75, -0.5), 0.5) == HAND_WRITTEN[key](oscillator, 0.75, -0.5, 0.5)
    other = tmp_path / "other.py"  # the audit notices other imports
    (tmp_path / "methods.py").write_text("", encoding="utf-8")
    other.write_text(f"import sys; sys.path.insert(0, {str(tmp_path)!r}); import methods\n", encoding="utf-8")
    assert output(other)[-1] == "foreign: ['methods']"


@claim("L209", evidence=COUNTED, by="program run, lines compared")
def test_program_prints_the_seven_lines() -> None:
    """Our program prints seven lines, with the digits that the exact values have."""
    texts = {row.claim: row.text for row in ROWS}
    lines = [numbers(line) for line in output(PROGRAM)[:-1]]
    assert [x for line in lines for x in line] == [texts[f"L{i}"] for i in range(210, 227)]
    assert len(lines) == 7


@pytest.mark.skipif(not LESSON.exists(), reason="the lesson is not beside this checkout")
def test_listing_of_the_lesson_prints_the_same_digits(tmp_path: Path) -> None:
    """The lesson's own listing needs no other package either, prints the same numbers, forms the same polynomials."""
    own, theirs = output(PROGRAM), output(listing(tmp_path))
    assert theirs[-1] == "foreign: []"
    assert [numbers(line) for line in theirs[:-1]] == [numbers(line) for line in own[:-1]]
    their = runpy.run_path(str(listing(tmp_path)))
    for name in program.METHODS:
        assert their["advance"](name, (STATE_Q, STATE_V), STATE_H) == program.step(name, (STATE_Q, STATE_V), STATE_H)
    assert their["energy"]((STATE_Q, STATE_V)) == program.energy((STATE_Q, STATE_V))
    with pytest.raises(ValueError, match=r"^Unknown method$"):
        their["advance"](Unequal(), (1.0, 0.0), 0.5)


@claim("L203", evidence=PROVED, by="dyadic step")
def test_whole_number_of_quarters_is_ten() -> None:
    """In our program each method starts afresh; forty steps of 1/4 make exactly 10, in floats too: 1/4 is dyadic."""
    assert step_count(END, DEFAULT_H) * DEFAULT_H == END
    assert Q(0.25) == DEFAULT_H
    assert Q(40 * 0.25) == END
    assert Q(float(Q(1, 10))) != PRESETS["small_steps"].h
    orders = list(permutations(program.METHODS))
    reached = [{name: program.final_state(name, 0.25, 40) for name in order} for order in orders]
    assert reached == [reached[0]] * 6
    for key, name in zip(LESSON_METHODS, program.METHODS, strict=True):
        assert run_method(PRESETS["default"], key)["final_state"] == reached[0][name]  # bit for bit, h being dyadic


class Unequal:
    """A name that is equal to none, and keeps what it is compared with; nothing else can be done with it."""

    def __init__(self) -> None:
        """Start with no comparison."""
        self.compared: list[object] = []

    def __eq__(self, other: object) -> bool:
        """Keep the other, and be unequal to it."""
        self.compared.append(other)
        return False


@claim("L206", evidence=COUNTED, by="raises on purpose")
def test_unknown_method_is_refused() -> None:
    """Our program refuses a method that is none of its three with a ValueError that says so, and never replaces it.

    It compares a name with the three and does nothing else with it, so one that equals none stands for all.
    """
    for name in ("Leapfrog", "Symplectic ", unequal := Unequal()):
        with pytest.raises(ValueError, match=r"^Unknown method$"):
            program.step(name, (1.0, 0.0), 0.5)  # type: ignore[arg-type]
    assert unequal.compared == [*program.METHODS]
    for name in ("Leapfrog", "", "Symplectic "):  # the first is ambiguous, the others are unknown
        with pytest.raises(ValueError, match=f"^(unknown method )?{name!r}"):
            entry_named(name)
    assert [program.step(name, (1.0, 0.0), 0.5)[1] < 0 for name in program.METHODS] == [True] * 3
