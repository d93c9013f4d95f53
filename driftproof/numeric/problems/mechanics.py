"""Problems of mechanics, q'' = F(q): planets near their sun, pendulums near the top, chains, chaos."""

from __future__ import annotations

from fractions import Fraction

from driftproof.methods.formulas.vector_fields import VectorField
from driftproof.numeric.problems.problem import CERTIFIED, ENCLOSED, EXACT, Problem, reference

CONSERVATIVE = {
    "explicit": "right at small steps; the energy drifts, more slowly the higher the order",
    "a_stable": "right at small steps; the energy drifts unless the method is symmetric or symplectic",
    "l_stable": "right at small steps; the energy drifts, in most cases downwards",
    "symplectic": "the energy error stays bounded over very long times if h resolves the motion",
}


def _kepler(name: str, eccentricity: Fraction, t: str, expected: dict[str, str]) -> Problem:
    """Kepler's problem, semi-major axis 1, mass 1 - e²: all data are rational, the period is 2 pi / sqrt(1 - e²)."""
    cubed = "((y0 * y0 + y1 * y1) * sqrt(y0 * y0 + y1 * y1))"
    return Problem(
        key=name,
        title=f"Kepler's problem, eccentricity {float(eccentricity):g}, from the pericentre to t = {t}",
        field=VectorField(
            ("y2", "y3", f"-mass * y0 / {cubed}", f"-mass * y1 / {cubed}"), (("mass", 1 - eccentricity**2),)
        ),
        start=(1 - eccentricity, Fraction(0), Fraction(0), 1 + eccentricity),
        reference=reference(name, EXACT, "the root of Kepler's equation, in ball arithmetic"),
        source="hairer-lubich-wanner-2006, I.2.2",
        energy="(y2 * y2 + y3 * y3) / 2 - mass / sqrt(y0 * y0 + y1 * y1)",
        second_order=True,
        expected={**CONSERVATIVE, **expected},
    )


NEAR_THE_SUN = {
    "explicit": "wrong from the start, which is the pericentre, unless h resolves it: the body is thrown far out",
    "symplectic": "energy error bounded if h resolves the pericentre; elsewhere on the orbit so small an h is wasted",
}


def _pendulum(name: str, title: str, speed: Fraction, expected: dict[str, str]) -> Problem:
    return Problem(
        key=name,
        title=title,
        field=VectorField(("y1", "-sin(y0)")),
        start=(Fraction(0), speed),
        reference=reference(name, EXACT, "sin(q/2) = k sn(t, k), q' = 2k cn(t, k), k = q'(0)/2, in ball arithmetic"),
        source="hairer-lubich-wanner-2006, I.1.3; dlmf-2025, 22.19(i)",
        energy="y1 * y1 / 2 - cos(y0)",
        second_order=True,
        expected={**CONSERVATIVE, **expected},
    )


NEAR_THE_TOP = {
    "explicit": "right at small steps; an energy gain above 2^-19 carries it over the top, and q grows for ever",
    "symplectic": "the energy error stays bounded, but one above 2^-19 carries the pendulum over the top",
    "l_stable": "right at small steps; it loses energy, so it turns back too far from the top",
}

HENON_HEILES = Problem(
    key="henon_heiles",
    title="Hénon and Heiles, two coupled oscillators at energy 1/8, to t = 100",
    field=VectorField(("y2", "y3", "-y0 - 2 * y0 * y1", "-y1 - y0 * y0 + y1 * y1")),
    start=(Fraction(0), Fraction(0), Fraction(3, 10), Fraction(2, 5)),
    reference=reference("henon_heiles", CERTIFIED, ENCLOSED),
    source="henon-heiles-1964; hairer-lubich-wanner-2006, I.3",
    energy="(y2 * y2 + y3 * y3 + y0 * y0 + y1 * y1) / 2 + y0 * y0 * y1 - y1 * y1 * y1 / 3",
    second_order=True,
    expected=CONSERVATIVE,
)


def _fermi_pasta_ulam() -> Problem:
    """Three stiff springs of frequency 50 among four soft ones: y0 to y2 their centres, y3 to y5 their elongations."""
    soft = ("(y0 - y3)", "(y1 - y4 - y0 - y3)", "(y2 - y5 - y1 - y4)", "(y2 + y5)")
    a, b, c, d = (f"{x} * {x} * {x}" for x in soft)
    forces = (f"{b} - {a}", f"{c} - {b}", f"-({c} + {d})", f"{a} + {b}", f"{b} + {c}", f"{c} - {d}")
    stiff = ("", "", "", *(f" - omega * omega * y{i}" for i in (3, 4, 5)))
    speeds = tuple(f"y{i}" for i in range(6, 12))
    quartic = " + ".join(f"{x} * {cube}" for x, cube in zip(soft, (a, b, c, d), strict=True))
    return Problem(
        key="fermi_pasta_ulam",
        title="Fermi, Pasta and Ulam's chain with three stiff springs, ω = 50, to t = 100",
        field=VectorField((*speeds, *(f + g for f, g in zip(forces, stiff, strict=True))), (("omega", Fraction(50)),)),
        start=tuple(Fraction(x) for x in (1, 0, 0, "1/50", 0, 0, 1, 0, 0, 1, 0, 0)),
        reference=reference("fermi_pasta_ulam", CERTIFIED, ENCLOSED),
        source="fermi-pasta-ulam-1955; hairer-lubich-wanner-2006, I.5.1",
        energy=f"({' + '.join(f'{v} * {v}' for v in speeds)}) / 2 + ({quartic}) / 4"
        " + omega * omega * (y3 * y3 + y4 * y4 + y5 * y5) / 2",
        second_order=True,
        stiff=True,
        expected={
            **CONSERVATIVE,
            "explicit": "bounded only while h omega is at most the method's imaginary limit, which is often 0",
            "symplectic": "energy and, resonances apart, spring energy stay bounded while h omega is within the limit",
        },
    )


MECHANICS_PROBLEMS = (
    _kepler("kepler", Fraction(3, 5), "20", {}),
    _kepler("kepler_eccentric", Fraction(9, 10), "30", NEAR_THE_SUN),
    _kepler("kepler_extreme", Fraction(99, 100), "90", NEAR_THE_SUN),
    _pendulum("pendulum", "A pendulum from the bottom with speed 1, to t = 20", Fraction(1), {}),
    _pendulum(
        "pendulum_near_separatrix",
        "A pendulum from the bottom with speed 2 - 2⁻²⁰: almost over the top, to t = 40",
        2 - Fraction(1, 2**20),
        NEAR_THE_TOP,
    ),
    HENON_HEILES,
    _fermi_pasta_ulam(),
)
