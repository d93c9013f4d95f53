"""What a query names is refused at its column where there is no such thing, and what is allowed is named."""

from __future__ import annotations

import pytest

from tests.texts.questions.refusals import demand_refusal

REFUSED = [
    ("rk4.__class__", 1, "is no id of a published value"),
    ("rk4.first_step.w", 1, "did you mean rk4.first_step.v"),
    ("eval(1)", 1, "'eval' is no function; there are abs, sqrt"),
    ("abs(1, 2)", 1, "abs takes 1 number"),
    ("ratio(1)", 1, "ratio takes 2 numbers"),
    ("1/0", 2, "it divides by zero"),
    ("0 ** -1", 1, "it divides by zero"),
    ("(-2) ** (1/2)", 1, "a number below zero has no real root"),
    ("sqrt(-1)", 1, "a number below zero has no real root"),
    ("log10(0)", 1, "only a number above zero has a logarithm"),
    ("(((2**64)**64)**64)**64", 2, "too long to write out"),
    ("energy_multiplier rk4 + 1", 23, "1 - h**6/72 + h**8/576 is no number"),
    ("energy_multiplier", 1, "is no id of a published value"),
    ("energy_multiplier rk5", 19, "unknown method 'rk5'"),
    ("energy_multipliers rk4", 1, "did you mean energy_multiplier"),
    ("energy_multiplier symplectic_euler", 1, "depends on the state"),
    ("energy_multiplier rk4 t=1", 23, "has no setting t here; it takes h"),
    ("energy_multiplier rk4 : foo", 25, "has no parts"),
    ("energy_multiplier backward_euler h=1e1200 from 1,0", 1, "starts nowhere"),
    ("stability_function backward_euler z=1", 1, "has a pole at z = 1"),
    ("stability_function velocity_verlet", 1, "only Runge-Kutta and collocation methods have R(z)"),
    ("order rk4 at 1/4", 14, "rk4 has no parameter"),
    ("order sdirk_order_2 at (1 - x)", 24, "'x' is a name; write numbers"),
    ("real_limit sdirk_order_2 sharp", 26, "knows no word sharp"),
    ("a_stable explicit_order_2 at 0", 30, "no method at alpha = 0"),
    ("order_fails rk4 : foo", 19, "it has tree, residual"),
    ("embedded_order rk4", 1, "rk4 has no embedded_order"),
    ("invariant symplectic_euler from 1,0", 1, "needs h"),
    ("dissipation symplectic_euler", 1, "the whole series vanishes"),
    ("one_step_matrix rk4", 1, "there are M_qq, M_qv, M_vq, M_vv"),
    ("step", 1, "is no id of a published value"),
    ("step : q", 1, "step needs h"),
    ("step h=1/2 : q", 1, "step is about a method"),
    ("step rk4 : q", 1, "step needs h"),
    ("step rk4 h=1/2", 1, "needs a readout after a colon"),
    ("step rk4 h=1/2 : speed", 18, "'speed' is no readout of step; there are q, v"),
    ("step rk4 h=0 : q", 1, "a step of size 0 goes nowhere"),
    ("step rk4 h=1/2 N=1/2 : q", 16, "the number of steps is whole, and 1 at least"),
    ("step rk4 h=1/2 N=0 : q", 16, "the number of steps is whole, and 1 at least"),
    ("step rk4 h=1/2 t=1 : q", 16, "step has no setting t here; it takes h, N"),
    ("step rk4 h=1/2 : q deg", 20, "'deg' has no place; only angles have units"),
    ("step rk4 h=1/2 : phase_error miles", 30, "is no unit of an angle; there are deg"),
    ("step rk4 h=1/2 from 0,0 : phase_error", 27, "the phase error is undefined"),
    ("step rk4 h=1/2 : k5.q", 18, "rk4 has the slopes k1 to k4"),
    ("step gauss2 h=1/2 : k1.q", 21, "explicit Runge-Kutta methods have"),
    ("step sdirk_order_2 h=1/2 : q", 6, "is a family; choose a method with at, a value of gamma"),
    ("run rk4 h=1/4 : q", 1, "run needs two of h, t and N"),
    ("run rk4 h=1/4 t=10 N=40 : q", 1, "run needs two of h, t and N"),
    ("run rk4 h=1/3 t=1/2 : q", 1, "nearest that do: 1/2 and 1/4"),
    ("run rk4 h=1e-17 t=10.00000000000000001 : q", 1, "more than 10**18 steps"),
    ("run gauss2 h=1/4 t=10 : evaluations", 25, "gauss2 is implicit"),
    ("run forward_euler h=1 N=600000 : q * 2", 1, "too long"),
    ("exact rk4 t=10 : q", 7, "the exact flow belongs to no method"),
    ("exact at 1/4 t=10 : q", 10, "the exact flow belongs to no method"),
    ("exact h=10 : q", 7, "exact has no setting h here; it takes t"),
    ("exact from 1,0 : q", 1, "exact needs t"),
    ("roundoff gauss2 h=1/4 : qq", 1, "is implicit"),
    ("roundoff rk4 h=1e400 : qq", 1, "overflows"),
    ("roundoff rk4 h=1e-400 : qq", 1, "a step of size 0 goes nowhere"),
    ("roundoff rk4 h=1/4 : foo", 22, "there are qq, qv, vq, vv, q, v, c"),
    ("run rk4 h=1 N=1 : phase_error + run rk4 h=1 N=1 : phase_error rad", 31, "degrees and radians do not add"),
    ("sqrt(run rk4 h=1 N=1 : phase_error)", 1, "a function of degrees is not defined"),
    ("1 / run rk4 h=1 N=1 : phase_error", 3, "has no unit of its own"),
    ("(run rk4 h=1 N=1 : phase_error) ** 2", 1, "powers of degrees are no unit"),
]


@pytest.mark.parametrize(("question", "column", "reason"), REFUSED)
def test_query_is_refused_at_the_column_of_what_is_wrong_with_it(question: str, column: int, reason: str) -> None:
    demand_refusal(question, column, reason)
