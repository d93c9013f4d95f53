"""What the peers answer for every tableau of the catalogue, and where they differ from us.

Orders, stability properties and limits of NodePy, kauri and RKkit, each of its own object for our tableau, and what
they say of some methods of their own. `docs/peers.json` keeps it, and `docs/differences.md` shows it.
"""

from __future__ import annotations

import json
import math
import signal
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any

from benchmarks.harness import quiet
from benchmarks.peers import installed, kauri_method, nodepy_method, rkkit_method
from driftproof.methods.catalogue import METHODS
from driftproof.methods.schemes import RungeKutta
from driftproof.reports.fact_sheet import facts

# Seconds after which a question counts as not answered: far more than any takes that is put.
PATIENCE = 60.0
# Floats agree with ours if they are this close, relatively.
CLOSE = 1e-6
# What is asked of methods with at most so many stages, because it takes minutes of larger ones: RKkit's order, which
# visits every assignment of stages to vertices, its other facts, and NodePy's stability intervals.
RKKIT_ORDER, RKKIT, NODEPY_LIMITS = 3, 10, 13

Question = Callable[[RungeKutta], Any]


@dataclass
class Comparison:
    """Of one fact: how many methods both answered, where they differ and what the peer said, and where it is silent."""

    agree: int = 0
    differs: dict[str, str] = field(default_factory=dict)
    silent: dict[str, str] = field(default_factory=dict)


def tableaux() -> list[RungeKutta]:
    """The methods that peers can be handed."""
    return [method for method in METHODS.values() if isinstance(method, RungeKutta)]


def at_most(stages: int, question: Question, *, explicit: bool = False) -> Question:
    """The question, put to methods with at most so many stages, and perhaps to explicit ones only; else None."""
    return lambda method: question(method) if method.stages <= stages and method.explicit >= explicit else None


def of_pairs(question: Question) -> Question:
    """The question, put to methods with a second row; None to others."""
    return lambda method: None if method.b_embedded is None else question(method)


def nodepy(ask: str, **how: bool) -> Question:
    """What this method of NodePy's own object answers."""
    return lambda method: getattr(nodepy_method(method, **how), ask)()


def rkkit(ask: str, stages: int = RKKIT) -> Question:
    """What this method of RKkit's own object answers."""
    return at_most(stages, lambda method: getattr(rkkit_method(method), ask)())


# Facts by our names; None means that the question is not put.
QUESTIONS: dict[str, dict[str, Question]] = {
    "nodepy": {
        "order": nodepy("order", exact=False),
        "embedded_order": of_pairs(nodepy("order", embedded=True, exact=False)),
        "stage_order": nodepy("stage_order", exact=False),
        "algebraically_stable": nodepy("is_algebraically_stable", exact=False),
        "ssp_coefficient": nodepy("absolute_monotonicity_radius", exact=False),
        "real_limit": at_most(NODEPY_LIMITS, nodepy("real_stability_interval"), explicit=True),
        "imaginary_limit": at_most(NODEPY_LIMITS, nodepy("imaginary_stability_interval"), explicit=True),
    },
    "kauri": {
        "order": lambda m: kauri_method(m).order(),
        "embedded_order": of_pairs(lambda m: kauri_method(m, embedded=True).order()),
    },
    "RKkit": {
        "order": rkkit("order", RKKIT_ORDER),
        "a_stable": rkkit("is_A_stable"),
        "l_stable": rkkit("is_L_stable"),
        "algebraically_stable": rkkit("is_algebraically_stable"),
        "symmetric": rkkit("is_Symmetric"),
        "symplectic": rkkit("is_Symplectic"),
        # Its limit is the point on the axis, not the length.
        "real_limit": at_most(RKKIT, lambda m: -float(rkkit_method(m).stability_on_real_negative_axis())),
    },
}


