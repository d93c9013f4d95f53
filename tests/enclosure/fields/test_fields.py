"""Right-hand sides as users write them run unchanged on enclosed numbers, or are refused in one line."""

from __future__ import annotations

import math
from functools import partial
from math import exp as exponential
from math import sin

import numpy as np
import pytest
from flint import arb, ctx
from numpy import interp, linalg, maximum, sign, zeros
from scipy.interpolate import BarycentricInterpolator

from driftproof.enclosure.arithmetic.evaluations import Evaluation, Refused
from driftproof.enclosure.arithmetic.numbers import Enclosed
from driftproof.enclosure.fields.fields import enclosable, enclosed_rates
from tests.looping import exactly

SCALE = 0.25
MATRIX = np.array([[0.5, -1.0], [1.0, 0.25]])


def helper(x):
    return math.sqrt(1 + x * x) * SCALE


def filled(t, y):
    rates = np.zeros(2)
    rates[0], rates[1] = y[1], -math.sin(y[0])
    return rates


def filled_by_name(t, y):
    rates = zeros(2, dtype=float)
    rates[:] = y[1], sin(y[0]) + exponential(t)
    return rates


def through_helpers(t, y):
    def inner(x):
        return helper(x) + math.pi

    return [inner(y[0]), math.pow(y[1], 3)]


class Oscillator:
    k = 3.0

    def field(self, t, y):
        return np.array([y[1], -self.k * y[0]], dtype=float)

    def __call__(self, t, y):
        return np.asarray([y[1], -self.k * np.tanh(y[0])])


def of_many_functions(t, y):
    return [math.atan2(y[0], y[1]) + math.log(y[0], 10), math.hypot(*y) - math.fabs(y[0]) + math.degrees(y[1])]


def guarded(t, y):
    if np.isnan(y).any() or not np.all(np.isfinite(y)) or math.isnan(y[0]) or math.isinf(t):
        raise ValueError("no numbers")
    return y[::-1] * len(y) / y.size


def in_place(t, y):
    rates = y.copy()
    rates[0], rates[1] = y[1], -y[0]
    rates *= 2
    rates -= np.zeros_like(y) + np.copy(y)
    other = np.zeros(2)
    np.multiply(rates, -1.0, out=other)
    return other


def out_of_pieces(t, y):
    q, v = np.split(y, 2)
    return np.hstack([v, -q]) + np.append(y[1:], y[:1]) * np.roll(y, 1) - np.flip(y) + y[[1, 0]]


def of_a_matrix(t, y):
    products = np.einsum("ij,j->i", MATRIX, y) + MATRIX.dot(y) + (MATRIX @ y.reshape(2, 1)).ravel()
    return products + np.linalg.inv(MATRIX) @ y + np.inner(y, [1.0, 0.5]) * np.cross([y[0], y[1], 0], [0, 0, 1.0])[:2]


def by_axes(t, y):
    return y * np.linalg.norm(y.reshape(1, 2), axis=1) + np.cumsum(y) / y.mean() + np.prod(y) * np.diff(y)[0]


def lists(t, y):
    a, *rest = y.tolist()
    return [math.fsum([a, 2.0]) + math.prod(rest), max(sorted([a, *rest])) + min(a, 5.0) * (rest[0] != 0)]


def clipped(t, y):
    return np.clip(y, 0.75, 10.0) * np.sign(y) + np.where(y[0] > 0, y, 0.0) + np.vectorize(lambda x: -x)(y)


CHOOSING = {
    "min": lambda t, y: [0.7 * min(y[0], 0.3)],
    "max of a list": lambda t, y: [0.7 * max([-y[0], 0.3])],
    "minimum": lambda t, y: [0.7 * np.minimum(y[0], 0.3)],
    "minimum of an array": lambda t, y: 0.7 * np.minimum(y, 0.3),
    "clip": lambda t, y: 0.7 * np.clip(y, 0.0, 0.3),
    "sign": lambda t, y: [0.7 * (0.3 * np.sign(y[0]))],
    "heaviside": lambda t, y: [0.7 * (0.3 * np.heaviside(y[0], 0.5))],
}


