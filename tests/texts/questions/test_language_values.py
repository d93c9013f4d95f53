"""Answers of the language against witnesses that share nothing with it: Fractions by hand, mpmath, published values."""

from __future__ import annotations

from fractions import Fraction as Q

import mpmath
import pytest
from flint import ctx

from driftproof.symbolic.algebra.certified import enclose, endpoints
from driftproof.texts.questions.answer import as_printed
from driftproof.texts.questions.decimals import Style
from driftproof.texts.questions.evaluate import value
from driftproof.texts.values.published import published_values

HALF_EVEN = Style(rounding="half-even")
State = tuple[Q, Q]


def forward_euler(z: State, h: Q) -> State:
    q, v = z
    return q + h * v, v - h * q


def symplectic_euler(z: State, h: Q) -> State:
    q, v = z
    v = v - h * q
    return q + h * v, v


def rk4(z: State, h: Q) -> State:
    def rate(z: State) -> State:
        return z[1], -z[0]

    def moved(by: Q, k: State) -> State:
        return z[0] + by * k[0], z[1] + by * k[1]

    k1 = rate(z)
    k2 = rate(moved(h / 2, k1))
    k3 = rate(moved(h / 2, k2))
    k4 = rate(moved(h, k3))
    return moved(h / 6, (k1[0] + 2 * k2[0] + 2 * k3[0] + k4[0], k1[1] + 2 * k2[1] + 2 * k3[1] + k4[1]))


BY_HAND = {"forward_euler": forward_euler, "symplectic_euler": symplectic_euler, "rk4": rk4}


def reached(key: str, h: Q, n: int, start: State = (Q(1), Q(0))) -> State:
    z = start
    for _ in range(n):
        z = BY_HAND[key](z, h)
    return z


def energy(z: State) -> Q:
    return (z[0] ** 2 + z[1] ** 2) / 2


@pytest.mark.parametrize("key", BY_HAND)
@pytest.mark.parametrize(("h", "n", "start"), [(Q(1, 2), 1, (Q(1), Q(0))), (Q(-3, 7), 5, (Q(2, 3), Q(-1)))])
def test_steps_are_those_written_out_by_hand(key: str, h: Q, n: int, start: State) -> None:
    asked = f"step {key} h={h} N={n} from {start[0]},{start[1]}"
    end = reached(key, h, n, start)
    expected = {"q": end[0], "v": end[1], "energy": energy(end), "energy_change": energy(end) - energy(start)}
    assert {name: value(f"{asked} : {name}").exact for name in expected} == expected
    assert value(f"{asked} : q").exact_text == str(end[0])


def in_mpmath(z: State) -> tuple[mpmath.mpf, mpmath.mpf]:
    q, v = (mpmath.mpf(x.numerator) / x.denominator for x in z)
    return q, v


@pytest.mark.parametrize("key", BY_HAND)
def test_errors_of_a_run_are_those_of_mpmath_to_forty_digits(key: str) -> None:
    with mpmath.workdps(60):
        q, v = in_mpmath(reached(key, Q(1, 4), 40))
        c, s = mpmath.cos(10), -mpmath.sin(10)
        turn = mpmath.degrees(mpmath.atan2(q * s - v * c, q * c + v * s))
        distance = mpmath.sqrt((q - c) ** 2 + (v - s) ** 2)
        witness = {
            "state_error": distance,
            "phase_error": turn,
            "phase_error deg": turn,
            "phase_error rad": mpmath.radians(turn),
            "phase_error turns": turn / 360,
            "exact.q": c,
            "exact.v": s,
        }
        for readout, expected in witness.items():
            for asked in ("h=1/4 t=10", "h=0.25 N=40", "N=40 t=10"):
                found = mpmath.mpf(value(f"run {key} {asked} : {readout}").digits(40))
                assert abs(found - expected) <= abs(expected) * mpmath.mpf(10) ** -39, (readout, asked)


