"""The rules beyond the borders of one component, in a sentence."""

from __future__ import annotations

from collections.abc import Sequence
from math import pi, ulp

from driftproof.blackbox.contract.rules import CHANGED, CLAMPED, REFLECTED, REFUSED, RESET, WRAPPED, Rule
from driftproof.blackbox.contract.thresholds import named

# A border of an angle that was found within so many ulps of a multiple of pi is that multiple, rounded on the way.
_ULPS = 4


def in_words(name: str, rules: Sequence[Rule]) -> str:
    """What happens to the component called `name` beyond its one or two borders."""
    if len(rules) == 2 and rules[0].kind == rules[1].kind:
        above, below = rules
        words = _both_sides(name, above, below)
        if words:
            return words
    return "; ".join(_one_side(name, rule) for rule in rules)


def _both_sides(name: str, above: Rule, below: Rule) -> str:
    """One sentence for two borders with the same kind of rule; empty if they take two."""
    if above.kind == CLAMPED and above.at_border and below.at_border and above.more == below.more:
        mirrored = above.value == -below.value
        words = f"|{name}| is capped at {named(above.value)}"
        return _and(words if mirrored else f"{name} is clamped to [{named(below.value)}, {named(above.value)}]", above)
    if above.kind == WRAPPED and not (above.more or below.more):
        return f"{name} is wrapped to {_interval(below, above)}"
    alike = above.kind == CHANGED or (above.kind in (RESET, REFUSED) and above.more == below.more)
    if alike and above.limit == -below.limit:
        return _one_side(f"|{name}|", above)
    return ""


def _one_side(name: str, rule: Rule) -> str:
    where = f"{name} {_where(rule)}"
    if rule.kind == CLAMPED and rule.at_border:
        side = "below" if rule.is_above else "above"
        return _and(f"{name} is kept at {named(rule.value)} or {side}", rule)
    if rule.kind == RESET:
        return f"with {where} the state jumps to {rule.more}"
    if rule.kind == REFUSED:
        return f"{where} is refused: {rule.more}"
    if rule.kind == CHANGED:
        return f"with {where} the state is changed at once: {rule.more}"
    becomes = {
        CLAMPED: f"{where} becomes {named(rule.value)}",
        WRAPPED: f"{where} is moved by {named(_snapped(rule.value))} {rule.more}".rstrip(),
        REFLECTED: f"{where} is turned back about {named(rule.value)}",
    }
    return becomes[rule.kind] if rule.kind == WRAPPED else _and(becomes[rule.kind], rule)


def _and(words: str, rule: Rule) -> str:
    return f"{words}, {rule.more}" if rule.more else words


def _where(rule: Rule) -> str:
    """beyond 2.4, from 2.4 on, below -2.4, from -2.4 down: the border, and on which side of it its number lies."""
    limit = named(rule.limit)
    if rule.is_above:
        return f"from {limit} on" if rule.includes_limit else f"beyond {limit}"
    return f"from {limit} down" if rule.includes_limit else f"below {limit}"


def _interval(below: Rule, above: Rule) -> str:
    """[-pi, pi): the ends, and which of them is left alone."""
    low, high = _snapped(below.limit), _snapped(above.limit)
    opens, closes = "(" if below.outer >= low else "[", ")" if above.outer <= high else "]"
    return f"{opens}{named(low)}, {named(high)}{closes}"


def _snapped(x: float) -> float:
    """The multiple of pi/2 within a few ulps, if there is one."""
    nearest = round(2 * x / pi) * (pi / 2)
    return nearest if nearest and abs(x - nearest) <= _ULPS * ulp(x) else x
