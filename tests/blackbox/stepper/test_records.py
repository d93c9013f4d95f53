"""Records as states: a dataclass with slots, changed or returned; what is returned, by its names or in its order."""

from dataclasses import dataclass

import pytest

from driftproof.blackbox.stepper.opening import opened


@dataclass(slots=True)
class Slotted:
    q: float
    v: float


def moved(q, v, h):
    return Slotted(q + h * v, v - h * (q + h * v))


def returned(state: Slotted, h):
    return moved(state.q, state.v, h)


def in_place(state: Slotted, h):
    new = moved(state.q, state.v, h)
    state.q, state.v = new.q, new.v


def of_a_particle(p: Slotted, h):
    return returned(p, h)


@pytest.mark.parametrize("step", [moved, returned, in_place, of_a_particle])
def test_a_dataclass_with_slots_is_a_state_as_well(step):
    assert opened(step).step(1.0, 0.5, 0.25) == (1.125, 0.21875)


@pytest.mark.parametrize(
    "answer", [lambda q, v: {"velocity": v, "x": q}, lambda q, v: {"a": q, "b": v}], ids=["names", "order"]
)
def test_what_is_returned_is_read_by_its_names_or_in_its_order(answer):
    assert opened(lambda q, v, h: answer(q + h * v, v - h * q)).step(1.0, 0.75, 0.25) == (1.1875, 0.5)
