"""The sandbox of templates: restricts calls, arithmetic and includes, and locates errors to the character."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from os.path import realpath
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
from driftproof.texts.templates.text_kinds import HTML, LARGEST_TEMPLATE, LATEX, TextKind

# The allowed filters of Jinja2: those that need no limit, without `default`, which would hide what is missing.
FILTERS = ("capitalize", "join", "length", "lower", "replace", "sort", "title", "trim", "upper")
# The keyword argument that passes the place of a call to our functions and filters.
PLACE = "driftproof_place"
# TeX that Jinja2 would read as its own: an argument {#1}, and a brace and a comment sign {% at the end of a line.
# Noncharacters of Unicode replace the signs during the lexing.
_OF_TEX = ((re.compile(r"(?<=\{)#(?=#*[0-9])"), "\ufdd0", "#"), (re.compile(r"(?<=\{)%(?=[ \t]*\r?\n)"), "\ufdd1", "%"))
# Lines of tags only, which are no lines of the text: a blank one would end a table. Not in {% raw %}, nor with {%+.
_TAGS_ALONE = re.compile(
    r"(?ms)(?P<raw>\{%[-+]?\s*raw\b.*?\bendraw\s*[-+]?%\})"
    r"|^[ \t]*(?P<tags>(?:(?:\{%(?!\+|-?\s*raw\b)(?:(?!%\}).)*%\}|\{#(?:(?!#\}).)*#\})[ \t]*)+)(?:\n|\Z)"
)


class TemplatePlace(NamedTuple):
    """A place in a template: the template's name and the offset of a character.

    `of_question` is true if a question begins there, so that its columns count from that character.
    """

    template: str
    offset: int
    of_question: bool = False


class Refusal(ValueError):
    """A request of a template that is refused; callers that know its place turn it into a TemplateProblem."""


class TemplateProblem(ValueError):
    """A template that cannot be rendered; the message is one line with file, line, column and reason."""

    @classmethod
    def at(cls, place: TemplatePlace, source: str, reason: str) -> TemplateProblem:
        """The problem at a place of the template with this source; lines and columns count from 1."""
        before = source[: place.offset]
        line, column = before.count("\n") + 1, place.offset - before.rfind("\n")
        return cls(f"{place.template}, line {line}, column {column}: {' '.join(reason.split())}")


class FolderLoader(BaseLoader):
    """A loader of templates from one folder; `sources` keeps each text read, with \\n as line ends."""

    def __init__(self, template: Path) -> None:
        """Take the folder of the template; the template itself may be a link out of it."""
        self.template, self.folder = template.name, template.parent
        self.sources: dict[str, str] = {}

    def get_source(self, environment: Environment, template: str) -> tuple[str, str, None]:
        """Read a template. Raises Refusal for a path out of the folder, ValueError if the file is not UTF-8."""
        path = self.folder / template
        if template != self.template and not Path(realpath(path)).is_relative_to(realpath(self.folder)):
            raise Refusal(f"{template[:60]!r} lies outside the folder of the template")
        if not path.is_file():
            raise TemplateNotFound(template)
        text = read_utf8(path, LARGEST_TEMPLATE).replace("\r\n", "\n").replace("\r", "\n")
        self.sources[template] = text
        return text, template, None


class _Lexer(Lexer):
    """A lexer that numbers tokens by their offset plus one instead of their line."""

    def __init__(self, environment: Environment, tex: bool) -> None:
        super().__init__(environment)
        self.tex = tex

    def tokeniter(
        self, source: str, name: str | None, filename: str | None = None, state: str | None = None
    ) -> Iterator[tuple[int, str, str]]:
        """The tokens in order, each located by search, as only white space that Jinja2 stripped lies between them."""
        for pattern, mark, _ in _OF_TEX:
            if mark in source:
                reason = f"the noncharacter U+{ord(mark):04X} is not allowed in a text"
                raise TemplateSyntaxError(reason, source.index(mark) + 1, name, filename)
            source = pattern.sub(mark, source) if self.tex else source
        without = _TAGS_ALONE.sub(lambda line: line["raw"] or re.sub(r"(?<=[%#]\})[ \t]+", "", line["tags"]), source)
        offset = end = 0
        try:
            for _, token, text in super().tokeniter(without, name, filename, state):
                offset = source.index(text, end)
                end = offset + len(text)
                for _, mark, sign in _OF_TEX:
                    text = text.replace(mark, sign)
                yield offset + 1, token, text
        except TemplateSyntaxError as error:
            # Jinja2 names a line only. The error is at the text after the last token, or at an unclosed last token.
            follows = len(source) - len(source[end:].lstrip())
            error.lineno = 1 + (offset if "Missing end" in str(error.message) else follows)
            raise


class Sandbox(SandboxedEnvironment):
    """An environment whose templates may call our functions and their own macros, and add texts and whole numbers."""

    intercepted_binops = frozenset(SandboxedEnvironment.default_binop_table)

    def __init__(
        self,
        loader: FolderLoader,
        kind: TextKind,
        ask: Callable[..., Any],
        filters: dict[str, Callable[..., Any]],
        finalize: Callable[[Any], Any],
    ) -> None:
        """Take value and filters that accept the keyword PLACE; `finalize` turns printed values into text."""
        super().__init__(
            loader=loader, undefined=StrictUndefined, autoescape=kind is HTML, finalize=finalize,
            keep_trailing_newline=True, auto_reload=False,
        )  # fmt: skip
        self.placed = {"value", *filters}
        self.globals = {"value": ask, "range": safe_range, "namespace": Namespace}
        self.filters = {name: self.filters[name] for name in FILTERS} | filters
        self.places = _Lexer(self, kind is LATEX)

    @property
    def lexer(self) -> Lexer:
        """The lexer that numbers tokens by offset."""
        return self.places

    def _generate(
        self, source: nodes.Template, name: str | None, filename: str | None, *more: Any, **options: Any
    ) -> str:
        """Compile; locate every expression at its first token, and pass our functions and filters their place."""
        for call in source.find_all(nodes.Call):
            if getattr(call.node, "name", None) == "value":
                question = next((x for x in call.args if isinstance(x, nodes.Const)), None)
                at = question.lineno + 1 if question else _first(call)  # after the quotation mark
                call.kwargs.append(_place_keyword(name, at, question is not None))
        for applied in source.find_all(nodes.Filter):
            if applied.name not in self.filters:
                unknown = f"{applied.name[:40]!r} is not a filter; the filters are {', '.join(self.filters)}"
                raise TemplateSyntaxError(unknown, applied.lineno, name, filename)
            if applied.name in self.placed:
                applied.kwargs.append(_place_keyword(name, applied.lineno))  # type: ignore[arg-type]
        for output in source.find_all(nodes.Output):
            for child in output.nodes:
                child.lineno = _first(child)
        return super()._generate(source, name, filename, *more, **options)

    def is_safe_callable(self, obj: Any) -> bool:
        """True for our functions and for macros, loops and blocks of Jinja2; False for methods of any other object."""
        of_loop = isinstance(obj, MethodType) and isinstance(obj.__self__, LoopContext)
        ours = any(obj is function for function in self.globals.values())
        # A call of an undefined name raises UndefinedError by itself.
        return ours or of_loop or isinstance(obj, Macro | LoopContext | BlockReference | StrictUndefined)

    def call(__self, __context: Context, __obj: Any, *args: Any, **kwargs: Any) -> Any:  # noqa: N805
        """Call a safe object. Raises SecurityError, which lists what may be called, for any other."""
        if not __self.is_safe_callable(__obj):
            names = ", ".join(__self.globals)
            raise SecurityError(f"a template may call only {names} and its own macros")
        return super().call(__context, __obj, *args, **kwargs)

    def call_binop(self, context: Context, operator: str, left: Any, right: Any) -> Any:
        """Compute with two whole numbers, / and ** excluded, or join two texts by +. Raises Refusal for all else."""
        whole = type(left) is type(right) is int and operator not in ("/", "**")
        if not whole and not (type(left) is type(right) is str and operator == "+"):
            raise Refusal(f"operator {operator} is not available in templates; value('1/3 + 1/6') computes exactly")
        return super().call_binop(context, operator, left, right)


def _place_keyword(name: str | None, at: int, of_question: bool = False) -> nodes.Keyword:
    """The keyword argument with the place, as a plain tuple, because the compiled template writes out constants."""
    return nodes.Keyword(PLACE, nodes.Const((name, at - 1, of_question)), lineno=at)


def _first(node: nodes.Node) -> int:
    """The number of the first token of an expression, its offset plus one."""
    return min([node.lineno or LARGEST_TEMPLATE, *map(_first, node.iter_child_nodes())])
