"""A change of an energy that is not the method's alone is said to be so, and no other."""

from pathlib import Path
from sys import path

import pytest

from driftproof.texts.questions.evaluate import value

SWING = "x'=v, v'=-sin(x), x(0)=1.2, v(0)=0"
RUN = "h=1/8, t=1"


@pytest.mark.parametrize("readout", ["energy_change", "relative_energy_change", "largest_energy_change"])
def test_an_energy_that_f_does_not_conserve_is_told_beside_its_change(readout):
    """To x = cos t belongs the change of x² of -sin² t, at 1/8 -0.0155."""
    turn = "run rk4 x'=v, v'=-x, x(0)=1, v(0)=0"
    found = value(f"{turn}, energy=x^2, {RUN} : {readout}")
    assert "f does not conserve this energy, which the true solution changes by -0.015543789" in found.remark
    assert f"; {found.remark})" in found.written("text")
    assert value(f"{turn}, energy=x^2 + v^2, {RUN} : {readout}").remark is None
    assert value(f"{turn}, energy=x^2, {RUN} : energy").remark is None


def test_an_energy_that_is_conserved_by_a_function_is_enclosed_and_has_no_remark():
    assert value(f"run rk4 {SWING}, energy=v^2/2 - cos(x), {RUN} : energy_change").remark is None
    assert "changes by" in value(f"run rk4 {SWING}, energy=v^2/2 + cos(x), {RUN} : energy_change").remark


@pytest.mark.parametrize(("constant", "remarked"), [("9.81", False), ("9.8100001", True)])
def test_a_constant_that_is_a_double_in_f_and_exact_in_the_energy_is_no_change(
    constant, remarked, tmp_path, monkeypatch
):
    """The solution changes it by some u of its terms, or, with another constant, by a part of 10⁻⁸."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("sys.path", [*path])
    Path("swinging_of_a_question.py").write_text(
        "from math import sin\ndef f(t, y): return [y[1], -9.81 * sin(y[0])]", encoding="utf-8"
    )
    about = (
        f"energy = 'y1^2/2 - {constant}*cos(y0)'\nstart = ['1.2', 0]\nend = 1\nfunction = 'swinging_of_a_question:f'"
    )
    Path("own.toml").write_text(about, encoding="utf-8")
    assert bool(value(f"run rk4 problem=own.toml {RUN.replace(',', '')} : energy_change").remark) is remarked
