"""`driftproof run`: certified readouts to the letter, undefined as null, no step and ten million steps."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable

import pytest

from driftproof.commands.arguments import LONG_RUN, NO_ANSWER, count_steps

Run = Callable[..., tuple[int, str, str]]

Answer = Callable[..., str]

RUN = """\
Forward Euler (forward_euler): 40 steps of h = 1/4 from (1, 0) to t = 10

final state q  -3.12900713279485795083259563110
final state v  1.22937903463293923853576097167
exact state q  -0.839071529076452452258863947824         exactly cos(10)
exact state v  0.544021110889369813404747661851          exactly -sin(10)
state error    2.39029716830675147537827059350
energy         5.65102922393805771725009208643
energy change  5.15102922393805771725009208643
phase error    -11.5080564137640654522887417745 degrees
steps          40
evaluations    40

30 digits, rounded half-even, certified
"""


def test_run_prints_every_certified_readout(answer: Answer) -> None:
    assert answer("run", "forward_euler", "--h", "1/4", "--t", "10", "--digits", "30") == RUN


def test_run_as_json_has_units_counts_and_undefined_as_null(answer: Answer) -> None:
    found = json.loads(answer("run", "rk4", "--h", "1/4", "--t", "10", "--format", "json"))
    assert (found["steps"], found["evaluations"]) == (40, 160)
    assert found["phase_error"]["unit"] == "degrees"
    assert found["exact_state"]["q"]["exact"] == "cos(10)"
    assert found["state_error"]["exact"] is None
    undefined = json.loads(answer("run", "rk4", "--h", "1/4", "--t", "10", "--state", "0,0", "--format", "json"))
    assert undefined["phase_error"] is None
    assert "undefined at the origin" in answer("run", "rk4", "--h", "1/4", "--t", "10", "--state", "0,0")


def test_no_time_and_the_origin_have_exact_answers(answer: Answer) -> None:
    found = json.loads(answer("run", "rk4", "--h", "1", "--t", "0", "--state", "1/3,3/20", "--format", "json"))
    assert found["state_error"] == {"exact": "0", "decimal": "0"}
    assert found["phase_error"] == {"exact": "0", "decimal": "0", "unit": "degrees"}
    assert found["exact_state"]["q"] == found["final_state"]["q"]
    assert (found["steps"], found["evaluations"]) == (0, 0)


def test_ten_million_steps_and_far_more_are_answered(answer: Answer) -> None:
    million = answer("run", "symplectic_euler", "--h", "1/4", "--t", "2500000", "--digits", "20")
    assert "10000000 steps" in million
    assert "2.5e" not in million
    assert "1" + 44 * "0" in answer("run", "symplectic_euler", "--h", "1", "--t", "1e44")


def test_question_without_an_answer_gives_one_line_and_its_own_exit(run: Run) -> None:
    status, out, err = run("run", "forward_euler", "--h", "1/4", "--t", "1e100")
    assert (status, out) == (NO_ANSWER, "")
    assert err == "driftproof run: the number lies outside 10**-78000 .. 10**78000, too long to write out\n"


def test_progress_bar_is_for_long_runs_on_a_terminal_only(monkeypatch: pytest.MonkeyPatch) -> None:
    assert count_steps(LONG_RUN * 10) == range(LONG_RUN * 10)  # standard error is no terminal here
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True, raising=False)
    assert count_steps(10) == range(10)
    bar = count_steps(LONG_RUN)
    assert not isinstance(bar, range)
    assert len(bar) == LONG_RUN
    bar.close()
