"""Whole runs, certified: against stepping with fractions, against mpmath, and where numbers are exact or undefined."""

from __future__ import annotations

from fractions import Fraction as Q
from typing import Any

import mpmath
import pytest
import sympy
from hypothesis import assume, given
from hypothesis import strategies as st

from driftproof import strategies
from driftproof.methods.problems import oscillator
from driftproof.methods.schemes import RungeKutta
from driftproof.methods.stepping import stepper
from driftproof.symbolic import oscillator_run
from driftproof.symbolic.algebra.certified import Uncertified, fixed, is_less, significant
from driftproof.symbolic.oscillator_run import OscillatorRun
from tests.nine import NINE

EULER, SYMPLECTIC, RK4 = NINE["forward_euler"], NINE["symplectic_euler"], NINE["rk4"]
START = (Q(1), Q(0))
WIDE = mpmath.mp.clone()
WIDE.dps = 60


def stepped(key: str, h: Q, n: int, state: tuple[Q, Q]) -> tuple[Q, Q]:
    step = stepper(NINE[key], lambda c: c)
    for _ in range(n):
        state = step(oscillator, *state, h)
    return state


RUNS = st.builds(
    lambda key, h, n, start: (OscillatorRun(NINE[key], h, n * h, start), stepped(key, h, n, start)),
    st.sampled_from(sorted(NINE)),
    strategies.rational_steps(max_denominator=20),
    st.integers(0, 12),
    strategies.rational_states(max_size=10, max_denominator=20),
)


@given(RUNS)
def test_final_state_is_that_of_stepping_with_fractions(drawn: tuple[OscillatorRun, tuple[Q, Q]]) -> None:
    run, (q, v) = drawn
    assert run.has_short_fractions
    assert run.final_state == (q, v)
    assert run.energy == (q * q + v * v) / 2
    assert run.energy_change == run.energy - sum(x * x for x in run.start) / 2


def mp(x: Q) -> Any:
    return WIDE.mpf(x.numerator) / x.denominator


def by_complex_numbers(run: OscillatorRun, state: tuple[Q, Q]) -> tuple[Any, Any]:
    """State error and phase error by another road: q - iv turns anticlockwise, and quotients have angles."""
    numerical = WIDE.mpc(mp(state[0]), -mp(state[1]))
    exact = WIDE.mpc(mp(run.start[0]), -mp(run.start[1])) * WIDE.expj(mp(run.t))
    degrees = WIDE.degrees(WIDE.arg(numerical / exact)) if exact and numerical else None
    return abs(numerical - exact), degrees


def agree(text: str, value: Any) -> bool:
    """30 correctly rounded digits against mpmath's 60, of which the sums above lose 25 at most: see the `assume`s."""
    return bool(abs(WIDE.mpf(text) - value) <= abs(value) * 5 * WIDE.mpf(10) ** -30)


@given(RUNS)
def test_errors_agree_with_complex_arithmetic_in_mpmath(drawn: tuple[OscillatorRun, tuple[Q, Q]]) -> None:
    run, state = drawn
    distance, degrees = by_complex_numbers(run, state)
    assume(distance == 0 or distance > WIDE.mpf(10) ** -20)
    assert agree(significant(run.state_error, 30), distance)
    assert (run.phase_error is None) == (degrees is None)
    if degrees is not None and run.phase_error != 0:
        assume(WIDE.mpf(10) ** -20 < abs(degrees))
        assert agree(significant(run.phase_error, 30), degrees)


def test_witness_notices_a_state_one_step_short() -> None:
    run = OscillatorRun(EULER, Q(1, 4), Q(10))
    text = significant(run.state_error, 30)
    assert agree(text, by_complex_numbers(run, stepped("forward_euler", Q(1, 4), 40, START))[0])
    assert not agree(text, by_complex_numbers(run, stepped("forward_euler", Q(1, 4), 39, START))[0])


def test_lesson_run_has_its_digits() -> None:
    run = OscillatorRun(EULER, Q(1, 4), Q(10))
    assert significant(run.state_error, 30) == "2.39029716830675147537827059350"
    assert fixed(run.phase_error, 6) == "-11.508056"
    assert (run.steps, run.exact_state) == (40, (sympy.cos(10), -sympy.sin(10)))


def test_certified_readouts_lie_where_they_must() -> None:
    for key in NINE:
        run = OscillatorRun(NINE[key], Q(1, 2), Q(100))
        assert is_less(Q(0), run.state_error)
        assert is_less(Q(-180), run.phase_error)
        assert is_less(run.phase_error, Q(180))


