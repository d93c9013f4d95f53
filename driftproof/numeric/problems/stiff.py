"""Stiff problems: some with a smooth exact solution, reactions of chemistry, and relaxation oscillations."""

from __future__ import annotations

from fractions import Fraction

from driftproof.methods.formulas.vector_fields import VectorField
from driftproof.numeric.problems.problem import CERTIFIED, ENCLOSED, EXACT, Problem, reference

STIFF = {
    "explicit": "unstable, so overflows or fails, unless h times the largest rate is within the stability limit",
    "a_stable": "follows the smooth solution at any step that resolves it; transients decay slowly if |R(oo)| = 1",
    "l_stable": "follows the smooth solution at any step that resolves it; transients are gone after a step or two",
}

PROTHERO_ROBINSON = Problem(
    key="prothero_robinson",
    title="Prothero and Robinson's equation, y' = λ (y - cos t) - sin t, λ = -10⁶, to t = 10",
    field=VectorField(("rate * (y0 - cos(t)) - sin(t)",), (("rate", Fraction(-1000000)),)),
    start=(Fraction(1),),
    reference=reference("prothero_robinson", EXACT, "y = cos t, in ball arithmetic"),
    source="prothero-robinson-1974; hairer-wanner-1996, IV.15",
    stiff=True,
    expected={
        **STIFF,
        "a_stable": "order reduction: errors C h^k, k one more than the stage order, whatever the order of the method",
        "l_stable": "order reduction; if the last stage is the new value (Radau IIA), errors are C h^k / (h lambda)",
    },
)

KAPS = Problem(
    key="kaps",
    title="Kaps' problem, 1/ε = 10⁶, to t = 1",
    field=VectorField(
        ("-(stiffness + 2) * y0 + stiffness * y1 * y1", "y0 - y1 - y1 * y1"), (("stiffness", Fraction(1000000)),)
    ),
    start=(Fraction(1), Fraction(1)),
    reference=reference("kaps", EXACT, "(exp(-2t), exp(-t)) for every epsilon, in ball arithmetic"),
    source="dekker-verwer-1984, 5.5",
    stiff=True,
    expected={
        **STIFF,
        "a_stable": "follows the smooth solution, except Lobatto IIIB, whose errors grow with h/epsilon",
        "l_stable": "follows the smooth solution y0 = y1^2 at any step that resolves it, whatever epsilon",
    },
)

SLOW_THEN_FAST = {
    "explicit": "overflows unless h is at most the method's real limit divided by 3 mu^2, the largest rate",
    "a_stable": "y0 is right on a slow branch; y1 starts off it and oscillates about it for long if |R(oo)| = 1",
    "l_stable": "right on a slow branch, which ends at t = 0.807; a step over that jump fails or ends anywhere",
}


def _van_der_pol(name: str, mu: int, shown: str, in_print: str = "") -> Problem:
    """The oscillator in Liénard's time, t = physical time / mu: its period tends to 3 - 2 log 2, epsilon = 1/mu^2."""
    return Problem(
        key=f"van_der_pol_{name}",
        title=f"Van der Pol's oscillator, μ = {shown}, in the time t = physical time / μ, to t = 2",
        field=VectorField(("y1", "mu * mu * ((1 - y0 * y0) * y1 - y0)"), (("mu", Fraction(mu)),)),
        start=(Fraction(2), Fraction(0)),
        reference=reference(f"van_der_pol_{name}", CERTIFIED, ENCLOSED + in_print),
        source="hairer-wanner-1996, IV.1; mazzia-magherini-2008, vdpol",
        stiff=True,
        expected=SLOW_THEN_FAST,
    )


