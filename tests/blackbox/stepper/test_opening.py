"""A stepper by its name or as a callable: what is imported, and what is refused in one line."""

import inspect
import re
import sys
from types import SimpleNamespace

import numpy as np
import pytest

from driftproof.blackbox.findings import Misbehaviour
from driftproof.blackbox.stepper.call_text import call_text
from driftproof.blackbox.stepper.opening import Target, imported, opened
from driftproof.blackbox.stepper.wrappers.wrappers import wrapper_line
from driftproof.symbolic.rounding.formats import BINARY32
from tests.blackbox.stepper.euler_steps import Tensor
from tests.blackbox.stepper.odd_steppers import ODD
from tests.blackbox.transcripts import Asked


def local_step(q, v, h):
    return q + h * v, v - h * q


def test_a_target_is_imported_by_its_name():
    assert imported("driftproof.numeric.steppers:rk4").__name__ == "rk4"
    assert imported("tests.blackbox.checks.habits:Multistep.step").__qualname__ == "Multistep.step"
    assert Target("driftproof.numeric.steppers:rk4").open().step(1.0, 0.0, 0.0) == (1.0, 0.0)
    assert Target(local_step).name == f"{__name__}:local_step"
    assert Target("driftproof.numeric.steppers:rk4").by_name
    assert not Target(local_step).by_name
    assert not Target("driftproof.numeric.steppers:rk4", array=np.array).by_name
    assert Target("driftproof.numeric.steppers:rk4", array="numpy:float32").open().format is BINARY32


def test_a_stepper_is_found_in_the_current_directory_before_others(tmp_path, monkeypatch):
    (tmp_path / "lies_here.py").write_text("def step(q, v, h):\n    return q + h, v\n", encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", [place for place in sys.path if place])
    assert [imported("lies_here:step")(1.0, 2.0, 0.5) for _ in range(2)] == [(1.5, 2.0)] * 2
    assert [n for n, place in enumerate(sys.path) if place == str(tmp_path)] == [0]


@pytest.mark.parametrize(("name", "message"), [
    ("driftproof.numeric.steppers", "'driftproof.numeric.steppers' names no stepper; write package."),
    ("driftproof/numeric/steppers.py:rk4", "names a file; write driftproof.numeric.steppers:rk4"),
    ("driftproof.numeric.steppers:rk4(1)", "names no stepper"),
    ("driftproof.numeric.steppers:rk5", "driftproof.numeric.steppers:rk5 cannot be imported: AttributeError"),
    ("no_such_module_here:step", "cannot be imported: ModuleNotFoundError"),
    ("driftproof.numeric.steppers:HAND_WRITTEN", ":HAND_WRITTEN is dict, which cannot be called; hand over a function"),
    (None, "what was given is None; hand over a function that makes one step, say: def step(f, t, y, h): return y + "),
])  # fmt: skip
def test_a_name_without_a_stepper_is_refused_in_one_line(name, message):
    with pytest.raises(ValueError, match=r".") as caught:
        Target(name).open()
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("name", ODD)
def test_what_is_seldom_met_is_opened_or_refused_as_before(name, as_before, monkeypatch):
    monkeypatch.setitem(sys.modules, "torch", SimpleNamespace(tensor=lambda x, dtype: Tensor(x), float64="double"))
    asked = Asked(ODD[name])
    step = asked.code if inspect.isfunction(ODD[name]) else ODD[name]
    try:
        subject = opened(step)
    except (ValueError, Misbehaviour) as refusal:
        said = re.split(" is not one of these| does not fit any calling", str(refusal))[0]
        as_before(type(refusal).__name__, said, wrapper_line(step), asked)
    else:
        steps = [] if subject.single else [subject.step(1.0, 0.75, 0.25), subject.step(-3.0, 0.5, 1.5)]
        shown = f"{subject.adapter.name}: {call_text(subject, 1.0, 0.75, 0.25)}"
        as_before(shown, (*steps, subject.log.changes_its_arguments, *subject.log.types), asked)
