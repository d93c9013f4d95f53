"""The facts door: it answers right where others are wrong, only what is asked for, and refuses in one line."""

import json
from dataclasses import replace
from fractions import Fraction as Q

import pytest

from driftproof.cli import main
from driftproof.methods.catalogue import METHODS
from driftproof.symbolic.facts import FACTS, facts_of
from driftproof.texts.writing.tex import number_tex, polynomial_tex

# The keys that the output format promises for every method.
SCHEMA = {
    "method",
    "family",
    "stages",
    "explicit",
    "order",
    "stability_function",
    "one_step_matrix",
    "determinant",
    "energy_multiplier",
    "invariant",
    "imaginary_limit",
    "real_limit",
    "a_stable",
    "l_stable",
    "symplectic",
    "error_constant",
    "dispersion",
    "dissipation",
}


def only(method, *names):
    return facts_of(method, names)


def test_every_key_that_is_promised_is_a_fact():
    assert set(FACTS) >= SCHEMA


def test_order_and_linear_order_are_two_facts():
    heun3 = METHODS["heun3"]
    rows = ((0, 0, 0), (Q(1, 3), 0, 0), (0, Q(1, 2), 0))
    twin = replace(heun3, key="twin", a=rows, b=(0, 0, 1), c=(0, Q(1, 3), Q(1, 2)))
    names = ("stability_function", "linear_order")
    assert only(twin, *names) == only(heun3, *names)
    assert (only(twin, "order")["order"], only(heun3, "order")["order"]) == (2, 3)


@pytest.mark.parametrize("power", [14, 30])
def test_a_weight_off_in_a_far_digit_costs_the_order(power):
    rk4 = METHODS["rk4"]
    off = replace(rk4, b=(rk4.b[0] + Q(1, 10**power), *rk4.b[1:]))
    facts = only(off, "order", "order_fails", "inconsistencies")
    assert facts["order"] == 0
    assert facts["order_fails"] == {"tree": "τ", "residual": f"1/{10**power}"}
    assert facts["inconsistencies"] == {"sum(b) - 1": f"1/{10**power}"}


@pytest.mark.parametrize(("key", "limit"), [("chebyshev10_1", "200"), ("ssprk40_2", "78")])
def test_real_limits_where_sampling_goes_wrong(key, limit):
    assert only(METHODS[key], "real_limit")["real_limit"]["exact"] == limit


def test_radau_is_algebraically_stable_and_trapezoid_is_not():
    assert only(METHODS["radau_iia2"], "algebraically_stable", "l_stable") == {
        "algebraically_stable": True,
        "l_stable": True,
    }
    assert only(METHODS["trapezoid"], "algebraically_stable", "a_stable") == {
        "algebraically_stable": False,
        "a_stable": True,
    }


def test_printed_inconsistency_is_a_verdict_with_its_residual():
    residual = Q(only(METHODS["prince_dormand87"], "inconsistencies")["inconsistencies"]["sum(b) - 1"])
    assert -Q(37, 10**19) < residual < -Q(36, 10**19)


def test_only_what_is_asked_for_is_computed(monkeypatch):
    def refuse(_):
        raise AssertionError("computed without being asked for")

    monkeypatch.setitem(FACTS, "ssp_coefficient", refuse)
    assert only(METHODS["rk4"], "order") == {"order": 4}
    with pytest.raises(AssertionError, match="without being asked"):
        only(METHODS["rk4"], "ssp_coefficient")


def test_user_s_own_tableau_and_bad_files(tmp_path, capsys):
    mine = tmp_path / "mine.toml"
    mine.write_text('family = "runge_kutta"\nA = [[0, 0], ["2/3", 0]]\nb = ["1/4", "3/4"]\n', encoding="utf-8")
    assert main(["facts", str(mine), "--only", "order,stability_function", "--format", "json"]) == 0
    assert json.loads(capsys.readouterr().out)["order"] == 2
    bad = {
        "ragged.toml": 'family = "runge_kutta"\nA = [[0, 0], ["2/3"]]\nb = ["1/4", "3/4"]\n',
        "code.toml": 'family = "runge_kutta"\nA = [["__import__(1)"]]\nb = [1]\n',
        "root.toml": 'family = "runge_kutta"\nA = [["s3"]]\nb = [1]\n',
        "missing.toml": None,
    }
    for name, text in bad.items():
        if text is not None:
            (tmp_path / name).write_text(text, encoding="utf-8")
        assert main(["facts", str(tmp_path / name)]) == 2
        captured = capsys.readouterr()
        assert captured.out == ""
        assert captured.err.count("\n") == 1
        assert name in captured.err


def test_unknown_fact_and_method_get_one_line(capsys):
    for arguments in (["facts", "rk4", "--only", "speed"], ["facts", "rk5"]):
        assert main(arguments) == 2
        assert capsys.readouterr().err.count("\n") == 1


def test_picture_of_the_region_is_drawn_and_a_splitting_has_none(tmp_path, capsys):
    picture = tmp_path / "region.svg"
    for kind in ("region", "order-star", "phase"):
        assert main(["facts", "rk4", "--only", "order", "--plot", str(picture), "--picture", kind]) == 0
        assert picture.read_text(encoding="utf-8").count("<svg") == 1
        picture.unlink()
    assert main(["facts", "symplectic_euler", "--plot", str(picture)]) == 2
    assert not picture.exists()


def test_numbers_and_polynomials_in_tex():
    assert number_tex("-1/120") == r"-\frac{1}{120}"
    assert number_tex("2*sqrt(2)") == r"2 \sqrt{2}"
    assert number_tex("2**(1/3)") == r"\sqrt[3]{2}"
    assert polynomial_tex(["1", "0", "-1", "1/2"], "h^2") == r"1-h^{4}+\frac{1}{2}h^{6}"
