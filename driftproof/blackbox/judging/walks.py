"""Comparison of successive steps with the method's, for many numbers of components, sizes, times and step sizes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import partial
from itertools import islice
from math import log2

from flint import arb, ctx

from driftproof.blackbox.findings import Misbehaviour, NoAnswer, NotFinite, StepFinding
from driftproof.blackbox.judging.agreement import ordinary_arguments, steps_back
from driftproof.blackbox.judging.nonlinear_problems import (
    START,
    NonlinearProblem,
    beginning_at_rest,
    moved,
    standing_still,
)
from driftproof.blackbox.judging.nonlinear_step import BITS, REFUSALS, NonlinearComparison
from driftproof.blackbox.judging.specification import Domain, Specification
from driftproof.blackbox.matching.tables import exact_tableau
from driftproof.blackbox.stepper.calling_conventions import FIELD, FORCE
from driftproof.blackbox.stepper.foreign_stepper import ForeignStepper
from driftproof.blackbox.stepper.states.array_adapters import AnyNumber

# The numbers of components tried: all up to one more than the widest vector registers hold, among them those of states
# that codes treat in a way of their own (6 of a satellite, 7 with a quaternion, 13 of a rigid body); then whole blocks.
# There are fewer positions, because each force is a product of all of them, and fewer components for implicit methods,
# because iterating their stages in balls is slow.
_NUMBERS, _POSITIONS, _SOLVED_FOR = (*range(1, 18), 24, 32), (*range(1, 13), 16, 32), (1, 2, 3, 4, 6, 7)
# Step sizes in units of the problem's own time: so short that numbers keep their sizes, of many bits, one taken twice.
# The third is almost the second, for which a code that keeps something of that h may take it.
_LENGTHS, _BACK = (0.1, 0.1, 0.1 * (1 - 2.0**-10), 1 / 30), (-0.07, -0.03)
# How many step sizes are tried with each further number of components, and how many numbers at the home place as well.
_FEW, _AT_HOME = 2, 9
# More equal steps than the start of any multistep method in use has, for codes that become one; and how many pairs of a
# place and a number of components are tried with h < 0.
_EQUAL, _PAIRS_BACK = 12, 7
# What precedes a step: a step that ends where it starts, or one after which the state was changed, as by an event, or
# by so little that a code which compares states to eleven digits takes it for the same one, and far above rounding.
_GOES_ON, _MOVED = "continues from the previous one", "begins when the previous one ended, in another state,"
_NUDGED, NUDGE = "begins when the previous one ended, in almost its state,", 1 + 2.0**-37
# Places of stages, in units of u, that count as one: rounding moves them by less.
_NEAR = 2.0**16


@dataclass(frozen=True)
class _Place:
    """The place of a moved problem: signed sizes, repeated as needed; the exponent of its pace; its origin of time.

    If it is `at_rest`, all slopes of a problem with t vanish at its start.
    """

    sizes: tuple[float, ...] = (1.0,)
    pace: int = 0
    origin: float = 0.0
    at_rest: bool = False

    @property
    def start(self) -> float:
        """The time at which walks begin here."""
        return self.origin + START * 2.0**-self.pace

    def problem(self, problem: NonlinearProblem) -> NonlinearProblem:
        """The problem moved here, with positions of one size if a force may be asked for a single one of them."""
        there = moved(problem, self.sizes if problem.coupled else self.sizes[:1], 2.0**self.pace, self.origin)
        return beginning_at_rest(there, self.start) if self.at_rest and problem.timed else there

    def within(self, domain: Domain, subject: ForeignStepper) -> bool:
        """True if its numbers, doubled, and step sizes lie in the domain and well inside the range of the format."""
        (shortest, longest), (smallest, largest) = domain.ranges
        room = subject.format.emax // 3
        lengths = [x * 2.0**-self.pace for x in _LENGTHS]
        return (
            all(2 * abs(x) <= largest and abs(x) >= smallest for x in self.sizes)
            and shortest <= min(lengths)
            and max(lengths) <= longest
            and max(*(abs(log2(abs(x))) for x in self.sizes), 2 * abs(self.pace)) <= room
        )


# Short steps with steep slopes and long steps with flat ones, at times before 0 and long after it, which have all bits;
# then at the time 0 itself, and at a Julian day, the largest times in use.
_PLACES = (
    _Place(),
    _Place((256.0,), -4, 1000.1),
    _Place((1.0, -256.0, 2.0**-30), 0, -7.3),
    _Place((2.0**-20,), 12, 100.1),
    _Place((-256.0,), 10, -0.7),
    _Place((1.0, -1.0), 0, -START, at_rest=True),
    _Place(origin=2451544.5),
)
# The place at which every number of components is tried.
_HOME = _Place((1.0, -1.0))


@dataclass(frozen=True)
class _Step:
    """One step of a walk that is not the method's."""

    place: _Place
    numbers: int
    t: float
    y: tuple[float, ...]
    h: float
    before: str
    words: str


