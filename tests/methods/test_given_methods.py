"""Methods are given by key, name, file, family and value, or as objects; what is none of these is refused."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction as Q
from pathlib import Path

import pytest

from driftproof.methods.catalogue import METHODS
from driftproof.methods.given_methods import method_of, methods_of, names_of
from driftproof.methods.schemes import RungeKutta


def test_scene_names_a_method_by_its_key_its_file_or_itself() -> None:
    assert names_of(["rk4", Path("mine.toml"), METHODS["heun2"]]) == (["rk4", "mine.toml", "heun2"], ())
    assert names_of("rk4, heun2") == names_of([METHODS["rk4"], Path("heun2")])
    own, other = replace(METHODS["rk4"], source="mine"), replace(METHODS["heun2"], key="mine")
    named, known = names_of([own, "rk4", other, own])
    assert named == ["rk4 of your own", "rk4", "mine", "rk4 of your own"]
    assert known == (("rk4 of your own", own), ("mine", other))
    for taken in ("euler", "bdf2"):  # a common name, and a key of which there are only facts
        assert names_of(replace(own, key=taken))[0] == [f"{taken} of your own"]
    with pytest.raises(ValueError, match="two methods have the key rk4 of your own; give each a key of its own"):
        names_of([own, replace(own, title="Another")])


def test_member_of_a_family_is_named_with_its_value(tmp_path: Path) -> None:
    path = tmp_path / "mine at home.toml"
    path.write_text('family = "runge_kutta"\nparameter = "a"\nA = [[0, 0], ["a", 0]]\nb = ["1 - 1/(2*a)", "1/(2*a)"]')
    for of in (f"{path}", "explicit_order_2"):
        found = method_of(f"{of} at 2/3")
        assert isinstance(found, RungeKutta)
        assert (found.a, found.b) == (METHODS["ralston2"].a, METHODS["ralston2"].b)
    assert method_of(f"{path} at sqrt(2)/2").b[1] ** 2 == Q(1, 2)
    path.write_text('title = "Mine"\n' + path.read_text())
    assert method_of(f"{path} at 2/3").title == "Mine at a = 2/3"
    assert methods_of("explicit_order_2 at 1, rk4")[0].b == (Q(1, 2), Q(1, 2))
    for given, said in (
        ("explicit_order_2 at 0", "is not defined at alpha = 0, a pole"),
        ("explicit_order_2", "one method is needed, such as 'explicit_order_2 at 1/2'"),
        ("explicit_order_2 at", "the expression is empty"),
        ("rk4 at 1/2", "^rk4 has no parameter"),
        (f"{path} 2", "^unknown method"),
        (__file__, "test_given_methods.py: the name of a method's file ends in .toml$"),
    ):
        with pytest.raises(ValueError, match=said):
            method_of(given)


def test_methods_are_named_in_one_text_or_one_by_one() -> None:
    rk4, heun2 = METHODS["rk4"], METHODS["heun2"]
    for given in ("rk4, heun2", ["rk4", heun2], (rk4, "heun2")):
        assert methods_of(given) == [rk4, heun2]
    assert methods_of(rk4) == [rk4]
    assert methods_of([]) == []
    for wrong, reason in (
        ("sdirk_order_2", "a family of methods, with"),
        (4, "^'4' is not a method: give a key, a .toml file, or a method$"),
        (len, "give a key, a .toml file, or a method; what is examined comes first$"),
    ):
        with pytest.raises(ValueError, match=reason):
            method_of(wrong)  # type: ignore[arg-type]
