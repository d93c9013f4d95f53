"""Write the facts of a method in four groups, with plain words beside the technical names.

Facts that the method does not have are left out; `--all` shows every fact.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from driftproof.methods.catalogue import FURTHER_METHODS, METHODS, Entry
from driftproof.methods.names import EASILY_CONFUSED, also_known_as
from driftproof.symbolic.known_methods import known_as
from driftproof.texts.writing.facts import fact_text, facts_text

# Heading, then fact | its label, for readers who may not know its name. The oscillator is q' = v, v' = -q.
_GROUPS = """
What it is
method | name
title | title
family | kind
parameter | free parameter
source | source
stages | stages
reduction | reducible: which stages count
steps | steps
rho | rho: coefficients of the values y
sigma | sigma: coefficients of the slopes F(y)
diagonal | gamma: diagonal entry, so that a step needs one factorisation
common_factor | common factor of rho and sigma
explicit | explicit: a step solves no equations
inconsistencies | inconsistencies of the coefficients

Accuracy
order | order p: the error at a fixed time is O(h^p)
claimed_order | claimed order (0: none)
order_but_for_rounding | order apart from rounding of the coefficients, with residuals
order_to_tolerance | order, ignoring residuals up to the tolerance
order_sets | parameter values for which the order is at least p
order_fails | first failing order condition
order_second_order_problems | order on q'' = F(q)
explicit_order | order of the explicit tableau
implicit_order | order of the implicit tableau
w_order | W-order: order with an arbitrary matrix in place of the Jacobian
embedded_order | order of the embedded method
stage_order | stage order: may limit the order on stiff problems
error_constant | error constant: leading error of a step on y' = y
first_barrier | Dahlquist's first barrier for this number of steps
dispersion | dispersion: leading phase error of a step of the oscillator
dissipation | dissipation: leading relative change of its amplitude in a step

Stability
zero_stable | zero-stable: bounded on y' = 0, at most linear in n on y'' = 0
root_condition | root condition on the roots of rho
stability_function | stability function R(z): on y' = λy, y1 = R(hλ) y0
real_limit | real limit: y' = -λy stays bounded for hλ up to
imaginary_limit | imaginary limit: an oscillation of frequency ω stays bounded for hω up to
imaginary_limit_within_digits | imaginary limit within the rounding of the coefficients
a_stable | A-stable: y' = λy with Re λ <= 0 stays bounded for every h > 0
sector | A(alpha)-stable: stable for |arg(-hλ)| < alpha
l_stable | L-stable: A-stable, and R(z) -> 0 as z -> oo
stability_within_digits | A- and L-stability that the rounding of the coefficients does not exclude
explicit_real_limit | real limit of the explicit part
explicit_imaginary_limit | imaginary limit of the explicit part
explicit_imaginary_limit_within_digits | imaginary limit of the explicit part within the rounding
implicit_a_stable | implicit part A-stable
implicit_l_stable | implicit part L-stable
implicit_stability_within_digits | implicit part: A- and L-stability that its rounding does not exclude
ssp_coefficient | SSP coefficient: largest monotone step, relative to forward Euler's

Structure
symplectic | symplectic: preserves the symplectic form of phase space
symmetric | symmetric: a step of -h undoes a step of h
energy_multiplier | energy multiplier: factor on the oscillator's q^2 + v^2 in a step
invariant | invariant: quadratic form that steps of the oscillator preserve
conserved_quadratics | all quadratic forms that such steps preserve
stiffly_accurate | stiffly accurate: the last stage is the new value
first_same_as_last | first same as last: the last slope is the first of the next step
"""
_READ = [part.splitlines() for part in _GROUPS.strip().split("\n\n")]
GROUPS = {heading: [line.split(" | ")[0] for line in lines] for heading, *lines in _READ}
_PLAIN = dict(line.split(" | ") for _, *lines in _READ for line in lines)
# Labels of multistep methods that differ from those of one-step methods; `error_constant` is C_{p+1}/sigma(1).
_OF_MULTISTEP = {
    "order": "order p: if zero-stable, the error at a fixed time is O(h^p)",
    "error_constant": "error constant: residual of that condition, divided by sigma(1)",
}


def grouped_facts_text(facts: Mapping[str, Any], everything: bool = False) -> str:
    """Facts under four headings, with other names of the method under the first; then all others, or their count."""
    groups = {heading: {name: facts[name] for name in names if name in facts} for heading, names in GROUPS.items()}
    shown = [name for group in groups.values() for name in group]
    rest = {name: value for name, value in facts.items() if name not in shown}
    labels, parts = _PLAIN | _OF_MULTISTEP if "rho" in facts else _PLAIN, []
    for heading, group in groups.items():
        named = {labels[name]: value for name, value in group.items() if everything or _is_shown(name, value, facts)}
        if not everything and (which := named.get(labels["reduction"])) is not None:
            named[labels["reduction"]] = f"{which.irreducible_stages} of them; which facts that concerns: --all"
        parts += [_under(heading, _called(named, facts["method"]) if "method" in group else named)]
    further = f"{len(rest)} more facts with --all, any one with --only NAME; in Python in .json(), and as .NAME"
    parts += [_under("Everything else", rest) if everything else further]
    return "\n\n".join(filter(None, parts))


def _is_shown(name: str, value: Any, facts: Mapping[str, Any]) -> bool:
    """False for one that the method lacks, a claimed order that it has, and a sector that A-stability already says."""
    if name == "claimed_order":
        return isinstance(facts.get("order"), int) and value > facts["order"]
    return fact_text(value) != "none" and (name != "sector" or callable(value.degrees.exact))


def _called(named: Mapping[str, Any], method: Any) -> dict[str, Any]:
    """The group with other names of a method of the catalogue, and methods not to confuse it with, at its end.

    Of a table that is none, with the method that it is, or is but for a few coefficients.
    """
    if method not in (METHODS.get(fact_text(method)), FURTHER_METHODS.get(fact_text(method))):
        known = known_as(method) if isinstance(method, Entry) else None
        return {**named, **({"in the catalogue": known.words} if known and (known.methods or known.near) else {})}
    names, others = also_known_as(method.key), EASILY_CONFUSED.get(method.key, ())
    called = {"also called": ", ".join(names), "not to be confused with": ", ".join(others)}
    return {**named, **{word: keys for word, keys in called.items() if keys}}


def _under(heading: str, named: Mapping[str, Any]) -> str:
    lines = facts_text(named).splitlines() if named else []
    return "\n".join([heading, *(f"  {line}" for line in lines)]) if lines else ""