@pytest.mark.parametrize("name", CHOOSING)
def test_constant_that_is_chosen_stays_exact_in_what_f_makes_of_it(name):
    """0.7 times 0.3 is no double."""
    evaluation = Evaluation()
    f = enclosable(CHOOSING[name])
    with ctx.workprec(128):
        (rate,) = enclosed_rates(f, Enclosed(evaluation, arb(0)), [Enclosed(evaluation, arb(10))])
        assert abs(rate.value - arb(0.7) * arb(0.3)) < 1e-30 < abs(rate.value - 0.7 * 0.3)


def test_arrays_of_one_number_may_stand_in_lists():
    evaluation = Evaluation()
    y = [Enclosed(evaluation, arb(2)), Enclosed(evaluation, arb(3))]
    for f in (
        lambda t, y: [y[1], np.where(y[0] > 0, 3.0, y[0])],
        lambda t, y: np.array([y[1], np.select([y[0] > 0], [3.0])]),
        lambda t, y: [y[1], np.fabs(-y[1])],
    ):
        assert [x.value for x in enclosed_rates(enclosable(f), Enclosed(evaluation, arb(0)), y)] == [3, 3]


def calling_each_other(t, y):
    def rise(x, depth):
        return fall(x, depth - 1) + fall(x, 0) if depth else math.sin(x)

    def fall(x, depth):
        return -rise(x, depth - 1) - rise(x, 0) if depth else math.exp(x)

    return [rise(y[0], 3), fall(y[1], 2)]


def repeated(x, times):
    return repeated(math.sin(x), times - 1) if times else x


def scaled(t, y, factor):
    return [math.cos(x) * factor for x in y]


def made_to_share():
    """What functions write, others read."""
    factor = 1.0

    def update(x):
        nonlocal factor
        factor = 5.0 if x > 0 else 1.0

    def sharing(t, y):
        update(y[0])
        return factor * y * sharing.scale

    sharing.scale = 0.5
    return sharing


def importing(t, y):
    import math
    from math import log as ln

    import numpy as np
    from numpy.linalg import norm

    return np.array([norm(y) * math.cos(y[0]), ln(max(y[1], 0.1)) + linalg.norm(y)])


def noting(t, y):
    global NOTED
    NOTED = 2 * y[0]
    return [noted(), y[1]]


def noted():
    return NOTED


NOTED = 0.0


def choosing(t, y):
    """Constants that are chosen are compared and rounded as such."""
    index, largest = max(enumerate(y), key=lambda pair: pair[1])
    known = [np.sign(y[0]) == 1, np.maximum(-y[0], 0) == 0, np.heaviside(y[0], 0.5) >= 1, np.clip(y[0], 0, 0.5) == 0.5]
    return [largest * index, y[[1, 0][int(np.clip(3 * y[0] + 2, 0, 1))]] * sum(known) + divmod(y[0], 2.0)[1]]


def of_constants(t, y):
    return [
        math.fsum([0.1] * 10) * y[0] + math.pow(7, 25),
        maximum(-y, 0.1)[0] * sign(y[1]) + interp(t, [0, 1], [2.0, 0.5]),
    ]


def into_integers(t, y):
    kept, other = np.full(2, 3), np.zeros_like(np.array([1, 2]))
    kept[0], other[1] = 2.7 * y[1], -2.7 * y[1]
    return kept + 1.0 * other + np.exp2(y) + [round(y[1], 1), y[0] % 0.25]


FIELDS = [
    *(filled, filled_by_name, through_helpers, of_many_functions, Oscillator().field, Oscillator()),
    lambda t, y: MATRIX @ y + np.cos(t),
    lambda t, y: np.array([np.dot(y, y), np.linalg.norm(y)]),
    lambda t, y: np.where(y > 0.5, y**2, -y),
    lambda t, y: np.concatenate([y[1:], y[:1]]) * np.exp(-np.sum(y)),
    lambda t, y: np.array([2 ** y[0], 1.5 ** y[1]]) + np.hypot(y[0], y) - np.arctan2(y, y[1]),
    lambda t, y: (y[0] > 0.7 * y) * 1.0 + (y[1] * y - y[0]) / y + (2 + y[1] - y) ** y[0],
    lambda t, y: np.maximum(y, 0.1) + np.empty_like(y).size,
    lambda t, y: [y[1] if t < 1 else y[0], 0],
    # As strangers write them.
    lambda t, y: [+repeated(y[0], 3), np.square(y[1]) - np.reciprocal(y[0])],
    *(calling_each_other, partial(scaled, factor=0.5)),
    *(
        guarded,
        in_place,
        out_of_pieces,
        of_a_matrix,
        by_axes,
        lists,
        clipped,
        made_to_share(),
        noting,
        importing,
        choosing,
        of_constants,
        into_integers,
    ),
]


