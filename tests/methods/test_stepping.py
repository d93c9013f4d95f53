"""The program text of a step: the same bits as tables read by loops, and nothing in it that is not needed."""

from __future__ import annotations

import ast
from fractions import Fraction as Q
from math import sin

import pytest

from driftproof.methods.catalogue import METHODS
from driftproof.methods.schemes import MethodError, Nystrom, RungeKutta, Splitting
from driftproof.methods.stepping import step_source, stepper
from driftproof.numeric.steppers import CountedForce
from tests.methods.tables.entries import EXPLICIT

STATES = [(1.0, 0.0, 0.5), (0.3, -0.7, 0.1), (-2.5, 1e-3, -1.3)]


def interpreted(method, force, q, v, h):
    """One step, read off the tables by loops, in floats."""
    if isinstance(method, Splitting):
        for kind, c in method.parts:
            if c != 0 and kind == "kick":
                v = v + (float(c) * h) * force(q)
            elif c != 0:
                q = q + (float(c) * h) * v
        return q, v
    if isinstance(method, Nystrom):
        forces = []
        for node, row in zip(method.c, method.a, strict=True):
            place = q + (float(node) * h) * v if node != 0 else q
            forces.append(force(weighed(place, row, forces, h * h)))
        return weighed(q + h * v, method.b_position, forces, h * h), weighed(v, method.b_velocity, forces, h)
    slopes = []
    for row in method.a:
        place, rate = (weighed(x, row, [k[i] for k in slopes], h) for i, x in enumerate((q, v)))
        slopes.append((rate, force(place)))
    q1, v1 = (weighed(x, method.b, [k[i] for k in slopes], h) for i, x in enumerate((q, v)))
    return q1, v1


def weighed(start, weights, slopes, h):
    terms = [float(w) * k for w, k in zip(weights, slopes, strict=False) if w != 0]
    if not terms:
        return start
    total, *rest = terms
    for term in rest:
        total = total + term
    return start + h * total


@pytest.mark.parametrize("method", EXPLICIT, ids=lambda m: m.key)
def test_the_text_gives_the_same_bits_as_the_tables_read_by_loops(method):
    step = stepper(method, float)
    for q, v, h in STATES:
        for force in (lambda x: -x, lambda x: -sin(x)):
            assert step(force, q, v, h) == interpreted(method, force, q, v, h)


def test_a_wrong_coefficient_gives_other_bits():
    rk4 = METHODS["rk4"]
    off = RungeKutta("off", "off", 4, "a test", rk4.a, (rk4.b[0] + Q(1, 10**12), *rk4.b[1:]), rk4.c)
    assert stepper(off, float)(sin, 1.0, 0.5, 0.5) != interpreted(rk4, sin, 1.0, 0.5, 0.5)


@pytest.mark.parametrize("method", EXPLICIT, ids=lambda m: m.key)
def test_the_text_holds_no_number_and_no_branch(method):
    nodes = list(ast.walk(ast.parse("\n".join(step_source(method).lines))))
    assert not [node for node in nodes if isinstance(node, ast.Constant | ast.If | ast.IfExp | ast.For | ast.While)]
    assert not {name for name, c in step_source(method).coefficients if c in (0, 1, -1)}


def test_a_stage_that_only_the_embedded_row_needs_is_left_out():
    force = CountedForce(lambda x: -x)
    stepper(METHODS["dormand_prince54"], float)(force, 1.0, 0.0, 0.1)
    assert force.calls == 6
    assert METHODS["dormand_prince54"].stages == 7


def test_coefficients_of_one_are_signs():
    back = RungeKutta("back", "back", 0, "a test", ((0, 0), (-1, 0)), (0, -1), (0, -1))
    assert step_source(back).lines == (
        *("k1_v = force(q)", "q_2 = q + h * (-v)", "v_2 = v + h * (-k1_v)", "k2_v = force(q_2)"),
        *("q_new = q + h * (-v_2)", "v_new = v + h * (-k2_v)"),
    )
    leapfrog = Splitting("kd", "kick and drift", 1, "a test", (("kick", -1), ("drift", 1), ("kick", Q(1, 2))))
    lines = step_source(leapfrog).lines
    assert lines[:3] == ("v_1 = v - h * (force(q))", "q_2 = q + h * v_1", "v_3 = v_1 + (c3 * h) * (force(q_2))")


@pytest.mark.parametrize("key", ["backward_euler", "gauss2"])
def test_an_implicit_method_has_no_text(key):
    with pytest.raises(MethodError, match="is implicit"):
        step_source(METHODS[key])
    with pytest.raises(MethodError, match="is implicit"):
        stepper(key, float)
