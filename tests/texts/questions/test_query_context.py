"""What a query names is refused at its column where there is no such thing, and what is allowed is named."""

import pytest

from driftproof.texts.questions.evaluate import value
from tests.texts.questions.refusals import require_refusal

REFUSED = [
    ("rk4.__class__", 1, "is not the id of a published value"),
    ("rk4.first_step.w", 1, "did you mean rk4.first_step.v"),
    ("eval(1)", 1, "'eval' is not a function; the functions are abs, sqrt"),
    ("abs(1, 2)", 1, "abs takes 1 number"), ("ratio(1)", 1, "ratio takes 2 numbers"),
    ("1/0", 2, "division by zero"), ("0 ** -1", 1, "division by zero"),
    ("(-2) ** (1/2)", 1, "a root of a negative number is not computed"),
    ("sqrt(-1)", 1, "a root of a negative number is not computed"),
    ("log10(0)", 1, "only a positive number has a logarithm"),
    ("(((2**64)**64)**64)**64", 2, "too long to write out"),
    ("energy_multiplier rk4 + 1", 23, "1 - h**6/72 + h**8/576 is not a number"),
    ("1 + -energy_multiplier rk4", 5, "1 - h**6/72 + h**8/576 is not a number"),
    ("1 + (energy_multiplier rk4) ** 2", 5, "1 - h**6/72 + h**8/576 is not a number"),
    ("1 + abs(energy_multiplier rk4)", 5, "1 - h**6/72 + h**8/576 is not a number"),
    ("energy_multiplier", 1, "energy_multiplier needs a method, as in energy_multiplier rk4"),
    ("energy_multiplier rk5", 19, "unknown method 'rk5'"),
    ("energy_multipliers rk4", 1, "did you mean energy_multiplier"),
    ("energy_multiplier symplectic_euler", 1, "has no energy_multiplier: the energy change of a step depends"),
    ("energy_multiplier rk4 t=1", 23, "does not take t here; it takes h"),
    ("energy_multiplier rk4 : foo", 25, "has no parts"),
    ("energy_multiplier backward_euler h=1e1200 from 1,0", 1, "takes no start here"),
    ("stability_function backward_euler z=1", 1, "has a pole at z = 1"),
    ("stability_function velocity_verlet", 1, "only Runge-Kutta and collocation methods have R(z)"),
    ("order rk4 at 1/4", 14, "rk4 has no parameter"),
    ("order sdirk_order_2 at (1 - x)", 24, "'x' is a name; write numbers"),
    ("a_stable explicit_order_2 at 0", 30, "explicit_order_2 is not defined at alpha = 0"),
    ("order_fails rk4 : leaf", 19, "'leaf' is not a part of order_fails of rk4; its parts are tree, residual"),
    ("order rk4 : leaf", 13, "'leaf' is not a part of order of rk4; it has no parts"),
    ("a21 rk4 : q", 11, "a21 has no parts; leave out 'q'"),
    ("run rk4 problem=no-such/pro-blem.toml h=1 t=1 : y0", 17, "no-such/pro-blem.toml"),
    ("order rk4 h=1", 11, "order does not take h here; it takes no settings"),
    ("embedded_order rk4", 1, "rk4 has no embedded_order"),
    ("real_limit velocity_verlet", 1, "velocity_verlet has no real_limit: only Runge-Kutta and collocation methods"),
    ("invariant rk4", 1, "rk4 has no invariant: the method conserves no quadratic form, or several independent ones"),
    ("sector rk4", 1, "sector needs a readout after a colon; the readouts are tan, degrees"),
    ("invariant symplectic_euler from 1,0", 1, "the value of the invariant at a state needs h"),
    ("dissipation implicit_midpoint", 1, "implicit_midpoint has no dissipation: every term of the series vanishes"),
    ("one_step_matrix rk4", 1, "the readouts are M_qq, M_qv, M_vq, M_vv"),
    ("step", 1, "is not the id of a published value"), ("step : q", 1, "step needs h"),
    ("step h=1/2 : q", 1, "step needs a method"), ("step rk4 : q", 1, "step needs h"),
    ("step rk4 h=1/2", 1, "needs a readout after a colon"),
    ("step rk4 h=1/2 : speed", 18, "'speed' is not a readout of step; the readouts are q, v"),
    ("step rk4 h=0 : q", 1, "the step size h must not be 0"),
    ("step rk4 h=1/2 N=1/2 : q", 16, "the number of steps must be a whole number, at least 1"),
    ("step rk4 h=1/2 N=0 : q", 16, "the number of steps must be a whole number, at least 1"),
    ("step rk4 h=1/2 t=1 : q", 16, "step does not take t here; it takes h, N"),
    ("step rk4 h=1/2 : q deg", 20, "'deg' is not allowed here; only angles take a unit"),
    ("step rk4 h=1/2 : phase_error miles", 30, "is not a unit of angles; the units are deg"),
    ("step rk4 h=1/2 from 0,0 : phase_error", 27, "the phase error is undefined"),
    ("step rk4 h=1/2 : k5.q", 18, "not a readout of step; the readouts are q, v, energy"),
    ("step gauss2 h=1/2 : k1.q", 21, "not a readout of step"),
    ("step sdirk_order_2 h=1/2 : q", 6, "is a family of methods; choose one with at and a value of gamma"),
    ("run rk4 h=1/4 : q", 1, "run needs exactly two of h, t and N"),
    ("how many steps of rk4 for mine.toml with error 1e-6", 27, "to name a problem, write problem=mine.toml"),
    ("largest step of rk4", 1, "for a problem of your own there is driftproof stability mine.toml"),
    ("run rk4 h=1/4 t=10 N=40 : q", 1, "run needs exactly two of h, t and N"),
    ("run rk4 h=1/3 t=1/2 : q", 1, "nearest that do: 1/2 and 1/4"),
    ("run rk4 h=1e-17 t=10.00000000000000001 : q", 1, "more than 10**18 steps"),
    ("run gauss2 h=1/4 t=10 : evaluations", 25, "gauss2 is implicit"),
    ("run forward_euler h=1 N=600000 : q * 2", 1, "too long"),
    ("exact rk4 t=10 : q", 7, "exact takes no method"),
    ("exact at 1/4 t=10 : q", 10, "exact takes no method"),
    ("exact h=10 : q", 7, "exact does not take h here; it takes t"),
    ("exact from 1,0 : q", 1, "exact needs t"),
    ("run rk4 h=1 N=1 : phase_error + run rk4 h=1 N=1 : phase_error rad", 31,
     "degrees and radians cannot be added or subtracted"),
    ("sqrt(run rk4 h=1 N=1 : phase_error)", 1, "functions take numbers without a unit, not degrees"),
    ("1 / run rk4 h=1 N=1 : phase_error", 3, "is not a known unit"),
    ("(run rk4 h=1 N=1 : phase_error) ** 2", 1, "a power of degrees is not a known unit"),
    ("(run rk4 h=1 N=1 : phase_error) * run rk4 h=1 N=1 : phase_error", 33,
     "degrees times degrees is not a known unit"),
    ("percent(run rk4 h=1 N=1 : phase_error, 2)", 1, "percent compares two numbers of the same unit; degrees is left"),
    ("7**80000 * 7**80000", 10, "too long to write out: more than 262144 bits"),
    ("invariant symplectic_euler : q", 30, "its parts are"),
    ("exact t=1 : q deg", 15, "'deg' is not allowed here; only angles take a unit"),
    ("run rk4 lambda=-1 h=1/4 t=0 : y", 9, "h = 1/4 does not divide t = 0: t / h = 0"),
    ("run rk4 lambda=-1 h=-1/4 t=1 : y", 9, "h = -1/4 does not divide t = 1: t / h = -4"),
]  # fmt: skip


@pytest.mark.parametrize(("question", "column", "reason"), REFUSED)
def test_query_is_refused_at_the_column_of_what_is_wrong_with_it(question, column, reason):
    require_refusal(question, column, reason)


def test_an_energy_that_the_question_does_not_say_is_asked_for():
    asked = "energy of velocity Verlet on x''=-sin(x), x(0)=1, x'(0)=0, h=0.1, t=2"
    require_refusal(asked, 1, "add what it is, as in energy=v")
    assert value(f"{asked}, energy=dx^2/2 - cos(x)").is_number
