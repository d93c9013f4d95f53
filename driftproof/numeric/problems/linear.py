"""Linear problems y' = Ay with closed forms: oscillators, Dahlquist's equation, damping, heat conduction by lines."""

from __future__ import annotations

from fractions import Fraction

from driftproof.methods.formulas.vector_fields import VectorField
from driftproof.numeric.problems.problem import EXACT, Problem, reference

_Rows = tuple[tuple[Fraction, ...], ...]

DECAY = {
    "explicit": "decays while h < real_limit / |lambda|, lambda of largest modulus; beyond, it grows to overflow",
    "a_stable": "decays for every h > 0; each step multiplies by |R(h lambda)|, close to 1 for large h if |R(oo)| = 1",
    "l_stable": "decays for every h > 0; components much faster than h vanish in a step or two, because R tends to 0",
}
OSCILLATION = {
    "explicit": "bounded only while h omega is at most the method's imaginary limit, which is 0 for many methods",
    "a_stable": "bounded for every h > 0; a method with |R(iy)| < 1 damps a motion that the equation preserves",
    "l_stable": "bounded for every h > 0; but fast oscillations that h does not resolve are wrongly damped out",
    "symplectic": "bounded up to the method's limit, for every h if A-stable; the energy error does not grow",
}


def _matrix(rows: list[list[int | Fraction]]) -> _Rows:
    return tuple(tuple(Fraction(x) for x in row) for row in rows)


def _dahlquist(name: str, rate: int, shown: str, t: str) -> Problem:
    return Problem(
        key=f"dahlquist_{name}",
        title=f"Dahlquist's equation, y' = λ y, λ = {shown}, to t = {t}",
        field=VectorField(("rate * y0",), (("rate", Fraction(rate)),)),
        start=(Fraction(1),),
        reference=reference(f"dahlquist_{name}", EXACT, "y = exp(lambda t), in ball arithmetic"),
        source="hairer-wanner-1996, IV.2",
        stiff=rate != -1,
        matrix=((Fraction(rate),),),
        expected=DECAY,
    )


HARMONIC = Problem(
    key="harmonic_oscillator",
    title="The harmonic oscillator, q'' = -q, to t = 10",
    field=VectorField(("y1", "-y0")),
    start=(Fraction(1), Fraction(0)),
    reference=reference("harmonic_oscillator", EXACT, "(cos t, -sin t), in ball arithmetic"),
    source="hairer-lubich-wanner-2006, I.1.3",
    energy="(y0 * y0 + y1 * y1) / 2",
    second_order=True,
    matrix=_matrix([[0, 1], [-1, 0]]),
    expected=OSCILLATION,
)

STIFF_OSCILLATOR = Problem(
    key="stiff_oscillator",
    title="A stiff spring, q'' = -10⁶ q: 1592 revolutions to t = 10",
    field=VectorField(("y1", "-omega * omega * y0"), (("omega", Fraction(1000)),)),
    start=(Fraction(1), Fraction(0)),
    reference=reference("stiff_oscillator", EXACT, "(cos 1000t, -1000 sin 1000t), in ball arithmetic"),
    source="hairer-lubich-wanner-2006, I.1.3",
    energy="(y1 * y1 + omega * omega * y0 * y0) / 2",
    second_order=True,
    stiff=True,
    matrix=_matrix([[0, 1], [-1000000, 0]]),
    expected=OSCILLATION,
)

SEPARATED = Problem(
    key="separated_oscillators",
    title="Two unit masses on soft springs, joined by a stiff one: frequencies 1 and 1000, to t = 10",
    # To the walls 1, between the masses 999999/2, a binary64: the squares of the frequencies are 1 and 10^6.
    field=VectorField(("y2", "y3", "-y0 - k * (y0 - y1)", "-y1 + k * (y0 - y1)"), (("k", Fraction(999999, 2)),)),
    start=(Fraction(1025, 1024), Fraction(1023, 1024), Fraction(0), Fraction(0)),
    reference=reference(
        "separated_oscillators", EXACT, "q = cos t ± cos(1000t)/1024 and its derivative, in ball arithmetic"
    ),
    source="hairer-lubich-wanner-2006, XIII.1",
    energy="(y2 * y2 + y3 * y3 + y0 * y0 + y1 * y1 + k * (y0 - y1) * (y0 - y1)) / 2",
    second_order=True,
    stiff=True,
    matrix=_matrix(
        [
            [0, 0, 1, 0],
            [0, 0, 0, 1],
            [Fraction(-1000001, 2), Fraction(999999, 2), 0, 0],
            [Fraction(999999, 2), Fraction(-1000001, 2), 0, 0],
        ]
    ),
    expected=OSCILLATION,
)

