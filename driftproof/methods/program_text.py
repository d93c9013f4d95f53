"""What the program text of any step is made of: sums from the left, coefficients under names, functions around them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

from driftproof.methods.number_field import Exact


class ProgramText:
    """Lines of a step and the coefficients that they name, as they come up.

    `compensated`: the additions that advance the state carry along what they round off, under names e_ and the
    component's; `tests/witnesses/compensated.py` derives what that is good for.
    """

    def __init__(self, *, compensated: bool = False) -> None:
        """Start with neither."""
        self.compensated = compensated
        self.lines: list[str] = []
        self.coefficients: dict[str, Exact] = {}

    def named(self, name: str, start: str, moved: str) -> str:
        """A name for start + what it moved by: a new one, or that of the start if it did not."""
        if not moved:
            return start
        self.lines.append(f"{name} = {start}{moved}")
        return name

    def sum(self, times: str, row: str, weights: Sequence[Exact], slopes: Mapping[int, str]) -> str:
        """The text of times (Σ wⱼ kⱼ), from the left; nothing where all weights are zero."""
        text = ""
        for j, weight in enumerate(weights):
            if weight != 0:
                sign, factor = self._factor(f"{row}_{j + 1}", weight)
                text += f"{f' {sign} ' if text else sign.removeprefix('+')}{factor}{slopes[j]}"
        return f"{times} {f'({text})' if ' ' in text or '-' in text else text}" if text else ""

    def step(self, name: str, c: Exact) -> str:
        """The text + (c h), or - h."""
        sign, factor = self._factor(name, c)
        return f" {sign} ({factor}h)" if factor else f" {sign} h"

    def advance(self, x: str, new: str, old: str, moved: str) -> None:
        """The text new = old + what it moves by; compensated, with what was lost before, and what is lost now kept.

        That is Knuth's exact sum (muller-2018, 4.3.2): six additions without a branch, whichever summand is larger.
        """
        if not self.compensated:
            self.lines.append(f"{new} = {old}{moved}")
            return
        self.lines += [
            f"d = e_{x}{moved}",
            f"{new} = {old} + d",
            f"g = {new} - {old}",
            f"e_{x} = ({old} - ({new} - g)) + (d - g)",
        ]

    def _factor(self, name: str, c: Exact) -> tuple[str, str]:
        """A sign, and the coefficient with its sign for product: ("+", "name * "), or nothing to multiply by."""
        if c in (1, -1):
            return ("+" if c == 1 else "-"), ""
        self.coefficients[name] = c
        return "+", f"{name} * "


def used_stages(a: Sequence[Sequence[Exact]], weights: Iterable[Sequence[Exact]]) -> list[int]:
    """The stages that the result depends on: those with a weight, and those that such stages are formed of."""
    open_rows, used = list(weights), set[int]()
    while open_rows:
        found = {j for j, x in enumerate(open_rows.pop()) if x != 0} - used
        used |= found
        open_rows += [a[j] for j in found]
    return sorted(used)


def indented(lines: Iterable[str]) -> list[str]:
    """The lines, four columns further in."""
    return [f"    {line}" for line in lines]


def maker_text(arguments: Iterable[str], name: str, lines: Iterable[str]) -> str:
    """The text of make(arguments...), which returns the function `name` that the lines define."""
    return "\n".join([f"def make({', '.join(arguments)}):", *indented([*lines, f"return {name}"]), ""])


def looping_maker_text(arguments: Sequence[str], head: str, lines: Iterable[str]) -> str:
    """The same of a function run that loops: it first takes the arguments of make over, into names that are faster."""
    name = lambda x: f"of_{x}"
    taken = [f"{', '.join(arguments)}, = {', '.join(map(name, arguments))},"] if arguments else []
    return maker_text(map(name, arguments), "run", [f"def run({head}):", *indented([*taken, *lines])])


def maker(text: str, key: str, functions: Mapping[str, Callable[..., Any]] | None = None) -> Callable[..., Any]:
    """The function make of such a text, in which `functions` are known by name; `key` stands in tracebacks.

    Only for text of our own writing, which is names, operators and integers: it is executed.
    """
    namespace: dict[str, Any] = dict(functions or {})
    exec(compile(text, f"<{key}>", "exec"), namespace)
    make: Callable[..., Any] = namespace["make"]
    return make