# What peers say of methods that they make themselves, as Python of theirs.
OWN_METHODS = {
    "nodepy": (
        "rk.RKC1(10).real_stability_interval()",
        "rk.SSPRK2(40).real_stability_interval(mode='float')",
        "rk.SSPRK2(40).absolute_monotonicity_radius()",
    ),
    "RKkit": (
        "SDIRK3().Title",
        "RKformula(SDIRK3()).order()",
        "SDIRK5().Title",
        "RKformula(SDIRK5()).check_order_using_rooted_trees(4)",
        "RKformula(SDIRK5()).check_order_using_rooted_trees(5)",
        "RKformula(Radau5()).is_algebraically_stable()",
    ),
}


def names_of(peer: str) -> dict[str, Any]:
    """The names that its expressions use."""
    if peer == "nodepy":
        from nodepy import rk

        return {"rk": rk}
    rkkit_method(METHODS["rk4"])  # type: ignore[arg-type]  # loads Sage in the order that it needs
    from RKkit.formulas import SDIRK3, SDIRK5, Radau5
    from RKkit.RKformula import RKformula

    return {"SDIRK3": SDIRK3, "SDIRK5": SDIRK5, "Radau5": Radau5, "RKformula": RKformula}


class NoAnswer(Exception):
    """The time is up."""


@contextmanager
def patience(seconds: float) -> Iterator[None]:
    """Raise NoAnswer if the block takes longer; needs a system with interval timers."""

    def stop(*_: object) -> None:
        raise NoAnswer(f"no answer within {seconds:g} s")

    before = signal.signal(signal.SIGALRM, stop)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)


def answered(question: Callable[[], Any]) -> tuple[Any, str]:
    """The answer and "", or None and why there is none."""
    try:
        with quiet(), patience(PATIENCE):
            return question(), ""
    except NoAnswer as late:
        return None, str(late)
    except Exception as error:  # whatever a peer may raise is its answer
        return None, type(error).__name__


def shown(value: Any) -> str:
    """A property as yes or no, a count as it is, a real number to six digits."""
    if isinstance(value, str):
        return value
    if str(value) in ("True", "False"):
        return "yes" if value else "no"
    number = float(value)
    return f"{number:.6g}"


def ours(method: RungeKutta, fact: str) -> str:
    """Our answer in that form."""
    value = facts(method, only=[fact]).data[fact]
    if isinstance(value, dict):  # a limit that is neither "0" nor "oo"
        return shown(float(value["decimal"]))
    if value == "oo":
        return shown(math.inf)
    return "yes" if value is True else "no" if value is False else str(value)


def same(theirs: str, mine: str) -> bool:
    """Equal, or equal as reals up to what floats can do."""
    try:
        return math.isclose(float(theirs), float(mine), rel_tol=CLOSE)
    except ValueError:
        return theirs == mine


def compared(fact: str, question: Question) -> Comparison:
    """The fact of every tableau of the catalogue."""
    found = Comparison()
    for method in tableaux():
        theirs, reason = answered(lambda method=method: question(method))
        if reason or theirs == "Unknown":
            found.silent[method.key] = reason or theirs
        elif theirs is not None:
            mine, said = ours(method, fact), shown(theirs)
            if same(said, mine):
                found.agree += 1
            else:
                found.differs[method.key] = said
    return found


def answers() -> dict[str, Any]:
    """Of every peer that is installed: its version, its answers, and those for methods of its own."""
    return {peer: _of_peer(peer, version) for peer, version in installed().items()}


def _of_peer(peer: str, version: str) -> dict[str, Any]:
    facts = {fact: vars(compared(fact, question)) for fact, question in QUESTIONS[peer].items()}
    own: dict[str, str] = {}
    for expression in OWN_METHODS.get(peer, ()):
        value, reason = answered(lambda expression=expression: eval(expression, names_of(peer)))
        own[expression] = reason or shown(value)
    return {"version": version, "facts": facts, "own": own}


def as_json(found: Mapping[str, Any]) -> str:
    """Sorted, byte-stable."""
    return json.dumps(found, indent=1, sort_keys=True, ensure_ascii=False) + "\n"
