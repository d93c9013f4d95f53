"""Runs of multistep methods are those of programs in Fractions and in floats, with the first values that are named."""

from fractions import Fraction as Q
from itertools import islice

import pytest
from flint import arb

from driftproof.enclosure.runs.multistep_runs import StartedMultistep
from driftproof.methods.tables import multistep

MULTISTEP = {method.key: method for method in multistep.ENTRIES}


def decay(t, y):
    return [-x for x in y]


def states(key, first, count, h=Q(1, 10), rate=decay, solved=None):
    run = StartedMultistep(MULTISTEP[key], None)
    return [*islice(run.states(rate, first, h, solved), count)]


def test_adams_bashforth_is_its_recurrence_in_fractions():
    by_hand = [Q(1), Q(9, 10)]
    for _ in range(5):
        by_hand.append(by_hand[-1] + Q(1, 10) * (Q(3, 2) * -by_hand[-1] - Q(1, 2) * -by_hand[-2]))
    found = states("adams_bashforth2", [[Q(1)], [Q(9, 10)]], 5)
    assert found == [[y] for y in by_hand[2:]]
    assert states("adams_bashforth2", [[Q(1)], [Q(8, 10)]], 5)[0] != found[0]  # the first values matter


def test_rate_is_asked_at_the_times_of_the_states():
    """On y' = t, two steps of Adams-Bashforth are exact: y = t²/2."""
    found = states("adams_bashforth2", [[Q(0)], [Q(1, 200)]], 4, rate=lambda t, y: [t])
    assert found == [[Q(n, 10) ** 2 / 2] for n in (2, 3, 4, 5)]


@pytest.mark.parametrize(("key", "weight"), [("bdf2", Q(2, 3)), ("adams_moulton2", Q(5, 12))])
def test_implicit_method_asks_for_a_backward_euler_step_that_ends_at_the_new_time(key, weight):
    asked = []

    def solved(y, t, size):
        asked.append((t, size))
        return [x / (1 + size) for x in y]  # of y' = -y

    found = states(key, [[Q(1)], [Q(9, 10)]], 3, solved=solved)
    assert asked == [(Q(n, 10) - weight / 10, weight / 10) for n in (2, 3, 4)]
    if key == "bdf2":
        assert found[0] == [(Q(4, 3) * Q(9, 10) - Q(1, 3)) / (1 + weight / 10)]


def test_balls_enclose_the_fractions():
    exact = states("adams_bashforth4", [[Q(1) - Q(n, 10)] for n in range(4)], 20)[-1][0]
    ball = states("adams_bashforth4", [[arb(10 - n) / 10] for n in range(4)], 20, rate=decay)[-1][0]
    assert ball.contains(arb(exact.numerator) / exact.denominator)
    assert ball.rad() < 1e-9


@pytest.mark.parametrize("key", ["adams_bashforth2", "bdf2", "bdf6"])
def test_radii_grow_by_no_more_than_the_bits_that_are_said_to_be_lost(key):
    """On y' = 0, where nothing else grows: the wide balls of the start stay within 2 to the power of these bits."""
    run, radius = StartedMultistep(MULTISTEP[key], None), 2.0**-40
    first = [[arb(1, radius)]] * run.method.steps
    *_, last = islice(run.states(lambda t, y: [arb(0)], first, Q(1), lambda y, *_: y), 30)
    assert radius <= last[0].rad() <= radius * 2.0 ** (run.bits_lost(30) + 1)
    assert (run.bits_lost(30) > 20) == (key != "adams_bashforth2")
