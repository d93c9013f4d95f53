"""Steps and runs as objects: exact quantities, numbers that print, a budget where it is asked for."""

from fractions import Fraction as Q

from driftproof import read_method, run, step


def test_quantities_are_exact_or_enclosed():
    found = run("rk4", "1/4", 10)
    assert (found.steps, found.start, found.method.key) == (40, (1, 0), "rk4")
    assert float(found.state_error) == 0.0003253084126731185
    assert [str(found.state_error), *map(str, found.exact_state)] == ["0.000325308412673119", "cos(10)", "-sin(10)"]
    assert step("rk4", Q(1, 2)).final_state == (Q(337, 384), Q(-23, 48))


def test_budget_is_there_where_it_is_asked_for(tmp_path):
    path = tmp_path / "euler.toml"
    path.write_text('family = "runge_kutta"\nA = [[0]]\nb = [1]\n')
    asked = run(read_method(path), "1/4", 1, budget=True)
    assert asked.budget["rounding"]["decimal"]
    assert str(asked).startswith(str(run(path, "1/4", 1)))
    assert run(path, "1/4", 1).budget is None
