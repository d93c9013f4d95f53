"""The digits of the references are right: certified by balls; another digit is noticed."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import replace
from decimal import Decimal
from fractions import Fraction
from functools import cache

import pytest
from flint import arb, ctx

from driftproof.enclosure.fields.text_fields import field_function
from driftproof.enclosure.solution.solutions import enclose_solution
from driftproof.numeric.problems.catalogue import PROBLEMS
from driftproof.numeric.problems.problem import CERTIFIED, EXACT, Problem, reference
from driftproof.numeric.reference_errors import decimal_energy
from tests.looping import exactly, some
from tests.witnesses.references.closed_forms import CLOSED_FORMS, ball
from tests.witnesses.references.literature import DOCS, page, published, right_digits, rows
from tests.witnesses.references.write import Row, computed
from tests.witnesses.references.write import main as write

BY_EVIDENCE = {e: [p for p in PROBLEMS.values() if p.reference.evidence == e] for e in (EXACT, CERTIFIED)}
# Whose first states are computed again in a moment.
SAMPLED = {"robertson": 2, "henon_heiles": 1}
# Steps short beside the fastest change; 1/100 for all others.
SHORT = {
    **dict.fromkeys(("dahlquist_1e6", "prothero_robinson", "kaps"), Fraction(1, 10**7)),
    **dict.fromkeys(("dahlquist_1e3", "stiff_oscillator", "separated_oscillators", "stiff_pair"), Fraction(1, 10**4)),
    **dict.fromkeys(("overdamped_oscillator", "heat_equation", "kepler_extreme"), Fraction(1, 10**4)),
    "kepler_eccentric": Fraction(1, 10**3),
}
key = lambda problem: problem.key


def wrong(stored: Sequence[Sequence[str]], right: Sequence[Row]) -> list[tuple[int, int]]:
    """Where a digit differs."""
    return [(i, j) for i, row in enumerate(right) for j, text in enumerate(row) if stored[i][j] != text]


@cache
def recomputed(name: str, count: int) -> list[Row]:
    problem = PROBLEMS[name]
    return computed(problem, problem.reference.times[:count])


def with_another_digit(text: str, place: int) -> str:
    """The decimal with its digit number `place` changed by one: the first is 0, the last -1."""
    at = [i for i, x in enumerate(text.partition("e")[0]) if x.isdigit()][place]
    return f"{text[:at]}{'1' if text[at] == '0' else chr(ord(text[at]) - 1)}{text[at + 1 :]}"


@pytest.mark.parametrize("problem", BY_EVIDENCE[EXACT], ids=key)
def test_closed_forms_have_the_digits_stored(problem: Problem) -> None:
    assert wrong(problem.reference.states, recomputed(problem.key, len(problem.reference.times))) == []


@pytest.mark.parametrize("problem", [PROBLEMS[name] for name in SAMPLED], ids=key)
def test_first_states_computed_again_have_the_digits_stored(problem: Problem) -> None:
    count = SAMPLED[problem.key]
    assert wrong(problem.reference.states[:count], recomputed(problem.key, count)) == []


@pytest.mark.long
@pytest.mark.parametrize("problem", BY_EVIDENCE[CERTIFIED], ids=key)
def test_all_states_computed_again_have_the_digits_stored(problem: Problem) -> None:
    assert wrong(problem.reference.states, recomputed(problem.key, len(problem.reference.times))) == []


@pytest.mark.parametrize("problem", [*BY_EVIDENCE[EXACT], *(PROBLEMS[name] for name in SAMPLED)], ids=key)
def test_another_digit_is_noticed_wherever_it_is_planted(problem: Problem) -> None:
    count = SAMPLED.get(problem.key, len(problem.reference.times))
    right = recomputed(problem.key, count)
    for i, row in exactly(count, enumerate(right)):
        for j, text in some(enumerate(row)):
            for place in (0, -1):
                planted = [list(stored) for stored in problem.reference.states[:count]]
                planted[i][j] = with_another_digit(text, place)
                assert wrong(planted, right) == [(i, j)]


def flows(problem: Problem, t: Fraction, h: Fraction, state: list[arb]) -> list[tuple[arb, arb]]:
    """From a state at t: the enclosed solution at t + h, and the closed form there."""
    _, end = enclose_solution(field_function(problem.field), state, [t, t + h]).states
    return list(zip(end, CLOSED_FORMS[problem.key](t + h), strict=True))


@pytest.mark.parametrize("problem", BY_EVIDENCE[EXACT], ids=key)
def test_closed_form_solves_the_equations_from_the_start_on_and_from_the_first_time(problem: Problem) -> None:
    h = SHORT.get(problem.key, Fraction(1, 100))
    first = problem.reference.times[0]
    with ctx.workprec(200):
        starts = [(Fraction(0), [ball(x) for x in problem.start]), (first, CLOSED_FORMS[problem.key](first))]
        for t, state in starts:
            pairs = flows(problem, t, h, state)
            assert all(a.overlaps(b) and a.rad() < arb(10) ** -25 for a, b in pairs)
            moved = [x + arb(10) ** -20 for x in state]
            assert not all(a.overlaps(b) for a, b in flows(problem, t, h, moved))


def over_last_interval(problem: Problem, start: Sequence[str]) -> tuple[arb, ...]:
    """The last state, enclosed, from the one before; the equations do not read t."""
    times = problem.reference.times[-2:]
    return enclose_solution(field_function(problem.field), list(map(Fraction, start)), times).states[-1]


def agree(found: Sequence[arb], stored: Sequence[str]) -> bool:
    """To 15 digits: the state before was rounded to 20, and may have grown more wrong by a factor of thousands."""
    return all(abs(a / ball(Fraction(b)) - 1) < arb(10) ** -15 for a, b in zip(found, stored, strict=True))


@pytest.mark.slow(keep=1)
# Not on the fast components, which forget.
@pytest.mark.parametrize(
    ("name", "slow"), [("van_der_pol_1e6", 0), pytest.param("hires", 4, marks=pytest.mark.long), ("oregonator", 2)]
)
def test_last_state_follows_from_the_one_before(name: str, slow: int) -> None:
    *_, before, last = PROBLEMS[name].reference.states
    assert agree(over_last_interval(PROBLEMS[name], before), last)
    planted = list(before)
    planted[slow] = with_another_digit(before[slow], -7)
    assert not agree(over_last_interval(PROBLEMS[name], planted), last)


def test_what_a_new_problem_lacks_is_said_with_the_file_in_which_to_write_it(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(ValueError, match=r"^slow has no times in \S+/digits\.json"):
        reference("slow", EXACT, "1/e")
    monkeypatch.delitem(CLOSED_FORMS, "kepler")
    for name, file in (("slow", "catalogue"), ("kepler", "closed_forms")):
        with pytest.raises(SystemExit, match=rf"^{name} .* in \S+/{file}\.py$"):
            write([name])


def test_a_new_problem_with_its_end_alone_has_digits_at_the_eighths(monkeypatch, tmp_path) -> None:
    old = PROBLEMS["dahlquist_1"]
    new = replace(old, reference=replace(old.reference, times=old.reference.times[-1:], states=((),)))
    monkeypatch.setattr("tests.witnesses.references.write.PROBLEMS", {"dahlquist_1": new})
    monkeypatch.setattr("tests.witnesses.references.write.DIGITS", tmp_path / "digits.json")
    (tmp_path / "digits.json").write_text('{"dahlquist_1": {"10": []}}')
    write(["dahlquist_1"])
    wanted = dict(zip(map(str, old.reference.times), map(list, old.reference.states), strict=True))
    assert json.loads((tmp_path / "digits.json").read_text()) == {"dahlquist_1": wanted}


def test_a_start_and_states_of_another_length_than_the_field_are_refused() -> None:
    kaps = PROBLEMS["kaps"]
    short = replace(kaps.reference, states=(*kaps.reference.states[:-1], ("1",)))
    for wrong in ({"start": kaps.start[:1]}, {"start": (*kaps.start, Fraction(0))}, {"reference": short}):
        with pytest.raises(ValueError, match="kaps: 2 rates need a start and a reference of 2 components"):
            replace(kaps, **wrong)
    bad = {"times": kaps.reference.times[::-1]}, {"times": kaps.reference.times[1:]}, {"times": (), "states": ()}
    for changed in (*bad, {"evidence": "rumour"}):
        with pytest.raises(ValueError, match=r"increasing times|'rumour'; choose from exact"):
            replace(kaps.reference, **changed)


@pytest.mark.parametrize("problem", [p for p in PROBLEMS.values() if p.energy is not None], ids=key)
def test_energy_of_every_state_stored_is_that_of_the_start(problem: Problem) -> None:
    """To 1e-16: the digits are twenty, and the energy may be a small difference of large parts."""
    before = decimal_energy(problem, problem.start)
    for state in some(problem.reference.states, 8):
        assert abs(decimal_energy(problem, map(Fraction, state)) - before) <= abs(before) * Decimal("1e-16")
    moved = (problem.start[0] + Fraction(1, 100), *problem.start[1:-1], problem.start[-1] + Fraction(1, 100))
    assert abs(decimal_energy(problem, moved) - before) > abs(before) * Decimal("1e-16")


def test_robertson_and_hires_keep_their_sums_in_the_digits_stored() -> None:
    for name, parts, total in (("robertson", (0, 1, 2), Fraction(1)), ("hires", (6, 7), Fraction(57, 10000))):
        for state in some(PROBLEMS[name].reference.states, 8):
            left = lambda texts, parts=parts, total=total: abs(sum(Fraction(texts[i]) for i in parts) / total - 1)
            assert left(state) < Fraction(1, 10**19)
            largest = max(parts, key=lambda i, state=state: Fraction(state[i]))
            planted = [with_another_digit(x, -3) if i == largest else x for i, x in enumerate(state)]
            assert left(planted) > Fraction(1, 10**19)


def test_every_reference_has_twenty_digits() -> None:
    for problem in some(PROBLEMS.values(), 26):
        for state in some(problem.reference.states, 8):
            for text in some(state):
                digits = text.partition("e")[0].lstrip("-0.").replace(".", "")
                assert len(digits) == 20 or text == "0e-400"


def test_page_is_what_the_numbers_give() -> None:
    assert (DOCS / "reference_digits.md").read_text(encoding="utf-8") == page()


def test_published_numbers_are_right_to_thirteen_digits_and_not_all_to_sixteen() -> None:
    right = [row[5] for row in rows()]
    assert min(right) == 13
    assert max(right) == 16


def test_every_published_state_has_all_components() -> None:
    assert all(len(entry["y"]) in (2, 3, 8) for entry in exactly(13, published()))


def test_right_digits_are_counted_to_half_a_unit() -> None:
    assert right_digits("0.1234E+01", Fraction("1.2344")) == 4
    assert right_digits("0.1234E+01", Fraction("1.2346")) == 3
    assert right_digits("0.1234E+01", Fraction("9")) == 0
