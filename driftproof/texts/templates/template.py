"""Render one template: answer its questions, format its output, and give every error its place."""

from __future__ import annotations

import re
import traceback
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from inspect import signature
from pathlib import Path
from typing import Any

from jinja2 import TemplateNotFound, TemplateSyntaxError, Undefined, UndefinedError, pass_context
from jinja2.runtime import Context
from markupsafe import Markup

from driftproof.support.environment import OWN_CODE_RUNS
from driftproof.support.files import named_beside
from driftproof.texts.questions.errors import QuestionError
from driftproof.texts.questions.evaluate import value
from driftproof.texts.templates.sandbox import PLACE, FolderLoader, Refusal, Sandbox, TemplatePlace, TemplateProblem
from driftproof.texts.templates.template_values import VALUE_FILTERS, NumberStyle, TemplateValue
from driftproof.texts.templates.text_kinds import HTML, MARKDOWN, TextKind, is_code, kind_of


class Template:
    """A template to render; `asked` counts the values that it asks for."""

    def __init__(self, template: Path, kind: TextKind, style: str | None, rounding: str | None) -> None:
        """Take the style and the rounding policy of the command; the template may set others."""
        self.asked = 0
        self.style = NumberStyle(kind, style or kind.style, rounding)
        self.loader = FolderLoader(template)
        filters = {name: self._placed(name, f) for name, f in VALUE_FILTERS.items()}
        self.sandbox = Sandbox(self.loader, kind, self._placed("value", self._value), filters, self._finalized)

    def text(self) -> str:
        """The rendered text. Raises TemplateProblem for any error in the template."""
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
        """The place of a Jinja2 error, whose line numbers are our offsets plus one; None if it is unknown."""
        places = [(frame.filename, frame.lineno) for frame in traceback.extract_tb(error.__traceback__)]
        if isinstance(error, TemplateSyntaxError):
            places = [(error.name or "", error.lineno)]
        known = [TemplatePlace(name, line - 1) for name, line in places if name in self.loader.sources and line]
        return known[-1] if known else None

    def _placed(self, name: str, function: Any) -> Callable[..., Any]:
        """Wrap a function for templates: pass it the current NumberStyle first, and give its errors their place."""

        @pass_context
        def call(context: Context, *arguments: Any, style: Any = None, rounding: Any = None, **named: Any) -> Any:
            place = named.pop(PLACE, None)
            with self._at(place):
                given = self._style(context, style, rounding, place), *arguments
                try:
                    signature(function).bind(*given, **named)
                except TypeError as error:
                    raise Refusal(f"{name}: {error}") from None
                found = function(*given, **named)
                return Markup(found) if name == "mathml" and self.style.kind is HTML else found

        return call

    def _style(self, context: Context, style: Any, rounding: Any, place: tuple[str, int, bool] | None) -> NumberStyle:
        """The style of the call, else of the template, else of the command or of the kind of text."""
        known, kind = context.get_all(), self.style.kind
        in_code = kind is MARKDOWN and place is not None and is_code(self.loader.sources[place[0]], place[1])
        style = style or known.get("style") or self.style.style
        return NumberStyle(kind, style, rounding or known.get("rounding") or self.style.rounding, in_code)

    @contextmanager
    def _at(self, place: tuple[str, int, bool] | None) -> Iterator[None]:
        """Turn errors raised inside into a TemplateProblem at this place; without a place they pass."""
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
            _require_defined(question)
            raise Refusal('a question is a string, as in value("rk4.first_step.q")')
        self.asked += 1
        return TemplateValue(value(question), style.kind)

    def _finalized(self, printed: object) -> object:
        """The printed form of an expression: a text, a whole number or a value. Raises Refusal for others."""
        if isinstance(printed, TemplateValue):
            return str(printed)
        if isinstance(printed, str) or (isinstance(printed, int) and not isinstance(printed, bool)):
            return printed
        _require_defined(printed)
        raise Refusal(f"a {type(printed).__name__} cannot be printed; print strings, whole numbers or values")


def _require_defined(x: object) -> None:
    """Raise UndefinedError, which names what is missing, if x is undefined in the template."""
    if isinstance(x, Undefined):
        str(x)


def _in_words(error: Exception) -> str:
    if isinstance(error, TemplateNotFound):
        return f"no template {str(error)[:60]!r} is in the folder of this one"
    if isinstance(error, RecursionError):
        return "nested too deeply, or a template includes itself"
    if isinstance(error, MemoryError):
        return "the template needs more memory than is allowed"
    message = error.message if isinstance(error, TemplateSyntaxError) else str(error)
    return message or type(error).__name__


def render_order(order: dict[str, Any]) -> dict[str, Any]:
    """Carry out an order of `rendering.render` in the separate process: {"text", "asked"} or {"problem"}."""
    before = OWN_CODE_RUNS.set(False)
    try:
        kind = kind_of(Path(order["output"]))
        template = Template(Path(order["template"]), kind, order["style"], order["rounding"])
        with named_beside(order["template"]):
            return {"text": template.text(), "asked": template.asked}
    except Exception as error:
        return {"problem": " ".join(str(error).split()) or type(error).__name__}
    finally:
        OWN_CODE_RUNS.reset(before)
