"""Errors of floats from digits, exactly: and what rounding may explain of them."""

from __future__ import annotations

from dataclasses import replace
from decimal import Decimal
from fractions import Fraction as Q
from math import cos, hypot, inf, sin

import mpmath
import pytest

from driftproof.methods.catalogue import METHODS
from driftproof.methods.formulas.vector_fields import VectorField
from driftproof.methods.numbers.number_field import square_root
from driftproof.methods.schemes import MethodError
from driftproof.numeric.problems.catalogue import PROBLEMS
from driftproof.numeric.problems.linear import HARMONIC
from driftproof.numeric.problems.problem import EXACT, Reference
from driftproof.numeric.reference_errors import (
    ENERGY,
    PHASE,
    STATE,
    U,
    decimal_energy,
    distance_from_digits,
    doubt,
    errors,
    floors,
    half_unit,
    told_apart,
)
from driftproof.numeric.work_precision.curves import measure_curve
from driftproof.numeric.work_precision.integrators import integrator
from tests.numeric.problems.runs_on_problems import DECAY

T = Q(10)


def test_distance_of_floats_from_digits_is_exact_where_a_difference_of_floats_is_not() -> None:
    tenth = Q(0.1) - Q(1, 10)
    assert distance_from_digits((0.1, 0.0), ("0.1", "0")) == float(tenth) != 0.1 - float("0.1")
    assert distance_from_digits((3.0, 4.0), ("0", "0")) == 5


def test_half_unit_is_that_of_the_last_digit_printed() -> None:
    assert half_unit(("0.123",)) == 0.0005
    assert half_unit(("1e-7", "-2e-7")) == float(Decimal("0.5e-7") * Decimal(2).sqrt())
    assert half_unit(("0.1230",)) == 0.00005
    assert [told_apart(x, ("0.1230",)) for x in (0.0, 2e-5, 4.9e-5, 5e-5)] == ["5.1e-5", "7.1e-5", "0.00010", ""]


def test_errors_of_the_exact_state_are_below_the_floor_and_those_of_another_are_not() -> None:
    exact = (cos(10), -sin(10))
    found, floor = errors(HARMONIC, {T: exact}), floors(HARMONIC)
    assert all(found[name].final <= floor[name] for name in (STATE, ENERGY, PHASE))
    assert abs(floor[STATE] / 2.0**-53 - 1) < 1e-15, "u on the unit circle"
    off = errors(HARMONIC, {T: (exact[0] + 1e-12, exact[1])})
    assert all(off[name].final > 1000 * floor[name] for name in (STATE, ENERGY, PHASE))


def test_largest_error_is_over_the_times_that_were_landed_on() -> None:
    half = HARMONIC.reference.times[3]
    found = errors(HARMONIC, {half: (2.0, 0.0), T: (cos(10), -sin(10))})
    assert found[STATE].largest > 1 > found[STATE].final


def test_phase_of_a_state_turned_by_a_degree_is_a_degree_and_undefined_at_the_origin() -> None:
    degree = 3.141592653589793 / 180
    assert abs(errors(HARMONIC, {T: (cos(10 + degree), -sin(10 + degree))})[PHASE].final - 1) < 1e-13
    still = replace(HARMONIC, reference=Reference((T,), (("2", "0"),), EXACT, ""))
    for state, angle in {(1.0, 0.0): 0, (3.0, 3.0): 45, (0.0, -1.0): 90, (-1.0, 0.0): 180, (0.0, 0.0): 180}.items():
        assert errors(still, {T: state})[PHASE].final == angle


def test_a_state_that_is_not_finite_has_no_error() -> None:
    with pytest.raises(ArithmeticError, match="no longer finite"):
        errors(HARMONIC, {T: (inf, 0.0)})


@pytest.mark.parametrize("name", ["sin", "cos"])
@pytest.mark.parametrize("x", [0.0, 0.5, -3.0, 40.0, 22.0, 1e8, 1e15, -1e22, 1e70, 1.7e308])
def test_energy_computes_functions_far_below_rounding(name: str, x: float) -> None:
    with mpmath.workdps(400):
        wanted = Decimal(mpmath.nstr(getattr(mpmath, name)(x), 70))
    assert abs(decimal_energy(replace(DECAY, energy=f"{name}(y0)"), [x]) - wanted) < Decimal("1e-59")


