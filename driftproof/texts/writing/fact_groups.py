"""Write the facts of a method in four groups, with plain words beside the technical names.

Facts that the method does not have are left out; `--all` shows every fact.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from driftproof.methods.catalogue import FACTS_ONLY, METHODS
from driftproof.methods.names import also_known_as, not_to_be_confused_with
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
steps | steps
rho | rho: what of the values y is summed
sigma | sigma: what of the slopes F(y) is
diagonal | gamma on the diagonal, one factorisation a step
explicit | explicit: no equation is solved in a step
inconsistencies | inconsistencies of the coefficients

Accuracy
order | order p: over a given time the error falls as h^p
claimed_order | order that is claimed, which the coefficients as written do not have
order_but_for_rounding | order but for rounded coefficients, and by what its conditions fail
order_to_tolerance | order up to residuals of the size asked for
order_sets | where the order is at least so high
order_fails | the first condition of a higher order that fails
order_second_order_problems | order on q'' = F(q) alone
explicit_order | order of the explicit table alone
implicit_order | order of the implicit table alone
w_order | W order: with any matrix in place of the Jacobian
embedded_order | order of the embedded row
stage_order | stage order: what is left of it on stiff problems
error_constant | error constant: error of a step on y' = y
first_barrier | Dahlquist's first barrier, by the number of steps
dispersion | dispersion: phase error of a step of the oscillator
dissipation | dissipation: what its amplitude gains in a step

Stability
zero_stable | zero-stable: bounded on y' = 0, or y'' = 0 as n
root_condition | root condition: where the roots of rho are
stability_function | stability function R(z): a step of y' = λy is y1 = R(hλ) y
real_limit | real limit: y' = -λy decays for hλ up to
imaginary_limit | imaginary limit: y' = iωy stays bounded for hω up to
a_stable | A-stable: whatever decays is damped, at any h
sector | A(alpha): decay is damped in |arg(-hλ)| < alpha
l_stable | L-stable: and what decays fast is gone in a step
stability_within_digits | stability that rounded coefficients do not exclude
explicit_real_limit | real limit of the explicit part alone
explicit_imaginary_limit | imaginary limit of the explicit part alone
implicit_a_stable | implicit part alone: A-stable
implicit_l_stable | implicit part alone: L-stable
implicit_stability_within_digits | implicit part alone: stability that rounded coefficients do not exclude
ssp_coefficient | SSP coefficient: keeps what Euler keeps, at h so often as large

Structure
symplectic | symplectic: area and volume in phase space are kept
symmetric | symmetric: a step back undoes a step
energy_multiplier | energy multiplier: factor on q^2 + v^2 of the oscillator in a step
invariant | invariant: kept exactly on the oscillator
conserved_quadratics | quadratics kept exactly
stiffly_accurate | stiffly accurate: the last stage is the new value
first_same_as_last | first same as last: a stage serves two steps
"""
_READ = [part.splitlines() for part in _GROUPS.strip().split("\n\n")]
GROUPS = {heading: [line.split(" | ")[0] for line in lines] for heading, *lines in _READ}
_OF_MULTISTEP = {"error_constant": "error constant: of exact less computed, over sigma(1)"}
_PLAIN = dict(line.split(" | ") for _, *lines in _READ for line in lines)


def grouped_facts_text(facts: Mapping[str, Any], everything: bool = False) -> str:
    """Facts under four headings, with other names of the method under the first; then all others, or their count.

    >>> facts = {"method": METHODS["trapezoid"], "order": 2, "symmetric": True, "decimal": False}
    >>> print(grouped_facts_text(facts))
    What it is
      name                     trapezoid
      also called              Crank-Nicolson, implicit trapezoid, implicit trapezoidal rule, trapezium rule
      not to be confused with  implicit_midpoint, heun2
    <BLANKLINE>
    Accuracy
      order p: over a given time the error falls as h^p  2
    <BLANKLINE>
    Structure
      symmetric: a step back undoes a step  yes
    <BLANKLINE>
    1 more fact with --all, any one with --only NAME
    """
    groups = {heading: {name: facts[name] for name in names if name in facts} for heading, names in GROUPS.items()}
    shown = [name for group in groups.values() for name in group]
    rest = {name: value for name, value in facts.items() if name not in shown}
    parts, plain = list[str](), _PLAIN | (_OF_MULTISTEP if "rho" in facts else {})
    for heading, group in groups.items():
        named = {plain[name]: value for name, value in group.items() if everything or _is_shown(name, value, facts)}
        parts += [_under(heading, _called(named, facts["method"]) if "method" in group else named)]
    if everything:
        parts += [_under("Everything else", rest)]
    elif rest:
        parts += [f"{len(rest)} more fact{'s' * (len(rest) > 1)} with --all, any one with --only NAME"]
    return "\n\n".join(filter(None, parts))


def _is_shown(name: str, value: Any, facts: Mapping[str, Any]) -> bool:
    """False for one that the method lacks, a claimed order that it has, and a sector that A-stability already says."""
    if name == "claimed_order":
        return isinstance(facts.get("order"), int) and value > facts["order"]
    return fact_text(value) != "none" and (name != "sector" or callable(value.degrees.exact))


def _called(named: Mapping[str, Any], method: Any) -> dict[str, Any]:
    """The group with other names of a method of the catalogue, and methods not to confuse it with, at its end."""
    if method not in (METHODS.get(fact_text(method)), FACTS_ONLY.get(fact_text(method))):
        return dict(named)
    names, others = also_known_as(method.key), not_to_be_confused_with(method.key)
    called = {"also called": ", ".join(names), "not to be confused with": ", ".join(others)}
    return {**named, **{word: keys for word, keys in called.items() if keys}}


def _under(heading: str, named: Mapping[str, Any]) -> str:
    lines = facts_text(named).splitlines() if named else []
    return "\n".join([heading, *(f"  {line}" for line in lines)]) if lines else ""
