"""The facts of a method, of a family or on a system: as attributes, in brackets, as text, TeX and JSON."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias, overload

from driftproof.methods.catalogue import FactsOnly
from driftproof.methods.expressions import parse_number, parse_system
from driftproof.methods.families import Family
from driftproof.methods.number_field import Exact
from driftproof.methods.rationals import ExactNumber, exact_number
from driftproof.methods.schemes import Method
from driftproof.methods.tableau_file import subject_of
from driftproof.support.plain_text import as_json
from driftproof.support.results import Printable
from driftproof.symbolic.facts import FACTS, ON_REQUEST, Facts, OrderWithin, Reduction, facts_only, order_within
from driftproof.symbolic.family_facts import FAMILY_FACTS, FamilyFacts
from driftproof.symbolic.linear.facts import TERMS, facts_by_name
from driftproof.symbolic.linear.systems import facts_on_system
from driftproof.texts.writing.fact_groups import grouped_facts_text
from driftproof.texts.writing.facts import facts_tex, facts_text
from driftproof.texts.writing.records import record

# The matrix of a system z' = Az: its rows, or "0 1; -1 -1/10".
GivenSystem: TypeAlias = str | Sequence[Sequence[ExactNumber]]
_Derive: TypeAlias = Callable[[Sequence[str]], dict[str, Any]]


class FactSheet(Printable):
    """Facts by name, in brackets or as attributes, each derived when it is asked for; printed, those of `only`."""

    def __init__(self, derive: _Derive, only: Sequence[str], *, grouped: bool = True) -> None:
        """Derive nothing yet; not `grouped` are facts about something else than a method."""
        self._derive, self._only, self._grouped = derive, tuple(only), grouped and not only

    @cached_property
    def shown(self) -> dict[str, Any]:
        """The facts that are printed. Raises ValueError for an unknown name."""
        return self._derive(self._only)

    def __getitem__(self, name: str) -> Any:
        """The fact of this name. Raises ValueError for an unknown one."""
        return self.shown[name] if "shown" in self.__dict__ and name in self.shown else self._derive((name,))[name]

    if not TYPE_CHECKING:  # checkers know the facts of a method by their types

        def __getattr__(self, name: str) -> Any:
            """The fact of this name, or what the method has by it."""
            if name.startswith("_"):
                raise AttributeError(name)
            try:
                return self[name]
            except ValueError as error:
                raise AttributeError(str(error)) from None

    def written(self, form: str, everything: bool = False) -> str:
        """As "text", "json" or "tex"; in groups, `everything` leaves out none."""
        if form == "json":
            return as_json(record(self.shown))
        if form == "tex":
            return facts_tex(self.shown)
        return grouped_facts_text(self.shown, everything) if self._grouped else facts_text(self.shown)


class MethodFacts(FactSheet, Facts):
    """The facts of a method as typed attributes, `order` and `imaginary_limit` among them; printed, as a sheet."""

    def __init__(self, method: Method, only: Sequence[str], tolerance: ExactNumber | None, terms: int) -> None:
        """Derive nothing yet; `terms` is the length of series."""
        Facts.__init__(self, method, terms)
        FactSheet.__init__(self, self._by_name, only)
        self._tolerance = None if tolerance is None else exact_number(tolerance, "order tolerance")

    @cached_property
    def order_to_tolerance(self) -> OrderWithin | None:
        """The order up to residuals of the size that was asked for."""
        return None if self._tolerance is None else order_within(self.method, self._tolerance)

    def _by_name(self, names: Sequence[str]) -> dict[str, Any]:
        """With those named of which it matters, where a stage is superfluous, whether they are of the table."""
        found = facts_by_name(self, names or FACTS, (*FACTS, *ON_REQUEST))
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
    at: Exact | str | None = None,
    system: None = None,
    order_tolerance: ExactNumber | None = None,
    terms: int = TERMS,
) -> MethodFacts: ...
@overload
def facts(
    method: str | Path | Method | Family | FactsOnly,
    *,
    only: Sequence[str] | None = None,
    system: GivenSystem | None = None,
    order_tolerance: ExactNumber | None = None,
) -> FactSheet: ...
def facts(
    method: str | Path | Method | Family | FactsOnly,
    *,
    only: Sequence[str] | None = None,
    at: Exact | str | None = None,
    system: GivenSystem | None = None,
    order_tolerance: ExactNumber | None = None,
    terms: int = TERMS,
) -> FactSheet:
    """The exact facts of a method: of its key or name, of a .toml file, or of the method itself.

    Of a family, `at` chooses one method; without it the facts are functions of its parameter. With `system`, a matrix
    such as "0 1; -1 -1/10", they are about z' = Az. `only` names the facts that are printed; of each name there is an
    attribute. Families and methods that have facts only, and systems, have other names than methods; give the object,
    `FAMILIES["sdirk_order_2"]`, for its type. Raises ValueError for what makes no sense.

    >>> from driftproof import facts
    >>> found = facts("RK4", only=["order", "imaginary_limit"])
    >>> found.order, found.a_stable
    (4, False)
    >>> found
    order            4
    imaginary limit  2*sqrt(2) = 2.828427124746190097603377448419
    """
    subject, names = subject_of(method), tuple(only or ())
    if isinstance(subject, Family) and at is not None:
        subject = subject.member(parse_number(at, "value") if isinstance(at, str) else at)
    elif at is not None:
        raise ValueError(f"{subject.key} has no parameter; `at` is for families such as sdirk_order_2")
    if isinstance(subject, Family):
        if system or order_tolerance is not None:
            raise ValueError(f"{subject.key} is a family; choose one method with `at`, a value of {subject.parameter}")
        of_family = FamilyFacts(subject)
        return FactSheet(lambda asked: facts_by_name(of_family, asked or FAMILY_FACTS, FAMILY_FACTS), names)
    tolerance = None if order_tolerance is None else exact_number(order_tolerance, "order tolerance")
    if isinstance(subject, FactsOnly):
        if system:
            raise ValueError(f"{subject.key} is {subject.kind}; `system` is not for it")
        return FactSheet(lambda asked: facts_only(subject, asked, tolerance), names)
    if system is None:
        return MethodFacts(subject, names, tolerance, terms)
    if tolerance is not None:
        raise ValueError("`system` is about one problem, an order tolerance about the method; ask separately")
    rows = parse_system(system) if isinstance(system, str) else [[exact_number(x) for x in row] for row in system]
    return FactSheet(lambda asked: facts_on_system(subject, rows, asked), names, grouped=False)
