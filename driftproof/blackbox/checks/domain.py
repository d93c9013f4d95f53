"""Checks of the domain: large states that are capped, reset, refused or overflow, and small ones put to rest."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from math import isnan, ldexp, nan

from driftproof.blackbox.checks import borders
from driftproof.blackbox.checks.trials import CheckResult, Trial, TrialRunner, pair_text, steady_runner
from driftproof.blackbox.stepper.calling_conventions import MAP
from driftproof.blackbox.stepper.foreign_stepper import ForeignStepper

CAPPED, RESET, REFUSED, OVERFLOWS, CHANGED = "capped", "reset", "refused", "overflows", "changed"
LARGE_STATES, _RANGES = "large_states", ("position_range", "velocity_range")
_PLURALS = ("positions", "velocities")
# Far out, a rule changes a state by more than this part of its size, a strong force in so short a step by rounding.
_PLAIN = 2.0**-10
# Sums of stages overflow a few binades early; a step that overflows earlier by this factor multiplies states.
_EARLY = 2.0**-24
_EXPONENT = 709.0  # of the largest exponential in binary64; a narrower format overflows before
# Powers of two on the way out, closely spaced where the limits on everyday angles, speeds and lengths are.
_OUTWARDS = (1, 2, 3, 4, 6, 8, 10, 13, 20, 30, 50)
# Powers of two on the way in, as far as binary64 goes.
_INWARDS = (1, 2, 3, 4, 6, 8, 10, 13, 17, 20, 27, 33, 50, 100, 300)


@dataclass(frozen=True)
class Rule:
    """What happens to one component beyond a border.

    `value` is what the component becomes if it is CAPPED; otherwise `more` says in words what happens.
    """

    kind: str
    component: int
    border: borders.Border
    value: float = nan
    more: str = ""

    @property
    def ends(self) -> tuple[float, float]:
        """The last value that is left unchanged, and the first beyond."""
        kept, beyond = (trial.given[self.component] for trial in self.border.example)
        return kept, beyond

    @property
    def limit(self) -> float:
        """The border as a programmer may have written it: the end with the shorter name."""
        return borders.shorter_number(*self.ends)


def domain(subject: ForeignStepper) -> tuple[CheckResult, ...]:
    """Check what large and small positions and velocities become, and from where on the arithmetic overflows."""
    runner = steady_runner(subject)
    short = borders.negligible_step(runner)
    if short is None:
        return (CheckResult("domain", None, "not tested: no step is short enough to leave the state unchanged"),)
    rules: list[Rule] = []
    for component in (0, 1):
        for sign in (1, -1):
            rules += filter(None, [_outwards(short, component, sign, rules)])
    ranges = (_range_check(component, [rule for rule in rules if rule.component == component]) for component in (0, 1))
    return (*ranges, _small(short), _large(runner, rules))


def _outwards(short: borders.NegligibleStep, component: int, sign: int, before: Sequence[Rule]) -> Rule | None:
    """The rule for large values of one component and sign; the borders of the rules found `before` are tried first.

    The way out starts from the state, or from 0 for the other sign.
    """
    base, e_max = short.state[component], short.runner.format.emax
    powers = {*_OUTWARDS, e_max // 2 + 8, e_max - 24} & {*range(e_max)}
    points = [sign * ldexp(base, k) for k in [*([0] if sign == -1 else []), *sorted({*powers, e_max + 1})]]
    hints = [(sign * abs(inner), sign * abs(outer)) for inner, outer in (rule.ends for rule in before)]
    seen = borders.border(short, partial(short.along, component), base if sign == 1 else 0.0, points, hints)
    return _rule_of(short, component, seen) if seen else None


def _rule_of(short: borders.NegligibleStep, component: int, seen: borders.Border) -> Rule | None:
    """The rule behind the border; None if it is only a strong force that begins to be felt."""
    first = seen.beyond[0]
    if first.answer is None and first.raised != "OverflowError":  # of Python's own powers
        return Rule(REFUSED, component, seen, more=first.refusal)
    # NaN for a state of ordinary size, of which nothing overflows, is where the domain of a built-in system ends:
    # exponentials are the first to overflow, and their quotients and differences are NaN.
    no_number = abs(first.given[component]) < _EXPONENT and any(map(isnan, first.answer or ()))
    if not first.finite and no_number and short.runner.subject.convention.kind == MAP:
        return Rule(REFUSED, component, seen, more=f"it returns {first.seen}")
    if not first.finite:
        return Rule(OVERFLOWS, component, seen)
    finite = [trial for trial in seen.beyond if trial.answer is not None and trial.finite]
    answers = {trial.answer for trial in finite if trial.answer is not None}
    values = {answer[component] for answer in answers}
    if len(values) == 1 and len({trial.given[component] for trial in finite}) > 1:
        if all(short.keeps_other(component, trial) for trial in finite):
            return Rule(CAPPED, component, seen, values.pop())
        if len(answers) == 1:
            return Rule(RESET, component, seen, more=f"the state jumps to {first.seen}")
    plain = next((t for t in finite if short.change(t) > _PLAIN * max(map(abs, t.given[:2]))), None)
    if plain is None:
        return None
    return Rule(CHANGED, component, seen, more=f"the state changes even as h -> 0: {_becomes(plain)}")


def _range_check(component: int, found: Sequence[Rule]) -> CheckResult:
    rules = [rule for rule in found if rule.kind != OVERFLOWS]
    if not rules:
        return CheckResult(_RANGES[component], True, f"{_PLURALS[component]} of any size are used as given")
    example = tuple(trial for rule in rules for trial in rule.border.example)
    holds = None if all(rule.kind == REFUSED for rule in rules) else False
    return CheckResult(_RANGES[component], holds, _in_words(borders.COMPONENT_NAMES[component], rules), example)


def _in_words(name: str, rules: Sequence[Rule]) -> str:
    """What happens to the component called `name` beyond its one or two borders, in one sentence if they are alike."""
    if len(rules) == 2 and rules[0].kind == rules[1].kind and rules[0].limit == -rules[1].limit:
        above, below = rules
        if above.kind == CAPPED and above.value == -below.value and above.value in above.ends:
            return f"|{name}| is capped at {borders.short_name(above.value)}"
        if above.kind == CHANGED or (above.kind != CAPPED and above.more == below.more):
            rules, name = [above], f"|{name}|"
    return "; ".join(_one_side(name, rule) for rule in rules)


def _one_side(name: str, rule: Rule) -> str:
    """The border on its side, such as "q beyond 2.4" or "q from -2.4 down", and what happens there."""
    inner, outer = rule.ends
    above, limit = outer > inner, borders.short_name(rule.limit)
    where = f"from {limit} {'on' if above else 'down'}"
    if rule.limit != outer:
        where = f"{'beyond' if above else 'below'} {limit}"
    if rule.kind == CAPPED:
        return f"{name} {where} becomes {borders.short_name(rule.value)}"
    return f"{name} {where} is refused: {rule.more}" if rule.kind == REFUSED else f"with {name} {where} {rule.more}"


def _large(runner: TrialRunner, rules: Sequence[Rule]) -> CheckResult:
    """Check where finite states begin to have no finite answer, though the step hardly moves them."""
    overflows = [rule for rule in rules if rule.kind == OVERFLOWS]
    if not overflows:
        return CheckResult(LARGE_STATES, True, "large states give finite answers")
    first = min(overflows, key=lambda rule: abs(rule.limit))
    name = borders.COMPONENT_NAMES[first.component]
    near = abs(first.limit) >= _EARLY * float(runner.format.largest)
    holds, room = near or (None if runner.of_another_system else False), "close to" if near else "far from"
    words = f"overflows from {name} = {first.limit:.4g} on, where the answer is {room} overflow"
    return CheckResult(LARGE_STATES, holds, words, first.border.example)


def _small(short: borders.NegligibleStep) -> CheckResult:
    """Check whether small values of one component, or small states, are put to rest."""
    shrinking = [2.0**-k for k in _INWARDS if k in range(short.runner.format.emax // 3)]
    for component in (1, 0):
        base = short.state[component]
        seen = borders.border(short, partial(short.along, component), base, [base * s for s in shrinking])
        if seen is not None:
            singular = not seen.beyond[0].finite and short.runner.of_another_system
            holds = None if singular else False
            return CheckResult("small_states", holds, _put_to_rest(short, component, seen), seen.example)
    # Where a rule rounds, as a wrapped angle does, small states lose digits without being put to rest.
    seen = None if short.slack else borders.border(short, short.scaled, 1.0, shrinking)
    if seen is None:
        return CheckResult("small_states", True, "small states are used as given")
    words = f"small states change even as h -> 0: {_becomes(seen.beyond[0])}"
    return CheckResult("small_states", False, words, seen.example)


def _put_to_rest(short: borders.NegligibleStep, component: int, seen: borders.Border) -> str:
    """What small values of a component become, in words: "|v| below 0.01 becomes 0"."""
    name, kept, first = borders.COMPONENT_NAMES[component], seen.kept.given[component], seen.beyond[0]
    given = first.given[component]
    answers = (trial.answer or (None, None) for trial in (first, short.along(component, -given)))
    after, mirrored = (answer[component] for answer in answers)
    limit = borders.shorter_number(kept, given)
    name = f"|{name}|" if after == mirrored == 0 else name
    where = f"{name} {'up to' if limit == given else 'below'} {borders.short_name(limit)}"
    return f"{where} becomes 0" if after == 0 else f"with {where} the state changes even as h -> 0: {_becomes(first)}"


def _becomes(trial: Trial) -> str:
    return f"{pair_text(trial.given[:2])} becomes {trial.seen}"
