"""Answers that are facts of a method or of a family, by the names that `driftproof facts` uses."""

from __future__ import annotations

import re
from difflib import get_close_matches
from fractions import Fraction
from typing import Any

from driftproof.methods.families import Family
from driftproof.symbolic.algebra.polynomials import polynomial
from driftproof.symbolic.algebra.text import polynomial_text
from driftproof.symbolic.facts import FACTS, facts_of
from driftproof.symbolic.family_facts import FAMILY_FACTS, family_facts
from driftproof.symbolic.linear.facts import ON_REQUEST, LinearFacts
from driftproof.texts.questions.asking import HEADS, Asking
from driftproof.texts.questions.errors import refused_at
from driftproof.texts.questions.exact_facts import EXACT_FACTS, NoSuchFact
from driftproof.texts.questions.value import COUNTED, PROVED, STATED, Value
from driftproof.texts.writing.facts import VARIABLES, fact_text
from driftproof.texts.writing.tex import fact_tex

# Facts that were counted, and those that are only what the source says: the others are derived.
EVIDENCE = {"stages": COUNTED} | dict.fromkeys(("method", "title", "family", "source", "claimed_order"), STATED)
# Parts that are formulas in SymPy's syntax: of the modified Hamiltonian.
FORMULAS = ("factor", "q2", "qv", "v2")


def fact(asking: Asking) -> Value:
    """Answers `FACT METHOD [at VALUE] [h=1/4] [: PART]`. Raises QuestionError, also where there is no such fact."""
    name = asking.head
    if name not in NAMES:
        raise asking.error(None, _unknown(name))
    subject = asking.subject()
    with refused_at(asking.text, asking.asked.column):
        if not isinstance(subject, Family) and name in EXACT_FACTS:
            try:
                return EXACT_FACTS[name](asking, LinearFacts(subject))
            except NoSuchFact as reason:
                raise ValueError(f"{subject.key} has no {name}: {reason}") from None
        asking.demand_only(readout=True)
        of_subject = family_facts(subject, (name,)) if isinstance(subject, Family) else facts_of(subject, (name,))
        return _of_json(asking, of_subject[name], subject.key)


NAMES = (*FACTS, *ON_REQUEST, *(name for name in FAMILY_FACTS if name not in FACTS))


def _unknown(name: str) -> str:
    close = get_close_matches(name, [*HEADS, *NAMES], n=2)
    hint = f"did you mean {' or '.join(close)}? " if close else ""
    return f"{name[:40]!r} is nothing that can be asked; {hint}`driftproof value --list` shows what can"


def _of_json(asking: Asking, found: Any, key: str) -> Value:
    """The part of a JSON-ready fact that the readout names: a number where it is one, else words."""
    name = asking.head
    for part in asking.asked.readout.text.split(".") if asking.asked.readout else ():
        if not isinstance(found, dict) or part not in found:
            parts = f"it has {', '.join(found)}" if isinstance(found, dict) and found else "it has no parts"
            raise asking.error(asking.asked.readout, f"{part[:40]!r} is no part of {name} of {key}; {parts}")
        found, name = found[part], part
    if found is None:
        raise ValueError(f"{key} has no {asking.head}")
    if found == "oo":
        return Value("", None, form="oo")
    evidence = EVIDENCE.get(name, PROVED)
    if (x := _rational(found)) is not None:
        return Value("", x, evidence)
    if name.endswith(("series", "rate")) and isinstance(found, list):
        terms = [x for c in found if (x := _rational(c)) is not None]
        if len(terms) == len(found):
            return Value("", None, form=polynomial_text(polynomial(terms), VARIABLES.get(name, "h")))
    if isinstance(found, str) and name in FORMULAS:
        return Value("", None, form=found)
    return Value("", None, evidence, form=fact_text(name, found), words=fact_tex(name, found))


def _rational(found: Any) -> Fraction | None:
    """The number, where a JSON-ready value is an integer or spells a rational number."""
    if isinstance(found, bool) or not isinstance(found, int | str):
        return None
    return Fraction(found) if isinstance(found, int) or _RATIONAL.fullmatch(found) else None


_RATIONAL = re.compile(r"-?[0-9]{1,4000}(/[0-9]{1,4000})?")
