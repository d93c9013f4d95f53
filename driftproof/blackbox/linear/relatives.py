"""The relatives of the catalogue's methods: what a stepper may be that is none of them, as maps with words."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import cache

from driftproof.blackbox.linear.classes import MethodClass, class_named, method_classes
from driftproof.blackbox.linear.parts import (
    CONSTANT,
    EXPLICIT,
    EXPONENTIAL,
    IMPLICIT,
    TRAPEZOIDAL,
    Damp,
    Drift,
    ExactFlow,
    FrozenForce,
    Kick,
    Model,
    Part,
    Whole,
)
from driftproof.methods.schemes import Splitting

# What people call the methods whose keys leave open which of two things comes first.
NAMES = {
    "symplectic_euler": "velocity-first symplectic Euler",
    "symplectic_euler_position_first": "position-first symplectic Euler",
}
MOST_SUBSTEPS = 10
# Compositions with more parts have no damping between them that anybody would have written.
MOST_PARTS_DAMPED = 8
# What is damped and divided into substeps at once.
DAMPED_IN_SUBSTEPS = ("forward_euler", "heun2", "rk4")
SPLIT_IN_SUBSTEPS = ("symplectic_euler", "symplectic_euler_position_first", "velocity_verlet", "position_verlet")
_FACTORS = {
    EXPONENTIAL: "exp(-{g} h)",
    EXPLICIT: "1 - {g} h",
    IMPLICIT: "1/(1 + {g} h)",
    TRAPEZOIDAL: "(1 - {g} h/2)/(1 + {g} h/2)",
    CONSTANT: "{g}, whatever h is",
}
_ORDINALS = ("first", "second", "third")


def name_of(key: str) -> str:
    """What a method is called in a sentence."""
    return NAMES.get(key, key)


def whole(each: MethodClass) -> Model:
    """A method of the catalogue itself."""
    return Model((Whole(each),), name_of(each.keys[0]), each.keys)


@cache
def whole_methods() -> tuple[Model, ...]:
    """The methods of the catalogue, one for each class."""
    return tuple(whole(each) for each in method_classes())


EXACT = Model((ExactFlow(),), "the exact solution")
DAMPED_EXACT = Model((ExactFlow(),), "the exact solution with linear drag {g}")


@cache
def substeps() -> tuple[Model, ...]:
    """Each method as n steps of h/n."""
    return tuple(
        replace(model, words=f"{_steps(n)} of {model.words}", extras=1, repeats=n)
        for n in range(2, MOST_SUBSTEPS + 1)
        for model in whole_methods()
    )


def _steps(n: int) -> str:
    return "two half steps" if n == 2 else f"{n} steps of h/{n}"


@cache
def adjoints() -> tuple[Model, ...]:
    """The adjoint of each method: the inverse of its step of -h."""
    return tuple(
        replace(model, words=f"the adjoint of {model.words}", extras=1, adjoint=True) for model in whole_methods()
    )


@cache
def parts_left_out() -> tuple[Model, ...]:
    """Each splitting with one kick or drift missing."""
    return tuple(_without(method, i, place) for method in _splittings() for i, place in enumerate(_places(method)))


def _without(method: Splitting, i: int, place: str) -> Model:
    left, meaning = tuple(_part(*p) for j, p in enumerate(method.parts) if j != i), _meaning(method, i)
    words = f"{name_of(method.key)} without its {place}{meaning}"
    return Model(left, words, (method.key,), extras=1, unlikely=not meaning)


def _meaning(method: Splitting, i: int) -> str:
    """What v is at the end of a step that leaves out its last kick, or at the start of one without its first."""
    last = len(method.parts) - 1
    if i not in (0, last) or method.parts[i][0] != "kick" or len(method.parts) < 3:
        return ""
    return ": v is the half-step velocity" if len(method.parts) == 3 else ": v is a velocity between two steps"


def frozen_force(beta: Fraction, *, damped: bool) -> Model:
    """q₁ = q + h v + β h² F, v₁ = v + h F, with F from before the step."""
    return Model((FrozenForce(beta),), _frozen_words(beta) + " plus linear drag {g}" * damped, extras=1)


def _frozen_words(beta: Fraction) -> str:
    formula = f"q + h v + {beta} h^2 F(q), v + h F(q)"
    if beta == Fraction(1, 2):
        return f"{formula}: position exact for a constant force, velocity as in forward_euler"
    substeps_ = 1 / abs(2 * beta - 1)
    if 1 < substeps_ <= 1000 and substeps_.denominator == 1:
        inner = "symplectic_euler" if beta > Fraction(1, 2) else "forward_euler"
        return f"{formula}: {substeps_} substeps of {inner} with the force of the first"
    return formula


@cache
def with_drag_in_the_force() -> tuple[Model, ...]:
    """Methods whose force, or right-hand side, has a linear drag, in the ways in which one writes it."""
    split = [model for method in _splittings() for model in _dragged(method)]
    return DAMPED_EXACT, *split, *(_in_field(each) for each in method_classes() if each.stability is not None)


def _in_field(each: MethodClass) -> Model:
    words = f"{name_of(each.keys[0])} with linear drag {{g}} in its right-hand side"
    return Model((Whole(each, in_field=True),), words, each.keys, extras=1)


def _dragged(method: Splitting) -> Iterator[Model]:
    name, kicks = name_of(method.key), [i for i, (kind, _) in enumerate(method.parts) if kind == "kick"]
    forms = {
        f"{name} plus linear drag {{g}}": [EXPLICIT] * len(kicks),
        f"{name} plus implicit linear drag {{g}}: each kick divides by 1 + {{g}} times its time": [IMPLICIT]
        * len(kicks),
        f"{name} plus linear drag {{g}} on the mean of v before and after each kick": [TRAPEZOIDAL] * len(kicks),
    }
    if len(kicks) == 2:
        words = f"{name} plus linear drag {{g}}, explicit in its first kick and implicit in its last"
        forms[words] = [EXPLICIT, IMPLICIT]
    for words, drags in forms.items():
        drag = dict(zip(kicks, drags, strict=True))
        parts = tuple(Kick(c, drag[i]) if i in drag else Drift(c) for i, (_, c) in enumerate(method.parts))
        yield Model(parts, words, (method.key,), extras=1)


@cache
def with_velocity_damped(each: MethodClass, form: str) -> tuple[Model, ...]:
    """A method that multiplies the velocity by a factor of this form: after, before or between its parts."""
    factor, name, step = f"v times {_FACTORS[form]}", name_of(each.keys[0]), Whole(each)
    damp = Damp(Fraction(1), form)
    inside = (_damped_inside(method, damp, factor) for method in each.splittings)
    return (
        Model((step, damp), f"{name}, then {factor}", each.keys, extras=1),
        Model((damp, step), f"{factor}, then {name}", each.keys, extras=1),
        *(model for models in inside for model in models),
    )


@cache
def with_velocity_damped_twice(each: MethodClass, form: str) -> tuple[Model, ...]:
    """A method between two factors of this form, each for half the step."""
    if form == CONSTANT:
        return ()
    half, name = Damp(Fraction(1, 2), form), name_of(each.keys[0])
    words = f"{name} between two halves of a damping, v times {_FACTORS[form]} with h/2 for h"
    return (Model((half, Whole(each), half), words, each.keys, extras=1),)


def _damped_inside(method: Splitting, damp: Damp, factor: str) -> Iterator[Model]:
    if len(method.parts) > MOST_PARTS_DAMPED:
        return
    parts = [_part(*p) for p in method.parts]
    for i, place in enumerate(_places(method)):
        kind, c = method.parts[i]
        half = _part(kind, c * Fraction(1, 2))
        middle = (*parts[:i], half, damp, half, *parts[i + 1 :])
        yield Model(middle, f"{name_of(method.key)}, {factor} in the middle of its {place}", (method.key,), extras=1)
        if i + 1 < len(parts):
            between = (*parts[: i + 1], damp, *parts[i + 1 :])
            yield Model(between, f"{name_of(method.key)}, {factor} after its {place}", (method.key,), extras=1)


@cache
def damped_in_substeps() -> tuple[Model, ...]:
    """A few methods with drag in the force, as n steps of h/n."""
    inner = [model for method in _splittings() if method.key in SPLIT_IN_SUBSTEPS for model in _dragged(method)]
    inner += [_in_field(class_named(key)) for key in DAMPED_IN_SUBSTEPS]
    return tuple(
        replace(model, words=f"{_steps(n)} of {model.words}", extras=2, repeats=n)
        for n in range(2, MOST_SUBSTEPS + 1)
        for model in inner
    )


def _splittings() -> Iterator[Splitting]:
    return (method for each in method_classes() for method in each.splittings)


def _part(kind: str, c: object) -> Part:
    return Kick(c) if kind == "kick" else Drift(c)  # type: ignore[arg-type]


def _places(method: Splitting) -> Sequence[str]:
    """What each part is called: its kick, its first drift, its last kick, its 4th drift."""
    kinds = [kind for kind, _ in method.parts]
    return [_place(kind, kinds[: i + 1].count(kind), kinds.count(kind)) for i, kind in enumerate(kinds)]


def _place(kind: str, i: int, of: int) -> str:
    if of == 1:
        return kind
    if i == of:
        return f"last {kind}"
    return f"{_ORDINALS[i - 1]} {kind}" if i <= len(_ORDINALS) else f"{i}th {kind}"
