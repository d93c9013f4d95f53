"""The rendering of one template; as a module a process of its own, which a template cannot outgrow."""

from __future__ import annotations

import json
import re
import sys
import traceback
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from jinja2 import TemplateNotFound, TemplateSyntaxError, Undefined, UndefinedError, pass_context
from jinja2.runtime import Context
from markupsafe import Markup

from driftproof.texts.questions.ask import value
from driftproof.texts.questions.errors import QuestionError
from driftproof.texts.templates import method_tables, quantities
from driftproof.texts.templates.kinds import HTML, MARKDOWN, TEX, Kind, is_code, kind_of
from driftproof.texts.templates.problems import Place, Refusal, TemplateProblem, problem
from driftproof.texts.templates.quantities import Manner, Quantity
from driftproof.texts.templates.sandbox import PLACE, FolderLoader, Sandbox

LONGEST_OUTPUT = 10**7


class Rendering:
    """A template and what it becomes; `asked` counts the values that it asked for."""

    def __init__(self, template: Path, kind: Kind, style: str | None, rounding: str | None) -> None:
        """`style` and `rounding` are those of the command; the template may set others."""
        self.kind, self.asked = kind, 0
        self.manner = Manner(kind, style or kind.style, rounding)
        self.loader = FolderLoader(template)
        filters: dict[str, Callable[..., Any]] = {
            "digits": self._counted(quantities.digits),
            "places": self._counted(quantities.places),
            "exact": self._exact,
            "tex": self._tex,
            "mathml": self._mathml,
        }
        functions: dict[str, Callable[..., Any]] = {"value": self._value, "methods_table": self._table()}
        self.sandbox = Sandbox(self.loader, functions, filters, self._finalized, html=kind is HTML, tex=kind is TEX)

    def text(self) -> str:
        """What the template becomes. Raises TemplateProblem, or ValueError where its file cannot be read."""
        try:
            parts, length = [], 0
            for part in self.sandbox.get_template(self.loader.template).generate():
                parts.append(part)
                length += len(part)
                if length > LONGEST_OUTPUT:
                    raise Refusal(f"the text grows beyond {LONGEST_OUTPUT} characters")
            return "".join(parts)
        except TemplateProblem:
            raise
        except Exception as error:
            raise self._problem(error) from None

    def _problem(self, error: Exception) -> TemplateProblem:
        """The error at its place in the template, where it has one."""
        place = self._place(error)
        if place is None:
            return TemplateProblem(f"{self.loader.template}: {_in_words(error)}")
        source = self.loader.sources[place.template]
        if isinstance(error, UndefinedError) and (named := re.match(r"'(\w+)' is undefined", str(error))):
            found = re.compile(rf"\b{named[1]}\b").search(source, place.offset)
            place = place._replace(offset=found.start() if found else place.offset)
        return problem(place, source, _in_words(error))

    def _place(self, error: Exception) -> Place | None:
        if isinstance(error, TemplateSyntaxError):
            return Place(error.name, error.lineno - 1) if error.name in self.loader.sources else None
        for frame in reversed(traceback.extract_tb(error.__traceback__)):
            if frame.filename in self.loader.sources and frame.lineno:
                return Place(frame.filename, frame.lineno - 1)
        return None

    @contextmanager
    def _at(self, place: tuple[str, int, bool] | None) -> Iterator[None]:
        """Whatever is refused inside is refused at this place, if it is known."""
        try:
            yield
        except (Refusal, QuestionError, ArithmeticError) as error:
            if place is None:
                raise
            at, reason = Place(*place), str(error)
            if isinstance(error, QuestionError) and at.of_question:
                at, reason = at._replace(offset=at.offset + error.column - 1), error.reason
            raise problem(at, self.loader.sources[at.template], reason) from None

    def _value(self, question: object, **place: tuple[str, int, bool]) -> Quantity:
        with self._at(place.get(PLACE)):
            if not isinstance(question, str):
                _demand(question)
                raise Refusal('a question is text, as in value("rk4.first_step.q")')
            self.asked += 1
            return Quantity(value(question), self.kind)

    def _manner(self, context: Context, style: str | None, rounding: str | None) -> Manner:
        """As the filter says, else as the template has set it, else as the command or the kind of text says."""
        known = context.get_all()
        return Manner(
            self.kind,
            style or known.get("style") or self.manner.style,
            rounding or known.get("rounding") or self.manner.rounding,
        )

    def _counted(self, write: Callable[[object, object, Manner], str]) -> Callable[..., str]:
        @pass_context
        def apply(
            context: Context,
            x: object,
            count: object,
            style: str | None = None,
            rounding: str | None = None,
            **place: tuple[str, int, bool],
        ) -> str:
            with self._at(place.get(PLACE)):
                return write(x, count, self._manner(context, style, rounding))

        return apply

    def _exact(self, x: object, **place: tuple[str, int, bool]) -> str:
        at = place.get(PLACE)
        in_code = self.kind is MARKDOWN and at is not None and is_code(self.loader.sources[at[0]], at[1])
        with self._at(at):
            return quantities.exact(x, self.manner, in_code)

    def _tex(self, x: object, **place: tuple[str, int, bool]) -> str:
        with self._at(place.get(PLACE)):
            return quantities.tex(x)

    def _mathml(self, x: object, **place: tuple[str, int, bool]) -> str:
        with self._at(place.get(PLACE)):
            return self._markup(quantities.mathml(x, self.manner))

    def _table(self) -> Callable[..., str]:
        @pass_context
        def table(
            context: Context,
            methods: Any,
            columns: Any,
            h: str | None = None,
            t: str | None = None,
            style: str | None = None,
            rounding: str | None = None,
            **place: tuple[str, int, bool],
        ) -> str:
            with self._at(place.get(PLACE)):
                manner = self._manner(context, style, rounding)
                return self._markup(method_tables.methods_table(self._value, methods, columns, h, t, manner))

        return table

    def _markup(self, text: str) -> str:
        """Text that HTML takes as it is."""
        return Markup(text) if self.kind is HTML else text

    def _finalized(self, printed: object) -> object:
        """What an expression prints: text, a whole number, or a value that prints itself."""
        if isinstance(printed, Quantity):
            return str(printed)
        if isinstance(printed, str) or (isinstance(printed, int) and not isinstance(printed, bool)):
            return printed
        _demand(printed)
        raise Refusal(f"a {type(printed).__name__} is nothing to print; a text takes words, whole numbers and values")


