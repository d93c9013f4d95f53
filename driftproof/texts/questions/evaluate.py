"""Answer questions such as value("step rk4 h=1/2 from 1,0 : q"); each kind of query imports only what it needs."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import replace
from difflib import SequenceMatcher
from fractions import Fraction
from functools import cache, lru_cache
from math import isqrt
from typing import TYPE_CHECKING

from driftproof.methods.formulas.expression_tree import (
    CallNode,
    ChainNode,
    NameNode,
    NegatedNode,
    NumberNode,
    PowerNode,
)
from driftproof.methods.schemes import MethodError
from driftproof.support.plain_text import counted, did_you_mean
from driftproof.texts.questions.answer import Answer, as_printed
from driftproof.texts.questions.errors import QuestionError, refused_at
from driftproof.texts.questions.parser import Node, Query, parse_question
from driftproof.texts.questions.pieces import parsed_spelling
from driftproof.texts.questions.query_context import QueryContext
from driftproof.texts.questions.wording import COEFFICIENT, LARGEST_STEP, names_that_ask

if TYPE_CHECKING:
    from driftproof.enclosure.problem_tables import ProblemTable
    from driftproof.enclosure.runs.multistep_runs import StartedMultistep
    from driftproof.methods.schemes import Method
    from driftproof.symbolic.algebra.certified import CertifiableReal

# What a step or a run may have besides its settings.
_PARTS = ("start", "readout", "unit", "problem", "started")


def value(question: str) -> Answer:
    """The answer to a question, as `driftproof value --help` teaches them; the id of a published value is one, too.

    Raises QuestionError, with one line and the column, for a question without an answer, and TypeError if it is not a
    string. No part of the question is evaluated as Python code.

    >>> from driftproof import value
    >>> value("step rk4 h=1/2 : q").exact
    Fraction(337, 384)
    """
    if not isinstance(question, str):
        raise TypeError(f"a question is a string, such as 'order rk4', not {question!r:.60}")
    try:
        answer = _answer(parse_question(question), question)
    except QuestionError as error:
        raise type(error)(question, _own_column(question, error.column), error.reason) from None
    if callable(answer.exact):
        from driftproof.symbolic.algebra.certified import EnclosedReal

        answer = replace(answer, exact=EnclosedReal(answer.exact))
    return replace(answer, question=question)


def _own_column(question: str, column: int) -> int:
    """The column of the question where this column of its parsed spelling comes from."""
    for kind, start, _, begin, end in SequenceMatcher(None, question, parsed_spelling(question), False).get_opcodes():
        if begin < column <= end:
            return start + 1 + (column - 1 - begin) * (kind == "equal")
    return len(question) + 1


def _answer(node: Node, question: str) -> Answer:
    from driftproof.texts.questions import arithmetic

    match node:
        case NumberNode():
            return Answer("", node.value)
        case NameNode():
            return _published(node, question)
        case Query():
            context = QueryContext(node, question)
            return _QUERY_KINDS.get(context.head, _fact)(context)
        case CallNode():
            return _call(node, question)
        case ChainNode():
            total = _answer(node.first, question)
            for sign, part in node.rest:
                other = _answer(part, question)
                with refused_at(question, sign.column):
                    total = arithmetic.applied(arithmetic.OPERATIONS[sign.text], total, other)
            return total
        case NegatedNode():
            return _computed(question, node.column, arithmetic.negate, node.node)
        case PowerNode():
            return _computed(question, node.column, lambda x: arithmetic.raised(x, node.exponent), node.base)


def _computed(question: str, column: int, operation: Callable[..., Answer], *parts: Node) -> Answer:
    from driftproof.texts.questions.arithmetic import applied

    operands = [_answer(part, question) for part in parts]
    with refused_at(question, column):
        return applied(operation, *operands)


def _published(node: NameNode, question: str) -> Answer:
    """The published value: its exact form, answered as a question, or else its decimal; or a constant such as pi."""
    from driftproof.texts.questions.arithmetic import CONSTANTS
    from driftproof.texts.values.published import published_values

    entries = published_values()
    if node.name in CONSTANTS:
        return CONSTANTS[node.name]
    if node.name not in entries:
        asks = f"; {node.name} needs a method, as in {node.name} rk4" if node.name in names_that_ask() else ""
        hint = f"{asks or did_you_mean(node.name, entries)} (`driftproof value --list` lists all)"
        raise QuestionError(question, node.column, f"{node.name[:60]!r} is not the id of a published value{hint}")
    entry = entries[node.name]
    if entry["exact"] is None:
        return as_printed(entry)
    return replace(value(entry["exact"]), form=entry["exact"], evidence=entry["evidence"])


def _call(node: CallNode, question: str) -> Answer:
    from driftproof.texts.questions.arithmetic import NUMBER_FUNCTIONS

    name = node.function
    if name not in NUMBER_FUNCTIONS:
        known = ", ".join(NUMBER_FUNCTIONS)
        raise QuestionError(question, node.column, f"{name[:40]!r} is not a function; the functions are {known}")
    function, count = NUMBER_FUNCTIONS[name]
    if len(node.arguments) != count:
        raise QuestionError(question, node.column, f"{name} takes {counted(count, 'number')}")
    return _computed(question, node.column, function, *node.arguments)


def _step(context: QueryContext) -> Answer:
    """Answers `step METHOD [problem=NAME | rates=(-y0) | lambda=-2] h=1/2 [N=3] [from q,v] : READOUT [UNIT]`."""
    context.require_only("h", "N", parts=_PARTS)
    counted = context.query.readout is not None and context.query.readout.text == "evaluations"
    h = Fraction(1) if counted and "h" not in context.query.settings else context.setting("h", "h=1/2")
    return _run_answer(context, h, h * (_whole_number(context) if "N" in context.query.settings else 1))


def _run(context: QueryContext) -> Answer:
    """Answers `run METHOD [problem=NAME | rates=(-y0) | lambda=-2] h=1/4 t=10 [from q,v] : READOUT [UNIT]`.

    The query gives two of h, t and N.
    """
    context.require_only("h", "t", "N", parts=_PARTS)
    given = {name: number.value for name, number in context.query.settings.items()}
    if len(given) != 2:
        lacks = {0: " h=0.1 t=1", 1: " h=0.1" if "N" in given else " N=10"}.get(len(given))
        raise context.error(None, f"run needs exactly two of h, t and N, as in h=1/4 t=10{context.ask_for(lacks)}")
    h = given["h"] if "h" in given else given["t"] / _whole_number(context)
    return _run_answer(context, h, given["t"] if "t" in given else h * _whole_number(context))


def _whole_number(context: QueryContext) -> int:
    n = context.query.settings["N"]
    if n.value.denominator != 1 or n.value < 1:
        raise QuestionError(context.text, n.column, "the number of steps must be a whole number, at least 1")
    return int(n.value)


def _run_answer(context: QueryContext, h: Fraction, t: Fraction) -> Answer:
    from driftproof.enclosure.runs.multistep_runs import StartedMultistep
    from driftproof.texts.questions.runs import UNITS, in_unit, run_of, run_readouts

    readout, unit = context.query.readout, context.query.unit
    if h == 0:
        raise context.error(None, "the step size h must not be 0")
    method = context.method_of_run()
    if isinstance(method, StartedMultistep) or context.about_problem is not None:
        return _problem_answer(context, method, h, t)
    if unit is not None and unit.text not in UNITS:
        raise context.error(unit, f"{unit.shown} is not a unit of angles; the units are {', '.join(UNITS)}")
    with context.refused():
        run = run_of(method, h, t, context.start)
    with context.refused(readout):
        found = context.readout(run_readouts(method))(run)
        return found if unit is None else in_unit(found, UNITS[unit.text])


def _problem_answer(
    context: QueryContext, method: Method | StartedMultistep | None, h: Fraction, t: Fraction
) -> Answer:
    """Answer for a problem by name, or for y' = f(t, y) with its rates written out."""
    from driftproof.texts.questions import kept_energies, problems

    query, named = context.query, context.about_problem
    if query.problem and query.rates:
        raise context.error(named, "problem and rates each define a problem; give only one of them")
    if query.unit is not None:
        raise context.error(query.unit, "readouts on a problem take no unit")
    with context.refused(named):
        problem = _problem(context)
        try:
            given = query.start or ()
            start: tuple[CertifiableReal, ...] = tuple(_entry(x) if isinstance(x, str) else x for x in given)
        except QuestionError as error:
            raise context.error(None, f"start {error.text}: {error.reason}") from None
        run = problems.problem_run(method, problem, start or None, h, t)
    with context.refused(query.readout):
        found = context.readout(problems.problem_readouts(run, problem.unknowns))(run)
    of_change = query.readout is not None and query.readout.text in kept_energies.CHANGES_OF_ENERGY
    return replace(found, remark=kept_energies.energy_remark(run)) if of_change else found


