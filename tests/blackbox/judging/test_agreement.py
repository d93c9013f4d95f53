"""A stepper beside a method: right ones agree, wrong ones give the simplest example, on every run the same."""

from contextlib import suppress
from operator import attrgetter

import numpy as np
import pytest

from driftproof.blackbox.findings import UnsupportedCall
from driftproof.blackbox.judging.agreement import agreement, several_together, steps_back
from driftproof.blackbox.judging.measured_order import measured_orders
from driftproof.blackbox.judging.nonlinear_step import nonlinear_agreement
from driftproof.blackbox.judging.single_mistakes import single_mistakes
from driftproof.blackbox.judging.specification import Allowance, Domain, Specification
from driftproof.blackbox.stepper.opening import opened
from driftproof.methods.catalogue import METHODS
from tests.blackbox import handwritten_steppers as codes
from tests.blackbox.checks.habits import plain as symplectic_euler
from tests.blackbox.transcripts import Asked, shortened

FEW = 100


def capped(q, v, h):
    v = min(v - h * q, 100.0)
    return q + h * v, v


def slightly_off(q, v, h):
    v = v - (1 + 1e-12) * h * q
    return q + h * v, v


def refuses_large_steps(q, v, h):
    if h > 1:
        raise RuntimeError("h too large")
    return symplectic_euler(q, v, h)


def found(step, **options):
    return agreement(opened(step), Specification(METHODS["symplectic_euler"], **options), FEW)


@pytest.mark.parametrize(("array", "largest"), [(np.float32, 0.39), (np.float32, 1.67), (np.float16, 0.92)])
def test_states_in_rows_are_numbers_of_the_format_in_every_domain(array, largest):
    subject = opened(lambda q, v, h: (q + h * v, v - h * q), array=array)
    narrow = Specification(METHODS["forward_euler"], domain=Domain(largest_state=largest))
    passed, words, _ = several_together(subject, narrow)
    assert passed, words


def test_extremes_are_tried_only_where_they_are_asked_for():
    def in_other_units(q, v, h):  # a conversion that underflows below 1e-300
        q1, v1 = symplectic_euler(q * 1e-20, v * 1e-20, h)
        return q1 / 1e-20, v1 / 1e-20

    scale = 2.0**-60
    exactly = lambda q, v, h: tuple(x / scale for x in symplectic_euler(q * scale, v * scale, h))
    assert found(exactly).holds
    assert not found(exactly, domain=Domain(smallest_step=0.0, smallest_state=0.0)).holds
    assert not found(in_other_units, domain=Domain(smallest_step=0.0, smallest_state=0.0)).holds


def backwards_another(q, v, h):
    return symplectic_euler(q, v, h if h > 0 else h / 2)


def rows_mixed(q, v, h):
    q1, v1 = symplectic_euler(q, v, h)
    return (q1, v1) if np.size(q) == 1 else (q1[::-1], v1)


def solved(q, v, h):
    q1 = (q + h * v) / (1 + h * h)
    return q1 + 1e-10 * abs(q1), v - h * q1


NARROW = Domain(largest_step=0.5, largest_state=0.75, smallest_step=0.01, smallest_state=0.125)
LOOSE = Allowance(solver_tolerance=1e-9)
TRIED = {
    "symplectic Euler": (symplectic_euler, "symplectic_euler", {}),
    "in a narrow domain": (symplectic_euler, "symplectic_euler", {"domain": NARROW}),
    "another method": (symplectic_euler, "velocity_verlet", {"domain": NARROW}),
    "its neighbour": (symplectic_euler, "symplectic_euler_position_first", {}),
    "Euler's": (symplectic_euler, "forward_euler", {}),
    "Verlet's": (symplectic_euler, "velocity_verlet", {}),
    "one coefficient off": (slightly_off, "symplectic_euler", {}),
    "capped": (capped, "symplectic_euler", {}),
    "refusing": (refuses_large_steps, "symplectic_euler", {}),
    "another step back": (backwards_another, "symplectic_euler", {}),
    "rows mixed": (rows_mixed, "symplectic_euler", {"domain": NARROW}),
    "solved loosely": (solved, "backward_euler", {"allowance": LOOSE}),
    "solved too loosely": (solved, "backward_euler", {"allowance": Allowance(solver_tolerance=1e-12)}),
    "h in binary32": (symplectic_euler, "symplectic_euler", {"allowance": Allowance(step_in_binary32=True)}),
    "flushed": (symplectic_euler, "symplectic_euler", {"allowance": Allowance(flush_to_zero=True)}),
    "v from positions": (codes.velocity_from_positions, "symplectic_euler", {}),
    "v from positions, allowed": (
        codes.velocity_from_positions, "symplectic_euler", {"allowance": Allowance(velocity_from_positions=True)},
    ),
    "rk4": (codes.rk4, "rk4", {}),
}  # fmt: skip


@pytest.mark.slow(keep=10)
@pytest.mark.parametrize("name", TRIED)
@pytest.mark.parametrize("array", [None, np.float32, np.float16])
def test_all_that_is_asked_and_said_of_steps_is_as_before(name, array, as_before):
    step, key, how = TRIED[name]
    asked = Asked(step)
    subject, wanted = opened(asked.code, array=array), Specification(METHODS[key], **how)
    found = agreement(subject, wanted, FEW)
    said = [*found.lines, found.data, str(asked), tuple(steps_back(subject, wanted))]
    with suppress(UnsupportedCall):
        said.append(tuple(several_together(subject, wanted)))
    if step is codes.rk4:
        said += [single_mistakes(subject, METHODS["rk38"]), *map(attrgetter("words"), measured_orders(subject))]
        said += [nonlinear_agreement(subject, Specification(METHODS[other])).words for other in ("rk4", "rk38")]
    as_before(said[0], *shortened(said[1:], array is None), asked)
