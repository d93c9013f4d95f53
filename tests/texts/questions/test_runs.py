"""Answers about steps, runs, rounding and the exact flow: Fractions by hand, floats, and mpmath to forty digits."""

from fractions import Fraction as Q

import mpmath
import pytest

from driftproof.texts.questions.evaluate import value
from tests.texts.questions.steps_by_hand import BY_HAND, energy, reached


@pytest.mark.parametrize("key", BY_HAND)
@pytest.mark.parametrize(("h", "n", "start"), [(Q(1, 2), 1, (Q(1), Q(0))), (Q(-3, 7), 5, (Q(2, 3), Q(-1)))])
def test_steps_are_those_written_out_by_hand(key, h, n, start):
    asked = f"step {key} h={h} N={n} from {start[0]},{start[1]}"
    end = reached(key, h, n, start)
    expected = {"q": end[0], "v": end[1], "energy": energy(end), "energy_change": energy(end) - energy(start)}
    assert {name: value(f"{asked} : {name}").exact for name in expected} == expected
    assert value(f"{asked} : q").exact_text == str(end[0])


def in_mpmath(z):
    q, v = (mpmath.mpf(x.numerator) / x.denominator for x in z)
    return q, v


@pytest.mark.parametrize("key", BY_HAND)
def test_errors_of_a_run_are_those_of_mpmath_to_forty_digits(key):
    with mpmath.workdps(60):
        q, v = in_mpmath(reached(key, Q(1, 4), 40))
        c, s = mpmath.cos(10), -mpmath.sin(10)
        turn = mpmath.degrees(mpmath.atan2(q * s - v * c, q * c + v * s))
        distance = mpmath.sqrt((q - c) ** 2 + (v - s) ** 2)
        witness = {
            "state_error": distance, "phase_error": turn, "phase_error deg": turn,
            "phase_error rad": mpmath.radians(turn), "phase_error turns": turn / 360, "exact.q": c, "exact.v": s,
        }  # fmt: skip
        for readout, expected in witness.items():
            for asked in ("h=1/4 t=10", "h=0.25 N=40", "N=40 t=10"):
                found = mpmath.mpf(value(f"run {key} {asked} : {readout}").digits(40))
                assert abs(found - expected) <= abs(expected) * mpmath.mpf(10) ** -39, (readout, asked)


def test_a_run_of_no_steps_has_an_exact_phase_error_in_every_unit():
    assert {value(f"run rk4 h=1/4 t=0 : phase_error {unit}").exact for unit in ("deg", "rad", "turns")} == {0}


def test_slopes_are_the_rates_at_the_stages():
    expected = {"k1.q": Q(0), "k1.v": Q(-1), "k2.q": Q(-1, 4), "k3.v": Q(-15, 16), "k4.q": Q(-15, 32), "k4.v": Q(-7, 8)}
    assert {name: value(f"step rk4 h=1/2 : {name}").exact for name in expected} == expected


def test_exact_flow_is_cosine_and_sine():
    with mpmath.workdps(60):
        c, s = mpmath.cos(mpmath.mpf(1) / 2), mpmath.sin(mpmath.mpf(1) / 2)
        a, b = mpmath.mpf(3) / 5, mpmath.mpf(-2)
        for name, expected in (("q", a * c + b * s), ("v", b * c - a * s)):
            found = mpmath.mpf(value(f"exact t=1/2 from 3/5,-2 : {name}").digits(40))
            assert abs(found - expected) <= mpmath.mpf(10) ** -39
    assert value("exact t=1/2 from 3/5,-2 : q").exact_text == "3*cos(1/2)/5 - 2*sin(1/2)"
    assert value("exact t=5 from 3,4 : energy").exact == Q(25, 2)
    assert value("exact t=0 from 3,4 : v").exact == 4


def test_evaluations_are_counted_and_everything_else_is_proved_or_certified():
    found = [value(f"run rk4 h=1/4 t=10 : {name}").exact for name in ("evaluations", "steps", "h", "t")]
    assert found == [160, 40, Q(1, 4), 10]
    assert value("run rk4 h=1e-17 t=10 : steps").exact == 10**18  # as many as there may be
    assert value("run explicit_order_2 at 2/3 h=1/4 t=10 : evaluations").exact == 80
    kinds = {name: value(f"run rk4 h=1/4 t=10 : {name}").evidence for name in ("q", "state_error", "evaluations")}
    assert kinds == {"q": "DERIVED", "state_error": "CERTIFIED", "evaluations": "COUNTED"}


def test_long_runs_are_answered_by_squaring_and_long_numbers_enclosed():
    # In 10**12 steps of h = 1e-11, RK4 is off by h**4 t / 120 to leading order.
    found = value("run rk4 h=1e-11 t=10 : state_error")
    assert found.digits(5) == "8.3333e-46"
    # And behind by h**4 t / 120 radians.
    assert value("run rk4 N=1000000000000 t=10 : phase_error rad").digits(5) == "-8.3333e-46"
    assert value(f"step gauss2 h={'9' * 1000} : energy").digits(3) == "0.500"
