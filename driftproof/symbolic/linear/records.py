"""Exact objects of this package as JSON-ready records: numbers are strings, polynomials lists, constant term first."""

from __future__ import annotations

from typing import Any, TypeAlias

from driftproof.symbolic.algebra.polynomials import coefficients, exact
from driftproof.symbolic.algebra.rational_functions import RationalFunction
from driftproof.symbolic.algebra.series import Series
from driftproof.symbolic.algebra.text import polynomial_text, rational_text
from driftproof.symbolic.linear.implicit_stability import Decision
from driftproof.symbolic.linear.invariants import ModifiedHamiltonian, Quadratic, definite_limit
from driftproof.symbolic.linear.limits import Limit, data, imaginary_margin
from driftproof.symbolic.linear.region import PLACES, rounded_boundary
from driftproof.symbolic.linear.sector import sector_degrees, tangent_data
from driftproof.symbolic.linear.sector_enclosure import EnclosedTangent

Json: TypeAlias = Any


def at_infinity(f: RationalFunction) -> str:
    """The limit of f as its variable grows; "oo" for a pole."""
    value = f.at_infinity()
    return "oo" if value is None else str(value)


def decision_record(found: Decision, r: RationalFunction) -> Json:
    """The decision with its reason; `margin`: |Q(iy)|² - |P(iy)|², ascending in y²."""
    witness = None if found.witness is None else str(found.witness)
    margin = [str(c) for c in coefficients(imaginary_margin(r))]
    return {"holds": found.holds, "reason": found.reason, "witness": witness, "margin": margin}


def sector_record(tangent: Limit | EnclosedTangent) -> Json:
    """The sector of A(α)-stability: tan α, and α in degrees."""
    return {"tan": tangent_data(tangent), "degrees": sector_degrees(tangent)}


def quadratic_record(form: Quadratic) -> Json:
    """The coefficients of q², qv and v², polynomials in h."""
    names = ("q2", "qv", "v2")
    return {name: polynomial_text(c, "h") for name, c in zip(names, form.coefficients, strict=True)}


def conserved_record(form: Quadratic) -> Json:
    """A conserved quadratic, and the largest H such that it is positive definite for h in (0, H)."""
    return {"quadratic": quadratic_record(form), "definite_limit": data(definite_limit(form))}


def hamiltonian_record(found: ModifiedHamiltonian, factor: Series | None) -> Json:
    """H̃ = factor*(q2 q² + qv qv + v2 v²), in the words of `ModifiedHamiltonian`; `factor` also as a series."""
    cosine = rational_text(found.cosine, "h")
    return {
        "factor": f"acos({cosine})/sqrt(1 - ({cosine})**2)",
        "quadratic": {name: rational_text(getattr(found, name), "h") for name in ("q2", "qv", "v2")},
        "valid_limit": data(found.limit),
        "factor_series": None if factor is None else series_record(factor),
    }


def series_record(series: Series) -> list[str]:
    """The coefficients."""
    return [str(exact(c)) for c in series]


def boundary_record(r: RationalFunction) -> Json:
    """Points of the upper half-plane, each within `radius` of a z with |R(z)| = 1 and Re R(z) = `cosine`."""
    names = ("cosine", "re", "im")
    points = [dict(zip(names, point, strict=True)) for point in rounded_boundary(r)]
    return {"radius": f"1e-{PLACES}", "points": points}
