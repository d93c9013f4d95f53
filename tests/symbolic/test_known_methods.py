"""What a table is in the catalogue: every entry is itself, a spoiled one itself but for that, another is none."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction as Q

import pytest

from driftproof.methods.catalogue import FURTHER_METHODS, METHODS
from driftproof.methods.multistep import Multistep
from driftproof.methods.numbers.number_field import NumberField
from driftproof.methods.schemes import SUBSTEPS, Collocation, RungeKutta
from driftproof.symbolic.known_methods import known_as
from tests.looping import some

ENTRIES = [*METHODS.values(), *FURTHER_METHODS.values()]
TWINS = {"ssprk22": "heun2"}


@pytest.mark.slow(keep=1)
def test_every_entry_is_itself_or_the_first_of_its_coefficients():
    found = [(method.key, known_as(replace(method, key="mine", claimed_order=0)).words) for method in some(ENTRIES, 20)]
    assert found == [(key, TWINS.get(key, key)) for key, _ in found]


OFF = Q(1, 50)
RK4, BS32, BDF2 = METHODS["rk4"], METHODS["bogacki_shampine32"], FURTHER_METHODS["bdf2"]
AB4, ROS2, ARS222, GAUSS2 = (
    *(FURTHER_METHODS[key] for key in ("adams_bashforth4", "ros2", "ars222")),
    METHODS["gauss2"],
)
VERLET, RUTH, NYSTROM = METHODS["velocity_verlet"], METHODS["ruth3"], METHODS["nystrom4"]
S3 = NumberField("s", (-3, 0, 1), Q(1), Q(2)).generator
RALSTON3 = METHODS["ralston3"]
OTHER = dict(zip(SUBSTEPS, SUBSTEPS[::-1], strict=True))
IS = {
    "ralston3 except for b[2]: 1/3 instead of 4/9": replace(RALSTON3, b=(Q(2, 9), Q(1, 3), Q(1, 3))),
    "rk4 except for c[1]: 1/3 instead of 1/2": replace(RK4, c=(Q(0), Q(1, 3), Q(1, 2), Q(1))),
    "rk4 but for rounded digits": replace(RK4, b=(Q("0.16667"), Q("0.33333"), Q("0.33333"), Q("0.16667"))),
    "rk4 except for b[3]: 0.17667 instead of 1/6": replace(
        RK4, b=(Q("0.16667"), Q("0.33333"), Q("0.33333"), Q("0.17667"))
    ),
    "rk4, with embedded weights beside it": replace(RK4, b_embedded=(1, 0, 0, 0), embedded_order=1),
    "bogacki_shampine32, without its embedded weights": replace(BS32, b_embedded=None, embedded_order=None),
    "bogacki_shampine32_embedded": replace(BS32, b=BS32.b_embedded, b_embedded=BS32.b),
    "bogacki_shampine32 except for b_embedded[0]: 7/25 instead of 7/24": replace(
        BS32, b_embedded=(Q(7, 25), *BS32.b_embedded[1:])
    ),
    "ralston3: the same steps, written with other stages": replace(
        RALSTON3, a=tuple(row[::-1] for row in RALSTON3.a[::-1]), b=RALSTON3.b[::-1], c=RALSTON3.c[::-1]
    ),
    "gauss2": replace(
        GAUSS2,
        a=((Q(1, 4), Q(1, 4) - S3 / 6), (Q(1, 4) + S3 / 6, Q(1, 4))),
        c=(Q(1, 2) - S3 / 6, Q(1, 2) + S3 / 6),
    ),
    "gauss2: the same steps, written with other stages": Collocation("mine", "", 0, "", (Q(1, 6), -1, 1)),
    "velocity_verlet except for kick 2: 12/25 instead of 1/2": replace(
        VERLET, parts=(*VERLET.parts[:-1], ("kick", Q(12, 25)))
    ),
    "ruth3, its adjoint": replace(RUTH, parts=RUTH.parts[::-1]),
    "ruth3, kicks and drifts exchanged": replace(RUTH, parts=tuple((OTHER[kind], x) for kind, x in RUTH.parts)),
    "nystrom4 except for b_position[1]: 1/6 instead of 1/3": replace(NYSTROM, b_position=(Q(1, 6), Q(1, 6), Q(0))),
    "adams_bashforth4 except for sigma[1]: 13/8 instead of 37/24": replace(
        AB4, sigma=(AB4.sigma[0], Q(39, 24), *AB4.sigma[2:])
    ),
    "bdf2": replace(BDF2, rho=tuple(6 * x for x in BDF2.rho), sigma=tuple(6 * x for x in BDF2.sigma)),
    "bdf2, with rho and sigma newest first": replace(BDF2, rho=BDF2.rho[::-1], sigma=BDF2.sigma[::-1]),
    "ros2, without its embedded weights": replace(ROS2, b_embedded=None, embedded_order=None),
    "ars222 except for b_implicit[0]: 1/50 instead of 0": replace(ARS222, b_implicit=(OFF, *ARS222.b_implicit[1:])),
    "": Multistep("mine", "", 0, "", (1, -3, 2), (0, 0, 5)),
}  # fmt: skip


@pytest.mark.parametrize("words", IS)
def test_a_table_is_what_its_coefficients_say(words):
    found = known_as(replace(IS[words], key="mine"))
    assert found.words == words
    assert bool(found.near) == bool(found.differences) == ("except for" in words)
    assert bool(found.methods) == (words != "" and "except" not in words and "another table" not in words)


def test_methods_that_are_as_near_are_named_together():
    found = known_as(replace(METHODS["heun2"], key="mine", b=(Q(1, 2), Q(3, 5))))
    assert found.words == "heun2 or ssprk22 or heun_euler21 except for b[1]: 3/5 instead of 1/2"
    assert found.near == ("heun2", "ssprk22", "heun_euler21")


@pytest.mark.parametrize("last", [0.6756035959798289, 0.6765035959798289])
def test_doubles_that_were_printed_are_rounded_coefficients(last):
    numbers = 0.6756035959798289, 1.3512071919596578, -0.1756035959798288, -1.7024143839193153
    parts = zip(("drift", "kick") * 4, map(Q, map(repr, (*numbers, *numbers[2:0:-1], last))), strict=False)
    words = known_as(replace(METHODS["forest_ruth"], key="mine", parts=tuple(parts))).words
    wrong = "except for drift 6: 0.6765035959798289 instead of 0.6756035959798288"
    assert words == f"forest_ruth {'but for rounded digits' if last == numbers[0] else wrong}"


def test_of_many_with_one_stability_function_some_are_named():
    c2, half = Q(1, 4), Q(1, 2)
    a = ((0, 0, 0, 0), (c2, 0, 0, 0), (0, half, 0, 0), (1, -2, 2, 0))
    found = known_as(RungeKutta("mine", "", 4, "", a, (Q(1, 6), 0, Q(2, 3), Q(1, 6)), (0, c2, half, 1)))
    assert found.words == "the stability function of rk4, rk38, gill4, ralston4 and 2 more, another table"
    assert not found.methods
    assert not found.near
