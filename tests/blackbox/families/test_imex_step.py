"""Both tables of a split step are read to what its solver leaves; what is no such step is refused in words."""

import numpy as np
import pytest

from driftproof.blackbox.families.imex_step import read_imex_step
from driftproof.blackbox.findings import UnsupportedCall
from driftproof.blackbox.probes.scripted_answers import NotReadable
from driftproof.blackbox.stepper.opening import opened
from driftproof.methods.catalogue import FURTHER_METHODS
from tests.blackbox.families.linearised_steppers import floats
from tests.blackbox.families.split_steppers import imex, unsolved
from tests.looping import some


def test_every_entry_of_both_tables_is_read():
    method = FURTHER_METHODS["ark324"]
    reading = read_imex_step(opened(imex("ark324")))
    tables = (method.a_explicit, method.a_implicit, [method.b_explicit], [method.b_implicit])
    for seen, exact in some(zip((*reading.a, reading.b[:1], reading.b[1:]), tables, strict=True)):
        assert np.abs(np.array(seen) - floats(exact)).max() < reading.rounding.of(1.0)
    assert np.allclose(reading.c, floats(method.a_explicit).sum(axis=1), rtol=0, atol=1e-15)
    assert reading.curved < 1e-12


def test_what_is_no_such_step_is_refused_in_words():
    with pytest.raises(NotReadable, match=r"is off by 7\.5e-01 from what its coefficients give"):
        read_imex_step(opened(lambda f, g, t, y, h: y + h * f(t, y) + h * np.clip(g(t + h, y), -0.75, 0.75)))
    with pytest.raises(NotReadable, match=r"is off by 1\.7e-01"):  # of all refusals, the first
        read_imex_step(opened(lambda f, g, t, y, h: y + h * f(t, y) + h * g(t, y + h * abs(f(t, y)))))
    with pytest.raises(UnsupportedCall, match="takes one right-hand side"):
        read_imex_step(opened(lambda f, t, y, h: y + h * f(t, y)))
    assert read_imex_step(opened(unsolved)).stages == 3