class Walker(NonlinearComparison):
    """A comparison of successive steps at many places."""

    @property
    def what(self) -> str:
        """The noun for the components of its state."""
        return "positions" if self.partitioned else "components"

    def counted(self, numbers: int) -> str:
        """The count with its noun, such as "1 position" or "3 numbers"."""
        masses = " of unequal masses" * (numbers > 1 and self.subject.form.unequal_masses)
        return f"{numbers} {self.what if numbers > 1 else self.what[:-1]}{masses}"

    @property
    def numbers(self) -> tuple[int, ...]:
        """The numbers of components, or of positions, of the problems tried."""
        return _POSITIONS if self.partitioned else _NUMBERS if self.method.explicit else _SOLVED_FOR

    @property
    def places(self) -> list[_Place]:
        """The places that lie within the domain."""
        return [place for place in map(self.fitted, _PLACES) if place.within(self.wanted.domain, self.subject)]

    def fitted(self, place: _Place) -> _Place:
        """The place, with sizes of 1 for an implicit method, whose solver has a scale of its own."""
        return place if self.method.explicit else replace(place, sizes=(1.0,))

    def walk(self, problem: NonlinearProblem, place: _Place, lengths: Sequence[float]) -> _Step | None:
        """The first step that is not the method's; None if all are. Raises a Misbehaviour of the stepper."""
        there, t = place.problem(problem), place.start
        y = start = there.start(t)
        # A step of another right-hand side from the same start: a code that caches by t, y and h alone then goes wrong.
        rest = replace(there, rate=lambda t, y: [0.0 * x for x in y])
        rest.stepped(self.subject, t, y, lengths[0] * 2.0**-place.pace)
        after = ["", *[_GOES_ON] * (len(lengths) - 1), _MOVED if lengths == _LENGTHS else _NUDGED]
        for length, before in zip((*lengths, lengths[-1]), after, strict=True):
            h = length * 2.0**-place.pace
            y = start if before == _MOVED else [NUDGE * x for x in y] if before == _NUDGED else y
            seen = self.compared(there, t, y, h)
            if seen.wrong:
                n = there.positions or len(y)
                words = f"{seen.place}, with {self.counted(n)}, {seen.numbers}"
                return _Step(place, n, t, tuple(y), h, before, words)
            t, y = t + h, seen.end
        return None

    def why(self, step: _Step, problem: NonlinearProblem, of_numbers: dict[int, list[NonlinearProblem]]) -> str:
        """The one condition under which the step is wrong, "" if there is not just one. Raises a Misbehaviour."""
        there = step.place.problem(problem)
        if step.before:
            there.stepped(self.subject, step.t + 1, [x / 2 for x in step.y], step.h)
            if not self.compared(there, step.t, step.y, step.h).wrong:
                return f"a step that {step.before} differs from the same step taken alone"
        lengths = _LENGTHS if step.h > 0 else _BACK
        if self.walk(problem, _Place(), lengths):
            others = [found[0] for n, found in of_numbers.items() if n in (1, 2, 3) and n != step.numbers]
            if others and not any(self.walk(other, _Place(), lengths) for other in others):
                return f"with {self.counted(step.numbers)} it takes a different step"
            return ""
        alone = {
            f"at t = {step.t:.6g} it takes a different step": _Place(origin=step.place.origin),
            f"with h = {step.h:.6g} it takes a different step": _Place(pace=step.place.pace),
            "with components of other sizes it takes a different step": _Place(sizes=step.place.sizes),
        }
        return next((words for words, place in alone.items() if self.walk(problem, place, lengths)), "")