def test_slopes_are_the_rates_at_the_stages() -> None:
    expected = {"k1.q": Q(0), "k1.v": Q(-1), "k2.q": Q(-1, 4), "k3.v": Q(-15, 16), "k4.q": Q(-15, 32), "k4.v": Q(-7, 8)}
    assert {name: value(f"step rk4 h=1/2 : {name}").exact for name in expected} == expected


def test_exact_flow_is_cosine_and_sine() -> None:
    with mpmath.workdps(60):
        c, s = mpmath.cos(mpmath.mpf(1) / 2), mpmath.sin(mpmath.mpf(1) / 2)
        a, b = mpmath.mpf(3) / 5, mpmath.mpf(-2)
        for name, expected in (("q", a * c + b * s), ("v", b * c - a * s)):
            found = mpmath.mpf(value(f"exact t=1/2 from 3/5,-2 : {name}").digits(40))
            assert abs(found - expected) <= mpmath.mpf(10) ** -39
    assert value("exact t=1/2 from 3/5,-2 : q").exact_text == "3*cos(1/2)/5 - 2*sin(1/2)"
    assert value("exact t=5 from 3,4 : energy").exact == Q(25, 2)
    assert value("exact t=0 from 3,4 : v").exact == 4


def test_evaluations_are_counted_and_everything_else_is_proved_or_certified() -> None:
    assert (value("run rk4 h=1/4 t=10 : evaluations").exact, value("run rk4 h=1/4 t=10 : steps").exact) == (160, 40)
    assert value("run explicit_order_2 at 2/3 h=1/4 t=10 : evaluations").exact == 80
    kinds = {name: value(f"run rk4 h=1/4 t=10 : {name}").evidence for name in ("q", "state_error", "evaluations")}
    assert kinds == {"q": "PROVED", "state_error": "CERTIFIED", "evaluations": "COUNTED"}


def test_energy_multiplier_is_what_a_step_does_to_the_energy() -> None:
    for h in (Q(1, 4), Q(-2), Q(17, 5)):
        for key in ("forward_euler", "rk4"):
            expected = energy(reached(key, h, 1)) / energy((Q(1), Q(0)))
            assert value(f"energy_multiplier {key} h={h}").exact == expected
    assert value("energy_multiplier rk4").exact_text == "1 - h**6/72 + h**8/576"
    assert not value("energy_multiplier rk4").is_number


def test_one_step_matrix_has_the_images_of_the_axes_for_columns() -> None:
    h = Q(3, 7)
    for key in BY_HAND:
        columns = [reached(key, h, 1, axis) for axis in ((Q(1), Q(0)), (Q(0), Q(1)))]
        found = [[value(f"one_step_matrix {key} h={h} : M_{row}{column}").exact for column in "qv"] for row in "qv"]
        assert found == [[columns[j][i] for j in (0, 1)] for i in (0, 1)]
        (a, b), (c, d) = found
        assert value(f"determinant {key} h={h}").exact == a * d - b * c


def test_invariant_keeps_its_value_over_a_step() -> None:
    h, z = Q(2, 3), (Q(1, 5), Q(-4))
    q, v = symplectic_euler(z, h)
    before, after = (value(f"invariant symplectic_euler h={h} from {a},{b}").exact for a, b in (z, (q, v)))
    assert before == after == (z[0] ** 2 - h * z[0] * z[1] + z[1] ** 2) / 2
    assert value("invariant symplectic_euler").exact_text == "q**2/2 - h*q*v/2 + v**2/2"
    assert value("invariant symplectic_euler h=1/2 : qv").exact == Q(-1, 4)


def taylor(x: Q) -> Q:
    return 1 - x + x**2 / 2 - x**3 / 6 + x**4 / 24


def test_stability_limits_of_rk4_are_where_its_polynomial_leaves_the_disc() -> None:
    limit = Q(value("real_limit rk4").digits(40))
    unit = Q(1, 10**38)
    assert taylor(limit - unit) < 1 < taylor(limit + unit)
    assert value("stability_function rk4 z=-3/2").exact == taylor(Q(3, 2))
    imaginary = value("imaginary_limit rk4")
    assert (imaginary.exact_text, value("(imaginary_limit rk4)**2").exact) == ("2*sqrt(2)", 8)
    assert value("real_limit backward_euler").exact_text == "oo"


