"""Questions with a head: a step, a run, the exact flow, a rounding bound, or a fact by its name."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction

from driftproof.texts.questions.answer import Answer
from driftproof.texts.questions.asking import HEADS, Asking
from driftproof.texts.questions.errors import QuestionError, refused_at
from driftproof.texts.questions.syntax import Asked


def answer(asked: Asked, question: str) -> Answer:
    """The answer to what is asked in the question. Raises QuestionError."""
    return _ANSWERS.get(asked.head.text, _fact)(Asking(asked, question))


def _exact(asking: Asking) -> Answer:
    """Answers `exact t=10 [from q,v] : READOUT`."""
    from driftproof.texts.questions.runs import EXACT_READOUTS, ExactFlow

    asking.demand_only("t", start=True, readout=True)
    if asking.asked.subject or asking.asked.at:
        other = asking.asked.subject or asking.asked.at
        raise asking.error(other, "the exact flow belongs to no method, as in exact t=10 : q")
    return asking.readout(EXACT_READOUTS)(ExactFlow(asking.setting("t", "t=10"), asking.start))


def _step(asking: Asking) -> Answer:
    """Answers `step METHOD h=1/2 [N=3] [from q,v] : READOUT [UNIT]`."""
    asking.demand_only("h", "N", start=True, readout=True, unit=True)
    h = asking.setting("h", "h=1/2")
    return _of_run(asking, h, h * (_whole_number(asking) if "N" in asking.asked.settings else 1))


def _run(asking: Asking) -> Answer:
    """Answers `run METHOD h=1/4 t=10 [from q,v] : READOUT [UNIT]`, with any two of h, t and N."""
    asking.demand_only("h", "t", "N", start=True, readout=True, unit=True)
    given = {name: number.value for name, number in asking.asked.settings.items()}
    if len(given) != 2:
        raise asking.error(None, "run needs two of h, t and N, as in h=1/4 t=10")
    if "N" not in given:
        return _of_run(asking, given["h"], given["t"])
    n = _whole_number(asking)
    return _of_run(asking, given["h"], given["h"] * n) if "h" in given else _of_run(asking, given["t"] / n, given["t"])


def _whole_number(asking: Asking) -> int:
    n = asking.asked.settings["N"]
    if n.value.denominator != 1 or n.value < 1:
        raise QuestionError(asking.text, n.column, "the number of steps is whole, and 1 at least")
    return int(n.value)


def _of_run(asking: Asking, h: Fraction, t: Fraction) -> Answer:
    from driftproof.texts.questions.runs import ANGLES, READOUTS, UNITS, in_unit, run_of, slope

    method, readout, unit = asking.method(), asking.asked.readout, asking.asked.unit
    if h == 0:
        raise QuestionError(asking.text, asking.asked.column, "a step of size 0 goes nowhere; give a nonzero h")
    if unit is not None and (readout is None or readout.text not in ANGLES):
        raise asking.error(unit, f"{unit.shown} has no place; only angles have units to choose")
    if unit is not None and unit.text not in UNITS:
        raise asking.error(unit, f"{unit.shown} is no unit of an angle; there are {', '.join(UNITS)}")
    with refused_at(asking.text, asking.asked.column):
        run = run_of(method, h, t, asking.start)
    with refused_at(asking.text, (readout or asking.asked.head).column):
        found = slope(run, readout.text) if readout else None
        if found is None:
            found = asking.readout(READOUTS, more=", k1.q, k1.v, ...")(run)
        return found if unit is None else in_unit(found, UNITS[unit.text])


def _roundoff(asking: Asking) -> Answer:
    from driftproof.texts.questions.bounds import bound

    return bound(asking)


def _fact(asking: Asking) -> Answer:
    from driftproof.texts.questions.facts import fact

    return fact(asking)


_ANSWERS: dict[str, Callable[[Asking], Answer]] = dict(zip(HEADS, (_step, _run, _exact, _roundoff), strict=True))
