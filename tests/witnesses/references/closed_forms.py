"""The solutions that have closed forms, as Arb balls at the current precision: state(t) of each problem, by its key."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction

from flint import acb, arb, ctx, fmpq

State = Callable[[Fraction], list[arb]]


def ball(x: Fraction | int) -> arb:
    return arb(fmpq(x.numerator, x.denominator))


def exponential(rate: int) -> State:
    return lambda t: [ball(rate * t).exp()]


def oscillation(omega: int) -> State:
    return lambda t: [ball(omega * t).cos(), -omega * ball(omega * t).sin()]


def separated(t: Fraction) -> list[arb]:
    slow, fast = oscillation(1)(t), [x / 1024 for x in oscillation(1000)(t)]
    return [slow[0] + fast[0], slow[0] - fast[0], slow[1] + fast[1], slow[1] - fast[1]]


def stiff_pair(t: Fraction) -> list[arb]:
    slow, fast = ball(-t).exp(), ball(-1000 * t).exp()
    return [2 * slow - fast, fast - slow]


def overdamped(t: Fraction) -> list[arb]:
    slow, fast = ball(-t).exp() / 99, ball(-100 * t).exp() / 99
    return [100 * slow - fast, 100 * fast - 100 * slow]


def critically_damped(t: Fraction) -> list[arb]:
    return [ball(1 + t) * ball(-t).exp(), ball(-t) * ball(-t).exp()]


def heat(points: int) -> State:
    """Σₖ cₖ exp(λₖ t) sin(kπx), λₖ = -4(n + 1)² sin²(kπ/(2(n + 1))), cₖ = 2/(n + 1) Σᵢ u(xᵢ, 0) sin(kπxᵢ)."""
    parts = points + 1
    inner = range(1, parts)

    def state(t: Fraction) -> list[arb]:
        total = [arb(0)] * points
        for k in inner:
            wave = [arb.sin_pi_fmpq(fmpq(k * i, parts)) for i in inner]
            start = (ball(4 * Fraction(i, parts) * (1 - Fraction(i, parts))) for i in inner)
            weight = sum((u * w for u, w in zip(start, wave, strict=True)), arb(0)) * 2 / parts
            rate = -4 * parts**2 * arb.sin_pi_fmpq(fmpq(k, 2 * parts)) ** 2
            size = weight * (rate * ball(t)).exp()
            total = [u + size * w for u, w in zip(total, wave, strict=True)]
        return total

    return state


def kaps(t: Fraction) -> list[arb]:
    return [ball(-2 * t).exp(), ball(-t).exp()]


def cosine(t: Fraction) -> list[arb]:
    return [ball(t).cos()]


def kepler(eccentricity: Fraction) -> State:
    """From the pericentre (1 - e, 0) with velocity (0, 1 + e) about the mass 1 - e²: the semi-major axis is 1."""

    def state(t: Fraction) -> list[arb]:
        motion = ball(1 - eccentricity**2).sqrt()
        angle = eccentric_anomaly(eccentricity, motion * ball(t))
        sine, cosine, speed = angle.sin(), angle.cos(), motion / (1 - ball(eccentricity) * angle.cos())
        return [cosine - ball(eccentricity), motion * sine, -speed * sine, speed * motion * cosine]

    return state


def eccentric_anomaly(eccentricity: Fraction, mean: arb) -> arb:
    """E with E - e sin E = M. The left side rises by 1 - e at least, which bounds the error by the residual."""
    e, angle = ball(eccentricity), mean.mid()
    for _ in range(20 + ctx.prec.bit_length()):
        angle = (angle - (angle - e * angle.sin() - mean) / (1 - e * angle.cos())).mid()
    residual = (angle - e * angle.sin() - mean) / ball(1 - eccentricity)
    return angle + arb(0, residual.abs_upper())


def pendulum(speed: Fraction) -> State:
    """From (0, v₀), v₀ < 2: sin(q/2) = k sn(t), q' = 2k cn(t), k = v₀/2, by theta functions (dlmf-2025, 22.2)."""

    def state(t: Fraction) -> list[arb]:
        modulus = acb(ball((speed / 2) ** 2))
        quarter = modulus.elliptic_k()
        tau = acb(0, 1) * (1 - modulus).elliptic_k() / quarter
        _, two, three, four = acb(0).modular_theta(tau)
        one_z, two_z, _, four_z = (acb(ball(t)) / (2 * quarter)).modular_theta(tau)
        sn = (three * one_z / (two * four_z)).real
        cn = (four * two_z / (two * four_z)).real
        return [2 * (ball(speed / 2) * sn).asin(), ball(speed) * cn]

    return state


CLOSED_FORMS: dict[str, State] = {
    "harmonic_oscillator": oscillation(1), "dahlquist_1": exponential(-1), "dahlquist_1e3": exponential(-1000),
    "dahlquist_1e6": exponential(-1000000), "stiff_oscillator": oscillation(1000), "separated_oscillators": separated,
    "stiff_pair": stiff_pair, "overdamped_oscillator": overdamped, "critically_damped_oscillator": critically_damped,
    "heat_equation": heat(15), "prothero_robinson": cosine, "kaps": kaps, "kepler": kepler(Fraction(3, 5)),
    "kepler_eccentric": kepler(Fraction(9, 10)), "kepler_extreme": kepler(Fraction(99, 100)),
    "pendulum": pendulum(Fraction(1)),
    "pendulum_near_separatrix": pendulum(2 - Fraction(1, 2**20)),
}  # fmt: skip
