"""The rendering of one template: its values, its output piece by piece, and every error at its place."""

from __future__ import annotations

import re
import traceback
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import Any

from jinja2 import TemplateNotFound, TemplateSyntaxError, Undefined, UndefinedError, pass_context
from jinja2.runtime import Context
from markupsafe import Markup

from driftproof.texts.questions.errors import QuestionError
from driftproof.texts.questions.evaluate import value
from driftproof.texts.templates import template_values
from driftproof.texts.templates.sandbox import PLACE, FolderLoader, Refusal, Sandbox, TemplatePlace, TemplateProblem
from driftproof.texts.templates.template_values import NumberStyle, TemplateValue
from driftproof.texts.templates.text_kinds import HTML, MARKDOWN, TextKind, is_code, kind_of


class Template:
    """A template and what it becomes; `asked` counts the values that it asked for."""

    def __init__(self, template: Path, kind: TextKind, style: str | None, rounding: str | None) -> None:
        """`style` and `rounding` are those of the command; the template may set others."""
        self.asked = 0
        self.style = NumberStyle(kind, style or kind.style, rounding)
        self.loader = FolderLoader(template)
        functions = {
            "value": self._placed(self._value),
            "methods_table": self._placed(self._methods_table, markup=True),
        }
        filters = {
            name: self._placed(write, markup=name == "mathml") for name, write in template_values.VALUE_FILTERS.items()
        }
        self.sandbox = Sandbox(self.loader, kind, functions, filters, self._finalized)

    def text(self) -> str:
        """What the template becomes. Raises TemplateProblem, or ValueError where its file cannot be read."""
        try:
            return self.sandbox.get_template(self.loader.template).render()
        except TemplateProblem:
            raise
        except Exception as error:
            raise self._problem(error) from None

    def _problem(self, error: Exception) -> TemplateProblem:
        place = self._place(error)
        if place is None:
            return TemplateProblem(f"{self.loader.template}: {_in_words(error)}")
        source = self.loader.sources[place.template]
        if isinstance(error, UndefinedError) and (named := re.match(r"'(\w+)' is undefined", str(error))):
            found = re.compile(rf"\b{named[1]}\b").search(source, place.offset)
            place = place._replace(offset=found.start() if found else place.offset)
        return TemplateProblem.at(place, source, _in_words(error))

    def _place(self, error: Exception) -> TemplatePlace | None:
        """Where Jinja2 failed: its lines are our offsets plus one."""
        places = [(frame.filename, frame.lineno or 0) for frame in traceback.extract_tb(error.__traceback__)]
        if isinstance(error, TemplateSyntaxError):
            places = [(error.name or "", error.lineno)]
        known = [TemplatePlace(name, line - 1) for name, line in places if name in self.loader.sources and line]
        return known[-1] if known else None

    def _placed(self, function: Callable[..., Any], markup: bool = False) -> Callable[..., Any]:
        """The function, which takes the style in force first, as a template calls it: what it refuses has a place.

        What is `markup` HTML takes as it is.
        """

        @pass_context
        def call(context: Context, *arguments: Any, style: Any = None, rounding: Any = None, **named: Any) -> Any:
            place = named.pop(PLACE, None)
            with self._at(place):
                found = function(self._style(context, style, rounding, place), *arguments, **named)
                return Markup(found) if markup and self.style.kind is HTML else found

        return call

    def _style(self, context: Context, style: Any, rounding: Any, place: tuple[str, int, bool] | None) -> NumberStyle:
        """As the call says, else as the template has set it, else as the command or the kind of text says."""
        known, kind = context.get_all(), self.style.kind
        in_code = kind is MARKDOWN and place is not None and is_code(self.loader.sources[place[0]], place[1])
        return NumberStyle(
            kind,
            style or known.get("style") or self.style.style,
            rounding or known.get("rounding") or self.style.rounding,
            in_code,
        )

    @contextmanager
    def _at(self, place: tuple[str, int, bool] | None) -> Iterator[None]:
        """Whatever is refused inside is refused at this place, if it is known."""
        try:
            yield
        except (Refusal, QuestionError, ArithmeticError) as error:
            if place is None:
                raise
            at, reason = TemplatePlace(*place), str(error)
            if isinstance(error, QuestionError) and at.of_question:
                at, reason = at._replace(offset=at.offset + error.column - 1), error.reason
            raise TemplateProblem.at(at, self.loader.sources[at.template], reason) from None

    def _value(self, style: NumberStyle, question: object) -> TemplateValue:
        if not isinstance(question, str):
            _demand(question)
            raise Refusal('a question is text, as in value("rk4.first_step.q")')
        self.asked += 1
        return TemplateValue(value(question), style.kind)

    def _methods_table(self, style: NumberStyle, *arguments: Any, **named: Any) -> str:
        return template_values.methods_table(style, partial(self._value, style), *arguments, **named)

    def _finalized(self, printed: object) -> object:
        """What an expression prints: text, a whole number, or a value that prints itself."""
        if isinstance(printed, TemplateValue):
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
    message = error.message if isinstance(error, TemplateSyntaxError) else str(error)
    return message or type(error).__name__


def render_order(order: dict[str, Any]) -> dict[str, Any]:
    """The answer to the order of `rendering.render`, in the isolated process: {"text", "asked"} or {"problem"}."""
    try:
        kind = kind_of(Path(order["output"]))
        template = Template(Path(order["template"]), kind, order["style"], order["rounding"])
        return {"text": template.text(), "asked": template.asked}
    except Exception as error:
        return {"problem": " ".join(str(error).split()) or type(error).__name__}
