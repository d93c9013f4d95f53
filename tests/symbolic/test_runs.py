"""Powers by squaring, and whole certified runs: against stepping with fractions, mpmath and SymPy's own cosines."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction as Q
from typing import Any

import mpmath
import pytest
import sympy
from flint import arb
from hypothesis import assume, given
from hypothesis import strategies as st

from driftproof import strategies
from driftproof.methods.programs.stepping import oscillator, stepper
from driftproof.methods.schemes import Nystrom, RungeKutta
from driftproof.symbolic import runs
from driftproof.symbolic.algebra.certified import endpoints, fixed, significant
from driftproof.symbolic.runs import OscillatorRun, as_balls, exact_matrix_at, power, short_power
from tests.looping import exactly
from tests.nine import NINE

EULER, SYMPLECTIC, RK4 = NINE["forward_euler"], NINE["symplectic_euler"], NINE["rk4"]
START = (Q(1), Q(0))
WIDE = mpmath.mp.clone()
WIDE.dps = 60
MATRICES = st.tuples(*4 * [strategies.rationals(max_size=3, max_denominator=9)])


@given(MATRICES, st.integers(0, 40), st.integers(1, 200))
def test_short_power_is_the_power_or_nothing(matrix: tuple[Q, Q, Q, Q], n: int, bits: int) -> None:
    short, full = short_power(matrix, n, bits), power(matrix, n)
    length = max(max(abs(x.numerator), x.denominator).bit_length() for x in map(Q, full))
    assert short == full if short else length > bits or n > 0
    assert short is None or length <= bits or n == 0


def test_matrix_of_finite_order_has_short_powers_for_ever() -> None:
    sixth_of_a_turn = exact_matrix_at(SYMPLECTIC, Q(1))
    assert short_power(sixth_of_a_turn, 6 * 10**100 + 1, 1) == sixth_of_a_turn
    growing = exact_matrix_at(EULER, Q(1, 4))
    assert short_power(growing, 10**100, 4000) is None


@given(MATRICES, st.integers(0, 50))
def test_balls_enclose_the_exact_power(matrix: tuple[Q, Q, Q, Q], n: int) -> None:
    for ball, exact in exactly(4, zip(power(as_balls(matrix), n), power(matrix, n), strict=True)):
        low, high = endpoints(arb(ball))
        assert low <= exact <= high


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
    assert (run.steps, *map(str, run.exact_state)) == (40, "cos(10)", "-sin(10)")


@given(strategies.rational_states(max_size=4, max_denominator=20), strategies.rationals(max_size=20, max_denominator=3))
def test_exact_state_is_written_as_sympy_writes_it(start: tuple[Q, Q], t: Q) -> None:
    assume(t != 0)
    q, v, angle = (sympy.Rational(x.numerator, x.denominator) for x in (*start, t))
    c, s = sympy.cos(angle), sympy.sin(angle)
    found = OscillatorRun(EULER, t, t, start).exact_state
    assert tuple(map(str, found)) == (str(q * c + v * s), str(v * c - q * s))
    for x, wanted in zip(found, (q * c + v * s, v * c - q * s), strict=True):
        assert fixed(x, 25) == fixed(Q(str(sympy.N(wanted, 60))), 25)


@pytest.mark.parametrize(
    ("command", "used"),
    [
        *(("run rk4 --h 1/4 --t 10", "symbolic.runs"), ("step rk4 --h 1/4 --state 1,0", "methods.programs.stepping")),
        *(("facts gauss2", "symbolic.facts"), ("roundoff yoshida4 --h 1/10", "symbolic.rounding.step_bound")),
        ("verify examples.in_your_tests.springs:velocity_verlet --method rk4", "blackbox.verify"),
    ],
)
def test_answers_load_no_sympy(command: str, used: str, modules_after: Callable[[str], set[str]]) -> None:
    loaded = modules_after(f"from driftproof.cli import main; main({command.split()!r})")
    assert f"driftproof.{used}" in loaded
    assert "sympy" not in loaded


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


def test_phase_error_is_undefined_from_the_origin_or_where_the_numerical_state_reaches_it() -> None:
    """z + h(k₂ - k₁) = (1 - h²) z: inconsistent, but a method, and it stops dead at h = 1."""
    stops = RungeKutta("stops", "Stops", 0, "test", ((0, 0), (1, 0)), (-1, 1), (0, 1))
    for method, h, start, error in ((RK4, Q(1, 3), (Q(0), Q(0)), "0"), (stops, Q(1), START, "1.0000000000000000000")):
        run = OscillatorRun(method, h, h, start)
        assert (run.final_state, run.phase_error, significant(run.state_error, 20)) == ((0, 0), None, error)


def test_periodic_run_keeps_exact_fractions_however_long() -> None:
    run = OscillatorRun(SYMPLECTIC, Q(1), Q(6 * 10**50 + 2), (Q(1, 3), Q(1, 3)))
    assert run.final_state == (0, Q(-1, 3))
    assert significant(run.final_state[0], 5) == "0"
    assert run.energy == Q(1, 18)


def test_energies_that_every_step_conserves_are_fractions_however_long_the_state() -> None:
    run = OscillatorRun("implicit_midpoint", Q(1, 100), Q(100), (Q(1, 3), Q(1)))  # type: ignore[arg-type]
    assert not run.has_short_fractions
    assert (run.energy, run.energy_change) == (Q(5, 9), 0)
    assert callable(OscillatorRun(SYMPLECTIC, Q(1, 100), Q(100)).energy), "of determinant 1, but no rotation"


def test_a_start_is_read_exactly_or_refused() -> None:
    assert OscillatorRun(RK4, Q(1, 4), Q(10), (0.25, "1/3")).start == (Q(1, 4), Q(1, 3))  # type: ignore[arg-type]
    for start, why in (((0.1, 0.0), "the double 0.1 is not 0.1 exactly"), ((Q(1),), "position,velocity")):
        with pytest.raises(ValueError, match=why):
            OscillatorRun(RK4, Q(1, 4), Q(10), start)  # type: ignore[arg-type]


def test_long_and_short_forms_print_the_same_digits(monkeypatch: pytest.MonkeyPatch) -> None:
    short = OscillatorRun(RK4, Q(1, 4), Q(10), (Q(1, 3), Q(2)))
    assert short.has_short_fractions
    monkeypatch.setattr(runs, "LONGEST_FRACTION", 10)
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


def test_step_that_does_not_divide_and_step_at_a_pole_of_the_matrix_are_refused() -> None:
    """k = -(q + hv/2) + h² k/4 has no solution at h = 2."""
    with pytest.raises(ValueError, match="nearest that do: 10/33 and 5/17"):
        OscillatorRun(RK4, Q(3, 10), Q(10))
    pole = Nystrom("pole", "Pole", 0, "test", (Q(1, 2),), ((Q(-1, 4),),), (Q(1, 2),), (Q(1),))
    assert exact_matrix_at(pole, Q(1))
    with pytest.raises(ValueError, match="pole has no step at h = 2, a pole of its one-step matrix"):
        exact_matrix_at(pole, Q(2))
