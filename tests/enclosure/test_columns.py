"""The columns of a file are read by their names, in any order; what the names do not settle is refused in one line."""

from __future__ import annotations

import pytest

from driftproof import certify
from driftproof.enclosure.columns import column_names, named_columns

X_V, SECOND = ("x", "v"), ("x", "y", "dx", "dy")
READ = {
    ("t,x,v", X_V): (0, (1, 2)), ("t,v,x", X_V): (0, (2, 1)), ("v,x,time [s]", X_V): (2, (1, 0)),
    (",t,v,x", X_V): (1, (3, 2)), ("Unnamed: 0;t;v;x", ()): (1, (2, 3)), ("t,v,x", ()): (0, (1, 2)),
    ("t y[1] y[0]", ()): (0, (2, 1)), ("T,t", ("T",)): (1, (0,)), ("t,T", ()): (0, (1,)), ("t,E,v,x", X_V): (0, (3, 2)),
    ("t,q,v", X_V): (0, (1, 2)), ("tau,v,x", X_V): (0, (2, 1)), ("t,vx,vy,y,x", SECOND): (0, (4, 3, 1, 2)),
    (",x,v", X_V): (0, (1, 2)), ('"Time (s)","X","V"', X_V): (0, (1, 2)), ("t_s,x0,x1", ()): (0, (1, 2)),
}  # fmt: skip
REFUSED = {
    ("t,q,p", X_V): "its columns are t, q, p, but f has x, v: name them alike",
    ("a,b,c", X_V): "no column of a, b, c is named t or time", ("a,b,c", ()): "no column of a, b, c is named t or time",
    ("t,x,x", X_V): "two columns are named x",
    ("times,ts,x", ("x",)): "times, ts may each be the time; name one of them",
}  # fmt: skip


@pytest.mark.parametrize(("line", "unknowns"), READ)
def test_names_tell_the_columns(line, unknowns):
    assert named_columns(column_names(line), unknowns, counts=False)[:2] == READ[line, unknowns]


@pytest.mark.parametrize(("line", "unknowns"), REFUSED)
def test_names_that_do_not_fit_are_refused(line, unknowns):
    with pytest.raises(ValueError, match=REFUSED[line, unknowns]):
        named_columns(column_names(line), unknowns, counts=False)


def test_index_that_counts_the_rows_is_no_time():
    with pytest.raises(ValueError, match=r'no column of "", y is named t or time; the first counts the rows'):
        named_columns(["", "y"], ["y"], counts=True)


ROWS = {
    "x,t\n1,0\n2.7,1\n": "columns read by their names: t, x", "t,x\n0,1\n1,2.7\n": "",
    "# x t\n1 0\n2.7 1\n": "columns read by their names: t, x",
    "0,1\n1,2.7\n": "the file names no columns: read as t, x",
    ",t,x\n0,0,1\n2,1,2.7\n": "columns read by their names: t, x", "# by hand\nx;t\n1;0\n2.7;1": "columns read by",
}  # fmt: skip


@pytest.mark.parametrize("text", ROWS)
def test_error_is_that_of_the_named_columns(text, tmp_path):
    (tmp_path / "run.csv").write_text(text)
    found = certify("x' = x", tmp_path / "run.csv")
    assert found.text().startswith("largest error 0.01828182846, proved: component x at t = 1, point 1")
    assert found.said.startswith(ROWS[text])
    assert bool(found.said) == bool(ROWS[text])
