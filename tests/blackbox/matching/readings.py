"""How steppers are read and matched in these tests, and which methods of the catalogue are read."""

from __future__ import annotations

from driftproof.blackbox.matching.match import match_forces, match_tableau
from driftproof.blackbox.probes.force import read_forces
from driftproof.blackbox.probes.tableau import TableauReading, read_tableau
from driftproof.blackbox.stepper.opening import opened
from driftproof.methods.catalogue import METHODS
from driftproof.methods.schemes import RungeKutta, Splitting
from driftproof.symbolic.rounding.formats import BINARY64
from tests.blackbox.handwritten_steppers import floats
from tests.catalogue.representatives import THOROUGH

EXPLICIT = [key for key, method in METHODS.items() if method.explicit]
TABLEAUX = [key for key in EXPLICIT if isinstance(METHODS[key], RungeKutta)]
SHORT = [key for key in TABLEAUX if METHODS[key].stages < 20]
SPLITTINGS = [key for key in EXPLICIT if isinstance(METHODS[key], Splitting)]
# Of every kind of numbers and every family one: those whose lines stand in transcripts.
TOLD = ["forward_euler", "rk4", "zonneveld43", "ralston4", "luther6", "fehlberg45", "dormand_prince54", "dop853"]
TOLD += ["ssprk104", "chebyshev10_1", "symplectic_euler", "velocity_verlet", "yoshida4", "mclachlan4", "nystrom4"]
TOLD += ["backward_euler", "gauss2", "sdirk2", "lobatto_iiia3"]
EACH = [*METHODS] if THOROUGH else TOLD
# The same step under several names: a pair propagates it, or it was found twice.
TIES = [
    {"heun2", "ssprk22", "heun_euler21"}, {"rk4", "zonneveld43"}, {"ralston3", "bogacki_shampine32"},
    {"dop853", "dop853_third"},
]  # fmt: skip


def ties_of(key):
    return next((tie for tie in TIES if key in tie), {key})


def in_field(step):
    return match_tableau(read_tableau(opened(step, "field")))


def on_force(step):
    return match_forces(read_forces(opened(step)))


def read_with(key, *places, by=0.125, timed=True, in_format=BINARY64):
    """What is read of a method with so much more in some places, such as ("a", 2, 1)."""
    numbers = dict(zip("abc", floats(METHODS[key]), strict=True))
    for name, *rows, last in places:
        (numbers[name][rows[0]] if rows else numbers[name])[last] += by
    a, b, c = numbers.values()
    return TableauReading(tuple(map(tuple, a)), tuple(b), tuple(c) if timed else None, in_format)


def counted(method):
    """The stages that the step depends on."""
    found = {j for j, x in enumerate(method.b) if x}
    for i in reversed(range(method.stages)):
        found |= {j for j, x in enumerate(method.a[i]) if x and i in found}
    return found
