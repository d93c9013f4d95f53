"""Loops over numbers: what compiles a loop compiles what it calls, and leaves the functions in Python as they are."""

from __future__ import annotations

from driftproof.numeric.steps import loops


def double(x):
    return 2 * x


def fourfold(x):
    return double(double(x))


def test_a_compiled_loop_calls_compiled_loops_and_is_made_once(monkeypatch):
    compiled = []
    monkeypatch.setattr(loops, "compiled_function", lambda f: compiled.append(f.__name__) or (lambda x: f(x) + 1))
    assert loops.loop(fourfold, compiled=True)(1) == 2 * (2 * 1 + 1) + 1 + 1
    assert loops.loop(fourfold, compiled=True) is loops.loop(fourfold, compiled=True)
    assert compiled == ["double", "fourfold"]
    assert loops.loop(fourfold, compiled=False) is fourfold
    assert fourfold(1) == 4


def test_rows_of_zeros_are_lists_of_floats_or_arrays_of_the_numbers_that_are_wanted(monkeypatch):
    monkeypatch.setattr(loops, "compiled_function", lambda function: function)
    (zeros, indices), (on_arrays, of_integers) = (loops.allocators(compiled=compiled) for compiled in (False, True))
    assert (zeros(2, 1), indices(2)) == ([[0.0], [0.0]], [0.0, 0.0])
    assert (on_arrays(2, 1).tolist(), of_integers(2).dtype.kind) == ([[0.0], [0.0]], "i")
