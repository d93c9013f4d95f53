"""Continuous extensions are exact data of the methods that they extend; what is not their data is refused."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import pytest

from driftproof.methods.catalogue import EXTENSIONS, METHODS, extensions_of
from driftproof.methods.continuous import hermite
from driftproof.methods.schemes import MethodError
from tests.looping import exactly

THETAS = [Fraction(1, 3), Fraction(1, 2), Fraction(7, 8)]


def test_the_catalogue_holds_the_extensions_of_codes_in_use():
    assert list(EXTENSIONS) == [
        *("bogacki_shampine32_hermite", "rk4_hermite", "dormand_prince54_shampine", "dormand_prince54_hermite"),
        *("tsitouras54_quartic", "dop853_dense"),
    ]
    assert [each.key for each in extensions_of(METHODS["dop853_third"])] == ["dop853_dense"]
    assert extensions_of(METHODS["fehlberg45"]) == ()
    with pytest.raises(KeyError):
        EXTENSIONS["rk4"]


@pytest.mark.parametrize("theta", THETAS)
def test_the_cubic_interpolates_any_cubic(theta):
    """Where f(t) = 1 + 2t + 3t², y = t + t² + t³ is a cubic, which the Hermite cubic is at every theta."""
    extension = EXTENSIONS["rk4_hermite"]
    values = [sum(c * theta**k for k, c in enumerate(weight)) for weight in extension.weights]
    slopes = [1 + 2 * c + 3 * c * c for c in extension.c]
    assert sum(b * k for b, k in zip(values, slopes, strict=True)) == theta + theta**2 + theta**3
    assert [sum(row) * theta**k for k, row in enumerate(extension.columns)] == [0, theta, 0, 0]


def test_a_slope_at_the_end_is_a_stage_of_its_own_only_where_the_method_has_none():
    assert len(hermite(METHODS["bogacki_shampine32"]).a) == 4
    assert len(hermite(METHODS["heun2"]).a) == 3
    uneven = replace(hermite(METHODS["heun2"]), weights=((0, 1), (0,), (0, 0, 1)))
    assert uneven.columns == ((0, 0, 0), (1, 0, 0), (0, 0, 1))
    for key in exactly(2, ("backward_euler", "lobatto_iiic2")):  # of which the second has its first node at 0
        with pytest.raises(MethodError, match=rf"^{key}: its first stage is not f\(t, y\)"):
            hermite(METHODS[key])


def test_what_does_not_begin_with_the_method_is_refused():
    extension = EXTENSIONS["rk4_hermite"]
    other = replace(METHODS["rk4"], c=(*METHODS["rk4"].c[:3], 2))
    for method in exactly(2, (METHODS["heun2"], other)):
        with pytest.raises(MethodError, match=f"the first stages are not those of {method.key}"):
            replace(extension, method=method)
    with pytest.raises(MethodError, match="as many entries as there are stages"):
        replace(extension, weights=extension.weights[1:])


def test_the_coefficients_are_those_of_scipy():
    """Beside SciPy's own, to its floats: its P has the powers of theta from 1, its DOP853 the last four differences."""
    rk = pytest.importorskip("scipy.integrate._ivp.rk")
    for key, theirs in {"bogacki_shampine32_hermite": rk.RK23.P, "dormand_prince54_shampine": rk.RK45.P}.items():
        ours = EXTENSIONS[key].weights
        assert theirs.shape == (len(ours), len(ours[0]) - 1)
        assert all(
            abs(float(x) - y) < 1e-14 for a, b in zip(ours, theirs, strict=True) for x, y in zip(a[1:], b, strict=True)
        )
    dense, theirs = EXTENSIONS["dop853_dense"], rk.DOP853
    assert [[float(x) for x in row] for row in dense.a[13:]] == theirs.A_EXTRA.tolist()
    # Of the seven nested terms the last has theta^4 (1 - theta)^3, so that its row is minus the coefficient of theta^7.
    leading = [-float(weight[7]) for weight in dense.weights]
    assert all(abs(x - y) < 1e-12 for x, y in zip(leading, theirs.D[3], strict=True))
