"""Building blocks of the program text of a step: sums from the left, named coefficients, functions that make it."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

from driftproof.methods.numbers.number_field import Exact


class ProgramText:
    """The lines of a step and the coefficients that they name, in the order in which they are written.

    In a `compensated` text the additions that advance a component y0 also keep their rounding error, as e_y0;
    `tests/witnesses/compensated.py` derives what is gained.
    """

    def __init__(self, *, compensated: bool) -> None:
        self.compensated = compensated
        self.lines: list[str] = []
        self.coefficients: dict[str, Exact] = {}

    def named(self, name: str, start: str, moved: str) -> str:
        """The name of start + moved: `name`, which a new line defines, or `start` if nothing is added."""
        if not moved:
            return start
        self.lines.append(f"{name} = {start}{moved}")
        return name

    def sum(self, times: str, row: str, weights: Sequence[Exact], slopes: Mapping[int, str]) -> str:
        """The text of times (Σ wⱼ kⱼ), summed from the left; "" if all weights are zero."""
        text = ""
        for j, weight in enumerate(weights):
            if weight != 0:
                sign, factor = self._factor(f"{row}_{j + 1}", weight)
                text += f"{f' {sign} ' if text else sign.removeprefix('+')}{factor}{slopes[j]}"
        return f"{times} {f'({text})' if ' ' in text or '-' in text else text}" if text else ""

    def step(self, name: str, c: Exact) -> str:
        """The text of + c h, such as " + (c2 * h)" or " - h"; "" if c = 0."""
        if c == 0:
            return ""
        sign, factor = self._factor(name, c)
        return f" {sign} ({factor}h)" if factor else f" {sign} h"

    def advance(self, x: str, new: str, old: str, moved: str) -> None:
        """Write new = old + moved; if compensated, also add the last rounding error and keep the new one.

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
        """The sign and the factor of a product with c: ("+", "name * "), or a sign and "" if c is 1 or -1."""
        if c in (1, -1):
            return ("+" if c == 1 else "-"), ""
        self.coefficients[name] = c
        return "+", f"{name} * "


def used_stages(a: Sequence[Sequence[Exact]], weights: Iterable[Sequence[Exact]]) -> list[int]:
    """The stages on which the result depends: those with a nonzero weight, and those that they use in turn."""
    open_rows, used = list(weights), set[int]()
    while open_rows:
        found = {j for j, x in enumerate(open_rows.pop()) if x != 0} - used
        used |= found
        open_rows += [a[j] for j in found]
    return sorted(used)


def indented(lines: Iterable[str]) -> list[str]:
    """The lines, indented by four more columns."""
    return [f"    {line}" for line in lines]


def maker_text(arguments: Iterable[str], name: str, lines: Iterable[str]) -> str:
    """The text of make(arguments...), which returns the function `name` that the lines define."""
    return "\n".join([f"def make({', '.join(arguments)}):", *indented([*lines, f"return {name}"]), ""])


def looping_maker_text(arguments: Sequence[str], head: str, lines: Iterable[str]) -> str:
    """Like `maker_text`, for a function run that loops: it first copies the arguments of make to faster local names."""
    name = lambda x: f"of_{x}"
    taken = [f"{', '.join(arguments)}, = {', '.join(map(name, arguments))},"] if arguments else []
    return maker_text(map(name, arguments), "run", [f"def run({head}):", *indented([*taken, *lines])])


def maker(text: str, key: str, functions: Mapping[str, Callable[..., Any]] | None = None) -> Callable[..., Any]:
    """Execute such a text and return its function make; it knows `functions` by name, and tracebacks show `key`.

    Only for text that driftproof has written, of names, operators and integers.
    """
    namespace: dict[str, Any] = dict(functions or {})
    exec(compile(text, f"<{key}>", "exec"), namespace)
    make: Callable[..., Any] = namespace["make"]
    return make
