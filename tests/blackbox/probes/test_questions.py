"""A stepper is asked how it is called, and which coefficients it has: as a field, else as forces see them."""

import re

import numpy as np
import pytest

from driftproof import identify, verify
from driftproof.blackbox.findings import Misbehaviour, UnsupportedCall
from driftproof.blackbox.probes.questions import introduction, read_coefficients
from driftproof.blackbox.probes.scripted_answers import NotReadable
from driftproof.blackbox.stepper.opening import opened
from tests.blackbox import handwritten_steppers as codes
from tests.blackbox.dragged_steppers import RIGHT, WRONG, kicks_of_half, semi_implicit
from tests.blackbox.transcripts import Asked, shortened


def symplectic(f, t, y, h):
    v = y[1] + h * f(t, y)[1]
    return [y[0] + h * v, v]


def turned(angle):
    """Symplectic Euler on two numbers whose velocities are turned by an angle."""
    turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])

    def step(force, q, v, h):
        v = turn @ (v + h * force(q))
        return q + h * v, v

    return step


def adaptive(f, t, y, h):
    return y + h * f(t, y) if abs(f(t, y)).max() < 0.5 else y + h * f(t, y + h * f(t, y))


def test_a_stepper_is_introduced_by_its_calls_its_numbers_and_its_format():
    found = introduction(opened(codes.rk4))
    assert (found.calls, found.numbers, found.format) == ("field", "NumPy arrays", "binary64")


READ = dict(enumerate([step for step, *_ in (*RIGHT, *WRONG)]))
READ |= {name: vars(codes)[name] for name in ("dopri5", "ssprk104_in_two_registers", "jameson", "rk4_without_time")}
READ |= {"symplectic": symplectic, "adaptive": adaptive, "turned by 0": turned(0.0), "turned": turned(0.1)}
READ |= {"fails at 3": lambda f, t, y, h: y + h * f(t, y) if h != 3 else 1 / 0}
READ |= {f"turned by {k} roundings": turned(k * 2.0**-53) for k in (15, 17)}
IN_WORDS = (*range(0, len(READ), 4), *(name for name in READ if isinstance(name, str)))


@pytest.mark.parametrize("name", READ)
def test_all_that_is_asked_for_coefficients_and_said_is_as_before(name, as_before):
    asked = Asked(READ[name])
    try:
        subject = opened(asked.code)
        asked.count, asked.checksum = 0, 0  # how it is opened is another matter
        reading = read_coefficients(subject)
        said = [*reading.lines, *getattr(reading, "stale_velocities", ()), reading]
        as_before(*shortened(said, name in IN_WORDS), asked)
    except (NotReadable, Misbehaviour) as refusal:
        as_before(refusal, asked)


def test_what_has_none_is_refused():
    with pytest.raises(UnsupportedCall):
        read_coefficients(opened(lambda q, v, h: (q + h * v, v - h * q)))


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize(("step", "key"), RIGHT, ids=range(len(RIGHT)))
def test_a_step_whose_force_is_given_right_velocities_is_its_method_and_raises_no_alarm(step, key):
    report = identify(step, isolate=False)
    assert re.match(rf"it is {key}\b(?!.* but )", report.verdict)
    assert report.section("Faults") is None
    assert (step, key) not in RIGHT[::4] or verify(step, key, examples=20, isolate=False).passed


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize(("step", "key", "words"), WRONG, ids=[f"{key}: {words}" for _, key, words in WRONG])
def test_wrong_velocities_fail_and_are_named(step, key, words):
    found = verify(step, key, examples=20, isolate=False)
    assert found.passed is False
    assert found.verdict.startswith(f"is not {key}")
    assert words in found.verdict


def test_velocities_of_stages_may_limit_the_order():
    kicked = read_coefficients(opened(kicks_of_half))
    assert kicked.velocities_limit_order
    assert not read_coefficients(opened(semi_implicit)).velocities_limit_order
