"""Runs of up to 10⁹ steps: energies where the exact map has them, rounding within the theorem and by its laws."""

from fractions import Fraction as Q

import pytest

pytest.importorskip("numba")

from benchmarks import long_runs
from benchmarks.long_runs import decades, exponent, laws_section, long_run, runs_section

U = 2.0**-53
TIERS = [pytest.param(10**4, id="short"), pytest.param(10**9, id="long", marks=pytest.mark.long)]


@pytest.mark.parametrize("most", TIERS)
def test_a_symplectic_run_keeps_its_energy_and_its_rounding_stays_far_below_the_theorem(most):
    """The map conserves q²(1 - h²/4) + v², so its energy never leaves a band of width h²/4; rounding walks, as √N."""
    run = long_run("velocity_verlet", most)
    h = Q(long_runs.H)
    assert abs(run.energy) <= h * h / 4 / (1 - h * h / 4)
    assert abs(run.energy - run.energy_of_map) <= 4 * run.rounding * U + 1e-5 * abs(run.energy_of_map)
    assert run.rounding <= run.theorem / most**0.5 * 3
    assert run.compensated < run.rounding / 4


@pytest.mark.parametrize("most", TIERS)
def test_rounding_of_rk4_is_the_pull_of_its_weights_which_the_theorem_bounds_and_compensation_leaves(most):
    """Each step is short by u h/2, so that N of them are late by N u h/2 on the circle; a bound like √N would fail."""
    run = long_run("rk4", most)
    pull = most * long_runs.H / 2
    assert pull / 2 < run.rounding < 2 * pull
    assert pull / 2 < run.compensated < 2 * pull
    assert run.rounding <= run.theorem
    decay = most * long_runs.H**6 / 72
    assert run.energy == pytest.approx(-decay, rel=1e-2 + decay)
    assert run.energy == pytest.approx(run.energy_of_map, rel=1e-4)


def test_a_run_that_is_told_a_wrong_step_is_beyond_the_theorem(monkeypatch):
    """The bound has teeth: 2⁻⁴⁰ more in each of a thousand steps is beyond what rounding may do."""
    right = long_runs.compiled_runner
    wrong = lambda *args, **options: lambda y, h, first, last: right(*args, **options)(y, h + 2.0**-40, first, last)
    monkeypatch.setattr(long_runs, "compiled_runner", wrong)
    run = long_run("velocity_verlet", 10**3)
    assert run.rounding > run.theorem


@pytest.mark.long
def test_rounding_grows_by_its_laws():
    section = laws_section(10**9)
    assert [goal.met for goal in section.goals] == [True] * 4, section.goals


def test_tables_of_long_runs_have_a_row_for_each_power_of_ten(monkeypatch):
    monkeypatch.setattr(long_runs, "RUNS", (("velocity_verlet", long_runs.H),))
    section = runs_section(10**5)
    assert [row[1] for row in section.rows[1:]] == ["1e3", "1e4", "1e5"]
    assert [goal.met for goal in section.goals] == [True]
    assert decades(10**9)[-1] == 10**9
    counts = [10, 100, 1000]
    assert exponent(counts, [n**1.5 for n in counts]) == pytest.approx(1.5)