def walked(subject: ForeignStepper, wanted: Specification) -> StepFinding:
    """Compare successive steps with the method's, as `walk_on` does, and steps with the slope 0 at a later stage."""
    walker = Walker(subject, wanted)
    found = walk_on(walker)
    if found.holds:
        still, (_, steps) = "where the slope of one stage is exactly 0", ordinary_arguments(subject, wanted.domain)
        of_stages, h = (_standing_still, steps[0]) if wanted.method.explicit else (_settled, steps[1])
        try:
            with suppress(*REFUSALS), ctx.workprec(BITS):
                for problem in of_stages(walker, h):
                    seen = walker.compared(problem, START, problem.start(START), h)
                    if seen.wrong:
                        return StepFinding(False, f"{still}, {seen.place}, {seen.numbers}")
        except NotFinite as failure:
            return StepFinding(False, f"{still}, {failure}")
    return found


def _standing_still(walker: Walker, h: float) -> Iterator[NonlinearProblem]:
    """Yield, for each later stage of an explicit method, a problem in which all slopes are 0 at its place."""
    near, numbers = _NEAR * float(walker.subject.format.u), 0 if walker.partitioned else 2 - walker.subject.single
    problem = partial(standing_still, near=near, numbers=numbers, positions=int(walker.partitioned))
    steady, places = problem(0.0), list[arb]()

    def noted(t: AnyNumber, y: list[AnyNumber]) -> Sequence[AnyNumber]:
        places.append(y[0])
        return steady.rate(t, y)

    walker.own_step(replace(steady, rate=noted), START, steady.start(START), h)
    found = dict.fromkeys(float(x.mid()) for x in places)
    yield from (problem(place) for place in found if abs(place - 1) > 4 * near)


def _settled(walker: Walker, h: float) -> Iterator[NonlinearProblem]:
    """Yield, for each stage of an implicit method, a problem in which the slope of that stage is 0, as at the start."""
    (problem,), t = walker.problems(2 - walker.subject.single), START
    near = _NEAR * float(walker.subject.format.u)
    for node in exact_tableau(walker.method)[2] if problem.timed and not walker.partitioned else ():
        stage = t + float(node) * h

        def rate(at: AnyNumber, y: Sequence[AnyNumber], stage: float = stage) -> list[AnyNumber]:
            weight = (at - t) * (at - stage) / h**2 * (abs(at - stage) > near)
            return [weight * k for k in problem.rate(at, [*y])]

        yield replace(problem, rate=rate)


def walk_on(walker: Walker, lengths: Sequence[float] = _LENGTHS, most: int | None = None) -> StepFinding:
    """Compare successive steps with the method's, for each number of components and at each place.

    Places and numbers of components are paired so that each occurs, in `most` pairs at most. The answer is None if no
    such step is taken, and the call is always "". Raises UnsupportedCall if the system is built in.
    """
    with ctx.workprec(BITS):
        try:
            return _walked_on(walker, lengths, most)
        except NotFinite as failure:
            return StepFinding(False, str(failure))


