"""A user's TOML file becomes a method exactly, and whatever is wrong with it is said in one line, with its place."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction as Q
from pathlib import Path
from typing import Any

import pytest

from driftproof.methods import tableau_file
from driftproof.methods.additive import Additive
from driftproof.methods.catalogue import FURTHER_METHODS
from driftproof.methods.given_methods import method_of
from driftproof.methods.numbers.number_field import cube_root, square_root
from driftproof.methods.schemes import Collocation, Method, MethodError, Nystrom, RungeKutta, Splitting
from driftproof.methods.tableau_file import read_method
from tests.methods.conftest import Write
from tests.methods.tables.entries import entry

GAUSS = """
family = "runge_kutta"
title = "Gauss by hand"
claimed_order = 4
A = [["1/4", "1/4 - s3/6"], ["1/4 + s3/6", 0.25]]
b = [0.5, "1/2"]
c = ["1/2 - s3/6", "(3 + s3)/6"]
[roots]
s3 = "sqrt(3)"
"""


def test_gauss_method_is_read_in_its_field(write: Write) -> None:
    method, known = read_method(write(GAUSS)), entry("gauss2")
    assert isinstance(method, RungeKutta)
    assert (method.a, method.b, method.c, method.field) == (known.a, known.b, known.c, known.field)
    assert (method.key, method.title, method.claimed_order) == ("mine", "Gauss by hand", 4)
    assert (method.source, method.decimal, method.b_embedded) == ("given by the user", False, None)


def test_nodes_left_out_are_the_row_sums_and_given_ones_are_kept(write: Write) -> None:
    heun = 'family = "runge_kutta"\nA = [[0, 0], [1, 0]]\nb = ["1/2", "1/2"]\n'
    assert read_method(write(heun)).c == (0, 1)
    method = read_method(write(heun + "c = [0, 0.9]\n"))
    assert isinstance(method, RungeKutta)
    assert method.inconsistencies() == {"c[1] - sum(a[1])": Q(-1, 10)}


def test_pair_splitting_nystrom_and_collocation_are_read(write: Write) -> None:
    pair = 'family = "runge_kutta"\nA = [[0, 0], [1, 0]]\nb = ["1/2", "1/2"]\nb_embedded = [1, 0]\nembedded_order = 1'
    read = read_method(write(pair))
    assert isinstance(read, RungeKutta)
    assert (read.b_embedded, read.embedded_order) == ((1, 0), 1)
    unclaimed = read_method(write(pair.removesuffix("\nembedded_order = 1")))
    assert unclaimed == replace(read, embedded_order=0)
    dense = read_method(write(pair + '\ndense = [[0, 1, "-sqrt(2)/2"], [0, 0, "1/2"]]'))
    assert (dense.dense, dense.embedded("_x").dense) == (((0, 1, -square_root(2) / 2), (0, 0, Q(1, 2))), None)
    verlet = 'family = "splitting"\nkey = "v"\nparts = [["kick", "1/2"], ["drift", 1], ["kick", 0.5]]\n'
    assert read_method(write(verlet)) == Splitting(
        "v", "v", 0, "given by the user", (("kick", Q(1, 2)), ("drift", Q(1)), ("kick", Q(1, 2)))
    )
    table = 'family = "nystrom"\nc = [0, "1/2", 1]\nA = [[0, 0, 0], ["1/8", 0, 0], [0, "1/2", 0]]\n'
    nystrom = read_method(write(table + 'b_position = ["1/6", "1/3", 0]\nb_velocity = ["1/6", "2/3", "1/6"]\n'))
    known = entry("nystrom4")
    assert isinstance(nystrom, Nystrom)
    assert [getattr(nystrom, x) == getattr(known, x) for x in ("c", "a", "b_position", "b_velocity")] == 4 * [True]
    collocation = read_method(write('family = "collocation"\nnode_polynomial = ["1/6", -1, 1]\n'))
    assert isinstance(collocation, Collocation)
    assert collocation.node_polynomial == (Q(1, 6), -1, 1)


@pytest.mark.parametrize(
    ("first", "second"),
    [('g = "1 - sqrt(2)/2"\nd = "2*g"', 'd = "2 - sqrt(2)"'), ('g = "1/5"\nd = "2/g"', "d = 10")],
)
def test_roots_are_numbers_and_expressions_in_earlier_roots(write: Write, first: str, second: str) -> None:
    text = 'family = "splitting"\nparts = [["kick", "d"], ["drift", "1/d"]]\n[roots]\n'
    one, other = (method_of(write(text + more)) for more in (first, second))
    assert isinstance(one, Splitting)
    assert one.parts == other.parts


def test_roots_are_declared_by_radical_or_by_polynomial_and_interval(write: Write) -> None:
    text = 'family = "splitting"\nparts = [["kick", "r"], ["drift", "1/r"]]\n[roots]\nr = '
    assert parts_of(read_method(write(text + '"cbrt(2)"\n')))[0] == cube_root(2)
    assert parts_of(read_method(write(text + '"sqrt(12)"\n')))[0] ** 2 == 12
    large = parts_of(read_method(write(text + f"{{ minpoly = [-{2**200 - 1}, 0, 1], interval = [1, '2e30'] }}\n")))
    assert large[0] ** 2 == 2**200 - 1
    root = parts_of(read_method(write(text + "{ minpoly = [-2, 0, 0, 1], interval = [1, '1.5'] }\n")))
    assert root[0] ** 3 == 2
    assert root[0] * root[1] == 1
    assert root[0].field.name == "r"


def parts_of(method: Method) -> list[Any]:
    assert isinstance(method, Splitting)
    return [c for _, c in method.parts]


def test_decimals_are_exact_and_never_floats(write: Write) -> None:
    parts = f'["kick", 0.1], ["drift", 1e-30], ["kick", "-2.5e-1"], ["drift", 0x{5000 * "f"}]'
    method = read_method(write(f'family = "splitting"\ndecimal = true\nparts = [{parts}]\n'))
    assert parts_of(method) == [Q(1, 10), Q(1, 10**30), Q(-1, 4), 2**20_000 - 1]
    assert method.decimal


HEAD = 'family = "runge_kutta"\n'
ONE = HEAD + "A = [[0]]\nb = [1]\n"
MINPOLY = ONE + "[roots]\nr = {{ minpoly = {}, interval = {} }}\n"
WRONG: list[tuple[str | bytes, str]] = [
    ("", "family is missing; write 'runge_kutta' or 'splitting' or 'nystrom' or 'collocation'"),
    ('family = "rosenbrocks"', "family is 'rosenbrocks'; write 'runge_kutta'"),
    (HEAD + "b = [1]", "A is missing"),
    (HEAD + "A = [[1/2]]\nb = [1]", 'Unclosed array (at line 2, column 8); write a fraction in quotes, "1/2"'),
    (HEAD + "A = [[0, 0], [1, 0]]\nb = [1, 0]\nb_hat = [1, 0]", "rename 'b_hat' to b_embedded"),
    ("Family = 'runge_kutta'\nA = [[0]]\nb = [1]", "rename 'Family' to family"),
    ("famly = 'runge_kutta'\nA = [[0]]\nb = [1]", "rename 'famly' to family"),
    ("Stages = 1\nA = [[0]]\nb = [1]", "family is missing"),
    (HEAD + "A = [[0, 0], [1, 0]]\nw = [1, 0]", "(`driftproof facts --help` shows one)"),
    ('family = "splitting"\na = [1]\nb = [1]', "has no key 'a'; its keys are family, "),
    (
        'family = "splitting"\na = [1]\nb = [1]',
        "parts (write parts = [['kick', '1/2'], ['drift', 1], ...], the sub-steps",
    ),
    (
        'family = "multistep"\nalpha = [1, -1]',
        "(alpha is rho, beta is sigma, both from the oldest value to the new one)",
    ),
    (
        HEAD + "A = [0, -5, -153]\nB = [1, 1, 1]",
        "(a low-storage or convex form is written as its tableau, the weights of all slopes in each stage and ",
    ),
    ('family = "multistep"\nrho = [1, -1]\nsteps = 1', "a multistep has no key 'steps'; its keys are family, "),
    ('family = "additive"\nc = [1]', "an additive has no key 'c'"),
    (
        HEAD + 'A = [["√2/2"]]\nb = [1]',
        "A[0][0]: '√2/2', column 1: '√' is not allowed in an expression; write sqrt(2) ",
    ),
    (HEAD + "A = [[0, 0], [1]]\nb = [1, 0]", "A is not square: A[1] has 1 entries, A has 2 rows"),
    (ONE + "b_embedded = [1]\nembedded_order = -1", "embedded_order is -1; write a whole number from 0 to 200"),
    (ONE + "dense = [[1], [1]]", "dense has 2 entries, 1 are needed"),
    (HEAD + "A = [[0]]\nb = 1", "b is 1; write a list"),
    (HEAD + "A = [[0]]\nb = []", "A has 1 rows, but there are 0 weights"),
    (HEAD + "A = [[[0]]]\nb = [1]", "A[0][0] is [0]; write an integer, a decimal or an expression in quotes"),
    (HEAD + "A = [[true]]\nb = [1]", "A[0][0] is True; write an integer"),
    (ONE + "c = [0, 1]", "c has 2 entries, 1 are needed"),
    (ONE + "C = [0]", "a runge_kutta has no key 'C'; did you mean c? its keys are family, key"),
    (ONE + "b = [1]\n", "a key is given twice (at line 4, column 8)"),
    (ONE + "[roots]\nr = 'sqrt(2)'\nr = 'sqrt(3)'\n", "a key is given twice (at line 6, column 14)"),
    (ONE + "roots = 3", "roots is 3; write a table [roots]"),
    (ONE + "[roots]\nr = 'sqrt(4)'", "roots.r: 'sqrt(4)', column 1: sqrt(4): the number must exceed 1 and not"),
    (ONE + "[roots]\nr = 'sin(1)'", "roots.r: 'sin(1)', column 1: 'sin' is not a function; use sqrt and cbrt"),
    (ONE + "[roots]\nr = { minpoly = [-2, 0, 1] }", "; write { minpoly = [...], interval = [...] } or 'sqrt(n)'"),
    (ONE + "[roots]\n'a b' = 'sqrt(2)'", "roots.a b: a name is a letter"),
    (MINPOLY.format("[-9, 0, 4]", "[1, 2]"), "roots.r: r: the minimal polynomial is reducible"),
    (MINPOLY.format("[0.5, 0, -1]", "[0, 1]"), "roots.r: minpoly: the coefficients are integers of at most 60 digits"),
    (MINPOLY.format(f"[-{2**200 + 1}, 0, 1]", "[0, '1e40']"), "roots.r: minpoly: the coefficients are integers of"),
    (MINPOLY.format("[-2, 0, 1]", "[1]"), "roots.r: interval has 1 entries, 2 are needed"),
    (HEAD + "A = [['s3']]\nb = [1]", "A[0][0]: 's3', column 1: 's3' is unknown; write integers, decimals, sqrt(n)"),
    (
        GAUSS.replace("s3/6)", "s2/6)").replace("1/4 - s3", "1/4 - s2"),
        "A[0][1]: '1/4 - s2/6', column 7: 's2' is unknown",
    ),
    (HEAD + "A = [['exit(1)']]\nb = [1]", "A[0][0]: 'exit(1)', column 1: 'exit' is not a function; use sqrt"),
    (HEAD + "A = [['1/0']]\nb = [1]", "A[0][0]: '1/0', column 2: division by zero"),
    (HEAD + "A = [['0**-1']]\nb = [1]", "A[0][0]: '0**-1', column 1: division by zero"),
    (HEAD + "A = [[1e999999999]]\nb = [1]", "A[0][0]: '1e999999999', column 1: number: '1e999999999' is too long"),
    (HEAD + "A = [[nan]]\nb = [1]", "A[0][0]: 'nan', column 1: 'nan' is unknown"),
    (HEAD + f"A = [[0x{'f' * 9000}]]\nb = [1]", "A[0][0] is an integer of 36000 bits; at most 20000 are read"),
    (HEAD + f"A = [[{'9' * 5000}]]\nb = [1]", "Exceeds the limit (4300 digits)"),
    (ONE + "claimed_order = -1", "claimed_order is -1; write a whole number from 0 to 200"),
    (HEAD + "A = [0]\nb = [1]", "A[0] is 0; A is a list of rows, as in [[0, 0], [1, 0]]"),
    (ONE + "claimed_ordr = 1", "has no key 'claimed_ordr'; did you mean claimed_order? its keys are family"),
    (ONE + f"claimed_order = 1{'0' * 5000}", "5001 digits"),
    ('family = "runge-kuta"', "'rosenbrock'; did you mean runge_kutta?"),
    (ONE + f"claimed_order = 0x{'f' * 9000}", "claimed_order is a huge number; write a whole number"),
    (ONE + "embedded_order = 1", "b_embedded is missing"),
    (ONE + "decimal = 1", "decimal is 1; write true or false"),
    (ONE + "title = ''", "title is ''; write a line of text of 1 to 200 characters"),
    (ONE + 'title = "a\\nb"', "title is 'a\\nb'; write a line of text of 1 to 200 characters"),
    (ONE + "key = '../x'", "key is '../x'; write a letter, then letters, digits"),
    ('family = "splitting"\nparts = [["push", 1]]', "parts[0] is ['push', 1]; write ['kick', number] or ['drift', n"),
    ('family = "splitting"\nparts = [["kick"]]', "parts[0] is ['kick']; write ['kick', number]"),
    ('family = "splitting"\nparts = [[["kick"], 1]]', "parts[0] is [['kick'], 1]; write"),
    ('family = "collocation"\nnode_polynomial = [1, 0, 1]', "node_polynomial has a complex or a multiple root"),
    ('family = "collocation"\nnode_polynomial = [0, 1]\ndecimal = true', "decimal = true is not allowed: a rounded"),
    (f'family = "collocation"\nnode_polynomial = {[1] * 52}', "node_polynomial has 52 entries; at most 51 are allowed"),
    (f'family = "multistep"\nrho = {[1] * 32}', "rho has 32 entries; at most 31 are allowed"),
    (
        'family = "collocation"\nnode_polynomial = ["r", 1]\n[roots]\nr = "sqrt(2)"',
        "node_polynomial[0] is sqrt(2); a rational n",
    ),
    ("not toml", "Expected '=' after a key in a key/value pair (at line 1, column 5)"),
    (b"\xff\xfe", "not UTF-8 at byte 0"),
    ("a = " + "[" * 5000 + "]" * 5000, ""),
]


@pytest.mark.parametrize(("text", "reason"), WRONG, ids=range(len(WRONG)))
def test_wrong_file_is_refused_in_one_line_with_its_name_and_place(refusal, text, reason) -> None:  # type: ignore[no-untyped-def]
    assert reason in refusal(text)


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        (HEAD + 2_000_000 * "#", "too large; at most 2000000 bytes are read"),
        (HEAD + f"A = [[0]]\nb = [{9000 * '0,'}]\n", "b has 9000 entries; at most 200 are allowed"),
        (HEAD + f"b = [1]\nA = [{9000 * '[0],'}]", "A has 9000 entries; at most 200 are allowed"),
        ('family = "splitting"\nparts = [' + 9000 * '["kick", 1],' + "]", "parts has 9000 entries; at most 1000"),
    ],
    ids=["file", "weights", "rows", "parts"],
)
def test_thousands_of_stages_are_refused_before_their_numbers_are_read(
    write: Write, text: str, reason: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    numbers: list[object] = []
    monkeypatch.setattr(tableau_file, "_number", lambda *arguments: numbers.append(arguments))
    with pytest.raises(MethodError, match=reason):
        read_method(write(text))
    assert len(numbers) <= 1


@pytest.mark.slow
def test_two_hundred_stages_are_read(write: Write) -> None:
    rows = ",".join("[" + ",".join(["'1/7'"] * i + ["0"] * (200 - i)) + "]" for i in range(200))
    method = read_method(write(HEAD + f"A = [{rows}]\nb = [{','.join(['0.005'] * 200)}]\n"))
    assert isinstance(method, RungeKutta)
    assert (method.stages, method.explicit, method.inconsistencies()) == (200, True, {})


def test_file_that_is_not_there_or_is_no_file_is_refused(tmp_path: Path) -> None:
    missing = "No such file or directory"
    refused = ((tmp_path / "none.toml", missing), (tmp_path, "Is a directory"), (tmp_path / "two\nlines.toml", missing))
    for path, reason in refused:
        with pytest.raises(MethodError, match=reason) as caught:
            read_method(path)
        assert "\n" not in str(caught.value)


def test_key_is_the_name_of_the_file(tmp_path: Path) -> None:
    for name, key in (("rk4.toml", "rk4"), ("3 stages!.toml", "method_3_stages_"), (51 * "a" + ".toml", 50 * "a")):
        path = tmp_path / name
        path.write_text(ONE, encoding="utf-8")
        assert read_method(path).key == key
        assert read_method(str(path)).key == key


def test_additive_method_is_read_from_its_two_tables(write: Write) -> None:
    tables = "A_explicit = [[0, 0], [1, 0]]\nA_implicit = [[0, 0], [0, 1]]\nb_explicit = [1, 0]\nb_implicit = [0, 1]"
    read, known = read_method(write(f'family = "additive"\n{tables}')), FURTHER_METHODS["ars111"]
    assert isinstance(read, Additive)
    assert (
        replace(read, **{name: getattr(known, name) for name in ("key", "title", "claimed_order", "source")}) == known
    )


def test_rows_may_end_at_the_diagonal(write: Write) -> None:
    """Below it for an explicit table, on it for one that is solved stage by stage."""
    square = 'A = [[0, 0, 0], ["1/2", 0, 0], [-1, 2, 0]]'
    for rows in ('A = [[], ["1/2"], [-1, 2]]', 'A = [[0], ["1/2", 0], [-1, 2, 0]]'):
        full, short = (read_method(write(f"{HEAD}{text}\nb = [0, 0, 1]\n")) for text in (square, rows))
        assert full == short
    assert read_method(write(HEAD + "A = [[]]\nb = [1]\n")) == read_method(write(ONE))