FACTS = {
    "order rk4": ("4", "PROVED"),
    "stages rk4": ("4", "COUNTED"),
    "a_stable radau_iia2": ("yes", "PROVED"),
    "a_stable rk4": ("no", "PROVED"),
    "error_constant rk4": ("-1/120", "PROVED"),
    "error_constant rk4 : power": ("5", "PROVED"),
    "order_fails rk4 : residual": ("1/120", "PROVED"),
    "dispersion rk4": ("-h**5/120", "PROVED"),
    "dispersion rk4 h=1/10": ("-1/12000000", "PROVED"),
    "dissipation rk4 : coefficient": ("-1/144", "PROVED"),
    "dispersion_series rk4": ("-h**5/120 + h**7/336 - h**9/5184 - h**11/19008", "PROVED"),
    "stability_function radau_iia2": ("(1 + z/3)/(1 - 2*z/3 + z**2/6)", "PROVED"),
    "limit_at_infinity radau_iia2": ("0", "PROVED"),
    "limit_at_infinity rk4": ("oo", "PROVED"),
    "ssp_coefficient ssprk33": ("1", "PROVED"),
    "sector radau_iia2 : degrees": ("90", "PROVED"),
    "sector radau_iia2 : tan": ("oo", "PROVED"),
    "sector rk4 : degrees": ("0", "PROVED"),
    "simplifying_assumptions gauss2 : B": ("4", "PROVED"),
    "principal_error rk4 : squared_norm": ("349/1658880", "PROVED"),
    "modified_hamiltonian symplectic_euler : quadratic.qv": ("-h/2", "PROVED"),
    "order sdirk_order_2": ("2", "PROVED"),
    "order sdirk_order_2 at (1/2 + sqrt(3)/6)": ("3", "PROVED"),
    "order sdirk_order_2 at = 1/4": ("2", "PROVED"),
    "a_stable sdirk_order_2": ("[1/4, oo)", "PROVED"),
    "a_stable sdirk_order_2 at 1/5": ("no", "PROVED"),
    "title rk4": ("Classical RK4", "STATED"),
}


@pytest.mark.parametrize("question", FACTS)
def test_facts_are_answered_by_name(question: str) -> None:
    found = value(question)
    assert (found.exact_text, found.evidence) == FACTS[question]


def test_rounding_bound_holds_for_a_float_step_and_is_rounded_up() -> None:
    h, u = 0.25, Q(1, 2**53)
    for q, v in ((1.0, 0.0), (0.3, -0.7), (1.1, 1e-9)):
        v1 = v + h * -q
        q1 = q + h * v1
        exact = symplectic_euler((Q(q), Q(v)), Q(h))
        for name, error in (("q", abs(Q(q1) - exact[0])), ("v", abs(Q(v1) - exact[1]))):
            for sharp in ("", "sharp "):
                bound = value(f"roundoff symplectic_euler h=1/4 {sharp}from {Q(q)},{Q(v)} : {name}").exact
                assert isinstance(bound, Q)
                assert error <= bound * u
    # To first order |dq| <= u ((1 + 4h²)|q| + 3h|v|); d = u/(1 + u) and the second order leave 1e-15 of it.
    entries = {"qq": Q(5, 4), "qv": Q(3, 4), "vq": Q(1, 2), "vv": Q(1)}
    for name, first_order in entries.items():
        found = value(f"roundoff symplectic_euler h=1/4 : {name}")
        assert isinstance(found.exact, Q)
        assert abs(found.exact - first_order) < Q(1, 10**15)
        assert Q(found.digits(3)) >= found.exact
        assert found.unit == "u"


def test_sharp_bounds_are_smaller_where_cancellation_is_seen() -> None:
    for readout in ("qq", "q"):
        plain, sharp = (value(f"roundoff symplectic_euler h=1/4 {word} : {readout}").exact for word in ("", "sharp"))
        assert isinstance(plain, Q)
        assert isinstance(sharp, Q)
        assert abs(plain - Q(5, 4)) < Q(1, 10**15)
        assert abs(sharp - 1) < Q(1, 10**15)