def _demand(x: object) -> None:
    """Raises UndefinedError, which says what is missing, for what a template leaves undefined."""
    if isinstance(x, Undefined):
        str(x)


def _in_words(error: Exception) -> str:
    if isinstance(error, TemplateNotFound):
        return f"there is no template {str(error)[:60]!r} beside this one"
    if isinstance(error, RecursionError):
        return "nested too deeply, or a template includes itself"
    if isinstance(error, MemoryError):
        return "more memory is needed than a template may take"
    if isinstance(error, TemplateSyntaxError):
        return error.message or type(error).__name__
    return str(error) or type(error).__name__


def _bound_memory(size: int) -> None:
    """A template that fills the memory is stopped, where the system knows how to."""
    with suppress(ImportError, ValueError, OSError):
        import resource

        resource.setrlimit(resource.RLIMIT_AS, (size, size))


def main() -> None:
    """Read the order of `rendering.render` from standard input; write {"text", "asked"} or {"problem"}."""
    order = json.load(sys.stdin)
    _bound_memory(order["memory"])
    try:
        rendering = Rendering(
            Path(order["template"]), kind_of(Path(order["output"])), order["style"], order["rounding"]
        )
        answer: dict[str, Any] = {"text": rendering.text(), "asked": rendering.asked}
    except (Exception, MemoryError) as error:
        answer = {"problem": " ".join(str(error).split()) or type(error).__name__}
    json.dump(answer, sys.stdout)


if __name__ == "__main__":
    main()
