"""The benchmark of runs compares like with like; its times depend on the machine and are not tested."""

from __future__ import annotations

import shutil
from dataclasses import replace

import pytest

from benchmarks import engine
from benchmarks.timing import Row, Times
from driftproof.numeric.engine import field_runner, runner


def test_loops_by_hand_have_the_bits_of_ours():
    ours = runner(engine.RK4)(*engine.START, engine.H, 100)
    assert engine.by_hand(*engine.START, engine.H, 100) == engine.by_steps(*engine.START, engine.H, 100) == ours
    lorenz = field_runner(engine.RK4, engine.LORENZ)(engine.LORENZ_START, engine.H, 0, 100)
    assert engine.lorenz_by_hand(engine.LORENZ_START, engine.H, 100) == lorenz


@pytest.mark.skipif(not (shutil.which("gcc") or shutil.which("cc")), reason="no C compiler")
def test_unfused_c_has_our_bits_and_fused_c_has_others(monkeypatch):
    monkeypatch.setattr(engine, "MANY", 1000)
    ours = runner(engine.RK4)(*engine.START, engine.H, 1000)
    assert engine.c_trajectory(engine.compiled_c("-ffp-contract=off"))() == ours
    if "fma" in _flags_of_the_processor():
        assert engine.c_trajectory(engine.compiled_c("-mfma", "-ffp-contract=fast"))() != ours


def _flags_of_the_processor() -> str:
    try:
        with open("/proc/cpuinfo", encoding="utf-8") as lines:
            return next((line for line in lines if line.startswith("flags")), "")
    except OSError:
        return ""


def test_goals_are_ratios_of_one_run_and_equal_bits():
    times = {"ours": Times([2.0, 3.0]), "ours, numba": Times([0.5]), "scipy, RK45": Times([100.0])}
    row = Row(engine.BY_SCIPY, times, {"ours": "a", "ours, numba": "a", "scipy, RK45": "b"})
    by_numba, bits = engine.goals([row])
    assert (by_numba.found, by_numba.met) == ("200", True)
    slow, _ = engine.goals([replace(row, times={**times, "scipy, RK45": Times([20.0])})])
    assert (slow.found, slow.met) == ("40", False)
    assert (bits.found, bits.met) == ("our bits", True)
    *_, other = engine.goals([replace(row, answers={**row.answers, "ours, numba": "c"})])
    assert not other.met