ROBERTSON = Problem(
    key="robertson",
    title="Robertson's reactions, rates from 0.04 to 3·10⁷, to t = 10¹¹",
    field=VectorField(
        ("-slow * y0 + fast * y1 * y2", "slow * y0 - fast * y1 * y2 - fastest * y1 * y1", "fastest * y1 * y1"),
        (("slow", Fraction(1, 25)), ("fast", Fraction(10**4)), ("fastest", Fraction(3 * 10**7))),
    ),
    start=(Fraction(1), Fraction(0), Fraction(0)),
    reference=reference("robertson", CERTIFIED, f"{ENCLOSED}; the published digits at t = 10¹¹ agree to 13 places"),
    source="robertson-1966; hairer-wanner-1996, IV.1 and IV.10; mazzia-magherini-2008, rober",
    stiff=True,
    expected={
        **STIFF,
        "a_stable": "right while h is small against t, and y0 + y1 + y2 = 1 up to rounding; a long first step fails",
        "l_stable": "as A-stable, but backward Euler can begin with a long step; once y1 < -y2/3000, all diverge",
    },
)

HIRES = Problem(
    key="hires",
    title="HIRES, light and the growth of plants in eight reactions, to t = 321.8122",
    field=VectorField(
        (
            "-k1 * y0 + k2 * y1 + k6 * y2 + supply",
            "k1 * y0 - (k2 + k3) * y1",
            "-(k6 + k1) * y2 + k2 * y3 + k5 * y4",
            "k3 * y1 + k1 * y2 - (k4 + k2) * y3",
            "-(k5 + k1) * y4 + k2 * (y5 + y6)",
            "-k_plus * y5 * y7 + k4 * y3 + k1 * y4 - k2 * y5 + k4 * y6",
            "k_plus * y5 * y7 - (k2 + k4 + k4) * y6",
            "(k2 + k4 + k4) * y6 - k_plus * y5 * y7",
        ),
        (
            *(("k1", Fraction(171, 100)), ("k2", Fraction(43, 100)), ("k3", Fraction(832, 100))),
            *(("k4", Fraction(69, 100)), ("k5", Fraction(35, 1000)), ("k6", Fraction(832, 100))),
            *(("k_plus", Fraction(280)), ("supply", Fraction(7, 10000))),
        ),
    ),
    start=(Fraction(1), *[Fraction(0)] * 6, Fraction(57, 10000)),
    reference=reference("hires", CERTIFIED, f"{ENCLOSED}; the published digits agree to 15 places or more"),
    source="schafer-1975; hairer-wanner-1996, IV.10; mazzia-magherini-2008, hires",
    stiff=True,
    expected={
        **STIFF,
        "explicit": "mildly stiff: right up to h = real_limit / 212, the largest rate; beyond, wrong before the end",
    },
)

OREGONATOR = Problem(
    key="oregonator",
    title="The Oregonator, a limit cycle of three reactions, to t = 360",
    field=VectorField(
        ("s * (y1 + y0 * (1 - q * y0 - y1))", "(y2 - (1 + y0) * y1) / s", "w * (y0 - y2)"),
        (("s", Fraction(7727, 100)), ("q", Fraction(8375, 10**9)), ("w", Fraction(161, 1000))),
    ),
    start=(Fraction(1), Fraction(2), Fraction(3)),
    reference=reference("oregonator", CERTIFIED, f"{ENCLOSED}; the published digits at t = 360 agree to 13 places"),
    source="field-noyes-1974; hairer-wanner-1996, IV.1 and IV.10; mazzia-magherini-2008, orego",
    stiff=True,
    expected={
        **STIFF,
        "a_stable": "right between the pulses, which come at t = 20 and 323; a step over a pulse fails or is wrong",
        "l_stable": "right between the pulses, which come at t = 20 and 323; a step over a pulse fails or is wrong",
    },
)

STIFF_PROBLEMS = (
    PROTHERO_ROBINSON,
    KAPS,
    _van_der_pol("1e3", 10**3, "10³", "; the published digits at t = 2 agree to 13 places"),
    _van_der_pol("1e4", 10**4, "10⁴"),
    _van_der_pol("1e5", 10**5, "10⁵"),
    _van_der_pol("1e6", 10**6, "10⁶"),
    *(ROBERTSON, HIRES, OREGONATOR),
)
