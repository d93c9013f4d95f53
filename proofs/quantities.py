"""Every quantity that the lesson prints, by stable id: its description and its exact value."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from fractions import Fraction as Q

from driftproof.methods.catalogue import METHODS
from driftproof.numeric.scenes import LARGEST_LESSON_H, PRESETS, Scene
from driftproof.symbolic.algebra.certified import CertifiableReal
from driftproof.symbolic.derivation.energy import invariant_quadratic
from driftproof.symbolic.derivation.one_step import at_rational
from driftproof.symbolic.runs import TrigonometricNumber
from proofs.claims import CERTIFIED, COUNTED, GIVEN, PROVED
from proofs.setting import (
    BOUNDARY_H,
    EULER,
    FIRST_H,
    LESSON_METHODS,
    RK4,
    START,
    SYMPLECTIC,
    M,
    calls_of_a_step,
    counted_evaluations,
    energy,
    rates,
    run,
    state_after,
)

EXERCISE_START = (Q(0), Q(1))
EXERCISE_H = {EULER: Q(1, 10), RK4: Q(2, 5)}
COMPONENTS = {"q": "position", "v": "velocity"}


@dataclass(frozen=True)
class Quantity:
    """A quantity: its stable id, a description, a function that returns its exact value, and the kind of evidence."""

    id: str
    words: str
    value: Callable[[], CertifiableReal]
    evidence: str


def _proved(key: str, words: str, value: Callable[[], CertifiableReal]) -> Quantity:
    return Quantity(key, words, value, PROVED)


def _enclosed(key: str, words: str, value: Callable[[], CertifiableReal | None]) -> Quantity:
    return Quantity(key, words, lambda: _defined(value()), CERTIFIED)


def _counted(key: str, words: str, value: Callable[[], int]) -> Quantity:
    return Quantity(key, words, lambda: Q(value()), COUNTED)


def _given(key: str, words: str, value: Callable[[], CertifiableReal]) -> Quantity:
    return Quantity(key, words, value, GIVEN)


def _defined(value: CertifiableReal | None) -> CertifiableReal:
    if value is None:
        raise ValueError("the quantity is undefined at the origin")
    return value


def _setting() -> Iterator[Quantity]:
    yield _given("first_step.h", "step of the worked first step", lambda: FIRST_H)
    yield _given("largest_h", "largest step on offer", lambda: LARGEST_LESSON_H)
    yield _proved("exact.energy", "energy of the exact solution", lambda: energy(*START))
    for scene in PRESETS.values():
        yield _given(f"{scene.name}.h", f"step of the scene {scene.name}", lambda scene=scene: scene.h)
        yield _proved(f"{scene.name}.steps", f"steps of the scene {scene.name}", lambda scene=scene: Q(scene.steps))


def _first_step(key: str, title: str) -> Iterator[Quantity]:
    for i, (letter, word) in enumerate(COMPONENTS.items()):
        after = lambda i=i: state_after(key, 1, FIRST_H)[i]
        yield _proved(f"{key}.first_step.{letter}", f"{word} after the first step, {title}", after)
    after_step = lambda: energy(*state_after(key, 1, FIRST_H))
    yield _proved(f"{key}.first_step.energy", f"energy after the first step, {title}", after_step)


def _exact_states() -> Iterator[Quantity]:
    cosine = lambda t: TrigonometricNumber(Q(1), Q(0), t)
    minus_sine = lambda t: TrigonometricNumber(Q(0), Q(-1), t)
    yield _enclosed("exact.first_step.q", "exact position after the first step", lambda: cosine(Q(1, 2)))
    yield _enclosed("exact.first_step.v", "exact velocity after the first step", lambda: minus_sine(Q(1, 2)))
    yield _enclosed("exact.default.q", "exact position at t = 10", lambda: cosine(Q(10)))
    yield _enclosed("exact.default.v", "exact velocity at t = 10", lambda: minus_sine(Q(10)))


def _rates() -> Iterator[Quantity]:
    yield _counted("rk4.stages", "rates that RK4 forms", lambda: calls_of_a_step(RK4))
    for stage in range(4):
        for i, (letter, word) in enumerate(COMPONENTS.items()):
            rate = lambda stage=stage, i=i: rates(RK4, FIRST_H)[stage][i]
            yield _proved(
                f"rk4.first_step.k{stage + 1}.{letter}", f"{word} rate k{stage + 1} of RK4's first step", rate
            )


def _scene_run(key: str, title: str, scene: Scene) -> Iterator[Quantity]:
    exact = lambda: run(key, scene.h)
    where = f"at t = 10, {title}, scene {scene.name}"
    for i, (letter, word) in enumerate(COMPONENTS.items()):
        yield _proved(f"{key}.{scene.name}.{letter}", f"{word} {where}", lambda i=i: exact().final_state[i])
    yield _enclosed(f"{key}.{scene.name}.state_error", f"state error {where}", lambda: exact().state_error)
    yield _proved(f"{key}.{scene.name}.energy", f"energy {where}", lambda: exact().energy)
    yield _proved(f"{key}.{scene.name}.energy_change", f"energy change {where}", lambda: exact().energy_change)
    yield _enclosed(f"{key}.{scene.name}.phase_error", f"phase error in degrees {where}", lambda: exact().phase_error)
    calls = lambda: counted_evaluations(key, scene.h)
    yield _counted(f"{key}.{scene.name}.evaluations", f"evaluations {where}", calls)


def _boundary() -> Iterator[Quantity]:
    for n in (1, 2, 3, 5):
        for i, (letter, word) in enumerate(COMPONENTS.items()):
            after = lambda n=n, i=i: state_after(SYMPLECTIC, n, BOUNDARY_H)[i]
            key = f"{SYMPLECTIC}.stability_boundary.step{n}.{letter}"
            yield _proved(key, f"{word} after {n} symplectic steps of 2", after)


def _exercise_1(key: str, title: str) -> Iterator[Quantity]:
    after = lambda: state_after(key, 1, FIRST_H, EXERCISE_START)
    for i, (letter, word) in enumerate(COMPONENTS.items()):
        yield _proved(f"{key}.exercise_1.{letter}", f"{word} in exercise 1, {title}", lambda i=i: after()[i])
    yield _proved(f"{key}.exercise_1.energy", f"energy in exercise 1, {title}", lambda: energy(*after()))


def _conserved_in_exercise_1() -> Q:
    q, v = state_after(SYMPLECTIC, 1, FIRST_H, EXERCISE_START)
    q2, qv, v2 = (at_rational(c, FIRST_H) for c in invariant_quadratic(M(SYMPLECTIC)))
    return q2 * q * q + qv * q * v + v2 * v * v


def _exercise_2(key: str, h: Q, title: str) -> Iterator[Quantity]:
    yield _proved(f"{key}.exercise_2.steps", f"steps in exercise 2, {title}", lambda: Q(run(key, h).steps))
    calls = lambda: counted_evaluations(key, h)
    yield _counted(f"{key}.exercise_2.evaluations", f"evaluations in exercise 2, {title}", calls)


def _all() -> Iterator[Quantity]:
    yield from _setting()
    yield from _exact_states()
    yield from _rates()
    yield from _boundary()
    for key in LESSON_METHODS:
        title = METHODS[key].title
        yield from _first_step(key, title)
        yield from _scene_run(key, title, PRESETS["default"])
        yield from _exercise_1(key, title)
    for key, h in EXERCISE_H.items():
        yield from _exercise_2(key, h, METHODS[key].title)
    conserved = f"{SYMPLECTIC}.exercise_1.invariant"
    yield _proved(conserved, "conserved quadratic in exercise 1", _conserved_in_exercise_1)


QUANTITIES: dict[str, Quantity] = {quantity.id: quantity for quantity in _all()}
