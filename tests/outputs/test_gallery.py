"""The gallery's adapters import without their packages, and where a package is there, do what is expected of it."""

from fractions import Fraction
from functools import cache
from math import log2
from pathlib import Path

import mpmath
import pytest

from driftproof.blackbox.isolation import IsolatedRunner
from driftproof.blackbox.stepper.opening import Target
from driftproof.methods.catalogue import METHODS
from driftproof.symbolic.runs import exact_matrix_at
from examples.gallery import run, solver_table, trial
from tests.looping import exactly, some
from tests.outputs.gallery_expected import EXPECTED, FIELDS, FORCES, MAPS

TARGETS = run.targets()
PRESENT = [name for name, entry in TARGETS.items() if run.installed(entry.package) is not None]
# Some seconds together: by default two, and all with -m long.
ASKED = [pytest.param(name, marks=pytest.mark.long if i % 3 else ()) for i, name in enumerate(PRESENT)]
CALLS = {"field": FIELDS, "force": FORCES, "map": MAPS}
# A step is some dozens of roundings of numbers about 1.
NOISE = {"binary64": 64 * 2.0**-53, "binary32": 64 * 2.0**-24}
# Twice this far from a whole number a slope would show the next one.
SLACK = 0.45


def test_every_target_has_an_expected_answer_of_its_calling_convention():
    assert {name: entry.calls for name, entry in TARGETS.items()} == {
        name: calls for calls, expected in CALLS.items() for name in expected
    }


def test_names_are_the_packages_and_the_steps_are_there():
    for name, entry in some(TARGETS.items(), 200):
        assert name == f"{entry.package} {entry.step.partition(':')[2]}"
        assert entry.key is None or entry.key in METHODS


def test_claims_that_differ_from_what_is_are_said_to_be_untrue():
    for name, expected in EXPECTED.items():
        claimed = TARGETS[name].order
        assert expected.untrue or claimed in (None, expected.order), name


def test_what_the_page_opens_with_is_found_in_the_table_and_seen_by_plain_runs_worst_first():
    page = run.TABLE.read_text(encoding="utf-8")
    findings = run.FINDINGS.read_text(encoding="utf-8").strip()
    assert findings in page
    rows = [line.strip("| ").split(" | ") for line in findings.splitlines()[2:]]
    orders = []
    for package, _, promised, seen, _, _, asked in exactly(10, rows):
        step = asked.strip("`").partition(" identify ")[2]
        name = next(name for name, entry in TARGETS.items() if entry.step == step)
        assert name.startswith(package.split()[0])
        assert TARGETS[name].order == int(promised)
        assert EXPECTED[name].untrue
        orders.append(round(float(seen)))
    assert orders == sorted(orders)
    source = Path(run.__file__).with_name("convergence.py").read_text(encoding="utf-8")
    assert "import driftproof" not in source
    assert "from driftproof" not in source


def test_adapters_import_no_package(modules_after):
    adapters = sorted(path.stem for path in Path(run.__file__).parent.glob("on_*.py"))
    loaded = modules_after(f"import {', '.join(f'examples.gallery.{name}' for name in adapters)}")
    assert {f"examples.gallery.{name}" for name in adapters} <= loaded
    assert {name.split(".")[0] for name in loaded} & {"torch", "jax", "scipy", "mujoco", "gymnasium"} == set()


def test_gallery_skips_what_is_not_installed():
    assert run.installed("no-such-package-of-ours") is None


def test_table_is_markdown_with_a_row_for_each_target():
    text = run.written([("a b", "1", "x | y", "it is rk4", "4", "4", "1 u", "passed")], ["other"])
    assert "| a b | 1 | x \\| y | it is rk4 | 4 | 4 | 1 u | passed |" in text
    assert text.endswith("Not asked: other.\n")


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize(
    "name", ASKED or [pytest.param("", marks=pytest.mark.skip("no package of the gallery is here"))]
)
def test_one_step_is_as_expected(name):
    entry, expected = TARGETS[name], EXPECTED[name]
    runner = IsolatedRunner(Target(entry.step, entry.calls, entry.array), run.TIME_LIMIT)
    matrix, answers, precision = runner.run([trial.matrix, trial.answers, trial.format_of])
    noise = NOISE[precision.result]
    if expected.what in METHODS and not matrix.failed:
        assert _distance(matrix.result, expected.what) <= noise + expected.loose
    assert not answers.failed, answers.seen
    _check_order(expected, _errors(*answers.result), noise + expected.loose)


def _distance(matrix, key):
    exact = exact_matrix_at(METHODS[key], Fraction(1, 2))
    return max(abs(x - y) for x, y in zip((*matrix[0], *matrix[1]), map(float, exact), strict=True))


def _check_order(expected, errors, noise):
    """The slope at the smallest steps whose errors stand out; above order 4 these are too large to show it."""
    clear = [error for error in errors if error > 16 * noise]
    if expected.order is None or expected.order > 4 or len(clear) < 2:
        return
    assert abs(log2(clear[-2] / clear[-1]) - 1 - expected.order) < SLACK, errors


def _errors(problem, answers):
    flow, start = _flow(problem)
    exact = [flow(start + h) for h in trial.STEPS]
    return [max(float(abs(x - y)) for x, y in zip(*pair, strict=True)) for pair in zip(answers, exact, strict=True)]


@cache
def _flow(problem):
    """The exact solution of a problem from its start, by mpmath's Taylor series, and the time of the start."""
    force = trial.hard_spring if problem == trial.SPRING else lambda q: -q
    rate = trial.driven if problem == trial.DRIVEN else lambda t, y: [y[1], force(y[0])]
    start = trial.TIME if problem == trial.DRIVEN else 0.0
    flow = mpmath.odefun(rate, start, list(trial.START))
    return flow, start


@pytest.mark.slow
def test_whole_solvers_stand_in_their_table_as_they_are_found():
    cells = solver_table.row("scipy RK45")
    assert cells[2:5] == ("5", "dormand_prince54", "5")
    assert cells[5:] == ("h_next/h = 0.9 r^(-1/5), at least 0.2, at most 10 (not PI)", "")
    page = solver_table.PAGE.read_text(encoding="utf-8").partition("## Every solver")[2]
    rows = [line.strip("| ").split(" | ")[0] for line in page.splitlines() if line.startswith("| ")][2:]
    assert set(some(rows, 100)) <= set(solver_table.solvers())
    assert not hasattr(solver_table.PACKAGES["scipy"], "NoSuchMethod")
