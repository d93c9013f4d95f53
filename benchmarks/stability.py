"""Stability functions, limits and properties, beside NodePy and RKkit: python benchmarks/stability.py

Ours is exact; NodePy's R(z) is exact for rational tableaux, its stability intervals and SSP coefficients are floats;
RKkit works with real algebraic numbers. A peer is handed its method as its own object, made before the clock starts,
but RKkit keeps what a method has answered, so that its object is made anew in every call.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).parents[1]))  # the checkout's own packages, whatever else is installed

from flint import fmpq_poly

from benchmarks.peers import (
    installed,
    nodepy_method,
    rational_function,
    read_nodepy,
    read_rkkit,
    rkkit_method,
    six_digits,
)
from benchmarks.timing import Contestant, Row, Subject, cold_and_warm, measure, print_measured, with_peers
from driftproof.methods.catalogue import METHODS
from driftproof.symbolic.algebra.radicals import decimal
from driftproof.symbolic.linear.implicit_stability import a_stability, l_stability
from driftproof.symbolic.linear.limits import imaginary_limit, real_limit
from driftproof.symbolic.linear.monotonicity import ssp_coefficient
from driftproof.symbolic.linear.oscillator import stability_function_of
from driftproof.symbolic.linear.stability_function import stability_function, stability_function_of_collocation
from driftproof.symbolic.trees.quadratic import algebraic_stability

# Any: the catalogue holds methods of every family under its keys.
METHOD: dict[str, Any] = {**METHODS}


def r_of(key: str) -> dict[str, Contestant]:
    """R(z), by the method's tableau or by its nodes."""
    method = METHOD[key]
    if hasattr(method, "node_polynomial"):
        return cold_and_warm(lambda: stability_function_of_collocation(method.node_polynomial), read_r)
    return cold_and_warm(lambda: stability_function(method), read_r)


def read_r(r: Any) -> str:
    """Ours as the peers' are read; over a number field as it prints."""
    return rational_function(r.num.coeffs(), r.den.coeffs()) if isinstance(r.num, fmpq_poly) else str(r)


def limits_of(key: str) -> Callable[[], Any]:
    """Both limits, with R."""

    def task() -> Any:
        r = stability_function_of(METHOD[key])
        return real_limit(r), imaginary_limit(r)

    return task


def read_limits(limits: Any) -> str:
    """Both to six digits."""
    return ", ".join(f"{float(decimal(limit, 8)):.6g}" for limit in limits)


def nodepy_tasks() -> dict[str, dict[str, Contestant]]:
    """Its stability functions, intervals, SSP coefficient and algebraic stability."""

    def intervals(key: str) -> Contestant:
        method = nodepy_method(METHOD[key])
        task = lambda: (method.real_stability_interval(), method.imaginary_stability_interval())
        return Contestant(task, lambda found: ", ".join(f"{float(x):.6g}" for x in found))

    found = {
        f"R(z) of {key}": {"nodepy": Contestant(nodepy_method(METHOD[key]).stability_function, read_nodepy)}
        for key in ("rk4", "fehlberg78", "dop853")
    }
    found |= {f"both limits of {key}, with R": {"nodepy": intervals(key)} for key in ("rk4", "dop853")}
    ssp, radau = nodepy_method(METHOD["ssprk104"]), nodepy_method(METHOD["radau_iia3"])
    found["SSP coefficient of ssprk104"] = {"nodepy": Contestant(ssp.absolute_monotonicity_radius, six_digits())}
    found["algebraic stability of radau_iia3"] = {"nodepy, floats": Contestant(radau.is_algebraically_stable)}
    return found


def rkkit_tasks() -> dict[str, dict[str, Contestant]]:
    """Its stability functions and properties."""
    asked = {
        "R(z) of rk4": ("rk4", lambda made: made.stability_function(), read_rkkit),
        "R(z) of fehlberg78": ("fehlberg78", lambda made: made.stability_function(), read_rkkit),
        "A- and L-stability of radau_iia3": ("radau_iia3", lambda made: (made.is_A_stable(), made.is_L_stable()), str),
        "algebraic stability of radau_iia3": ("radau_iia3", lambda made: made.is_algebraically_stable(), str),
    }
    return {
        name: {"RKkit": Contestant(lambda key=key, ask=ask: ask(rkkit_method(METHOD[key])), read)}
        for name, (key, ask, read) in asked.items()
    }


TASKS = {"nodepy": nodepy_tasks, "RKkit": rkkit_tasks}


def properties(key: str) -> dict[str, Contestant]:
    """A- and L-stability, with R."""

    def task() -> Any:
        r = stability_function_of(METHOD[key])
        return bool(a_stability(r)), bool(l_stability(r))

    return cold_and_warm(task)


def subjects() -> list[Subject]:
    """The questions, each with ours and with the peers that are installed; goals in ms."""
    goals = {"rk4": 0.1, "fehlberg78": 2, "gauss5": 1}
    found = [
        Subject(f"R(z) of {key}", r_of(key), goals.get(key))
        for key in ("rk4", "fehlberg78", "dop853", "gauss2", "gauss5")
    ]
    found += [
        Subject(f"both limits of {key}, with R", cold_and_warm(limits_of(key), read_limits))
        for key in ("rk4", "dop853")
    ]
    radau, ssp = METHOD["radau_iia3"], METHOD["ssprk104"]
    found += [Subject(f"A- and L-stability of {key}", properties(key)) for key in ("radau_iia3", "gauss10")]
    found.append(Subject("algebraic stability of radau_iia3", cold_and_warm(lambda: algebraic_stability(radau).holds)))
    read = six_digits(lambda limit: decimal(limit, 8))
    found.append(Subject("SSP coefficient of ssprk104", cold_and_warm(lambda: ssp_coefficient(ssp), read)))
    return with_peers(found, (tasks() for name, tasks in TASKS.items() if name in installed()))


def rows(rounds: int) -> list[Row]:
    """All subjects, measured."""
    return measure(subjects(), rounds)


def main(arguments: Sequence[str] | None = None) -> None:
    """Measure and print."""
    print_measured(arguments, __doc__, rows)


if __name__ == "__main__":
    main()
