"""verify, from end to end: right steppers pass, wrong ones fail with the name of what they are and an example."""

import json
from fractions import Fraction

import pytest

from driftproof.blackbox.judging.agreement import Domain
from driftproof.blackbox.judging.tolerance import Allowance
from driftproof.blackbox.verify import assert_verified, verify
from driftproof.cli import main
from driftproof.methods.catalogue import METHODS
from tests.blackbox import handwritten_steppers as codes
from tests.blackbox.test_identify import rk4, rk38, velocity_verlet

FEW = 50


def symplectic_euler(q, v, h):
    v = v - h * q
    return q + h * v, v


def backward_euler(q, v, h):
    v = (v - h * q) / (1 + h * h)
    return q + h * v, v


@pytest.mark.parametrize(
    ("step", "method"),
    [
        (rk4, "rk4"),
        (rk38, METHODS["rk38"]),
        (velocity_verlet, "velocity_verlet"),
        (symplectic_euler, "symplectic_euler"),
    ],
)
def test_right_steppers_pass(step, method):
    report = verify(step, method, examples=FEW)
    assert report.passed
    assert "to roundoff" in report.verdict


def test_sizes_that_overflow_are_refused_and_refute_nothing():
    for domain in (Domain(largest_state=1e308), Domain(largest_step=1e300)):
        with pytest.raises(ValueError, match=r"where binary64 overflows; choose smaller sizes"):
            verify(velocity_verlet, "velocity_verlet", examples=FEW, domain=domain)
    assert verify(velocity_verlet, "velocity_verlet", examples=FEW, domain=Domain(largest_state=1e300)).passed


def test_a_method_of_a_file_that_claims_no_order_is_held_to_the_order_that_is_derived(tmp_path):
    tableau = tmp_path / "mine.toml"
    tableau.write_text('family = "runge_kutta"\nA = [[0, 0], ["2/3", 0]]\nb = ["1/4", "3/4"]\n', encoding="utf-8")

    def ralston(f, t, y, h):
        k1 = f(t, y)
        return y + h * (k1 / 4 + 3 * f(t + 2 * h / 3, y + 2 * h / 3 * k1) / 4)

    assert "mine has order 2" in str(verify(ralston, str(tableau), examples=FEW))


def test_what_has_the_same_matrix_but_other_coefficients_fails():
    report = verify(rk38, "rk4", examples=FEW)
    assert not report.passed
    assert report.verdict == "is not rk4; it is rk38"
    assert report.section("Rounding: passed")
    assert report.section("Coefficients: FAILED")


def test_the_fifth_order_row_of_fehlberg_has_a_key_of_its_own():
    pair = METHODS["fehlberg45"]
    rows, nodes = codes.floats(pair)[0], codes.floats(pair)[2]
    step = codes.tableau(rows, [float(x) for x in pair.b_embedded], nodes)
    assert verify(step, "fehlberg45_embedded", examples=FEW).passed
    refuted = verify(step, "fehlberg45", examples=FEW)
    assert refuted.verdict == "is not fehlberg45; it is fehlberg45, with the embedded weights propagated"
    assert "fehlberg45_embedded" in refuted.text()


def test_the_assertion_names_the_right_method_and_shows_an_example():
    named = r"is not velocity_verlet; it is, .*, velocity-first symplectic Euler \(symplectic_euler\)"
    with pytest.raises(AssertionError, match=named) as failure:
        assert_verified(symplectic_euler, method="velocity_verlet", examples=FEW)
    assert "the simplest step beyond the bound: step(q=" in str(failure.value)
    assert_verified(symplectic_euler, method="symplectic_euler", examples=FEW)


def test_an_implicit_stepper_is_held_to_the_tolerance_that_is_stated():
    with pytest.raises(ValueError, match="backward_euler is implicit"):
        verify(backward_euler, "backward_euler")
    stated = Allowance(solver_tolerance=Fraction(1, 10**10))
    assert verify(backward_euler, "backward_euler", allowance=stated, examples=FEW).passed
    assert not verify(backward_euler, "implicit_midpoint", allowance=stated, examples=FEW).passed


def test_a_domain_keeps_a_capped_stepper_to_what_is_asked():
    def capped(q, v, h):
        v = min(v - h * q, 100.0)
        return q + h * v, v

    assert verify(capped, "symplectic_euler", domain=Domain(largest_state=30.0), examples=FEW).passed
    failed = verify(capped, "symplectic_euler", examples=FEW)
    assert not failed.passed
    assert any("100" in line for line in failed.section("What it is: faults").lines)


def test_on_the_command_line_the_status_tells(capsys):
    here = "tests.blackbox.test_verify:symplectic_euler"
    assert main(["verify", here, "--method", "symplectic_euler", "--examples", "5"]) == 0
    assert main(["verify", here, "--method", "forward_euler", "--examples", "5", "--format", "json"]) == 1
    data = json.loads(capsys.readouterr().out.split("\n{", 1)[-1].join(["{", ""]) or "{}")
    assert data["passed"] is False
    assert data["rounding"]["failing"]["q"]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--method", "rk5"], "rk5"),
        (["--method", "rk4", "--solver-tolerance", "1e-10"], "takes no solver_tolerance"),
        (["--method", "rk4", "--largest-step", "0"], "write a number above 0"),
        (["--method", "rk4", "--examples", "none"], "number of examples"),
    ],
)
def test_a_question_without_sense_is_refused_in_one_line(arguments, message, capsys):
    try:
        status = main(["verify", "tests.blackbox.test_verify:symplectic_euler", *arguments])
    except SystemExit as end:
        status = end.code
    assert status == 2
    error = capsys.readouterr().err
    assert message in error
    assert error.count("\n") == 1