@pytest.mark.parametrize("f", FIELDS, ids=range(len(FIELDS)))
def test_field_means_in_balls_what_it_means_in_floats(f):
    t, y = 0.75, np.array([0.625, 1.5])
    evaluation = Evaluation()
    state = [Enclosed(evaluation, arb(x)) for x in y]
    found = enclosed_rates(enclosable(f), Enclosed(evaluation, arb(t)), state)
    for ball, wanted in exactly(2, zip(found, f(t, y), strict=True)):
        assert abs(float(arb(ball.value).mid()) - wanted) < 1e-14 * (1 + abs(wanted))


def caught(f, t=0.75, y=(0.625, 1.5)):
    evaluation = Evaluation()
    with pytest.raises(Refused) as refusal:
        enclosed_rates(enclosable(f), Enclosed(evaluation, arb(t)), [Enclosed(evaluation, arb(x)) for x in y])
    return str(refusal.value)


def catching(t, y):
    try:
        return [complex(y[0]).real, 0]
    except Exception:
        return [1.0, 0]


def into_a_buffer(t, y):
    MATRIX[0] = y
    return MATRIX[0]


@pytest.mark.parametrize(
    ("f", "said"),
    [
        (lambda t, y: [math.gamma(y[0]), 0], "f uses math.gamma, which has no enclosure"),
        (
            lambda t, y: [BarycentricInterpolator([0.0, 9.0], [0.0, 1.0])(t), 0],
            "f calls an interpolation that has no enclosure; numpy.",
        ),
        (lambda t, y: [math.remainder(y[0], 1), 0], "f uses math.remainder, which has no enclosure"),
        (lambda t, y: [np.nextafter(y[0], 1), 0], "f uses nextafter, which has no enclosure"),
        (lambda t, y: [1j * y[0], 0], "f uses a complex as a number"),
        (lambda t, y: [float("nan") * y[0], 0], "f uses the constant nan"),
        (lambda t, y: {}["k"], "f fails on enclosed numbers: KeyError"),
        (lambda t, y: [f"{y[0]:.3f}", 0], "f fails on enclosed numbers: TypeError: unsupported format string"),
        (lambda t, y: [np.add.outer(y[0], 1.0), 0], "f uses numpy.add in a way that has no enclosure"),
        (lambda t, y: [y[0].hypot(y), 0], "f uses a NotImplementedType as a number"),
        (catching, "f catches the exception by which the enclosure refuses an operation"),
        (lambda t, y: np.array([y[1], 0], dtype=int), "f makes an array of type int64, which has no enclosure"),
        (lambda t, y: np.asarray(y, dtype="f4"), "f makes an array of type float32, which has no enclosure"),
        (into_a_buffer, "in 'MATRIX[0] = y'; what has an enclosure"),
        (lambda t, y: y.astype(float), "f converts a number to a float in '(lambda t, y: y.astype(float)"),
        (lambda t, y: [y[0]], "f returns 1 numbers for 2 components"),
        (lambda t, y: [y[5], 0], "f fails on enclosed numbers: IndexError"),
        (lambda t, y: [{1.0: 2.0}[t], 0], "f looks numbers up by their value, as in a dict"),
        (lambda t, y: [None, y[0]], "f uses a NoneType as a number"),
    ],
    ids=lambda x: x if isinstance(x, str) else "",
)
def test_field_without_enclosure_is_refused(f, said):
    assert said in caught(f)
    assert "\n" not in caught(f)


class Uncopied:
    def __init__(self):
        self.sine, self.two = math.sin, 2.0

    def __reduce_ex__(self, protocol):
        raise TypeError("no copies")


def test_an_object_that_cannot_be_copied_is_used_as_it_is():
    held = Uncopied()
    (rate,) = enclosable(lambda t, y: [held.two * y[0]])(0, [Enclosed(Evaluation(), arb(3))])
    assert rate.value == 6


def test_rebound_leaves_the_given_function_as_it_was():
    enclosable(filled)
    assert filled(0.0, np.array([1.0, 2.0])).dtype == float
    assert filled.__globals__["math"] is math