def _problem(context: QueryContext) -> ProblemTable:
    """The problem of a query: by name, by its rates or, if it gives none, the oscillator."""
    from driftproof.texts.questions.problems import problem_of_name

    query = context.query
    if query.problem:
        return problem_of_name(query.problem.text, {name: x.value for name, x in query.parameters.items()})
    if not query.rates:
        return problem_of_name("harmonic_oscillator", {})._replace(unknowns=("q", "v"))
    return _stated(tuple(x.text for x in query.rates), query.energy.text if query.energy else None, query.unknowns)


@lru_cache(maxsize=256)
def _stated(rates: tuple[str, ...], energy: str | None, unknowns: tuple[str, ...]) -> ProblemTable:
    """The problem of rates that are written out; hundreds of questions of a text are about the same."""
    from driftproof.enclosure.problem_tables import ProblemTable
    from driftproof.methods.formulas.field_text import field_of_text

    names = {name: f"y{i}" for i, name in enumerate(unknowns)}
    field = field_of_text(dict(zip(unknowns, rates, strict=True)) if unknowns else rates)
    if energy is None:
        return ProblemTable(field, (), None, unknowns)
    try:
        both = field_of_text([*rates, energy], names=names)
    except MethodError as error:
        said = str(error).replace(f"rate {len(rates)}", "energy").removesuffix(f", y{len(rates)}")
        raise MethodError(field.in_own_words(said)) from None
    return ProblemTable(replace(field, parameters=both.parameters), (), both.rates[-1], unknowns)