STIFF_PAIR = Problem(
    key="stiff_pair",
    title="A stiff pair, eigenvalues -1 and -1000, to t = 1",
    field=VectorField(("998 * y0 + 1998 * y1", "-999 * y0 - 1999 * y1")),
    start=(Fraction(1), Fraction(0)),
    reference=reference("stiff_pair", EXACT, "(2 exp(-t) - exp(-1000t), exp(-1000t) - exp(-t)), in ball arithmetic"),
    source="press-2007, 17.5",
    stiff=True,
    matrix=_matrix([[998, 1998], [-999, -1999]]),
    expected=DECAY,
)

OVERDAMPED = Problem(
    key="overdamped_oscillator",
    title="An overdamped oscillator, q'' = -100 q - 101 q': eigenvalues -1 and -100, to t = 5",
    field=VectorField(("y1", "-100 * y0 - 101 * y1")),
    start=(Fraction(1), Fraction(0)),
    reference=reference(
        "overdamped_oscillator", EXACT, "q = (100 exp(-t) - exp(-100t))/99 and its derivative, in ball arithmetic"
    ),
    source="hairer-norsett-wanner-1993, I.6",
    stiff=True,
    matrix=_matrix([[0, 1], [-100, -101]]),
    expected=DECAY,
)

CRITICAL = Problem(
    key="critically_damped_oscillator",
    title="A critically damped oscillator, q'' = -q - 2q': one Jordan block, to t = 10",
    field=VectorField(("y1", "-y0 - 2 * y1")),
    start=(Fraction(1), Fraction(0)),
    reference=reference("critically_damped_oscillator", EXACT, "((1 + t) exp(-t), -t exp(-t)), in ball arithmetic"),
    source="hairer-norsett-wanner-1993, I.6",
    matrix=_matrix([[0, 1], [-1, -2]]),
    expected=DECAY,
)


def _heat(points: int) -> Problem:
    """u_t = u_xx on (0, 1), u = 0 at both ends, u(x, 0) = 4x(1 - x), by central differences at `points` points."""
    per_square, width = Fraction((points + 1) ** 2), range(points)
    beside = [[f"y{j}" for j in (i - 1, i + 1) if j in width] for i in width]
    rates = tuple(f"{per_square} * ({' + '.join(beside[i])} - 2 * y{i})" for i in width)
    nodes = [Fraction(i + 1, points + 1) for i in width]
    return Problem(
        key="heat_equation",
        title=f"Heat conduction by the method of lines, {points} points, to t = 1/2",
        field=VectorField(rates),
        start=tuple(4 * x * (1 - x) for x in nodes),
        reference=reference(
            "heat_equation", EXACT, "the sum over the discrete Laplacian's eigenvectors, in ball arithmetic"
        ),
        source="hairer-wanner-1996, IV.2",
        stiff=True,
        matrix=tuple(tuple(per_square * (-2 if i == j else 1 if abs(i - j) == 1 else 0) for j in width) for i in width),
        expected=DECAY,
    )


LINEAR_PROBLEMS = (
    HARMONIC,
    _dahlquist("1", -1, "-1", "10"),
    _dahlquist("1e3", -1000, "-10³", "1"),
    _dahlquist("1e6", -1000000, "-10⁶", "1"),
    *(STIFF_OSCILLATOR, SEPARATED, STIFF_PAIR, OVERDAMPED, CRITICAL),
    _heat(15),
)
