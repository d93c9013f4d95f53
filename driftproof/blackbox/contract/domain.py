"""Which states a stepper takes as they are, and what it makes of the others before it moves them at all."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from math import ldexp

from driftproof.blackbox.contract.bench import Bench, steady_bench
from driftproof.blackbox.contract.clauses import Clause, Trial, shown
from driftproof.blackbox.contract.rule_words import in_words
from driftproof.blackbox.contract.rules import OVERFLOWS, REFUSED, Rule, rule_of
from driftproof.blackbox.contract.still import NAMES, Border, Still, border, still
from driftproof.blackbox.contract.thresholds import named, rounder
from driftproof.blackbox.stepper.subject import Subject

_RANGES = ("position_range", "velocity_range")
_PLURALS = ("positions", "velocities")
# Sums of stages overflow a few binades early. What overflows earlier by more than this multiplies states.
_EARLY = 2.0**-24


def domain(subject: Subject) -> tuple[Clause, ...]:
    """What becomes of large positions and velocities, of small ones, and from where on the arithmetic overflows."""
    bench = steady_bench(subject)
    found = still(bench)
    if found is None:
        return (Clause("domain", None, "not asked: there is no step so short that it leaves the state alone"),)
    rules: list[Rule] = []
    for component in (0, 1):
        for sign in (1, -1):
            rules += filter(None, [_outwards(found, component, sign, rules)])
    ranges = (_range_clause(component, [rule for rule in rules if rule.component == component]) for component in (0, 1))
    return (*ranges, _small(found), _large(bench, rules))


def _outwards(found: Still, component: int, sign: int, before: Sequence[Rule]) -> Rule | None:
    """The rule for large values of one component and sign; often one has been found elsewhere before.

    The way out starts from the state, or from 0 on the other side.
    """
    base, e_max = found.state[component], found.bench.format.emax
    powers = [k for k in (1, 2, 3, 4, 6, 8, 10, 13, 20, 30, 50, e_max // 2 + 8, e_max - 24) if k < e_max]
    points = [sign * ldexp(base, k) for k in [*([0] if sign < 0 else []), *sorted({*powers, e_max + 1})]]
    hints = [(sign * abs(rule.inner), sign * abs(rule.outer)) for rule in before]
    seen = border(found, partial(found.along, component), base if sign > 0 else 0.0, points, hints)
    return rule_of(found, component, seen) if seen else None


def _range_clause(component: int, found: Sequence[Rule]) -> Clause:
    rules = [rule for rule in found if rule.kind != OVERFLOWS]
    if not rules:
        return Clause(_RANGES[component], True, f"{_PLURALS[component]} of any size are taken as they are")
    example = tuple(trial for rule in rules for trial in rule.example)
    holds = None if all(rule.kind == REFUSED for rule in rules) else False
    return Clause(_RANGES[component], holds, in_words(NAMES[component], rules), example)


def _large(bench: Bench, rules: Sequence[Rule]) -> Clause:
    """From where on finite states have no finite answer, though they are hardly moved."""
    overflows = [rule for rule in rules if rule.kind == OVERFLOWS]
    if not overflows:
        return Clause("large_states", True, "large states have finite answers")
    first = min(overflows, key=lambda rule: abs(rule.limit))
    name = NAMES[first.component]
    holds = abs(first.limit) >= _EARLY * float(bench.format.largest)
    words = f"overflows from {name} = {first.limit:.4g} on, where the answer is {'nearly' if holds else 'far'} "
    words += "too large" if holds else "from too large"
    return Clause("large_states", holds, words, first.example)


def _small(found: Still) -> Clause:
    """Whether small values of one component, or small states, are put to rest."""
    powers = (1, 2, 3, 4, 6, 8, 10, 13, 17, 20, 27, 33, 50, 100, 300)
    shrinking = [2.0**-k for k in powers if 3 * k < found.bench.format.emax]
    for component in (1, 0):
        base = found.state[component]
        seen = border(found, partial(found.along, component), base, [base * s for s in shrinking])
        if seen is not None:
            return _small_clause(_asleep(found, component, seen), seen)
    # Where a rule rounds, as a wrapped angle does, small states lose digits without being put to rest.
    seen = None if found.slack else border(found, found.scaled, 1.0, shrinking)
    if seen is None:
        return Clause("small_states", True, "small states are taken as they are")
    return _small_clause(f"small states are changed at once: {_becomes(seen.beyond[0])}", seen)


def _small_clause(words: str, seen: Border) -> Clause:
    return Clause("small_states", False, words, (seen.kept, seen.beyond[0]))


def _asleep(found: Still, component: int, seen: Border) -> str:
    """|v| below 0.01 becomes 0."""
    name, kept, first = NAMES[component], seen.kept.given[component], seen.beyond[0]
    given = first.given[component]
    answers = (trial.answer or (None, None) for trial in (first, found.along(component, -given)))
    after, mirrored = (answer[component] for answer in answers)
    limit = rounder(kept, given)
    where = f"{f'|{name}|' if after == mirrored == 0 else name} {'up to' if limit == given else 'below'} {named(limit)}"
    return f"{where} becomes 0" if after == 0 else f"with {where} the state is changed at once: {_becomes(first)}"


def _becomes(trial: Trial) -> str:
    return f"{shown(trial.given[:2])} becomes {trial.seen}"
