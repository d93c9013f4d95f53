"""Answers about rounding: the bound of one binary64 step, in units of u."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction

from driftproof.numeric.steppers import hand_written
from driftproof.symbolic.rounding.fixed_step_bound import fixed_step_bound
from driftproof.symbolic.rounding.formats import BINARY64
from driftproof.symbolic.rounding.n_steps_bound import largest_safe_state, run_bound, safe_state_text
from driftproof.symbolic.rounding.step_bound import LinearBound, StepOrMethod, step_bound
from driftproof.texts.questions.answer import Answer
from driftproof.texts.questions.query_context import START_AT_REST, QueryContext

_State = tuple[Fraction, Fraction]

BOUND_ENTRIES: dict[str, Callable[[LinearBound], Fraction]] = {
    "qq": lambda bound: bound.error[0][0],
    "qv": lambda bound: bound.error[0][1],
    "vq": lambda bound: bound.error[1][0],
    "vv": lambda bound: bound.error[1][1],
}
OF_STATE = {"q": 0, "v": 1}
GROWTH = "c"


def bound(context: QueryContext) -> Answer:
    """Answers `roundoff METHOD h=1/4 [sharp] [from q,v] : READOUT` with a number that bounds a rounding error, over u.

    qq, qv, vq and vv are the entries of E(h) in |dz| <= E(h)|z| + r(h); q and v are |dq| and |dv| from the start, r
    included; c is the growth per step in the step's own norm. h and the start are rounded to the nearest doubles. All
    of it holds for states from which nothing in the step overflows; a start that may overflow is refused.
    """
    context.demand_only("h", start=True, words=("sharp",), readout=True)
    h, method = context.setting("h", "h=1/4"), context.method()
    context.readout(dict.fromkeys((*BOUND_ENTRIES, *OF_STATE, GROWTH)))
    with context.refused():
        h = BINARY64.nearest(h)
        if h == 0:
            raise ValueError("a step of size 0 goes nowhere; give a nonzero h")
        subject: StepOrMethod = hand_written(method) or method
        start = BINARY64.nearest(context.start[0]), BINARY64.nearest(context.start[1])
        if max(map(abs, start)) > (safe := largest_safe_state(subject, h)):
            raise ValueError(
                f"the step may overflow from q = {float(start[0])!r}, v = {float(start[1])!r}, where no bound holds; "
                f"nothing overflows for |q|, |v| <= {safe_state_text(safe)}"
            )
        return Answer("", _bound(context, subject, h, start) / BINARY64.u, unit="u", is_bound=True)


def _bound(context: QueryContext, subject: StepOrMethod, h: Fraction, start: _State) -> Fraction:
    readout = context.query.readout.text if context.query.readout else ""
    if readout == GROWTH:
        return run_bound(subject, h, 1, START_AT_REST, BINARY64).growth
    sharp = "sharp" in context.query.words
    if readout in BOUND_ENTRIES:
        return BOUND_ENTRIES[readout](fixed_step_bound(subject, h).linear if sharp else step_bound(subject).at(h))
    of_state = fixed_step_bound(subject, h).error_of(*start) if sharp else step_bound(subject).error_of(h, *start)
    return of_state[OF_STATE[readout]]
