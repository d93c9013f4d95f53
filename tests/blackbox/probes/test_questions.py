"""A stepper is asked how it is called, and which coefficients it has: as a field, else as forces see them."""

import pytest

from driftproof.blackbox.findings import UnsupportedCall
from driftproof.blackbox.probes.force import ForceReading
from driftproof.blackbox.probes.questions import introduction, read_coefficients
from driftproof.blackbox.probes.scripted_answers import NotReadable
from driftproof.blackbox.probes.tableau import TableauReading
from driftproof.blackbox.stepper.opening import opened
from tests.blackbox import handwritten_steppers as codes


def symplectic(f, t, y, h):
    v = y[1] + h * f(t, y)[1]
    return [y[0] + h * v, v]


def adaptive(f, t, y, h):
    return y + h * f(t, y) if abs(f(t, y)).max() < 0.5 else y + h * f(t, y + h * f(t, y))


def test_a_stepper_is_introduced_by_its_calls_its_numbers_and_its_format():
    found = introduction(opened(codes.rk4))
    assert (found.calls, found.numbers, found.format) == ("field", "NumPy arrays", "binary64")


def test_coefficients_are_those_of_a_tableau_or_of_forces():
    assert isinstance(read_coefficients(opened(codes.rk4)), TableauReading)
    assert isinstance(read_coefficients(opened(symplectic)), ForceReading)


def test_what_has_none_is_refused():
    with pytest.raises(NotReadable):
        read_coefficients(opened(adaptive))
    with pytest.raises(UnsupportedCall):
        read_coefficients(opened(lambda q, v, h: (q + h * v, v - h * q)))
