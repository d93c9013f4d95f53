"""Steppers just within and just beyond what a check allows, by what they do: a check that allows more is noticed."""

from __future__ import annotations

from tests.blackbox.checks.habits import code, then

# What counts as rounding, relative to a state of ordinary size, in binary64.
ROUNDING = 2.0**-43
# Steps that are not very short are wrong by a factor.
_WRONG = "q, v = plain(q, v, h); k = 1 + ({}) * (h > 0.1); return q * k, v * k"


def calling(places):
    """Calls the force once in a short step, and in a long one at these places."""
    body = f"x = [force(at) for at in ({places} if h > 0.1 else [q])][-1]; return q + h * v, v + h * x"
    return code(body, "force, q, v, h")


def partly_back(share):
    """A step back is this share of the opposite of the step forth."""
    return code(f"a, b = plain(q, v, abs(h)); s = 1 if h >= 0 else -{share}; return q + s * (a - q), v + s * (b - v)")


def within_and_beyond(name, body, edge, within=0.9, beyond=1.1):
    """The stepper with `e` just below its edge, and just above."""
    factors = {"within": within, "beyond": beyond}
    return {f"{name}, {word}": code(f"e = {edge * factor!r}; {body}") for word, factor in factors.items()}


EDGES = {
    "back by 0.78": partly_back(0.78),
    "back by 0.7": partly_back(0.7),
    "back but never forth": code("return plain(q, v, h) if h < 0 else (q, v)"),
    "integers but at 0": code("return (1 / h, v) if h == 0 else tuple(map(int, plain(q, v, h)))"),
    "the time of the end": code("return y + h * f(t + h, y)", "f, t, y, h"),
    "two wrong times": code("return y + h * (f(0.0, y) + f(20.0, y)) / 2", "f, t, y, h"),
    "a time and a force": code("v = v + h * force(q); return q + h * v, v", "force, t, q, v, h"),
    **within_and_beyond("nothing but rounding at h = 0", "return plain(q * (1 + e * (h == 0)), v, h)", ROUNDING),
    # The parts of a step that three times the state has otherwise: 0.0888 of the larger error, at a larger size.
    **within_and_beyond(
        "18 bits",
        "return q + h * v * (1 + max(e * (abs(q) > 1e-9), e / 2 * (abs(q) > 1e-18))), v - h * q",
        2.0**-18 / 0.0888,
    ),
    **within_and_beyond(
        "43 bits",
        "return q + h * v * (1 + max(e * (abs(q) > 1e-9), e / 2 * (abs(q) > 1e-18))), v - h * q",
        ROUNDING / 0.0888,
    ),
    **within_and_beyond("a power near 2", "k = 1 + 1e-3 * abs(h) ** (2 + e); return q * k, v * k", 0.125),
    "a defect at two steps": code("k = 1 + 1e-10 * h ** 8; return q * k, v * k"),
    "a defect at one step": code("k = 1 + 1e-12 * h ** 8; return q * k, v * k"),
    **within_and_beyond("a matrix with a large entry", "return q + 1000 * h * v, v * (1 + e)", 250.0**2 * ROUNDING),
    **within_and_beyond("a spread", "return q * (1 + e), v * (1 - e)", ROUNDING / 2),
    **within_and_beyond("a factor", "return q * (1 + e), v * (1 + e)", ROUNDING / 2),
    **within_and_beyond("a bent position", "a, b = plain(q, v, h); return a * (1 + e * (q * v != 0)), b", ROUNDING),
    # There h q is taken from v: the sum of both is 1.97 times their difference.
    **within_and_beyond(
        "a bent velocity", "a, b = plain(q, v, h); return a, b * (1 + e * (q * v != 0))", 1.966 * ROUNDING
    ),
    **within_and_beyond(
        "an area by differences", "return q, v * (1 + e) if q > 0.5 else 2 * v", 64 * 2.0**-34, 127 / 128, 129 / 128
    ),
    # Six calls in two groups of three are an iteration's; five are not, nor six that are farther apart.
    "two groups of three": calling([-3.0, -3 + 1 / 64, -3 + 1 / 32, -2 - 1 / 32, -2 - 1 / 64, -2.0]),
    "groups of three and two": calling([-3.0, -3 + 1 / 64, -3 + 1 / 32, -2 - 1 / 64, -2.0]),
    "three and three far apart": calling([-3.0, -3 + 1.5 / 64, -3 + 3 / 64, -2 - 3 / 64, -2 - 1.5 / 64, -2.0]),
    "a simple fraction": code("return plain(q, v, 1 / 1000)"),
    "no simple fraction": code("return plain(q, v, 1 / 1001)"),
    "a cap near 0.1": code("return plain(q, v, min(h, 0.1 - 15 * 2.0**-56))"),
    "a cap not so near 0.1": code("return plain(q, v, min(h, 0.1 - 18 * 2.0**-56))"),
    **within_and_beyond("a sharp border", _WRONG.format("e * (abs(q) >= 3.0)"), 2.0**-27),
    "soon more": code(_WRONG.format("2.0**-30 * (abs(q) >= 3.0) + 2.0**-9 * (abs(q) >= 11.7)")),
    "later more": code(_WRONG.format("2.0**-30 * (abs(q) >= 3.0) + 2.0**-9 * (abs(q) >= 12.3)")),
    **within_and_beyond(
        "other at once",
        "k = 1 + (h > 0.1) * (abs(q) > 0.7390851332151607 * (1 + e)); q, v = plain(q, v, h); return q * k, v * k",
        2.0**-20,
    ),
    **within_and_beyond(
        "a sum with a number",
        "q, v = plain(q, v, h) if not 0 < abs(q) < 0.5 else plain(q + e, v, h); return q, v",
        64 * 2.0**-53 * 0.7390851332151607,
        0.98,
        1.02,
    ),
    # One more of them is a rounding of the step itself.
    **within_and_beyond(
        "a few of the smallest",
        "a, b = plain(q, v, h); return a + e * 2.0**-1074 * (0 < abs(q) < 2.0**-1022), b",
        63.5,
        0.99,
        1.01,
    ),
    **within_and_beyond(
        "numbers that vanish", "return tuple(0.0 if abs(x) < e else x for x in plain(q, v, h))", 2.0**-1021
    ),
    "overflows by 24 binades": code("q, v = plain(q, v, h); return q * 2.0**24 / 2.0**24, v"),
    "overflows by 25 binades": code("q, v = plain(q, v, h); return q * 2.0**25 / 2.0**25, v"),
    **within_and_beyond(
        "a change of a thousandth", "q, v = plain(q, v, h); return q * (1 + e * (abs(q) > 50)), v", 2.0**-10
    ),
    "capped below the cap": then("v = 4.0 if v > 5 else -4.0 if v < -5 else v"),
    "capped otherwise": then("v = 5.0 if v > 5 else -4.0 if v < -5 else v"),
    "reset otherwise": then("q, v = (1.0, 0.0) if q > 2.4 else (-1.0, 0.0) if q < -2.4 else (q, v)"),
    "refused otherwise": code(
        "if q > 5: raise ValueError('high')\nif q < -5: raise ValueError('low')\nreturn plain(q, v, h)"
    ),
    "changed otherwise": then("q = q - 8 if q >= 4 else q / 2 if q <= -4 else q"),
    "put there and moved": then("q, v = (3.0, v + q) if q > 3 else (q, v)"),
    "halved down there": then("q = q / 2 if q <= -4 else q"),
    "small positions": then("q = 0.0 if abs(q) <= 0.01 else q"),
    "small velocities on one side": then("v = 0.0 if 0 < v < 0.01 else v"),
    "halved when small": then("v = v / 2 if abs(v) <= 0.01 else v"),
}
EDGES_IN_BINARY32 = within_and_beyond("a border in binary32", _WRONG.format("e * (abs(q) >= 3.0)"), 2.0**-4)