def test_positive_phase_error_means_ahead() -> None:
    """A step of Verlet turns by 2 asin(h/2) > h, on average: ahead. One of forward Euler by atan h < h: behind."""
    assert is_less(Q(0), OscillatorRun(NINE["velocity_verlet"], Q(1, 2), Q(50)).phase_error)
    assert is_less(OscillatorRun(EULER, Q(1), Q(1)).phase_error, Q(0))


def test_whole_turns_are_not_counted() -> None:
    """Symplectic Euler at h = 1 turns by 60 degrees a step; after 6·k steps it is where it was, and t = 6k is not."""
    run = OscillatorRun(SYMPLECTIC, Q(1), Q(6000))
    assert run.final_state == START
    turns = WIDE.mpf(6000) / (2 * WIDE.pi)
    assert 954 < turns < 955
    assert agree(significant(run.phase_error, 30), 360 * (955 - turns))


@pytest.mark.parametrize("start", [(Q(1), Q(0)), (Q(1, 3), Q(3, 20)), (Q(-1, 7), Q(0))])
def test_no_time_means_no_error_exactly(start: tuple[Q, Q]) -> None:
    run = OscillatorRun(RK4, Q(1, 3), Q(0), start)
    assert (run.steps, run.final_state, run.exact_state) == (0, start, start)
    assert (run.state_error, run.energy_change, run.phase_error) == (0, 0, 0)
    assert fixed(run.exact_state[1], 1) == fixed(start[1], 1)  # 3/20 is a tie, which only a fraction can settle


def test_phase_error_is_undefined_at_the_origin_and_the_state_error_is_zero() -> None:
    run = OscillatorRun(RK4, Q(1, 3), Q(7), (Q(0), Q(0)))
    assert run.phase_error is None
    assert significant(run.state_error, 5) == "0"


def test_phase_error_is_undefined_where_the_numerical_state_reaches_the_origin() -> None:
    """z + h(k₂ - k₁) = (1 - h²) z: inconsistent, but a method, and it stops dead at h = 1."""
    stops = RungeKutta("stops", "Stops", 0, "test", ((0, 0), (1, 0)), (-1, 1), (0, 1))
    run = OscillatorRun(stops, Q(1), Q(1))
    assert run.final_state == (0, 0)
    assert run.phase_error is None
    assert significant(run.state_error, 20) == "1.0000000000000000000"


def test_periodic_run_keeps_exact_fractions_however_long() -> None:
    run = OscillatorRun(SYMPLECTIC, Q(1), Q(6 * 10**50 + 2), (Q(1, 3), Q(1, 3)))
    assert run.final_state == (0, Q(-1, 3))
    assert significant(run.final_state[0], 5) == "0"
    assert run.energy == Q(1, 18)


def test_long_and_short_forms_print_the_same_digits(monkeypatch: pytest.MonkeyPatch) -> None:
    short = OscillatorRun(RK4, Q(1, 4), Q(10), (Q(1, 3), Q(2)))
    assert short.has_short_fractions
    monkeypatch.setattr(oscillator_run, "LONGEST_FRACTION", 10)
    long = OscillatorRun(RK4, Q(1, 4), Q(10), (Q(1, 3), Q(2)))
    assert not long.has_short_fractions
    assert callable(long.energy)
    for name in ("energy", "energy_change", "state_error", "phase_error"):
        assert significant(getattr(short, name), 40) == significant(getattr(long, name), 40)
    assert [fixed(x, 40) for x in short.final_state] == [fixed(x, 40) for x in long.final_state]


@pytest.mark.parametrize("power", [7, 45, 60, 300])
def test_any_number_of_steps_is_answered(power: int) -> None:
    """At 128 bits some of these runs are balls wider than any number that can be written out; that is not an answer."""
    run = OscillatorRun(SYMPLECTIC, Q(1, 4), Q(10**power, 4))
    q, v = (Q(significant(x, 30)) for x in run.final_state)
    # The quantity that the method conserves is still 1/2, to the digits that the components have.
    assert abs((q * q + v * v - q * v / 4) / 2 - Q(1, 2)) < Q(4, 10**29)


def test_run_that_outgrows_all_writing_is_refused_in_one_line() -> None:
    run = OscillatorRun(EULER, Q(1, 4), Q(10**30))
    with pytest.raises(Uncertified, match="too long to write out") as caught:
        significant(run.energy, 5)
    assert "\n" not in str(caught.value)


def test_step_that_does_not_divide_is_refused_when_the_run_is_made() -> None:
    with pytest.raises(ValueError, match="nearest that do: 10/33 and 5/17"):
        OscillatorRun(RK4, Q(3, 10), Q(10))


def test_time_runs_backwards_with_negative_steps() -> None:
    back = OscillatorRun(EULER, Q(-1, 4), Q(-10))
    assert back.final_state == stepped("forward_euler", Q(-1, 4), 40, START)
    assert significant(back.exact_state[1], 6) == "-0.544021"
