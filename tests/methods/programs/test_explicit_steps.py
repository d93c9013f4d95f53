"""Steps as text for systems: the bits of loops over the tableau, time as a multiple of h, and names that are taken."""

from __future__ import annotations

import math
from fractions import Fraction as Q

import numpy as np
import pytest

from driftproof.methods.catalogue import METHODS
from driftproof.methods.formulas.vector_fields import VectorField
from driftproof.methods.programs.explicit_steps import array_step, field_source
from driftproof.methods.schemes import MethodError, RungeKutta
from driftproof.numeric.steps.engine import runner
from tests.float_bits import bits
from tests.methods.tables.entries import EXPLICIT

VAN_DER_POL = VectorField(("y1", "mu * (1 - y0 * y0) * y1 - y0 + sin(t)"), (("mu", Q(5, 2)),))
LOTKA_VOLTERRA = VectorField(("y0 * (2 - y1)", "y1 * (y0 - 1)"))
LORENZ = VectorField(("10 * (y1 - y0)", "y0 * (rho - y2) - y1", "y0 * y1 - 8 * y2 / 3"), (("rho", Q(28)),))
DECAY = VectorField(("-y0 * sqrt(t + 1)",))
FIELDS = {
    VAN_DER_POL: (lambda t, y: [y[1], 2.5 * (1 - y[0] * y[0]) * y[1] - y[0] + math.sin(t)], (1.0, 0.5)),
    LOTKA_VOLTERRA: (lambda t, y: [y[0] * (2 - y[1]), y[1] * (y[0] - 1)], (1.5, 1.25)),
    LORENZ: (
        lambda t, y: [10 * (y[1] - y[0]), y[0] * (28 - y[2]) - y[1], y[0] * y[1] - 8 * y[2] / 3],
        (1.0, 1.5, 20.0),
    ),
    DECAY: (lambda t, y: [-y[0] * math.sqrt(t + 1)], (1.0,)),
}
TABLEAUX = [method for method in EXPLICIT if isinstance(method, RungeKutta)]


def looped(method, rate, y, h, first, last):
    """The same steps, read off the tableau by loops over stages and components."""
    for n in range(first, last):
        t, slopes = n * h, []
        for row, node in zip(method.a, method.c, strict=True):
            slopes.append(rate(t if node == 0 else t + float(node) * h, moved(y, row, slopes, h)))
        y = moved(y, method.b, slopes, h)
    return tuple(y)


def moved(y, weights, slopes, h):
    terms = [(float(w), k) for w, k in zip(weights, slopes, strict=False) if w != 0]
    if not terms:
        return y
    sums = []
    for i in range(len(y)):
        total = terms[0][0] * terms[0][1][i]
        for w, k in terms[1:]:
            total = total + w * k[i]
        sums.append(total)
    return [x + h * s for x, s in zip(y, sums, strict=True)]


@pytest.mark.slow(keep=8)
@pytest.mark.parametrize("method", TABLEAUX, ids=lambda m: m.key)
def test_a_run_of_a_system_has_the_bits_of_loops_over_the_tableau(method):
    for field, (rate, start) in FIELDS.items():
        found = runner(method, field)(start, 0.01, 3, 8)
        assert bits(*found) == bits(*looped(method, rate, start, 0.01, 3, 8))


@pytest.mark.parametrize("method", EXPLICIT, ids=lambda m: m.key)
def test_step_of_arrays_has_the_bits_of_a_run_by_components(method):
    """Two coupled oscillators with a force in time: the rate is a function of arrays, or the acceleration of them."""
    second_order = not isinstance(method, RungeKutta)
    field = VectorField(("y2", "y3", "y1 - 2 * y0 + t", "y0 - 2 * y1"))
    start, force = (0.3, -0.7, 0.1, 1.0), lambda t, q: np.array([q[1] - 2 * q[0] + t, q[0] - 2 * q[1]])
    step = array_step(method, force if second_order else lambda t, y: np.array([*y[2:], *force(t, y[:2])]), float)
    y = [np.array(part) for part in ((start[:2], start[2:]) if second_order else (start,))]
    made = [float(x) for part in step(y, 0.0, 0.01) for x in part]
    assert bits(*made) == bits(*runner(method, field)(start, 0.01, 0, 1))


@pytest.mark.parametrize(("key", "times"), [("rk4", ["t_2", "t_3", "t_4"]), ("nystrom4", ["t_2", "t_3"])])
def test_a_time_is_written_where_it_is_another_one_and_read(key, times):
    for rate, wanted in (("-y0 + t", times), ("-y0", [])):
        lines = field_source(METHODS[key], VectorField(("y1", rate))).lines
        assert [name for name in (line.partition(" = ")[0] for line in lines) if name.startswith("t_")] == wanted


def test_what_an_embedded_row_leads_away_by_is_written_where_it_is_asked_for():
    plain = ("k1_y0 = -y0", "y0_2 = y0 + h * k1_y0", "k2_y0 = -y0_2", "y0_new = y0 + h * (b_1 * k1_y0 + b_2 * k2_y0)")
    field = VectorField(("-y0",))
    assert field_source(METHODS["heun_euler21"], field).lines == plain
    estimated = field_source(METHODS["heun_euler21"], field, estimated=True).lines
    assert estimated == (*plain, "y0_off = h * (d_1 * k1_y0 + d_2 * k2_y0)")


def test_a_run_of_a_system_goes_on_where_it_stopped_bit_for_bit():
    """Time is i h for a whole i: a clock that adds h up would read something else from the sixth step on."""
    run = runner(METHODS["rk4"], VAN_DER_POL)
    whole = run((1.0, 0.5), 0.1, 0, 60)
    assert run(run((1.0, 0.5), 0.1, 0, 23), 0.1, 23, 60) == whole
    clock = 0.0
    for _ in range(60):
        clock += 0.1
    assert clock != 60 * 0.1
    assert run(run((1.0, 0.5), 0.1, 0, 23), 0.1, 22, 59) != whole


@pytest.mark.parametrize("name", ["h", "t", "y0", "k1_y0", "b_1", "sin", "copysign", "range"])
def test_a_parameter_with_a_name_of_the_text_is_refused(name):
    with pytest.raises(MethodError, match=f"'{name}'"):
        runner(METHODS["rk4"], VectorField((f"{name} * y0",), ((name, Q(2)),)))
