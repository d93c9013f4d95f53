"""Numbers go in and come out as floats, lists, arrays and other people's arrays, each by its adapter."""

import numpy as np
import pytest

from driftproof.blackbox.findings import NotANumber, StepRaised
from driftproof.blackbox.stepper.opening import opened
from driftproof.symbolic.rounding.formats import BINARY16, BINARY32, BINARY64
from tests.blackbox.stepper.euler_steps import EULER, Tensor, field, force_of_numbers, map_of_numbers

STATE, H = (1.0, 0.75), 0.25


def map_of_a_tensor(y, dt):
    return y + dt * Tensor([y.data[1], -y.data[0]])


STEPS = [lambda q, v, h: (q + h * v, v + h * -q), force_of_numbers, field, map_of_a_tensor]
STEPS += [lambda t, y, h: (t + h, map_of_a_tensor(y, h))]


@pytest.mark.parametrize("step", STEPS, ids=range(5))
def test_other_peoples_arrays_are_written_and_read(step):
    subject = opened(step, array=Tensor)
    assert subject.step(*STATE, H) == EULER
    assert subject.format is BINARY32
    assert subject.log.types == {"torch.float32"}
    assert not subject.log.changes_its_arguments


def test_a_tensor_changed_in_place_is_seen():
    def in_place(y, dt):
        y += dt * Tensor([y.data[1], -y.data[0]])

    subject = opened(in_place, array=Tensor)
    assert subject.step(*STATE, H) == EULER
    assert subject.log.works_in_place


def test_what_a_maker_of_arrays_refuses_is_its_own():
    assert opened(map_of_numbers, array=float).step(*STATE, H) == EULER
    with pytest.raises(StepRaised, match="OverflowError: no"):
        opened(map_of_numbers, array=lambda x: (_ for _ in ()).throw(OverflowError("no")))


@pytest.mark.parametrize(
    ("array", "fmt"), [(np.float64, BINARY64), (np.float32, BINARY32), (np.float16, BINARY16)], ids=str
)
def test_the_format_is_that_of_the_answer(array, fmt):
    assert opened(map_of_numbers, array=array).format is fmt
    assert opened(field, array=array).format is fmt


def test_complex_numbers_without_imaginary_parts_are_real_ones_and_others_are_not():
    subject = opened(lambda f, t, y, h: y + 0j + h * np.asarray(f(t, y + 0j)))
    assert subject.step(*STATE, H) == EULER
    assert subject.log.types == {"complex128"}
    with pytest.raises(NotANumber, match="it asks for its right-hand side at ndarray with entries of type complex128"):
        opened(lambda f, t, y, h: y + h * np.asarray(f(t, y + 2.0**-20 * 1j)))
