"""Answers about facts of methods and families, by the names that `driftproof facts` uses."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from typing import Any

from driftproof.methods.catalogue import FurtherMethod
from driftproof.methods.families import Family
from driftproof.methods.formulas.expressions import parse_number
from driftproof.methods.numbers.number_field import Algebraic, Exact
from driftproof.methods.schemes import RungeKutta
from driftproof.symbolic.algebra.polynomials import Polynomial, coefficients, evaluate, exact, polynomial, scalar
from driftproof.symbolic.algebra.radicals import radical_form
from driftproof.symbolic.algebra.rational_functions import fraction, polynomial_text, sum_text
from driftproof.symbolic.algebra.real_roots import RealRoot
from driftproof.symbolic.facts import (
    BUT_FOR_ROUNDING,
    FACTS,
    ON_REQUEST,
    OTHER_FACTS,
    WHY_NONE,
    Facts,
    facts_of_further,
    hidden_by_rounding,
)
from driftproof.symbolic.linear.a_stability import Angle
from driftproof.symbolic.linear.fact_values import ExactFunction, Formula, Sector, TruncatedSeries
from driftproof.symbolic.linear.facts import facts_by_name
from driftproof.symbolic.linear.invariants import QuadraticForm
from driftproof.symbolic.linear.phase import LeadingTerm
from driftproof.symbolic.linear.stability_limits import Infinity
from driftproof.texts.questions.answer import CERTIFIED, COUNTED, DERIVED, STATED, Answer
from driftproof.texts.questions.query_context import QueryContext
from driftproof.texts.questions.wording import COEFFICIENT
from driftproof.texts.writing.facts import fact_tex, fact_text
from driftproof.texts.writing.records import parts

FACT_NAMES = tuple(dict.fromkeys((*FACTS, *ON_REQUEST, *OTHER_FACTS)))
# Fact -> its evidence: counted, or stated by the source; all others are derived.
_EVIDENCE = {"stages": COUNTED} | dict.fromkeys(("method", "title", "family", "source", "claimed_order"), STATED)
_AS_ROUNDED = "with the coefficients as rounded"
# Leading terms that are answered with their power of h; for others the coefficient alone is the answer.
WITH_POWER = ("dispersion", "dissipation")


def fact(context: QueryContext) -> Answer:
    """Answers `FACT METHOD [at VALUE] [h=1/4] [: PART]`. Raises QuestionError if the method has no such fact."""
    name, subject = context.head, context.subject()
    with context.refused():
        if isinstance(subject, Family | FurtherMethod):
            known = facts_of_further(subject, (name,))
        else:
            facts = Facts(subject)
            known = facts_by_name(facts, (name,), (*FACTS, *ON_REQUEST)) | hidden_by_rounding(facts, (name,))
        found, within = known.pop(name), next(iter(known), None)
        if found is None:
            why = f": {WHY_NONE[name]}" if name in WHY_NONE else ""
            raise ValueError(f"{subject.key} has no {name}{why}")
        if isinstance(found, QuadraticForm) and context.query.readout is None:
            return _quadratic(context, found)
        answer = _answer(context, *_part(context, found, subject.key))
        touched = isinstance(found, bool) or any(name in names for names in BUT_FOR_ROUNDING.values())
        # Its file may not say that it is rounded.
        if within is None and not (touched and not isinstance(subject, Family) and subject.decimal):
            return answer
        more = f"; {within} ignores the rounding" if within else ""
        return replace(answer, remark=f"{_AS_ROUNDED}{more}")


def coefficient(context: QueryContext) -> Answer:
    """Answers `a21 METHOD`, `b1 METHOD`, `bhat1 METHOD` and `c2 METHOD`: an entry of a tableau."""
    context.require_only()
    method, named = context.method(), COEFFICIENT.fullmatch(context.head)
    assert named is not None
    with context.refused():
        if not isinstance(method, RungeKutta):
            raise ValueError(f"{method.key} has no tableau of numbers; only Runge-Kutta methods do")
        row: Any = method.a if named["a"] else {"b": method.b, "c": method.c, "bhat": method.b_embedded}[named["row"]]
        numbers = [int(digits) for digits in named.groups()[1:] if digits and digits.isdigit()]
        if row is None or max(numbers) > method.stages:
            raise ValueError(f"{method.key} has no {context.head}")
        for number in numbers:
            row = row[number - 1]
        return _exact_answer(row)


def _part(context: QueryContext, found: Any, key: str) -> tuple[str, Any]:
    """The name and the value of the part that the readout names, else of the whole fact."""
    name, token = context.head, context.query.readout
    if name == "one_step_matrix":
        entries = (ExactFunction(entry, "h") for row in found for entry in row)
        return name, context.readout(dict(zip(("M_qq", "M_qv", "M_vq", "M_vv"), entries, strict=True)))
    if isinstance(found, Sector):
        return name, context.readout(parts(found) or {})
    for part in token.text.split(".") if token else ():
        known = parts(found)
        if known is None or part not in known:
            has = f"its parts are {', '.join(known)}" if known else "it has no parts"
            raise context.error(token, f"{part[:40]!r} is not a part of {name} of {key}; {has}")
        found, name = known[part], part
    if isinstance(found, LeadingTerm) and name in WITH_POWER:
        return name, ExactFunction(fraction(polynomial([*found.power * [0], found.coefficient])), "h")
    return name, found.coefficient if isinstance(found, LeadingTerm) else found


def _answer(context: QueryContext, name: str, found: Any) -> Answer:
    """The answer for a part of a fact: a number, a formula or words; a function is evaluated if its variable is set."""
    function = found.function if isinstance(found, Formula) else found
    if isinstance(function, ExactFunction):
        context.require_only(function.variable, parts=("readout",))
        found = _at_setting(context, function)
    else:
        context.require_only(parts=("readout",))
    number = of_number(found)
    if number is not None:
        return replace(number, evidence=_EVIDENCE[name]) if name in _EVIDENCE else number
    if isinstance(found, Formula):
        return Answer("", None, form=found.text)
    if isinstance(found, TruncatedSeries):
        return Answer("", None, form=polynomial_text(polynomial(found.coefficients), found.variable))
    return Answer("", None, _EVIDENCE.get(name, DERIVED), form=fact_text(found), words=fact_tex(found))


def _at_setting(context: QueryContext, f: ExactFunction) -> Any:
    """The value of f if its variable is set or f is constant, else f as a formula. Raises ValueError at a pole."""
    number = context.query.settings.get(f.variable)
    if number is None and (f.f.num.degree() > 0 or f.f.den.degree() > 0):
        return Formula(str(f))
    try:
        return f(Fraction(0) if number is None else number.value)
    except ZeroDivisionError:
        raise ValueError(f"{context.head} has a pole at {f.variable} = {number and number.value}") from None


def _quadratic(context: QueryContext, form: QuadraticForm) -> Answer:
    """The conserved quadratic as a formula in h, q and v, or its value for the given h and state."""
    context.require_only("h", parts=("start",))
    h, polynomials = context.query.settings.get("h"), form.coefficients
    if h is not None:
        polynomials = tuple(polynomial([exact(evaluate(p, scalar(h.value)))]) for p in polynomials)
    if context.query.start is None:
        terms = zip(polynomials, ("q**2", "q*v", "v**2"), strict=True)
        return Answer("", None, form=sum_text(_times(p, monomial) for p, monomial in terms if p != 0))
    if h is None:
        raise ValueError("the value of the invariant at a state needs h, as in h=1/2 from 1,0")
    q, v = context.start
    monomials = (q * q, q * v, v * v)
    found = sum(exact(p[0]) * x for p, x in zip(polynomials, monomials, strict=True))
    return _exact_answer(found)


def _times(p: Polynomial, monomial: str) -> str:
    """The nonzero p(h) times a monomial in SymPy's syntax; a single term as in -h*q*v/2."""
    terms = [(k, c) for k, c in enumerate(coefficients(p)) if c]
    if len(terms) > 1:
        return f"({polynomial_text(p, 'h')})*{monomial}"
    [(k, c)] = terms
    power = "" if k == 0 else "h*" if k == 1 else f"h**{k}*"
    return polynomial_text(polynomial([0, c]), power + monomial)


def of_number(x: Any) -> Answer | None:
    """The answer for any type of number in facts, with radicals if there are some; for oo, a form; None for others."""
    if isinstance(x, Infinity):
        return Answer("", None, form="oo")
    if isinstance(x, Angle):
        return Answer("", x.exact, CERTIFIED if callable(x.exact) else DERIVED, "degrees")
    if isinstance(x, RealRoot) and x.rational is None:
        form = radical_form(x)
        # A root of degree 2 is given in its quadratic field, so that arithmetic with it stays exact.
        return Answer("", parse_number(form, "root") if form and len(x.minimal) == 3 else x.ball, form=form)
    if isinstance(x, RealRoot):
        return Answer("", x.rational)
    return _exact_answer(x) if isinstance(x, int | Fraction | Algebraic) and not isinstance(x, bool) else None


def _exact_answer(x: int | Exact) -> Answer:
    return Answer("", Fraction(x) if isinstance(x, int | Fraction) else x.as_fraction() if x.is_rational else x)
