"""The Jinja2 environment of a template: what it may call, compute and include, and where each of its parts stands."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from pathlib import Path
from types import MethodType
from typing import Any, NamedTuple

from jinja2 import BaseLoader, Environment, StrictUndefined, nodes
from jinja2.exceptions import SecurityError, TemplateNotFound, TemplateSyntaxError
from jinja2.lexer import Lexer
from jinja2.runtime import BlockReference, Context, LoopContext, Macro
from jinja2.sandbox import SandboxedEnvironment, safe_range
from jinja2.utils import Namespace

from driftproof.support.files import read_utf8
from driftproof.texts.templates.text_kinds import HTML, LATEX, TextKind

# Larger than any text that people read.
_LARGEST_TEMPLATE = 10**7
# Of Jinja2's own filters those that need no bound; `default` would make a blank of what is missing.
FILTERS = ("capitalize", "join", "length", "lower", "replace", "sort", "title", "trim", "upper")
# The argument through which a call or a filter of ours learns where it stands.
PLACE = "driftproof_place"
# What TeX writes and Jinja2 would read: an argument {#1}, and a brace before the end of a line {%. Noncharacters of
# Unicode hold their places meanwhile.
_OF_TEX = ((re.compile(r"(?<=\{)#(?=#*[0-9])"), "\ufdd0", "#"), (re.compile(r"(?<=\{)%(?=[ \t]*\r?\n)"), "\ufdd1", "%"))


class TemplatePlace(NamedTuple):
    """A character of a template: the template's name, and the offset from its beginning.

    `of_question` is true where a question begins there, whose own columns then count from that character.
    """

    template: str
    offset: int
    of_question: bool = False


class Refusal(ValueError):
    """What a template asks for is not done; whoever knows the place makes a TemplateProblem of it."""


class TemplateProblem(ValueError):
    """A template that cannot be rendered; the message is the whole line: file, line, column, reason."""

    @classmethod
    def at(cls, place: TemplatePlace, source: str, reason: str) -> TemplateProblem:
        """The problem at a place in the source of its template; lines and columns count from 1."""
        before = source[: place.offset]
        line, column = before.count("\n") + 1, place.offset - before.rfind("\n")
        return cls(f"{place.template}, line {line}, column {column}: {' '.join(reason.split())}")


class FolderLoader(BaseLoader):
    """Templates from one folder; `sources` keeps the text of each that was read, line ends as \\n."""

    def __init__(self, template: Path) -> None:
        """The folder is that of the template, which itself may be a link to elsewhere."""
        self.template, self.folder = template.name, template.parent
        self.sources: dict[str, str] = {}

    def get_source(self, environment: Environment, template: str) -> tuple[str, str, None]:
        """The text of a template. Raises Refusal for a path that leads out of the folder, ValueError for no text."""
        path = self.folder / template
        if template != self.template and not path.resolve().is_relative_to(self.folder.resolve()):
            raise Refusal(f"{template[:60]!r} lies outside the folder of the template")
        if not path.is_file():
            raise TemplateNotFound(template)
        text = read_utf8(path, _LARGEST_TEMPLATE).replace("\r\n", "\n").replace("\r", "\n")
        self.sources[template] = text
        return text, template, None


class _Lexer(Lexer):
    """A lexer whose tokens are numbered by their offset plus one instead of their line."""

    def __init__(self, environment: Environment, tex: bool) -> None:
        super().__init__(environment)
        self.tex = tex

    def tokeniter(
        self, source: str, name: str | None, filename: str | None = None, state: str | None = None
    ) -> Iterator[tuple[int, str, str]]:
        """The tokens in order; between two of them stands white space at most, which Jinja2 has stripped."""
        for pattern, mark, _ in _OF_TEX:
            if mark in source:
                reason = f"the noncharacter U+{ord(mark):04X} has no place in a text"
                raise TemplateSyntaxError(reason, source.index(mark) + 1, name, filename)
            source = pattern.sub(mark, source) if self.tex else source
        offset = end = 0
        try:
            for _, token, text in super().tokeniter(source, name, filename, state):
                offset = source.index(text, end)
                end = offset + len(text)
                for _, mark, sign in _OF_TEX:
                    text = text.replace(mark, sign)
                yield offset + 1, token, text
        except TemplateSyntaxError as error:
            # Jinja2 knows the line: it fails at what follows the last token, or at that one if it is never closed.
            follows = len(source) - len(source[end:].lstrip())
            error.lineno = 1 + (offset if "Missing end" in str(error.message) else follows)
            raise


class Sandbox(SandboxedEnvironment):
    """Templates that call `functions` and their own macros, apply `filters`, and compute with whole numbers."""

    intercepted_binops = frozenset(SandboxedEnvironment.default_binop_table)

    def __init__(
        self,
        loader: FolderLoader,
        kind: TextKind,
        functions: dict[str, Callable[..., Any]],
        filters: dict[str, Callable[..., Any]],
        finalize: Callable[[Any], Any],
    ) -> None:
        """`functions` and `filters` take the keyword PLACE; `finalize` makes text of what is printed."""
        super().__init__(
            loader=loader,
            undefined=StrictUndefined,
            autoescape=kind is HTML,
            finalize=finalize,
            keep_trailing_newline=True,
            auto_reload=False,
        )
        self.placed = {**functions, **filters}
        self.globals = {**functions, "range": safe_range, "namespace": Namespace}
        self.filters = {name: self.filters[name] for name in FILTERS} | filters
        self.places = _Lexer(self, kind is LATEX)

    @property
    def lexer(self) -> Lexer:
        """The lexer that keeps offsets."""
        return self.places

    def _generate(
        self, source: nodes.Template, name: str | None, filename: str | None, defer_init: bool = False
    ) -> str:
        """Compile; every expression stands where its first token does, and our own calls and filters are told where."""
        for call in source.find_all(nodes.Call):
            called = getattr(call.node, "name", None)
            if called in self.placed:
                question = next((x for x in call.args if called == "value" and isinstance(x, nodes.Const)), None)
                at = question.lineno + 1 if question else _first(call)  # after the quotation mark
                call.kwargs.append(_told(name, at, question is not None))
        for applied in source.find_all(nodes.Filter):
            if applied.name not in self.filters:
                unknown = f"there is no filter {applied.name[:40]!r}; there are {', '.join(self.filters)}"
                raise TemplateSyntaxError(unknown, applied.lineno, name, filename)
            if applied.name in self.placed:
                applied.kwargs.append(_told(name, applied.lineno))  # type: ignore[arg-type]
        for output in source.find_all(nodes.Output):
            for child in output.nodes:
                child.lineno = _first(child)
        return super()._generate(source, name, filename, defer_init)

    def is_safe_callable(self, obj: Any) -> bool:
        """Our functions, and what Jinja2 makes of macros, loops and blocks; no method of any other object."""
        of_loop = isinstance(obj, MethodType) and isinstance(obj.__self__, LoopContext)
        ours = any(obj is function for function in self.globals.values())
        # What is undefined says so when it is called.
        return ours or of_loop or isinstance(obj, Macro | LoopContext | BlockReference | StrictUndefined)

    def call(__self, __context: Context, __obj: Any, *args: Any, **kwargs: Any) -> Any:  # noqa: N805
        """Call what is safe; say in words what is."""
        if not __self.is_safe_callable(__obj):
            names = ", ".join(__self.globals)
            raise SecurityError(f"a template calls {names} and its own macros, and nothing else")
        return super().call(__context, __obj, *args, **kwargs)

    def call_binop(self, context: Context, operator: str, left: Any, right: Any) -> Any:
        """Whole numbers are added, subtracted, multiplied, divided with a remainder; text is added to text."""
        whole = type(left) is type(right) is int and operator not in ("/", "**")
        if not whole and not (type(left) is type(right) is str and operator == "+"):
            raise Refusal(f"{operator} is not for a template; value('1/3 + 1/6') computes exactly")
        return super().call_binop(context, operator, left, right)


def _told(name: str | None, at: int, of_question: bool = False) -> nodes.Keyword:
    """The keyword that tells a call its place; a plain tuple, as the compiled template spells constants out."""
    return nodes.Keyword(PLACE, nodes.Const((name, at - 1, of_question)), lineno=at)


def _first(node: nodes.Node) -> int:
    """Where the first token of an expression stands."""
    return min([node.lineno or _LARGEST_TEMPLATE, *map(_first, node.iter_child_nodes())])
