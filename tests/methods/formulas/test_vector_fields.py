"""Systems y' = f(t, y) as text: what is refused, derivatives as they are written, kinks and jumps."""

from __future__ import annotations

import pytest

from driftproof.methods.formulas.vector_fields import VectorField, partial_derivative
from driftproof.methods.schemes import MethodError


@pytest.mark.parametrize(
    ("rates", "parameters", "what"),
    [
        ((), (), "at least one rate"), (("y1",), (), "'y1' is not allowed"),
        (("0.1 * y0",), (), r"'0\.1' is not allowed"), (("y0 ** 2",), (), "is not allowed"),
        (("tan(y0)",), (), "'tan' is not allowed"), (("y0.real",), (), "is not allowed"),
        (("sin",), (), "'sin' is not allowed"), (("y0 +",), (), "not an expression"),
        (("y0 if t else y0",), (), "'y0 if t else y0' is not allowed"),
        (("y0 > 0",), (), "'y0 > 0' is not allowed"), (("y0 if 0 < y0 < 1 else t",), (), "'0 < y0 < 1' is not allowed"),
        (("floor",), (), "'floor' is not allowed"), (("True * y0",), (), "'True' is not allowed"),
    ],
)  # fmt: skip
def test_a_rate_that_is_no_plain_formula_is_refused(rates, parameters, what):
    with pytest.raises(MethodError, match=what):
        VectorField(rates, parameters)


@pytest.mark.parametrize(
    ("rate", "derivative"),
    [
        *(("y0 * y1", "y1"), ("y1 * y0", "y1"), ("y1 - y0", "-1"), ("sin(y1) * 2", "0"), ("exp(y0)", "exp(y0)")),
        *(("y0 + y1", "1"), ("t + y0", "1"), ("y0 - t", "1"), ("-y0", "-1"), ("-t", "0"), ("y0 * y0", "y0 + y0")),
        *(("sin(y0)", "cos(y0)"), ("cos(y0)", "-sin(y0)"), ("log(y0)", "1 / y0"), ("sqrt(y0)", "1 / (2 * sqrt(y0))")),
        *(("y0 + y0", "1 + 1"), ("y0 - y0", "1 - 1"), ("y0 * 1", "1"), ("exp(2 * y0)", "exp(2 * y0) * 2")),
        *(("abs(y0)", "copysign(1, y0)"), ("y0 * abs(y0)", "abs(y0) + y0 * copysign(1, y0)"), ("abs(y1)", "0")),
        ("2 * y0 * sin(y0) + t * y0", "2 * sin(y0) + 2 * y0 * cos(y0) + t"),
        *(("y0 / y1", "1 / y1"), ("y1 / y0", "-(y1 / y0 * (1 / y0))"), ("exp(-y0)", "exp(-y0) * -1"), ("y1 / t", "0")),
    ],
)
def test_derivatives_are_written_without_ones_and_zeros(rate, derivative):
    assert partial_derivative(rate, "y0") == derivative


@pytest.mark.parametrize(("rate", "smooth"), [("sin(y0)", True), ("abs(y0)", False), ("floor(t) + y0", False)])
def test_a_field_with_a_kink_or_a_jump_is_not_smooth(rate, smooth):
    assert VectorField((rate,)).smooth is smooth
