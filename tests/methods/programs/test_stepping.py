"""The program text of a step: nothing in it that is not needed, and none for an implicit method."""

from __future__ import annotations

import ast
from fractions import Fraction as Q

import pytest

from driftproof.methods.catalogue import METHODS
from driftproof.methods.programs.stepping import step_source, stepper
from driftproof.methods.schemes import MethodError, RungeKutta, Splitting
from driftproof.numeric.steppers import CountedForce
from tests.methods.tables.entries import EXPLICIT


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
