"""The program text of explicit steps for systems y' = f(t, y), component by component or on arrays."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, Protocol

from driftproof.methods.formulas.vector_fields import FLOOR, FUNCTIONS, OF_DERIVATIVES
from driftproof.methods.numbers.number_field import Exact
from driftproof.methods.programs.program_text import (
    ProgramText,
    indented,
    looping_maker_text,
    maker,
    maker_text,
    used_stages,
)
from driftproof.methods.schemes import Collocation, Method, MethodError, Nystrom, RungeKutta, Splitting


class Field(Protocol):
    """What a step needs of a system; `VectorField` is one."""

    @property
    def components(self) -> tuple[str, ...]:
        """The names of the components of the state."""

    @property
    def parameters(self) -> tuple[tuple[str, Exact], ...]:
        """The names in the rates that stand for numbers, and these."""

    @property
    def autonomous(self) -> bool:
        """True if no rate reads t."""

    def second_order(self) -> tuple[tuple[str, ...], tuple[str, ...]]:
        """The names of the positions and of the velocities. Raises MethodError for another system."""

    def at(self, names: Mapping[str, str]) -> list[str]:
        """The rates as text, with t and the components replaced by other names."""


@dataclass(frozen=True)
class FieldSource:
    """The lines of a step, which read y0, y1, ..., t, h and the coefficients, and define y0_new, y1_new, ...

    `coefficients` has those of the method, then the parameters of the field. The lines of a compensated step also
    update e_y0, e_y1, ..., the rounding errors of the additions so far; only `run` can use them.
    """

    lines: tuple[str, ...]
    coefficients: tuple[tuple[str, Exact], ...]
    components: tuple[str, ...]
    compensated: bool
    timed: bool

    def run(self) -> str:
        """The text of make(coefficients...) -> run(y, h, first, last) -> y: steps i = first to last - 1, from t = i h.

        The time, if a rate reads it, is computed anew in each step, with one rounding, rather than accumulated.
        """
        time = ["t = i * h"] if self.timed else []
        body = [*time, *self.lines, f"{self._tuple('')} = {self._tuple('_new')}"]
        loop = ["for i in range(first, last):", *indented(body)]
        start = [f"e_{y} = {y} - {y}" for y in self.components] if self.compensated else []
        lines = [f"{self._tuple('')} = y", *start, *loop, f"return {self._tuple('')}"]
        return looping_maker_text(self._names, "y, h, first, last", lines)

    def step(self) -> str:
        """The text of make(coefficients...) -> step(y, t, h) -> y."""
        lines = [f"{self._tuple('')} = y", *self.lines, f"return {self._tuple('_new')}"]
        return maker_text(self._names, "step", ["def step(y, t, h):", *indented(lines)])

    @property
    def _names(self) -> list[str]:
        return [name for name, _ in self.coefficients]

    def _tuple(self, suffix: str) -> str:
        return f"({''.join(f'{name}{suffix}, ' for name in self.components).rstrip()})"


def field_source(method: Method, field: Field, *, compensated: bool = False, estimated: bool = False) -> FieldSource:
    """The program text of an explicit step for a system, component by component.

    Splittings and Nyström methods need a second-order system, see `VectorField.second_order`, and evaluate only its
    accelerations; time advances with the drifts. Sums are taken from the left, h multiplies a sum once, and factors 1
    and -1 are left out, which is exact in every arithmetic. A stage that nothing uses is left out. In a `compensated`
    step the additions that advance the state keep their rounding errors; `tests/witnesses/compensated.py` derives what
    is gained. `estimated` adds the error estimates y0_off, ... of a pair. Raises MethodError for an implicit method,
    and as `second_order` does.
    """
    if not method.explicit or isinstance(method, Collocation):
        raise MethodError(f"{method.key} is implicit: its stages are equations, so it has no explicit step")
    text = ProgramText(compensated=compensated)
    if isinstance(method, RungeKutta):
        _runge_kutta(method, field, text, method.b_embedded if estimated else None)
    elif isinstance(method, Splitting):
        _splitting(method, field, text)
    else:
        _nystrom(method, field, text)
    _require_new_names(field, text)
    coefficients = (*text.coefficients.items(), *field.parameters)
    return FieldSource(tuple(text.lines), coefficients, field.components, compensated, not field.autonomous)


@dataclass(frozen=True)
class CalledField:
    """A system whose state is y, or q and v, and whose last rate is a call, of the names of t and of y or q."""

    components: tuple[str, ...]
    call: str
    autonomous: bool = False
    parameters: tuple[tuple[str, Exact], ...] = ()

    def second_order(self) -> tuple[tuple[str, ...], tuple[str, ...]]:
        """The names q and v."""
        return self.components[:1], self.components[1:]

    def at(self, names: Mapping[str, str]) -> list[str]:
        """The rates v, unless the state is y, and the call."""
        velocities = (names.get(v, v) for v in self.components[1:])
        return [*velocities, self.call.format(names.get("t", "t"), names[self.components[0]])]


def array_step(method: Method, f: Callable[..., Any], lift: Callable[[Any], Any]) -> Callable[..., tuple[Any, ...]]:
    """The function step((y,), t, h) -> (y₁,) of an explicit Runge-Kutta method for y' = f(t, y), y an array or vector.

    For a splitting or a Nyström method it is step((q, v), t, h) -> (q₁, v₁), for q'' = f(t, q). Its text is that of
    `field_source`. `lift` converts each coefficient to the arithmetic of y. Raises MethodError for an implicit method.
    """
    source = field_source(method, CalledField(("y",) if isinstance(method, RungeKutta) else ("q", "v"), "f({0}, {1})"))
    make = maker(source.step(), method.key, {"f": f})
    step: Callable[..., tuple[Any, ...]] = make(*(lift(c) for _, c in source.coefficients))
    return step


def _runge_kutta(method: RungeKutta, field: Field, text: ProgramText, other: Sequence[Exact] | None) -> None:
    """Write kᵢ = f(t + cᵢ h, y + h Σ aᵢⱼ kⱼ), then y + h Σ bᵢ kᵢ; with other weights b̂, also h Σ (bᵢ - b̂ᵢ) kᵢ."""
    components = field.components
    slopes: dict[str, dict[int, str]] = {name: {} for name in components}
    for i in used_stages(method.a, [method.b, *([] if other is None else [other])]):
        names = {name: f"{name}_{i + 1}" for name in components}
        for name in components:
            names[name] = text.named(names[name], name, text.sum(" + h *", f"a{i + 1}", method.a[i], slopes[name]))
        names["t"] = _time(field, text, i + 1, f"c{i + 1}", method.c[i])
        for name, rate in zip(components, field.at(names), strict=True):
            if other is None and rate.isidentifier():  # it needs no second name; of a pair, all slopes have theirs
                slopes[name][i] = rate
            else:
                slopes[name][i] = f"k{i + 1}_{name}"
                text.lines.append(f"{slopes[name][i]} = {rate}")
    for name in components:
        text.advance(name, f"{name}_new", name, text.sum(" + h *", "b", method.b, slopes[name]))
        if other is not None:
            differences = [x - y for x, y in zip(method.b, other, strict=True)]
            text.lines.append(f"{name}_off ={text.sum(' h *', 'd', differences, slopes[name])}")


def _splitting(method: Splitting, field: Field, text: ProgramText) -> None:
    """Write the kicks and drifts one after the other; time advances with the drifts."""
    positions, velocities = field.second_order()
    latest = {x: x for x in (*positions, *velocities, "t")}
    drifted: Exact = Fraction(0)
    for i, (kind, c) in enumerate(method.parts, 1):
        if c == 0:
            continue
        if kind == "kick":
            latest["t"] = _time(field, text, i, f"s{i}", drifted)
            moved, rates = velocities, _accelerations(field, latest)
        else:
            moved, rates = positions, [latest[v] for v in velocities]
            drifted = drifted + c
        for x, rate in zip(moved, rates, strict=True):
            text.advance(x, f"{x}_{i}", latest[x], f"{text.step(f'c{i}', c)} * {rate}")
            latest[x] = f"{x}_{i}"
    text.lines += [f"{x}_new = {latest[x]}" for x in (*positions, *velocities)]


def _nystrom(method: Nystrom, field: Field, text: ProgramText) -> None:
    """Write the forces kᵢ at q + cᵢ h v + h² Σ aᵢⱼ kⱼ, then the two sums."""
    pairs = list(zip(*field.second_order(), strict=True))
    forces: dict[str, dict[int, str]] = {q: {} for q, _ in pairs}
    for i in used_stages(method.a, [method.b_position, method.b_velocity]):
        node = method.c[i]
        names = {"t": _time(field, text, i + 1, f"c{i + 1}", node)}
        for q, v in pairs:
            drift = text.step(f"c{i + 1}", node)
            moved = f"{drift} * {v}" if drift else ""
            moved += text.sum(" + h * h *", f"a{i + 1}", method.a[i], forces[q])
            names[q] = text.named(f"{q}_{i + 1}", q, moved)
        for (q, v), force in zip(pairs, _accelerations(field, names), strict=True):
            forces[q][i] = f"k{i + 1}_{v}"
            text.lines.append(f"{forces[q][i]} = {force}")
    for q, v in pairs:
        text.advance(q, f"{q}_new", q, f" + h * {v}{text.sum(' + h * h *', 'p', method.b_position, forces[q])}")
    for q, v in pairs:
        text.advance(v, f"{v}_new", v, text.sum(" + h *", "b", method.b_velocity, forces[q]))


def _accelerations(field: Field, names: Mapping[str, str]) -> list[str]:
    """F(t, q), in parentheses because it is a factor, with these names of t and the positions."""
    return [f"({rate})" for rate in field.at(names)[len(field.components) // 2 :]]


def _time(field: Field, text: ProgramText, i: int, name: str, c: Exact) -> str:
    """The name of t + c h, which is only written if a rate reads it."""
    return "t" if field.autonomous else text.named(f"t_{i}", "t", text.step(name, c))


def _require_new_names(field: Field, text: ProgramText) -> None:
    """Raise MethodError for a parameter that has the name of something else in the text, such as h."""
    taken = {"t", "h", "i", "y", "first", "last", "range", "make", "run", "step"}
    taken |= {*FUNCTIONS, *OF_DERIVATIVES, FLOOR, *field.components}
    taken |= {"start_", "end_", "begin_", "member_", *(f"{y}_block" for y in field.components)}
    taken |= {*text.coefficients, *(line.partition(" = ")[0] for line in text.lines)}
    for name in sorted(taken.intersection(dict(field.parameters))):
        raise MethodError(f"a parameter may not be called {name!r}: the text of the step has that name")
