"""Rosenbrock methods: order conditions written out, float runs with right and wrong Jacobians, planted mistakes."""

from dataclasses import replace
from fractions import Fraction as Q
from math import log2

import numpy as np
import pytest
from flint import fmpq

from driftproof import METHODS, Facts, facts, significant
from driftproof.methods.catalogue import FURTHER_METHODS, entry_named
from driftproof.methods.rosenbrock import Rosenbrock
from driftproof.symbolic.algebra.polynomials import exact
from driftproof.symbolic.rosenbrock import RosenbrockFacts
from tests.looping import exactly, some

EVERY = {key: method for key, method in FURTHER_METHODS.items() if isinstance(method, Rosenbrock)}
# Order, order with any J, embedded order: the claims, W orders from the conditions of order 2 written out below.
ORDERS = {
    "ros2": (2, 2, 1),
    "ode23s": (2, 2, 3),
    "ros3p": (3, 1, 2),
    "grk4t": (4, 1, 3),
    "rodas3": (3, 1, 2),
    "rodas4": (4, 1, 3),
}
TINY = Q(1, 10**11)  # above the rounding of 12 printed digits, far below any residual of a wrong order


def arrays(method, weights=None):
    rows = (method.alpha, method.gamma, method.b if weights is None else weights)
    return [np.array(row, dtype=float) for row in rows]


def field(y):
    u, v = y
    return np.array([v + u * u / 4, -u + np.sin(u * v) / 2])


def jacobian(y):
    u, v = y
    c = np.cos(u * v) / 2
    return np.array([[u / 2, 1], [-1 + c * v, c * u]])


def run(method, steps, wrong=0.0, weights=None):
    """y at t = 1 from (1, 1/2), with `wrong` added to an entry of J: written out from the definition."""
    alpha, gamma, b = arrays(method, weights)
    y, h = np.array([1.0, 0.5]), 1 / steps
    for _ in range(steps):
        j, k = jacobian(y) + np.array([[0, 0], [wrong, wrong]]), []
        for i in range(len(b)):
            inner = y + h * sum((alpha[i, m] * k[m] for m in range(i)), np.zeros(2))
            known = field(inner) + h * j @ sum((gamma[i, m] * k[m] for m in range(i)), np.zeros(2))
            k.append(np.linalg.solve(np.eye(2) - h * gamma[i, i] * j, known))
        y = y + h * sum(x * slope for x, slope in zip(b, k, strict=True))
    return y


def rate(method, wrong=0.0, weights=None, steps=40):
    """The measured order: from differences of three runs, so that no solution is needed."""
    first, second, third = (run(method, n * steps, wrong, weights) for n in (1, 2, 4))
    return log2(np.linalg.norm(first - second) / np.linalg.norm(second - third))


@pytest.mark.slow(keep=3)
@pytest.mark.parametrize("key", EVERY)
def test_orders_are_those_claimed_and_those_measured(key):
    method, facts = EVERY[key], RosenbrockFacts(EVERY[key])
    found = facts.orders_within(TINY)
    assert found[1:] == ORDERS[key]
    assert (found.order, found.embedded_order) == (method.claimed_order, method.embedded_order)
    if not method.decimal:
        assert (facts.order, facts.w_order, facts.embedded_order) == ORDERS[key]
    # At h = 1/40 the next term of the error moves the rate by less than half an order.
    measured = rate(method), rate(method, wrong=0.7), rate(method, weights=method.b_embedded)
    assert all(abs(x - order) < 0.4 for x, order in exactly(3, zip(measured, ORDERS[key], strict=True)))


@pytest.mark.parametrize("key", EVERY)
def test_conditions_written_out_hold_and_changed_coefficients_lose_the_order(key):
    method = EVERY[key]
    a, g, b = arrays(method)
    beta, ones = a + g, np.ones(len(b))
    alphas, betas = a @ ones, beta @ ones
    written = [b @ ones - 1, b @ betas - 1 / 2, b @ alphas**2 - 1 / 3, b @ beta @ betas - 1 / 6]
    fourth = [b @ alphas**3 - 1 / 4, b @ (alphas * (a @ betas)) - 1 / 8]
    fourth += [b @ beta @ alphas**2 - 1 / 12, b @ beta @ beta @ betas - 1 / 24]
    order = 4 if max(map(abs, [*written, *fourth])) < 1e-11 else 3 if max(map(abs, written)) < 1e-11 else 2
    assert order == method.claimed_order
    weights = (method.b[0] + Q(1, 1000), *method.b[1:])
    assert RosenbrockFacts(replace(method, b=weights)).orders_within(TINY).order == 0
    last = max(i for i, x in enumerate(method.b) if x)  # a stage after it is the error estimate's alone
    row = method.gamma[last]
    row = (*row[: last - 1], row[last - 1] + Q(1, 1000), *row[last:])
    gamma = (*method.gamma[:last], row, *method.gamma[last + 1 :])
    changed = RosenbrockFacts(replace(method, gamma=gamma)).orders_within(TINY)
    assert changed.order < method.claimed_order


def test_stability_is_that_in_the_papers():
    found = {key: RosenbrockFacts(method) for key, method in EVERY.items()}
    assert {key: facts.a_stable for key, facts in found.items()} == {**dict.fromkeys(EVERY, True), "grk4t": False}
    assert [key for key, facts in found.items() if facts.l_stable] == ["ros2", "ode23s", "rodas3", "rodas4"]
    assert str(found["ros3p"].limit_at_infinity) == "1 - sqrt(3)"  # |R(oo)| = 0.73, lang-verwer-2001
    assert significant(found["grk4t"].sector.degrees.exact, 4) == "89.35"  # "89.3" in kaps-rentrop-1979
    assert [key for key, facts in found.items() if facts.stiffly_accurate] == ["rodas3"]
    assert [str(found[key].diagonal) for key in ("ros2", "rodas3")] == ["1 - 1/2*sqrt(2)", "1/2"]
    assert found["rodas4"].stability_within_digits.l_stable