def there_and_back(walker: Walker) -> StepFinding:
    """Compare as `walk_on` does and, if the steps are right and h < 0 is not refused, also for h < 0 at two places."""
    found = walk_on(walker)
    if found.holds and (back := walk_on(walker, _BACK, _PAIRS_BACK)).holds is False:
        return StepFinding(False, f"a step with h < 0 is wrong: {back.words}")
    return found


def _walked_on(walker: Walker, lengths: Sequence[float], most: int | None) -> StepFinding:
    taken, times, refused = list[int](), list[float](), ""
    of_numbers: dict[int, list[NonlinearProblem]] = {}
    for n in walker.numbers:
        with suppress(*REFUSALS):
            of_numbers[n] = walker.problems(n)
        if len(of_numbers) == most:
            break
    for place, problems, each in islice(_settings(walker, [*of_numbers.values()], lengths), most):
        found: list[_Step] = []
        for problem in problems:
            try:
                step = walker.walk(problem, place, each)
            except REFUSALS as refusal:
                refused = refused or str(refusal)
                break
            if step is None:
                taken.append(problem.positions or len(problem.names))
                times += [place.origin] * problem.timed
                break
            found.append(step)
        else:
            cause = ""
            with suppress(Misbehaviour, NoAnswer):  # without a cause, the wrong step stands
                cause = walker.why(found[0], problems[0], of_numbers)
            return StepFinding(False, ": ".join(filter(None, [cause, found[0].words])))
    if not taken:
        return StepFinding(None, f"it takes no such step: {refused}" if refused else "the domain is too small for it")
    sizes = f"{_listed(sorted({*taken}))}{walker.counted(max(taken)).removeprefix(str(max(taken)))}"
    also = f"; it does not take all of them: {refused}" if refused else ""
    steps = "runs, each step from the end of the previous one, the last from another state"
    words = f"{len(taken)} {steps}, with {sizes}"
    when = f", at times from {min(times):g} to {max(times):g}" if times else ""
    return StepFinding(True, f"{words}{when}{also}")


def _listed(numbers: Sequence[int]) -> str:
    """The numbers in words, with runs of three or more as "1 to 17"."""
    runs = list[list[int]]()
    for n in numbers:
        if runs and n == runs[-1][-1] + 1:
            runs[-1].append(n)
        else:
            runs.append([n])
    return ", ".join(f"{run[0]} to {run[-1]}" if len(run) > 2 else ", ".join(map(str, run)) for run in runs)


def _settings(
    walker: Walker, sizes: Sequence[list[NonlinearProblem]], lengths: Sequence[float]
) -> Iterator[tuple[_Place, list[NonlinearProblem], Sequence[float]]]:
    """Yield places with problems and step sizes, so that each place and each number of components occurs.

    Then come further steps of each number at the home place, and many equal steps.
    """
    places = walker.places
    if not (sizes and places):
        return
    for i in range(max(len(sizes), len(places))):
        yield places[i % len(places)], sizes[i % len(sizes)], lengths if i < len(places) else lengths[:_FEW]
    home = walker.fitted(_HOME)
    # Stages of an implicit method are iterated in balls, which is slow.
    if walker.method.explicit and home.within(walker.wanted.domain, walker.subject):
        yield from ((home, problems, lengths[:1]) for problems in sizes[1:_AT_HOME])
    yield places[0], sizes[min(1, len(sizes) - 1)], [lengths[0] / 2] * _EQUAL


def back_and_on(subject: ForeignStepper, wanted: Specification) -> StepFinding:
    """Compare steps with h < 0 as `steps_back` does; if right, also on nonlinear problems if these can be given."""
    found = steps_back(subject, wanted)
    if not found.holds or subject.convention.kind not in (FIELD, FORCE):
        return found
    on = walk_on(Walker(subject, wanted), _BACK, _PAIRS_BACK)
    if on.holds is False:
        return StepFinding(False, f"a step with h < 0 is wrong: {on.words}")
    return on._replace(words="; ".join(filter(None, (found.words, on.words)))) if on.holds or subject.single else found
