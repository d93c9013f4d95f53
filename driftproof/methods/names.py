"""Common names of the methods: synonyms, ambiguous names, and methods that are easily confused.

Names are compared without case, accents, hyphens, spaces and words such as "the" and "method".
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Mapping
from itertools import islice
from typing import TypeVar

from driftproof.support.plain_text import unknown

_Kind = TypeVar("_Kind")

_ORDINALS = {"2nd": "second", "3rd": "third", "4th": "fourth", "5th": "fifth", "6th": "sixth", "8th": "eighth"}
_DIGITS = {"two": "2", "three": "3", "four": "4", "five": "5", "six": "6"}
_FILLER_WORDS = {"the", "of", "method", "methods", "rule", "scheme", "integrator"}

# Key | other names.
_OTHER_NAMES = """
forward_euler | Euler, explicit Euler, Euler forward, RK1, AB1
backward_euler | implicit Euler, Euler backward, BDF1
symplectic_euler | semi-implicit Euler, semi-explicit Euler, Euler-Cromer, Cromer, kick-drift
symplectic_euler_position_first | drift-kick
velocity_verlet | kick-drift-kick, KDK, velocity Störmer-Verlet, kick-drift-kick leapfrog
position_verlet | drift-kick-drift, DKD, drift-kick-drift leapfrog
heun2 | Heun, improved Euler, explicit trapezoid, explicit trapezoidal rule
midpoint2 | explicit midpoint rule, midpoint RK2
rk4 | RK4, Runge-Kutta, Runge-Kutta 4, classical Runge-Kutta, classic Runge-Kutta, fourth-order Runge-Kutta
rk38 | 3/8 rule, RK4 3/8, Kutta 3/8, three-eighths rule
ssprk22 | SSPRK2, TVD-RK2
ssprk33 | SSPRK(3,3), SSPRK3, TVD-RK3, Shu-Osher
ssprk104 | SSPRK104
heun_euler21 | adaptive Heun, RK12
bogacki_shampine32 | Bogacki-Shampine, BS3, BS23, RK23, ode23
bogacki_shampine54 | BS5
fehlberg45 | Fehlberg, RKF45, Runge-Kutta-Fehlberg
fehlberg78 | RKF78, RK78
rk4_doubling54 | RK4 with step doubling, step doubling, RK4 with Richardson extrapolation
merson45 | Merson, Kutta-Merson
cash_karp54 | Cash-Karp, RKCK, CK45
dormand_prince54 | Dormand-Prince, DOPRI5, DOPRI54, RKDP, DP5, RK45, ode45
prince_dormand87 | Prince-Dormand, RK8(7)13M, DOPRI87
tsitouras54 | Tsitouras, Tsit5
dop853 | DOPRI853, Dormand-Prince 853
verner65 | DVERK
implicit_midpoint | gauss1, one-stage Gauss-Legendre
trapezoid | Crank-Nicolson, implicit trapezoid, implicit trapezoidal rule, trapezium rule
gauss2 | Hammer-Hollingsworth, two-stage Gauss-Legendre
gauss3 | Kuntzmann-Butcher, three-stage Gauss-Legendre
radau_iia2 | Radau3
radau_iia3 | Radau, Radau5
sdirk2 | Alexander 2
alexander3 | Alexander 3
tr_bdf2 | TRBDF2
forest_ruth | Forest-Ruth, FR4, Yoshida 4 position first
yoshida4 | triple jump
ruth3 | Ruth
nystrom4 | Runge-Kutta-Nyström, RKN4
bdf2 | BDF 2, Gear 2, two-step BDF
bdf3 | Gear 3
bdf4 | Gear 4
bdf5 | Gear 5
bdf6 | Gear 6
adams_bashforth2 | AB2, two-step Adams-Bashforth
adams_bashforth3 | AB3
adams_bashforth4 | AB4
adams_bashforth5 | AB5
adams_bashforth6 | AB6
two_step_leapfrog | leapfrog two-step, explicit midpoint two-step, two-step midpoint
milne_simpson | Milne, Simpson two-step
stormer2 | Störmer two-step, Verlet two-step, Störmer two-step Verlet
cowell2 | Numerov
rodas4 | RODAS 4
grk4t | GRK 4T, Kaps-Rentrop
ars111 | IMEX Euler, forward-backward Euler, ARS(1,1,1)
ark324 | KenCarp3, ARK324L2SA
ark436 | KenCarp4, ARK436L2SA
ark548 | KenCarp5, ARK548L2SA
"""

# Name | the keys of the methods that it may mean. Some authors number methods by order, others by stages.
_AMBIGUOUS = """
Verlet | velocity_verlet position_verlet
Störmer-Verlet | velocity_verlet position_verlet
Stoermer-Verlet | velocity_verlet position_verlet
Störmer | velocity_verlet position_verlet stormer2 stormer3 stormer4
Nyström | nystrom4 nystrom5
leapfrog | velocity_verlet position_verlet two_step_leapfrog
midpoint | midpoint2 implicit_midpoint
modified Euler | heun2 midpoint2
RK2 | heun2 midpoint2 ralston2
RK3 | kutta3 heun3 ralston3 ssprk33
Ralston | ralston2 ralston3 ralston4
Butcher | butcher5 butcher6 butcher7
Verner | verner65 verner76 verner87
Gauss | implicit_midpoint gauss2 gauss3
Gauss-Legendre | implicit_midpoint gauss2 gauss3
Gauss-Legendre 4 | gauss2 gauss4
GL4 | gauss2 gauss4
Gauss-Legendre 6 | gauss3 gauss6
GL6 | gauss3 gauss6
Radau IIA | radau_iia2 radau_iia3 radau_iia4
RadauIIA5 | radau_iia3 radau_iia5
Radau IA | radau_ia2 radau_ia3
Lobatto | trapezoid lobatto_iiia3 lobatto_iiib3 lobatto_iiic3
Lobatto IIIA | trapezoid lobatto_iiia3 lobatto_iiia4
Lobatto IIIB | lobatto_iiib2 lobatto_iiib3 lobatto_iiib4
Lobatto IIIC | lobatto_iiic2 lobatto_iiic3 lobatto_iiic4
SDIRK | sdirk2 alexander3 sdirk4
Yoshida | yoshida4 yoshida6 yoshida8
Yoshida 4 | yoshida4 forest_ruth
fourth-order Yoshida | yoshida4 forest_ruth
Suzuki | suzuki4 suzuki4_position_first
DOPRI8 | dop853 prince_dormand87
BDF | bdf2 bdf3 bdf4 bdf5 bdf6
Adams-Bashforth | adams_bashforth2 adams_bashforth3 adams_bashforth4 adams_bashforth5 adams_bashforth6
Adams-Moulton | adams_moulton2 adams_moulton3 adams_moulton4 adams_moulton5 adams_moulton6
AM2 | trapezoid adams_moulton2
AM3 | adams_moulton2 adams_moulton3
AM4 | adams_moulton3 adams_moulton4
AM5 | adams_moulton4 adams_moulton5
AM6 | adams_moulton5 adams_moulton6
"""

# Key | the keys of other methods that share its name, or its step on linear problems.
_NOT_TO_BE_CONFUSED = """
forward_euler | symplectic_euler backward_euler
symplectic_euler | symplectic_euler_position_first forward_euler
symplectic_euler_position_first | symplectic_euler
velocity_verlet | position_verlet
position_verlet | velocity_verlet
heun2 | midpoint2 heun3
midpoint2 | implicit_midpoint heun2
rk4 | rk38
implicit_midpoint | trapezoid midpoint2
trapezoid | implicit_midpoint heun2
bdf2 | tr_bdf2
dormand_prince54 | fehlberg45 cash_karp54
fehlberg45 | dormand_prince54 cash_karp54
radau_iia3 | radau_ia3
prince_dormand87 | dop853
dop853 | prince_dormand87
"""


class UnknownKey(KeyError):
    """A key that a table has not; the message is made when it is read, as asking for a key is common."""

    def __str__(self) -> str:
        """The key, with the nearest keys of the table."""
        key, table = self.args
        return unknown("key", key, table, f"{len(table)} keys are known")


class KeyedTable(Mapping[str, _Kind]):
    """A table by key that is shown by its first keys."""

    def __repr__(self) -> str:
        """The number of keys and the first ones."""
        return f"<{len(self)} by key: {', '.join(islice(self, 3))}, ...>"


def plain_name(name: str) -> str:
    """The letters and digits of a name, without accents, case and words such as "the" and "method".

    >>> plain_name("Störmer-Verlet"), plain_name("the Euler-Cromer method"), plain_name("Heun's method")
    ('stormerverlet', 'eulercromer', 'heun')
    """
    letters = "".join(c for c in unicodedata.normalize("NFKD", name.casefold()) if not unicodedata.combining(c))
    words = re.findall(r"[a-z0-9]+", re.sub(r"['’]s\b", "", letters))
    return "".join(_ORDINALS.get(word, word) for word in words if word not in _FILLER_WORDS)


def keys_called(name: str) -> tuple[str, ...]:
    """The keys of the methods with this common name: several if it is ambiguous, () if it is unknown.

    >>> keys_called("Crank-Nicolson"), keys_called("leapfrog"), keys_called("Laplace")
    (('trapezoid',), ('velocity_verlet', 'position_verlet', 'two_step_leapfrog'), ())
    """
    return _KEYS.get(plain_name(name), ())


def also_known_as(key: str) -> tuple[str, ...]:
    """The other names of the method with this key.

    >>> also_known_as("trapezoid")[0]
    'Crank-Nicolson'
    """
    return _NAMES.get(key, ())


def counted_names(title: str) -> list[str]:
    """Other names of a method whose title counts its stages or steps.

    >>> counted_names("Gauss, two stages (Hammer-Hollingsworth)")
    ['Gauss with two stages', 'two-stage Gauss', 'Gauss with 2 stages', '2-stage Gauss', 'Gauss, 2 stages']
    """
    found = re.fullmatch(r"([^,]+), (\w+) (stage|step)s(?: \(.*\))?", title)
    if not found:
        return []
    of, number, what = found.groups()
    spelled = [
        number,
        *(word if number == digit else digit for word, digit in _DIGITS.items() if number in (word, digit)),
    ]
    names = [name for n in spelled for name in (f"{of} with {n} {what}s", f"{n}-{what} {of}", f"{of}, {n} {what}s")]
    return [name for name in names if not title.startswith(name)]


def _lines(text: str, separator: str | None) -> dict[str, tuple[str, ...]]:
    pairs = (line.split(" | ") for line in text.strip().splitlines())
    return {name: tuple(word.strip() for word in words.split(separator)) for name, words in pairs}


_NAMES = _lines(_OTHER_NAMES, ", ")
# Key -> the keys of methods that are easily taken for it; name -> the keys of the methods that it may mean.
EASILY_CONFUSED, AMBIGUOUS_NAMES = _lines(_NOT_TO_BE_CONFUSED, None), _lines(_AMBIGUOUS, None)
# Names of Adams-Bashforth-Moulton methods of an order, with one correction or as many as they say.
BASHFORTH_MOULTON = re.compile(r"(?:abm|adams[-_ ]bashforth[-_ ]moulton)[-_ ]?([2-6])(?:[- ]\(?p((?:ec){1,2})e\)?)?")
COMMON_NAMES = (*(name for names in _NAMES.values() for name in names), *AMBIGUOUS_NAMES)
_KEYS: dict[str, tuple[str, ...]] = {plain_name(name): (key,) for key, names in _NAMES.items() for name in names}
_KEYS |= {plain_name(name): keys for name, keys in AMBIGUOUS_NAMES.items()}