def test_an_energy_without_a_value_is_said_in_words() -> None:
    for energy, x in (("log(y0)", -1.0), ("sin(y0 * y0 * y0 * y0)", 1e300)):
        with pytest.raises(ArithmeticError, match="the energy has no value at a state reached"):
            decimal_energy(replace(DECAY, energy=energy), [x])


def test_floor_of_an_energy_is_a_rounding_of_each_component_times_its_derivative() -> None:
    kepler = PROBLEMS["kepler"]
    x, y, v, w = map(float, kepler.reference.states[-1])
    mass, r = float(kepler.field.parameters[0][1]), hypot(x, y)
    wanted = v * v + w * w + mass * (x * x + y * y) / r**3
    assert floors(kepler)[ENERGY] == pytest.approx(2.0**-53 * wanted, rel=1e-12, abs=0)
    assert set(floors(kepler)) == {STATE, ENERGY}


def test_energy_reads_an_irrational_parameter_to_all_its_digits() -> None:
    problem = replace(
        replace(DECAY, energy="rate * rate * y0"), field=VectorField(("y0",), (("rate", square_root(2)),))
    )
    assert abs(decimal_energy(problem, [1.0]) - 2) < Decimal("1e-57")


def test_energy_reads_parameters_division_and_signs() -> None:
    problem = replace(DECAY, energy="-rate * y0 / 2 + exp(log(3)) - sqrt(4)")
    assert abs(6 * Q(decimal_energy(problem, [Q(1, 3)])) - 7) < Q(1, 10**50)


@pytest.mark.parametrize("sign", [1, -1])
def test_floor_of_an_energy_with_a_modulus_has_its_slope(sign: int) -> None:
    """E = y² |y| has the slope 3 y²."""
    reference = replace(DECAY.reference, states=(*DECAY.reference.states[:-1], (str(2 * sign),)))
    problem = replace(DECAY, energy="y0 * y0 * abs(y0)", reference=reference)
    assert decimal_energy(problem, [2.0 * sign]) == 8
    assert floors(problem)[ENERGY] == pytest.approx(24 * float(U))


def test_energy_with_choices_is_that_of_the_side_of_the_state() -> None:
    problem = replace(
        DECAY, energy="(y0 * y0 if y0 >= 1 else 3 if y0 > 0 else 4 if y0 < -1 else floor(y0)) + floor(y0)"
    )
    assert [decimal_energy(problem, [x]) for x in (1.5, 1.0, 0.5, -0.5, -1.0, -1.5)] == [3.25, 2, 3, -2, -2, 2]


@pytest.mark.parametrize("energy", ["y0 ** 2", "y0 * 0.5", "tan(y0)", "y0 % 2"])
def test_an_energy_that_holds_what_a_rate_may_not_is_refused(energy: str) -> None:
    with pytest.raises(MethodError, match="is not allowed"):
        decimal_energy(replace(DECAY, energy=energy), [1.0])


def test_doubt_grows_with_the_steps_and_covers_the_rounding_of_a_run_whose_method_is_exact_enough() -> None:
    found = measure_curve(HARMONIC, integrator(METHODS["dop853"], HARMONIC), (256, 512, 1024))
    assert all(0 < point.error < point.doubt for point in found)
    assert doubt(HARMONIC, 1024, 1.0) > 1.9 * doubt(HARMONIC, 512, 1.0) > float(512 * U)


def test_doubt_is_of_the_steps_the_times_and_the_last_digit() -> None:
    """(N + 1) u Q, Q the largest size at the start or later, u t times the speed, and half a unit of the digits."""
    for start, state, largest in ((Q(3), "0.5", 3), (Q(1, 4), "2.5", 2.5)):
        problem = replace(DECAY, start=(start,), reference=Reference((Q(1), Q(2)), (("0",), (state,)), EXACT, ""))
        assert doubt(problem, 2**50, 2.0**52) == pytest.approx((2**50 + 1) * 2.0**-53 * largest + 1 + 0.05, rel=1e-15)
        exact = replace(problem, reference=replace(problem.reference, states=(("0",), (state + "0" * 40,))))
        assert doubt(exact, 7, 0.0) == pytest.approx(8 * 2.0**-53 * largest, rel=1e-15, abs=0)
