"""The facts of a method, of a family or on a system: as attributes, in brackets, as text, TeX and JSON."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias, overload

from driftproof.methods.catalogue import Entry, FurtherMethod
from driftproof.methods.families import Family
from driftproof.methods.formulas.expressions import parse_number, parse_system
from driftproof.methods.given_methods import subject_of
from driftproof.methods.numbers.number_field import Algebraic
from driftproof.methods.numbers.rationals import ExactNumber, exact_number
from driftproof.methods.schemes import Method
from driftproof.support.plain_text import Json, as_json
from driftproof.support.results import Printable
from driftproof.symbolic.claimed_orders import false_claims, restoring_entries
from driftproof.symbolic.facts import (
    FACTS,
    ON_REQUEST,
    Facts,
    OrderWithin,
    Reduction,
    facts_of_further,
    hidden_by_rounding,
    order_within,
)
from driftproof.symbolic.linear.facts import TERMS, facts_by_name
from driftproof.symbolic.linear.systems import facts_on_system
from driftproof.texts.writing.fact_groups import grouped_facts_text
from driftproof.texts.writing.facts import facts_tex, facts_text
from driftproof.texts.writing.records import record

# The matrix of a system z' = Az: its rows, or "0 1; -1 -1/10".
GivenSystem: TypeAlias = str | Sequence[Sequence[ExactNumber]]
_Derive: TypeAlias = Callable[[Sequence[str]], dict[str, Any]]
# Where one of these is printed, the claims of orders are examined.
_CLAIMED = ("order", "claimed_order", "order_but_for_rounding", "embedded_order", "zero_stable", "root_condition")


class FactSheet(Printable):
    """Facts by name, in brackets or as attributes, each derived when it is asked for; `only` names those printed."""

    def __init__(
        self,
        derive: _Derive,
        only: Sequence[str],
        *,
        grouped: bool = True,
        claims_of: Entry | None = None,
        tolerance: Fraction | None = None,
    ) -> None:
        """Derive nothing yet. `grouped` is False for facts about something other than a method.

        The orders that `claims_of` claims are examined, to the tolerance if there is one.
        """
        self._tolerance = tolerance
        self._derive, self._only, self._grouped = derive, tuple(only), grouped and not only
        self._claims_of = None if only and not {*only} & {*_CLAIMED} else claims_of

    @cached_property
    def unreached(self) -> tuple[str, ...]:
        """The orders that are claimed and not reached, not even but for rounding, with what may be wrong, in lines.

        It is empty if neither an order nor zero-stability is among the facts that are printed.
        """
        lines: list[str] = []
        for found in false_claims(self._claims_of, self._tolerance) if self._claims_of else ():
            lines.append(str(found))
            row = " b_embedded[" if found.embedded else " b["
            entries = restoring_entries(found.method, found.method.claimed_order)
            lines += [entry.replace(" b[", row) for entry in entries]
        return tuple(lines)

    @cached_property
    def shown(self) -> dict[str, Any]:
        """The facts that are printed. Raises ValueError for an unknown name."""
        return self._derive(self._only)

    def __getitem__(self, name: str) -> Any:
        """The fact of this name. Raises ValueError for an unknown name."""
        return self.shown[name] if "shown" in self.__dict__ and name in self.shown else self._derive((name,))[name]

    if not TYPE_CHECKING:  # checkers know the facts of a method by their types

        def __getattr__(self, name: str) -> Any:
            """The fact of this name. Raises AttributeError for an unknown name."""
            if name.startswith("_"):
                raise AttributeError(name)
            try:
                return self[name]
            except ValueError as error:
                raise AttributeError(str(error)) from None

    @property
    def data(self) -> dict[str, Json]:
        """The facts that are printed, as JSON: numbers are strings, a fact that there is not is None."""
        found: dict[str, Json] = record(self.shown)
        return found | ({"unreached": [*self.unreached]} if self.unreached else {})

    def written(self, form: str, everything: bool = False) -> str:
        """The facts as "text", "json" or "tex"; `everything` shows also those that groups of text leave out."""
        if form == "json":
            return as_json(self.data)
        if form == "tex":
            return "".join(f"% {line}\n" for line in self.unreached) + facts_tex(self.shown)
        text = grouped_facts_text(self.shown, everything) if self._grouped else facts_text(self.shown)
        return "\n".join([*self.unreached, *[""] * bool(self.unreached), text])


class MethodFacts(FactSheet, Facts):
    """The facts of a method as typed attributes, such as `order` and `imaginary_limit`; printed, a sheet of facts."""

    def __init__(self, method: Method, only: Sequence[str], tolerance: ExactNumber | None, terms: int) -> None:
        """Derive nothing yet; `terms` is the length of series."""
        Facts.__init__(self, method, terms)
        given = None if tolerance is None else exact_number(tolerance, "order tolerance")
        FactSheet.__init__(self, self._by_name, only, claims_of=method, tolerance=given)

    @cached_property
    def order_to_tolerance(self) -> OrderWithin | None:
        """The order if residuals up to the given tolerance count as zero; None without a tolerance."""
        return None if self._tolerance is None else order_within(self.method, self._tolerance)

    def _by_name(self, names: Sequence[str]) -> dict[str, Any]:
        """The named facts, and what else they need: `reduction`, and what the rounding of the coefficients hides."""
        found = facts_by_name(self, names or FACTS, (*FACTS, *ON_REQUEST)) | hidden_by_rounding(self, names)
        if names and "reduction" not in names and self.reduction is not None:
            stages, *named = self.reduction
            table, irreducible = (tuple(name for name in known if name in found) for known in named)
            if table or irreducible:
                found["reduction"] = Reduction(stages, table, irreducible)
        if self.order_to_tolerance is not None:
            found["order_to_tolerance"] = self.order_to_tolerance
        return found


@overload
def facts(
    method: str | Path | Method,
    *,
    only: Sequence[str] | None = None,
    at: Algebraic | ExactNumber | None = None,
    system: None = None,
    order_tolerance: ExactNumber | None = None,
    terms: int = TERMS,
) -> MethodFacts: ...
@overload
def facts(
    method: str | Path | Method | Family | FurtherMethod,
    *,
    only: Sequence[str] | None = None,
    system: GivenSystem | None = None,
    order_tolerance: ExactNumber | None = None,
) -> FactSheet: ...
def facts(
    method: str | Path | Method | Family | FurtherMethod,
    *,
    only: Sequence[str] | None = None,
    at: Algebraic | ExactNumber | None = None,
    system: GivenSystem | None = None,
    order_tolerance: ExactNumber | None = None,
    terms: int = TERMS,
) -> FactSheet:
    """The exact facts of a method, given as its key or name, a .toml file, or itself.

    For a family, `at` chooses one method; without it the facts are functions of its parameter. With `system`, a matrix
    such as "0 1; -1 -1/10", they are about z' = Az. `only` names the facts that are printed; each fact is also an
    attribute. The facts of families, of further methods, and on systems have names of their own; for their
    type give the object, such as `FAMILIES["sdirk_order_2"]`. Raises ValueError for arguments that do not fit together.

    >>> from driftproof import facts
    >>> found = facts("RK4", only=["order", "imaginary_limit"])
    >>> found.order, found.a_stable
    (4, False)
    >>> found
    order            4
    imaginary limit  2*sqrt(2) = 2.828427124746190097603377448419
    """
    subject, names = subject_of(method), tuple(map(str.strip, only.split(",")) if isinstance(only, str) else only or ())
    if isinstance(subject, Family) and at is not None:
        at = parse_number(at, "value") if isinstance(at, str) else at
        subject = subject.member(at if isinstance(at, Algebraic) else exact_number(at, "value"))
    elif at is not None:
        raise ValueError(f"{subject.key} has no parameter; `at` works only with families such as sdirk_order_2")
    if isinstance(subject, Family):
        if system or order_tolerance is not None:
            raise ValueError(f"{subject.key} is a family; choose one method with `at`, a value of {subject.parameter}")
        return FactSheet(lambda asked: facts_of_further(subject, asked), names)
    tolerance = None if order_tolerance is None else exact_number(order_tolerance, "order tolerance")
    if isinstance(subject, FurtherMethod):
        if system:
            raise ValueError(f"{subject.key} is {subject.kind}; `system` does not work with it")
        derive: _Derive = lambda asked: facts_of_further(subject, asked, tolerance)
        return FactSheet(derive, names, claims_of=subject, tolerance=tolerance)
    if system is None:
        return MethodFacts(subject, names, tolerance, terms)
    if tolerance is not None:
        raise ValueError("`system` cannot be combined with an order tolerance; ask separately")
    rows = parse_system(system) if isinstance(system, str) else [[exact_number(x) for x in row] for row in system]
    return FactSheet(lambda asked: facts_on_system(subject, rows, asked), names, grouped=False)