def test_the_estimate_is_the_difference_of_the_rows_and_that_of_ros3p_is_blind_to_linear_problems():
    """E(z) at z = -1 against steps of both rows on y' = -y by h = 1 in floats; both orders; E at infinity."""
    for key, method in exactly(6, EVERY.items()):
        found, h = RosenbrockFacts(method).estimate, 1.0
        alpha, gamma, b = arrays(method)
        slopes = np.linalg.solve(np.eye(len(b)) + h * (alpha + gamma), -np.ones(len(b)))
        difference = float((b - arrays(method, method.b_embedded)[2]) @ slopes) * h
        assert float(exact(found.function.f(fmpq(-1)))) == pytest.approx(difference, abs=1e-12), key
        assert method.decimal or found.order == min(ORDERS[key][::2])
    blind = RosenbrockFacts(EVERY["ros3p"]).estimate
    assert (blind.function.f.data()["num"], blind.order, blind.at_infinity) == (["0"], 2, 0)
    assert RosenbrockFacts(EVERY["rodas4"]).estimate.at_infinity == 0
    assert RosenbrockFacts(replace(EVERY["ros2"], b_embedded=EVERY["ros2"].b)).estimate is None


def test_without_gamma_it_is_the_explicit_method_and_with_gamma_alone_another():
    rk4 = METHODS["rk4"]
    plain = Rosenbrock("m", "m", 4, "", rk4.a, tuple((Q(0),) * 4 for _ in range(4)), rk4.b)
    facts = RosenbrockFacts(plain)
    assert (facts.order, facts.w_order, plain.explicit) == (4, 4, True)  # no J, so any J
    assert facts.stability_function == Facts(rk4).stability_function
    one = RosenbrockFacts(Rosenbrock("m", "linearly implicit Euler", 1, "", ((0,),), ((1,),), (1,)))
    assert (one.order, one.w_order, one.l_stable, one.embedded_order) == (1, 1, True, None)
    assert one.stability_function == Facts(METHODS["backward_euler"]).stability_function
    half = RosenbrockFacts(Rosenbrock("m", "linearly implicit midpoint", 2, "", ((0,),), ((Q(1, 2),),), (1,)))
    assert (half.order, half.w_order) == (2, 1)
    assert half.w_order_fails.failing_tree == ("f", (("f", ()),))


def test_digits_alone_keep_decimal_tables_from_their_order():
    found = {key: RosenbrockFacts(FURTHER_METHODS[key]).order_but_for_rounding for key in ("rodas4", "grk4t", "ros3p")}
    assert (found["rodas4"], found["grk4t"].order, found["ros3p"]) == ((4, "7.78e-16", "4.31e-3"), 4, None)
    method = FURTHER_METHODS["grk4t"]
    wrong = replace(method, b=(method.b[0] + Q(1, 100), *method.b[1:]))
    assert RosenbrockFacts(wrong).order_but_for_rounding is None


def test_coefficients_of_unequal_numbers_of_digits_are_judged_by_the_shorter_ones():
    """ROS3 of Sandu (1997) has a gamma of 26 digits beside numbers of 32; the twin has a wrong digit."""
    g, rest = "0.43586652150845899941601945", "-0.19294655696029095575009695436041 1.74927148125794685173529749738960"
    weights = "-0.75457412385404315829818998646589 1.94100407061964420292840123379419"
    gamma, low, high, *b = map(Q, (g, *rest.split(), *weights.split(), "-0.18642994676560104463021124732829"))
    rows = ((0, 0, 0), (gamma, 0, 0), (gamma, 0, 0)), ((gamma, 0, 0), (low, gamma, 0), (0, high, gamma))
    for x, order in ((0, (3, "3.29e-27", "1.05e-1")), (Q(1, 10**16), (1, "1.01e-32", "2.43e-17"))):
        method = Rosenbrock("m", "ROS3", 3, "", rows[0], rows[1], (b[0] + x, b[1] - x, b[2]), decimal=True)
        assert RosenbrockFacts(method).order_but_for_rounding == order


def test_an_order_brings_the_one_but_for_rounding():
    assert [*facts("rodas4", only=["order"]).data] == ["order", "order_but_for_rounding"]
    assert [*facts("ros2", only=["order"]).data] == ["order"]
    assert [*facts("rodas4", only=["diagonal"]).data] == ["diagonal"]


def test_facts_are_written_and_asked_for_by_name(answer, refusal):
    assert facts(EVERY["ros2"]).data["gamma_sums"] == ["1 - 1/2*sqrt(2)", "-1 + 1/2*sqrt(2)"]
    text = answer("facts", "GRK4T", "--only", "claimed_order,order", "--order-tolerance", "1e-11")
    assert "order: 4, w_order: 1, embedded_order: 3" in text
    assert "its order is exact and takes no tolerance" in refusal("facts", "bdf2", "--order-tolerance", "1e-9")
    told = refusal("step", "rodas4", "--h", "1/2", "--state", "1,0")
    assert "takes a Jacobian: `driftproof stability`, `work-precision`, scenes of a problem, `driftproof facts`" in told
    assert all(entry_named(key.upper()) is method for key, method in some(EVERY.items()))