@cache
def _entry(text: str) -> CertifiableReal:
    """The number that an entry of a start spells; equal texts have the same, so that runs from it are known."""
    found = value(text).exact
    if found is None:
        raise ValueError(f"start: {text!r} is not a number")
    return found


def _exact(context: QueryContext) -> Answer:
    """Answers `exact t=10 [problem=NAME | rates=(-y0)] [from q,v] : READOUT`."""
    from driftproof.texts.questions.runs import EXACT_READOUTS

    context.require_only("t", parts=("start", "readout", "problem", "energy"))
    if other := context.query.subject or context.query.at:
        raise context.error(other, "exact takes no method, as in exact t=10 : q")
    if context.about_problem is not None:
        t = context.setting("t", "t=10")
        return _problem_answer(context, None, t, t)
    return context.readout(EXACT_READOUTS)(context.start, context.setting("t", "t=10"))


def limit_of_rates(rates: Mapping[str, str]) -> tuple[str, str] | None:
    """The limit and the size of y' = -size y or x'' = -size² x, None for other rates."""
    from driftproof.methods.formulas.field_text import rate_of_text
    from driftproof.methods.formulas.vector_fields import partial_derivative

    slopes = dict[tuple[str, str], Fraction]()
    with suppress(ValueError, LookupError, ZeroDivisionError):
        for of, rate in rates.items():
            for by in rates:
                slope = value(partial_derivative(rate_of_text(rate, {name: name for name in rates}), by)).exact
                slopes[of, by] = slope if isinstance(slope, Fraction) else Fraction(0) / 0
    names = [*rates]
    if len(names) == 1 and (c := slopes.get((names[0], names[0]), 0)) < 0:
        return "real_limit", str(-c)
    if len(names) == 2 and len(slopes) == 4 and not (slopes[names[0], names[0]] or slopes[names[1], names[1]]):
        square = -slopes[names[0], names[1]] * slopes[names[1], names[0]]
        root = Fraction(isqrt(square.numerator), isqrt(square.denominator)) if square > 0 else Fraction(0)
        return ("imaginary_limit", str(root) if root**2 == square else f"sqrt({square})") if square > 0 else None
    return None


def _largest_step(context: QueryContext) -> Answer:
    """Answers `largest stable step METHOD y'=-25y`: the limit of the method on an axis over the size of the problem."""
    from driftproof.texts.questions.arithmetic import OPERATIONS, applied

    context.require_only(parts=("problem", "start"))
    query = context.query
    found = limit_of_rates(dict(zip(query.unknowns, (rate.text for rate in query.rates), strict=True)))
    if found is None:
        said = "the largest stable step is known of y' = -cy and x'' = -cx; for others there is driftproof stability"
        raise context.error(context.about_problem, f"{said} mine.toml")
    of_method = replace(query, head=query.head._replace(text=found[0]), rates=(), start=None, unknowns=())
    limit = _fact(QueryContext(of_method, context.text))
    return applied(OPERATIONS["/"], limit, value(found[1])) if limit.is_number else limit


def _fact(context: QueryContext) -> Answer:
    from driftproof.texts.questions.facts import coefficient, fact

    return coefficient(context) if COEFFICIENT.fullmatch(context.head) else fact(context)


# Heads of queries that are not facts -> the function that answers them.
_QUERY_KINDS = {"step": _step, "run": _run, "exact": _exact, LARGEST_STEP: _largest_step}


def vocabulary() -> str:
    """A text with every name that a question may use: readouts, units, facts, functions, families and ids."""
    from driftproof.methods.families import FAMILIES
    from driftproof.texts.questions.arithmetic import CONSTANTS, NUMBER_FUNCTIONS
    from driftproof.texts.questions.facts import FACT_NAMES
    from driftproof.texts.questions.problems import PROBLEM_READOUTS
    from driftproof.texts.questions.runs import EXACT_READOUTS, RUN_READOUTS, UNITS
    from driftproof.texts.values.published import published_values

    parts = {
        "readouts of step and run": [*RUN_READOUTS, "k1.q", "k1.v", "..."],
        "readouts of exact": [*EXACT_READOUTS],
        "readouts on a problem, whose errors have no sign": [*PROBLEM_READOUTS],
        "units of phase_error": [*UNITS],
        "facts": [*FACT_NAMES],
        "functions and constants": [*NUMBER_FUNCTIONS, *CONSTANTS],
        "families, with at": [f"{key} ({family.parameter})" for key, family in FAMILIES.items()],
        "published values": [*published_values()],
    }
    lines = [f"{title}:\n  {', '.join(names)}" for title, names in parts.items()]
    return "\n".join([*lines, "methods:\n  `driftproof methods` lists them"])
