"""A changed rounding mode and lost subnormal numbers are named with who changed them, and kept from our own work."""

from __future__ import annotations

import ctypes
import platform
import shutil
import subprocess
import sys

import pytest

from driftproof.blackbox.identify import identify
from driftproof.blackbox.judging.specification import Allowance, Domain
from driftproof.blackbox.stepper.float_environment import FloatEnvironment, arithmetic_seen
from driftproof.blackbox.verify import verify

pytestmark = pytest.mark.skipif(
    sys.platform != "linux" or platform.machine() != "x86_64", reason="the numbers of rounding modes are x86-64's"
)
MODES = {"rounds downward": 0x400, "rounds upward": 0x800, "rounds toward zero": 0xC00}
EVERY_FLOAT = Domain(smallest_step=0.0, smallest_state=0.0)


@pytest.fixture
def library():
    """The C library's mathematics; the default mode is back afterwards."""
    found = ctypes.CDLL("libm.so.6")
    yield found
    found.fesetround(0)


def euler(q, v, h):
    return q + h * v, v - h * q


@pytest.mark.parametrize("words", MODES)
def test_arithmetic_tells_its_rounding_mode(library, words):
    library.fesetround(MODES[words])
    seen = arithmetic_seen()
    environment = FloatEnvironment()
    assert (seen, arithmetic_seen(), environment.seen) == (words, "", words)
    environment.enter()
    assert arithmetic_seen() == words
    environment.leave("afterwards")
    assert (arithmetic_seen(), environment.change) == ("", f"before the stepper is imported, arithmetic {words}")


def test_where_the_library_is_not_found_a_changed_mode_is_named_and_kept(library, monkeypatch):
    def missing(name):
        raise OSError(name)

    library.fesetround(MODES["rounds upward"])
    monkeypatch.setattr(ctypes, "CDLL", missing)
    assert (FloatEnvironment().seen, arithmetic_seen()) == ("rounds upward", "rounds upward")


def test_a_call_that_changes_the_rounding_mode_is_named_in_every_verdict(library):
    def step(q, v, h):
        library.fesetround(0x800)
        return euler(q, v, h)

    named = "since step(q=1.0, v=0.75, h=0.25), arithmetic rounds upward"
    assert identify(step).verdict.endswith(f"; {named}")
    failed = verify(step, "forward_euler", examples=100)
    assert named in failed.verdict
    assert not verify(step, "symplectic_euler", examples=100).passed
    assert arithmetic_seen() == ""


@pytest.mark.slow
def test_an_import_that_changes_the_rounding_mode_is_named(tmp_path, monkeypatch):
    code = "import ctypes\nctypes.CDLL('libm.so.6').fesetround(0xC00)\nstep = lambda q, v, h: (q + h * v, v - h * q)\n"
    (tmp_path / "upwards.py").write_text(code, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    named = "since the stepper was imported, arithmetic rounds toward zero"
    assert named in verify("upwards:step", "forward_euler", examples=100).verdict


@pytest.mark.skipif(shutil.which("gcc") is None, reason="no compiler whose -ffast-math would flush to zero")
def test_a_library_that_flushes_to_zero_is_named_and_allowed_for(tmp_path):
    (tmp_path / "fast.c").write_text("int nothing(void) { return 0; }\n", encoding="utf-8")
    made = tmp_path / "fast.so"
    subprocess.run(["gcc", "-shared", "-fPIC", "-ffast-math", "-o", made, tmp_path / "fast.c"], check=True)

    def step(q, v, h):
        ctypes.CDLL(str(made))
        return euler(q, v, h)

    report = verify(step, "forward_euler", examples=300, domain=EVERY_FLOAT, allowance=Allowance(flush_to_zero=True))
    assert report.passed
    assert "arithmetic flushes subnormal numbers to zero" in report.verdict
    assert "please report" not in report.text()
    assert not verify(step, "forward_euler", examples=300, domain=EVERY_FLOAT).passed
