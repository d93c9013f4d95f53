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


# Checks that allow `e` up to an edge: name, edge, body; and how near to it the two are, where others than 0.9 and 1.1.
_PARTS = "return q + h * v * (1 + max(e * (abs(q) > 1e-9), e / 2 * (abs(q) > 1e-18))), v - h * q"
_SHARP = _WRONG.format("e * (abs(q) >= 3.0)")
PAIRS = [
    ("nothing but rounding at h = 0", ROUNDING, "return plain(q * (1 + e * (h == 0)), v, h)"),
    # Three times the state goes otherwise by 0.0888 of the larger error.
    ("18 bits", 2.0**-18 / 0.0888, _PARTS),
    ("43 bits", ROUNDING / 0.0888, _PARTS),
    # Errors of two sizes are alike, and rounding, if one is no more than 64 times the other; else a rule about sizes.
    ("errors of two sizes", 1e-7 / 64, _PARTS.replace("e * (", "1e-7 * (", 1).replace("e / 2", "e"), 0.64, 1.33),
    ("a power near 2", 0.125, "k = 1 + 1e-3 * abs(h) ** (2 + e); return q * k, v * k"),
    ("a large entry", 250.0**2 * ROUNDING, "return q + 1000 * h * v, v * (1 + e)"),
    ("a spread", ROUNDING / 2, "return q * (1 + e), v * (1 - e)"),
    ("a factor", ROUNDING / 2, "return q * (1 + e), v * (1 + e)"),
    ("a bent position", ROUNDING, "a, b = plain(q, v, h); return a * (1 + e * (q * v != 0)), b"),
    # There h q is taken from v: the sum of both is 1.97 times their difference.
    ("a bent velocity", 1.966 * ROUNDING, "a, b = plain(q, v, h); return a, b * (1 + e * (q * v != 0))"),
    ("an area by differences", 2.0**-28, "return q, v * (1 + e) if q > 0.5 else 2 * v", 127 / 128, 129 / 128),
    ("a cap near 0.1", 16.5, "return plain(q, v, min(h, 0.1 - round(e) * 2.0**-56))", 0.98, 1.02),
    ("a sharp border", 2.0**-27, _SHARP),
    ("soon more", 12.0, _WRONG.format("2.0**-30 * (abs(q) >= 3) + 2.0**-9 * (abs(q) >= e)"), 0.97, 1.03),
    ("other at once", 2.0**-20, "p = q; " + _WRONG.format("abs(p) > 0.7390851332151607 * (1 + e)")),
    ("a sum with a number", 64 * 2.0**-53 * 0.739085, "return plain(q + e * (0 < abs(q) < 0.5), v, h)", 0.98, 1.02),
    # One more of them is a rounding of the step itself.
    ("the smallest", 63.5, "a, b = plain(q, v, h); return a + e * 5e-324 * (0 < abs(q) < 2.0**-1022), b", 0.99, 1.01),
    ("numbers that vanish", 2.0**-1021, "return tuple(0.0 if abs(x) < e else x for x in plain(q, v, h))"),
    ("an early overflow", 24.5, "q, v = plain(q, v, h); k = 2.0 ** round(e); return q * k / k, v", 0.98, 1.02),
    ("a thousandth", 2.0**-10, "q, v = plain(q, v, h); return q * (1 + e * (abs(q) > 50)), v"),
]


def both(name, edge, body, within=0.9, beyond=1.1):
    """The stepper with `e` just below its edge, and just above."""
    factors = {"within": within, "beyond": beyond}
    return {f"{name}, {word}": code(f"e = {edge * factor!r}; {body}") for word, factor in factors.items()}


EDGES = {name: step for pair in PAIRS for name, step in both(*pair).items()} | {
    "back by 0.78": partly_back(0.78),
    "back by 0.7": partly_back(0.7),
    "back but never forth": code("return plain(q, v, h) if h < 0 else (q, v)"),
    "integers but at 0": code("return (1 / h, v) if h == 0 else tuple(map(int, plain(q, v, h)))"),
    "integers, and what is given at 0": code("return (q, v) if h == 0 else tuple(map(int, plain(q, v, h)))"),
    "the time of the end": code("return y + h * f(t + h, y)", "f, t, y, h"),
    "two wrong times": code("return y + h * (f(0.0, y) + f(20.0, y)) / 2", "f, t, y, h"),
    "a time and a force": code("v = v + h * force(q); return q + h * v, v", "force, t, q, v, h"),
    "a defect at two steps": code("k = 1 + 1e-10 * h ** 8; return q * k, v * k"),
    "a defect at one step": code("k = 1 + 1e-12 * h ** 8; return q * k, v * k"),
    # Six calls in two groups of three are an iteration's; five are not, nor six that are farther apart.
    "two groups of three": calling([-3.0, -3 + 1 / 64, -3 + 1 / 32, -2 - 1 / 32, -2 - 1 / 64, -2.0]),
    "groups of three and two": calling([-3.0, -3 + 1 / 64, -3 + 1 / 32, -2 - 1 / 64, -2.0]),
    "three and three far apart": calling([-3.0, -3 + 1.5 / 64, -3 + 3 / 64, -2 - 3 / 64, -2 - 1.5 / 64, -2.0]),
    "a simple fraction": code("return plain(q, v, 1 / 1000)"),
    "no simple fraction": code("return plain(q, v, 1 / 1001)"),
    "capped below the cap": then("v = 4.0 if v > 5 else -4.0 if v < -5 else v"),
    "capped otherwise": then("v = 5.0 if v > 5 else -4.0 if v < -5 else v"),
    "reset otherwise": then("q, v = (1.0, 0.0) if q > 2.4 else (-1.0, 0.0) if q < -2.4 else (q, v)"),
    "refused otherwise": code("if abs(q) > 5: raise ValueError('high' if q > 0 else 'low')\nreturn plain(q, v, h)"),
    "changed otherwise": then("q = q - 8 if q >= 4 else q / 2 if q <= -4 else q"),
    "put there and moved": then("q, v = (3.0, v + q) if q > 3 else (q, v)"),
    "halved down there": then("q = q / 2 if q <= -4 else q"),
    "small positions": then("q = 0.0 if abs(q) <= 0.01 else q"),
    "small velocities on one side": then("v = 0.0 if 0 < v < 0.01 else v"),
    "halved when small": then("v = v / 2 if abs(v) <= 0.01 else v"),
}
EDGES_IN_BINARY32 = both("a border in binary32", 2.0**-4, _SHARP)
