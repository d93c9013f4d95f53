"""Trajectories from objects, arrays and files; what is none is refused in one line that names the place."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from driftproof.enclosure import trajectories
from driftproof.enclosure.arithmetic.evaluations import Refused
from driftproof.enclosure.trajectories import (
    BINARY32_UNIT,
    BINARY64_UNIT,
    float_of_text,
    has_trajectory,
    read_trajectory,
    trajectory_of,
)

TIMES = np.array([0.0, 0.1, 0.3])
STATES = np.array([[1.0, 0.0], [0.9, -0.1], [0.7, -0.3]])
SAME = {
    "rows": (TIMES, STATES), "columns": (TIMES, STATES.T), "lists": (TIMES.tolist(), STATES.tolist()),
    "scipy": (SimpleNamespace(t=TIMES, y=STATES.T),), "diffrax": (SimpleNamespace(ts=TIMES, ys=STATES),),
    "filled up": (SimpleNamespace(ts=[*TIMES, np.inf], ys=[*STATES, [np.inf, np.inf]]),),
}  # fmt: skip
FILES = {
    "commas": "t,q,v\n0,1,0\n0.1,0.9,-0.1\n0.3,0.7,-0.3\n",
    "blanks and a remark": "# by hand\n0 1 0\n\n.1\t9e-1 -0.1\n 0.3  0.7   -.3\n",
    "semicolons and Fortran": '"t";"q";"v"\n0;1;0\n0.1d0;9.0D-1;-1d-1\n3D-1;0.7;-0.3\n',
    "hexadecimal": "".join(f"{t.hex()}, {q.hex()}, {v.hex()}\n" for t, (q, v) in zip(TIMES, STATES, strict=True)),
}


@pytest.mark.parametrize("form", SAME)
def test_every_form_is_the_same_trajectory(form):
    run = trajectory_of(*SAME[form])
    assert (run.times, run.states, run.unit) == (TIMES.tolist(), STATES.tolist(), BINARY64_UNIT)
    assert has_trajectory(SAME[form][0]) == (len(SAME[form]) == 1)


@pytest.mark.parametrize("form", FILES)
def test_file_of_text_is_read(form, tmp_path):
    for name in ("run.csv", "run.TXT", "run.dat"):
        (tmp_path / name).write_text(FILES[form])
        assert read_trajectory(tmp_path / name).states == STATES.tolist()


@pytest.mark.parametrize("names", [("t", "y"), ("ts", "ys")])
def test_file_of_arrays_is_read(names, tmp_path):
    np.savez(tmp_path / "run.npz", **dict(zip(names, (TIMES, STATES.T), strict=True)))
    assert read_trajectory(tmp_path / "run.npz").times == TIMES.tolist()


def test_file_of_one_array_has_the_time_first(tmp_path):
    np.save(tmp_path / "run.npy", np.column_stack([TIMES, STATES]))
    found = read_trajectory(tmp_path / "run.npy")
    assert (found.times, found.states) == (TIMES.tolist(), STATES.tolist())
    for wrong in (TIMES, TIMES[:, None], STATES[None]):
        np.save(tmp_path / "run.npy", wrong)
        with pytest.raises(ValueError, match=r"run\.npy: its array has the shape \(.*\); it must have a row for each"):
            read_trajectory(tmp_path / "run.npy")
    np.savez(tmp_path / "run.npz", t=TIMES)
    (tmp_path / "run.npz").rename(tmp_path / "run.npy")
    with pytest.raises(ValueError, match=r"it is no \.npy file, as numpy\.save writes it"):
        read_trajectory(tmp_path / "run.npy")


def test_integers_that_are_no_doubles_are_refused():
    assert trajectory_of([0, 1], [[2**53], [2**53 + 2]]).states == [[2.0**53], [2.0**53 + 2]]
    for x in (2**53 + 1, 2**63 - 1):
        with pytest.raises(Refused, match=rf"y\[1, 0\] is {x}, which is no double"):
            trajectory_of([0, 1], np.array([[0], [x]]))


def test_binary32_is_seen():
    assert trajectory_of(TIMES.astype(np.float32), STATES.astype(np.float32)).unit == BINARY32_UNIT
    assert trajectory_of([0, 1], [[1.0], [1e300]]).unit == BINARY64_UNIT


WRONG = {
    "0,1,0\n0.1,0.9\n": r"run\.csv:2: 2 numbers; expected 3 numbers",
    "0,1\n0.1,x1\n": r"run\.csv:2: 'x1' is not a number",
    "0\n1\n": r"run\.csv:1: 1 numbers; expected t and at least one component",
    "0,1x\n1,2\n": r"run\.csv:1: '1x' is not a number",
    "0;1\n0,5;0,87\n": r"run\.csv:2: decimal commas; write 0\.5, with a point",
    "0 1\n0,5 -0,87\n": r"run\.csv:2: decimal commas",
    "0,1\n0,2\n": r"run\.csv: times must increase, but t\[1\] = 0\.0 is not above t\[0\] = 0\.0",
    "t,y\n": r"run\.csv: it has no numbers; write a line for each time",
    "": r"run\.csv: it has no numbers",
    "0,0x1.00000000000008p+0\n": r"run\.csv:1: '0x1\.00000000000008p\+0' has more digits than a double",
}


@pytest.mark.parametrize("text", WRONG)
def test_file_of_another_form_is_refused_with_its_line(text, tmp_path):
    (tmp_path / "run.csv").write_text(text)
    with pytest.raises(ValueError, match=WRONG[text]):
        read_trajectory(tmp_path / "run.csv")


def test_other_files_are_refused(tmp_path, monkeypatch):
    for name, content, said in (
        ("run.mat", b"0 1", r"must be a \.csv, \.txt, \.dat, \.npz or \.npy file"),
        ("run.npy", b"0 1", r"run\.npy: "),
        ("run.npz", b"no zip", r"run\.npz: it is no \.npz file"),
        ("run.csv", b"\xff\xfe", r"run\.csv: not UTF-8 at byte 0"),
    ):
        (tmp_path / name).write_bytes(content)
        with pytest.raises(ValueError, match=said):
            read_trajectory(tmp_path / name)
    np.savez(tmp_path / "other.npz", u=TIMES)
    with pytest.raises(ValueError, match="it has u; it must have the arrays t and y"):
        read_trajectory(tmp_path / "other.npz")
    np.savez(tmp_path / "pickled.npz", t=TIMES, y=np.array([{}, {}, {}], dtype=object))
    with pytest.raises(ValueError, match="pickled"):
        read_trajectory(tmp_path / "pickled.npz")
    for most, said in ((9, "too large; at most 9 bytes"), (10, "2 numbers; expected 3 numbers")):
        monkeypatch.setattr(trajectories, "LARGEST_RUN", most)
        (tmp_path / "run.csv").write_bytes(b"0,1,2\n0,1\n"[:10])
        with pytest.raises(ValueError, match=said):
            read_trajectory(tmp_path / "run.csv")


def test_object_without_a_trajectory_is_refused():
    with pytest.raises(Refused, match="SimpleNamespace has neither"):
        trajectory_of(SimpleNamespace(t=TIMES))


@pytest.mark.parametrize(
    ("word", "x"),
    [
        ("0x1.8p+0", 1.5),
        ("-0X1P-1", -0.5),
        ("1.5d0", 1.5),
        ("1D-3", 1e-3),
        ("0x3.ffffffffffffe0p0", 4 - 2.0**-51),
        ("0x.0p+0", 0.0),
    ],
)
def test_number_is_read_to_the_last_bit(word, x):
    assert float_of_text(word) == x