# Published ids, and a free question that has the same answer.
EQUIVALENT = {
    "compare.h": "1/2",
    "exact.energy": "exact t=10 : energy",
    "exact.first_step.q": "exact t=1/2 : q",
    "exact.first_step.v": "exact t=1/2 : v",
    "exact.default.q": "exact t=10 : q",
    "exact.default.v": "run rk4 h=1/4 t=10 : exact.v",
    "default.steps": "run rk4 h=1/4 t=10 : steps",
    "small_steps.steps": "run rk4 h=1/10 t=10 : steps",
    "rk4.stages": "stages rk4",
    "rk4.exercise_2.evaluations": "run rk4 N=25 t=10 : evaluations",
    "forward_euler.exercise_2.evaluations": "run forward_euler N=100 t=10 : evaluations",
    "forward_euler.exercise_1.q": "step forward_euler h=1/2 from 0,1 : q",
    "forward_euler.exercise_1.v": "step forward_euler h=1/2 from 0,1 : v",
    "forward_euler.exercise_1.energy": "step forward_euler h=1/2 from 0,1 : energy",
    "symplectic_euler.exercise_1.q": "step symplectic_euler h=1/2 from 0,1 : q",
    "symplectic_euler.exercise_1.invariant": "invariant symplectic_euler h=1/2 from 0,1",
    "quarter_cycle.state_error": "sqrt(2)",
    **{f"rk4.first_step.k{i}.{x}": f"step rk4 h=1/2 : k{i}.{x}" for i in (1, 2, 3, 4) for x in "qv"},
    **{f"{key}.first_step.{x}": f"step {key} h=1/2 : {x}" for key in BY_HAND for x in ("q", "v", "energy")},
    **{f"{key}.evaluations_per_step": f"step {key} h=1/2 : evaluations" for key in BY_HAND},
    **{
        f"{key}.default.{x}": f"run {key} h=1/4 t=10 : {x}"
        for key in BY_HAND
        for x in ("energy", "energy_change", "evaluations", "state_error")
    },
    **{f"forward_euler.default.{x}": f"run forward_euler h=1/4 t=10 : {x}" for x in ("q", "v", "phase_error")},
    **{
        f"symplectic_euler.stability_boundary.step{n}.{x}": f"step symplectic_euler h=2 N={n} : {x}"
        for n in (1, 2, 3, 5)
        for x in "qv"
    },
}


@pytest.mark.parametrize("key", EQUIVALENT)
def test_published_value_is_the_answer_to_a_free_question(key: str) -> None:
    published, free = value(key), value(EQUIVALENT[key])
    assert published.digits(25, HALF_EVEN) == free.digits(25, HALF_EVEN)
    entry = published_values()[key]
    if entry["exact"] is not None and "sin" not in entry["exact"] and "cos" not in entry["exact"]:
        assert published.exact == free.exact
    assert published.exact_text == entry["exact"]
    assert published.evidence == entry["evidence"]


def test_every_published_value_can_be_asked_for_and_most_have_a_question() -> None:
    ids = published_values()
    for key in ids:
        assert value(key).digits(20, HALF_EVEN).strip("0.-") != "" or ids[key]["exact"] == "0"
    assert set(EQUIVALENT) <= set(ids)
    assert len(EQUIVALENT) >= 50


def test_published_decimal_stands_for_all_numbers_that_round_to_it() -> None:
    with ctx.workprec(128):
        low, high = endpoints(enclose(as_printed({"decimal": "-1.250e-7", "evidence": "CERTIFIED"}).exact))
    half = Q(1, 2 * 10**10)
    assert low <= Q(-125, 10**9) - half
    assert high >= Q(-125, 10**9) + half
    assert high - low < half * Q(2001, 1000)


def test_value_without_an_exact_form_has_its_published_digits_and_no_more() -> None:
    key = "rk4.default.state_error"
    assert value(key).digits(24) == published_values()[key]["decimal"][:29]
    with pytest.raises(ValueError, match="which does not decide more digits"):
        value(key).digits(40)
