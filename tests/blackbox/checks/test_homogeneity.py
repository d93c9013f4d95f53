"""Steps of systems that they have built in: rounding among the smallest numbers and a pole are no faults of theirs."""

import numpy as np
import pytest

from driftproof.blackbox.identify import identify


def runge_kutta_on(rate, kept=lambda y: y):
    """RK4 of a system that it has built in."""

    def step(y, dt):
        y = kept(y)
        k1 = rate(y)
        k2 = rate(y + dt / 2 * k1)
        k3 = rate(y + dt / 2 * k2)
        return y + dt / 6 * (k1 + 2 * k2 + 2 * k3 + rate(y + dt * k3))

    return step


def stiff(y):
    return np.array([y[1] - 100.0 * y[0], -y[1]])


def flushed(y):
    return np.where(abs(y) < 2.0**-1022, 0.0, y)


@pytest.mark.parametrize(("kept", "words"), [(lambda y: y, []), (flushed, ["subnormal numbers become 0"])])
def test_rounding_of_the_smallest_numbers_grows_with_the_rates_of_a_system(kept, words):
    found = identify(runge_kutta_on(stiff, kept), isolate=False)
    faults = found.section("Faults").lines if found.section("Faults") else ()
    assert [fault.partition(":")[0] for fault in faults] == words


def to_a_centre(pole):
    """A leapfrog about a centre, whose orbits are known from their energy: a body that escapes has none."""

    def step(x, v, dt):
        with np.errstate(all="ignore"):
            r = np.sqrt(x @ x)
            bound = np.sqrt(pole / r - v @ v / 2)
            v = v - dt / 2 * x / r**3 * bound / bound
            x = x + dt * v
            return x, v - dt / 2 * x / np.sqrt(x @ x) ** 3

    return step


def test_where_the_domain_of_a_system_ends_nothing_overflows():
    found = identify(to_a_centre(3.0), isolate=False)
    assert found.section("Faults") is None
    told = "\n".join(found.section("Checks").lines)
    assert "is refused: it returns (nan, nan)" in told
    assert "a step from (0, 0) gives no answer" in told
