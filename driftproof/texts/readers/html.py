"""HTML as people see it: no tags, scripts or styles, table cells separated, MathML on one line.

Tags are matched here in time linear in the length of the page: `html.parser` takes quadratic time for markup that
never ends, and stops at some declarations.
"""

from __future__ import annotations

import html
import re
from dataclasses import dataclass, field

from driftproof.texts.readers.source_text import LISTING, PROSE, Block, Insertion, SourceText, joined

_TOKEN = re.compile(
    r"(?P<unseen><!--.*?(?:-->|\Z)|<[!?][^>]*+(?:>|\Z)|<(?P<raw>script|style)(?![\w:-]).*?(?=</(?P=raw)\b|\Z))"
    r"|<(?P<end>/?)(?P<name>[a-zA-Z][a-zA-Z0-9:-]*+)"
    r"(?P<attributes>(?:[^>\"'=]++|=\s*+\"[^\"]*+\"|=\s*+'[^']*+'|[\"'=])*+)(?:>|\Z)"
    r"|(?P<entity>&(?:\#[0-9]{1,7}|\#[xX][0-9a-fA-F]{1,6}|[a-zA-Z][a-zA-Z0-9]{1,31});)",
    re.DOTALL | re.IGNORECASE,
)
_CLASS = re.compile(r"\bclass\s*=\s*(?:\"([^\"]*)\"|'([^']*)'|([^\s\"'>]+))", re.IGNORECASE)
_LANGUAGE = re.compile(r"(?:language|lang|highlight|sourceCode|brush)[-: ]\s*([A-Za-z]\w*)")
_HIDDEN = ("template", "annotation", "annotation-xml")
# Classes of elements that repeat, for display, mathematics that is also there as MathML.
_REPEATING = ("katex-html",)
_INLINE = {
    "a", "abbr", "b", "bdi", "bdo", "cite", "code", "del", "dfn", "em", "font", "i", "ins", "kbd", "label", "mark",
    "q", "s", "samp", "small", "span", "strong", "time", "tt", "u", "var", "wbr", "script", "style", "math", "mi",
    "mn", "mo", "mrow", "mstyle", "mtext", "mspace", "mpadded", "semantics", "tspan",
}  # fmt: skip
_CELLS = ("td", "th", "mtd")
# Element -> the text before its first child, before its second and third, and after its last.
_SCHEMES = {
    "mfrac": ("", "/", "", ""), "msup": ("", "^{", "", "}"), "msub": ("", "_{", "", "}"), "msqrt": ("√(", "", "", ")"),
    "msubsup": ("", "_{", "}^{", "}"), "sup": ("^{", "", "", "}"),
    "sub": ("_{", "", "", "}"),
}  # fmt: skip
# Formulas nest a few levels deep; the limit guards against markup that never ends.
_DEEPEST = 100


def html_blocks(source: SourceText) -> list[Block]:
    """The blocks of a page: prose without markup, and preformatted text as listings. Attributes are ignored."""
    return _Page(source).blocks()


@dataclass
class _Open:
    """An open element of _SCHEMES: children finished so far, and elements open inside it."""

    name: str
    children: int = 0
    depth: int = 0


@dataclass
class _Page:
    """The state of one pass over the tags of a page."""

    source: SourceText
    done: list[Block] = field(default_factory=list)
    pieces: list[SourceText | Insertion] = field(default_factory=list)
    schemes: list[_Open] = field(default_factory=list)
    hidden: str = ""  # the name of the invisible element, and how many of that name are open
    hidden_depth: int = field(init=False)
    language: str = ""
    listing: bool = False
    first_cell: bool = True

    def blocks(self) -> list[Block]:
        done = 0
        for match in _TOKEN.finditer(self.source.text):
            self.keep(done, match.start())
            done = match.end()
            if match["entity"]:
                self.write(html.unescape(match["entity"]), match.start())
            elif match["name"]:
                self.tag(match["name"].lower(), match["attributes"], bool(match["end"]), match.start())
        self.keep(done, len(self.source.text))
        self.finish()
        return self.done

    def keep(self, start: int, stop: int) -> None:
        if not self.hidden:
            self.pieces.append(self.source[start:stop])

    def write(self, text: str, index: int) -> None:
        if not self.hidden:
            self.pieces.append(Insertion(text, self.source.origin(index)))

    def finish(self) -> None:
        self.done.append(Block(LISTING if self.listing else PROSE, joined(self.pieces), self.language * self.listing))
        self.pieces = []

    def tag(self, name: str, attributes: str, ends: bool, index: int) -> None:
        if self.hidden:
            self.hidden_depth += 0 if name != self.hidden or attributes.endswith("/") else -1 if ends else 1
            self.hidden = self.hidden if self.hidden_depth else ""
        elif ends:
            self.closed(name, index)
        else:
            self.opened(name, attributes, index)

    def opened(self, name: str, attributes: str, index: int) -> None:
        found = _CLASS.search(attributes)
        classes = next((group for group in found.groups() if group), "") if found else ""
        if name in _HIDDEN or any(repeating in classes for repeating in _REPEATING):
            self.hidden, self.hidden_depth = name, 1
        elif name == "pre":
            self.finish()
            self.listing = True
        elif name in _CELLS:
            self.write("\n" if self.first_cell else " | ", index)
            self.first_cell = False
        elif name in _SCHEMES and len(self.schemes) < _DEEPEST:
            self.write(_SCHEMES[name][0], index)
            self.schemes.append(_Open(name))
            return
        elif name not in _INLINE:
            self.first_cell = True
            self.write("\n", index)
        if language := _LANGUAGE.search(classes):
            self.language = language[1].lower()
        if self.schemes and not attributes.endswith("/"):
            self.schemes[-1].depth += 1
            self.bracket("(", name, index)

    def closed(self, name: str, index: int) -> None:
        if name == "pre" and self.listing:
            self.finish()
            self.listing, self.language = False, ""
        elif self.schemes and self.schemes[-1].name == name:
            self.write(_SCHEMES[name][3], index)
            self.schemes.pop()
            self.child_done(index)
        elif self.schemes and self.schemes[-1].depth and name not in _SCHEMES:
            self.bracket(")", name, index)
            self.schemes[-1].depth -= 1
            self.child_done(index)
        elif name not in _INLINE and name not in _CELLS:
            self.write("\n", index)

    def bracket(self, sign: str, name: str, index: int) -> None:
        """Write a bracket around a numerator or a denominator of several terms."""
        if name == "mrow" and self.schemes[-1].name == "mfrac" and self.schemes[-1].depth == 1:
            self.write(sign, index)

    def child_done(self, index: int) -> None:
        """Write what separates two children of the innermost element of _SCHEMES."""
        if self.schemes and self.schemes[-1].depth == 0:
            self.schemes[-1].children += 1
            if self.schemes[-1].children in (1, 2):
                self.write(_SCHEMES[self.schemes[-1].name][self.schemes[-1].children], index)
