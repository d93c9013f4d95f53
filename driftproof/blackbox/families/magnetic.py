"""Steps of a velocity in an electric and a magnetic field: Boris' step and others, by rotation, kicks and drifts."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from driftproof.blackbox.families.rotations import TURN_ANGLES, Turn, factors_of
from driftproof.blackbox.probes.coefficients import coefficient_text
from driftproof.blackbox.probes.scripted_answers import Rounding
from driftproof.blackbox.report import Criterion
from driftproof.methods.catalogue import METHODS
from driftproof.methods.schemes import Collocation, RungeKutta
from driftproof.support.plain_text import Json

# The parts of a kick before and after the rotation, or of a drift with the old and with the new velocity.
Halves = tuple[float, float]
_ALL = "x' = v, v' = E + v x B"
_WHOLE = "the electric field enters as in a single method for all of v' = E + v x B"
_LEAPFROG, _BOTH_HALVES, _AHEAD = (0.0, 1.0), (0.5, 0.5), (1.0, 0.0)
# For each drift of a leapfrog: where the fields are evaluated, in units of h v from x, and the times of v and x.
_TIMES: Mapping[Halves, tuple[float, str]] = {
    _LEAPFROG: (0.0, "v is half a step behind x"),
    _BOTH_HALVES: (0.5, "half a drift on either side of the push: x and v are at the same time"),
    _AHEAD: (1.0, "v is half a step ahead of x"),
}
# The names that users may give to Boris' step.
BORIS_NAMES = ("boris", "boris push", "boris pusher", "boris step")


@dataclass(frozen=True)
class Boris:
    """Boris' step as a method to compare with: half kicks about a rotation by 2 atan(h B/2), and a leapfrog's drift."""

    key: str = "boris"


@dataclass(frozen=True)
class MagneticReading:
    """The step v1 = R v + h (k R + l) E, x1 = x + h (m v + n v1), where R is a rotation about B, described by `turn`.

    `kick` is (k, l), None if there is no E or another law; `affine` is true if the kick is (R - 1)/z, as in one method
    for the whole of v' = E + v x B, `electric` if the stepper takes an E. `push` is the kick of a step without B, over
    h E. `drift` is (m, n), None if there is no x or another law; with an x, `moved` is what v and what E move it by, as
    factors of h v and h² E at TURN_ANGLES. `asked` holds the c of the places x + c h v at which the fields are
    evaluated. `uneven` says in words that the rotation depends on more than h B, `at_rest` what goes wrong where B is
    0; `kept` is the largest change of |v| seen without E; `flat` is true if only a plane across B was seen.
    """

    turn: Turn
    kick: Halves | None
    affine: bool
    push: float
    drift: Halves | None
    electric: bool
    moved: tuple[Sequence[complex], Sequence[complex]] | None
    asked: tuple[float, ...]
    uneven: str
    at_rest: str
    kept: float
    rounding: Rounding
    flat: bool = False

    @property
    def faults(self) -> list[str]:
        """The faults, whatever method it is meant to be."""
        found = [*filter(None, [self.uneven, self.at_rest])]
        turn, growth = self.turn, self.turn.growth
        if turn.scale < 0:
            found.append("it turns the other way: by B x v, not by v x B")
        if abs(turn.scale) != 1:
            hint = ": of Boris' step, as with t = h B instead of h B/2" if turn.times == 2 else ""
            found.append(f"{turn.lines('h B')[0]}{hint}")
        if growth is not None and not self.affine and not self.uneven:
            hint = ", as in Boris' step without 1/(1 + t^2)" if turn.method == "midpoint2" else ""
            found.append(f"|v| is not preserved without an electric field{hint}: {turn.lines('h B')[1]}")
        if not self._is_same(self.push, 1):
            half = ": one of two half kicks is missing" if self._is_same(self.push, 0.5) else ""
            found.append(f"without B the electric field gives h E times {self._text(self.push)}{half}")
        if self.drift is not None and not self._is_same(sum(self.drift), 1):
            found.append(f"without fields the position moves by {self._text(sum(self.drift))} h v")
        elif self._is(self.drift, _AHEAD) and not any(self.asked) and (self.boris or not self.affine):
            found.append("x moves with the old velocity and fields at the old position: not a leapfrog")
        elif self.boris and self._leapfrog and self._misplaced:
            right = self._place(self._leapfrog[0])
            found.append(f"the fields are evaluated at {self._misplaced}, not at {right}: order 1")
        elif self.affine and self.moved and not (self.uneven or self._staggered or self._of_one_method()):
            found.append(f"the position does not move as in a single method for all of {_ALL}")
        return found

    @property
    def _leapfrog(self) -> tuple[float, str] | None:
        """For the drift of a leapfrog: where the fields belong, and the times of v and x; else None."""
        return next((times for said, times in _TIMES.items() if self._is(self.drift, said)), None)

    @property
    def _misplaced(self) -> str:
        """The place of a field evaluation that is not the leapfrog's; "" if there is none."""
        meant = self._leapfrog[0] if self._leapfrog else 0.0
        return next((self._place(c) for c in self.asked if not self._is_same(c, meant)), "")

    @property
    def _staggered(self) -> bool:
        """True if x and v are half a step apart."""
        return self._is(self.drift, _LEAPFROG) or (self._is(self.drift, _AHEAD) and any(self.asked))

    def _of_one_method(self, factors: Sequence[complex] = (), pulled: Sequence[complex] = ()) -> bool:
        """True if x moves by (R - 1)/z h v, for R as read or given, and by `pulled` or ((R - 1)/z - 1)/z of h² E."""
        assert self.moved is not None
        said = [(r - 1) / (1j * x) for x, r in zip(TURN_ANGLES, factors or self.turn.factors, strict=True)]
        pulled = pulled or [(d - 1) / (1j * x) for x, d in zip(TURN_ANGLES, said, strict=True)]
        allowed = [self.rounding.of(8.0 * (1 + abs(d))) / x**2 for x, d in zip(TURN_ANGLES, said, strict=True)]
        rows = [(self.moved[0], said), *([(self.moved[1], pulled)] if self.electric else [])]
        return all(abs(m - d) <= a for mine, its in rows for m, d, a in zip(mine, its, allowed, strict=True))

    @property
    def boris(self) -> bool:
        """True if rotation and kicks are those of Boris' step."""
        return self.turn.known and self.turn.name == "implicit_midpoint" and self._is(self.kick, _BOTH_HALVES)

    @property
    def key(self) -> str | None:
        """The key of Boris' step, if it is that and has no fault; else None."""
        return "boris" if self.boris and not self.faults else None

    @property
    def named(self) -> bool:
        """True if the verdict names a method, exactly or nearly."""
        return bool(self.turn.method) and not self.uneven

    @property
    def verdict(self) -> str:
        """The verdict in one line."""
        staggered = self._leapfrog[1] if self._leapfrog and self._staggered else ""
        if self._is(self.drift, _BOTH_HALVES) and not self.asked and self.boris:
            staggered = "x and v are at the same time if the fields are those at x + 1/2 h v"
        plane = " in the plane, with B across it" * self.flat
        if self.uneven:
            name = "not a known step"
        elif self.boris:
            name = "boris"
        elif self.turn.known and self.affine:
            name = f"{self.turn.name} of v' = E + v x B"
        elif self.turn.known and self._is(self.kick, _BOTH_HALVES):
            name = f"boris except for its rotation, which is {self.turn.name}"
        elif self._is(self.kick, _BOTH_HALVES) or self.turn.method:
            known = self.turn.known and self.turn.name == "implicit_midpoint"
            other = f"a rotation by {self.turn.name}" if self.turn.method else self.turn.name
            name = f"{'the rotation of boris' if known else other}{self._kicks}"
        else:
            name = "not a known step"
        unknown = "the position moves by another law" if self.moved and not self.drift and not self.affine else ""
        return "; ".join([f"it is {name}{plane}", *filter(None, [staggered, unknown]), *self.faults])

    @property
    def _kicks(self) -> str:
        """The kicks in words if they are not half kicks; else ""."""
        if not self.electric or self._is(self.kick, _BOTH_HALVES) or self.faults:
            return ""
        whole = {(1.0, 0.0): "the whole kick before it", (0.0, 1.0): "the whole kick after it"}
        return f", with {next((words for said, words in whole.items() if self._is(self.kick, said)), 'other kicks')}"

    @property
    def parts(self) -> list[tuple[str, list[str]]]:
        """The evidence: titles with lines."""
        turn = self.turn.lines("h B")
        kept = f"|v| is preserved in steps with E = 0: off by {self.kept:.1e} at most"
        size = turn[1:] if self.turn.growth else [kept, "areas across B, and so volumes of velocities, are preserved"]
        kick, drift, where = self.kick, self.drift, "for B along (0, 0, 1), " if self.uneven else ""
        kicks = [] if kick is None else [f"kick {self._text(kick[0])} h E, rotation, kick {self._text(kick[1])} h E"]
        if self._is(kick, (1.0, 0.0), (0.0, 1.0)) and not self.affine:
            kicks.append("order 1 where both fields act: a half kick on either side of the rotation has order 2")
        if self.affine and not self.boris:
            kicks = [_WHOLE]
        moved = [] if drift is None else [f"x1 = x + {self._drift}"]
        if self._leapfrog and self._staggered:
            moved.append(f"{self._leapfrog[1]}: as a step from x and v at the same time it has order 1")
        places = dict.fromkeys(map(self._place, self.asked))
        moved += [f"the fields are evaluated at {' and at '.join(places)}"] if places and self._leapfrog else []
        return [("Rotation", [f"{where}{self.turn.name}: {turn[0]}", *size]), ("Kicks", kicks), ("Position", moved)]

    @property
    def data(self) -> dict[str, Json]:
        """The rotation, the kick and the drift for programs."""
        return {
            "method": self.key,
            "rotation": self.turn.name,
            "rotation_order": self.turn.order,
            "kick": None if self.kick is None else [repr(x) for x in self.kick],
            "drift": None if self.drift is None else [repr(x) for x in self.drift],
        }

    def criteria(self, method: object) -> list[Criterion]:
        """The criteria of a method in constant fields: the rotation, how E enters, and how x moves."""
        if isinstance(method, Boris):
            halves = self._is(self.kick, _BOTH_HALVES)
            words = ("half a kick of E on either side of the rotation" if halves else "E does not enter by half kicks",)
            _, moved = self._leapfrog or (0.0, "the position does not move by a drift of a leapfrog")
            drift = (self._staggered or self._is(self.drift, _BOTH_HALVES)) and not self._misplaced
            rotation = self.turn.held_to(METHODS["implicit_midpoint"])
        else:
            whole = "E does not enter as in a single method for all of v' = E + v x B"
            halves, words = self.affine, (_WHOLE if self.affine else whole,)
            drift, moved = self._moved_as(method)
            rotation = self.turn.held_to(method)
        kicks = (halves or not self.electric) and not self.faults
        lines = tuple(self.faults) or (words if self.electric else ("it takes no electric field",))
        checks = [rotation, Criterion("Electric field", kicks, lines, {})]
        return [*checks, Criterion("Position", drift if self.moved else None, (moved,), {})]

    def _moved_as(self, method: object) -> tuple[bool, str]:
        """Whether x moves as in this method for x and v together, and the same in words."""
        if self.moved is None:
            return False, "it does not move a position"
        if not isinstance(method, RungeKutta | Collocation):
            return False, f"{getattr(method, 'key', 'the method')} is not defined for {_ALL}: verify it as boris"
        factors, pulled = zip(*(factors_of(method, 1j * x) for x in TURN_ANGLES), strict=True)
        same = self._of_one_method(factors, pulled)
        law = "by another law" if self.drift is None else f"by {self._drift}"
        said = f"as in {method.key} for all of {_ALL}"
        return same, f"the position moves {said}" if same else f"the position moves {law}, not {said}"

    @property
    def _drift(self) -> str:
        """The movement of x in a step, as a formula."""
        pairs = zip(self.drift or (), ("v", "v1"), strict=False)
        parts = [f"{self._text(x)} {v}".removeprefix("1 ") for x, v in pairs if x]
        return f"h ({' + '.join(parts)})" if len(parts) > 1 else f"h {parts[0]}" if parts else "0"

    def _text(self, x: float) -> str:
        return coefficient_text(x, self.rounding.format, self._off)

    def _place(self, node: float) -> str:
        return f"x + {self._text(node)} h v".replace(" 1 h", " h") if node else "x"

    @property
    def _off(self) -> float:
        return self.rounding.of(4.0)

    def _is_same(self, x: float, y: float) -> bool:
        return abs(x - y) <= self._off

    def _is(self, halves: Halves | None, *said: Halves) -> bool:
        return halves is not None and any(all(map(self._is_same, halves, each)) for each in said)
