"""Markdown and MyST as people see them: no markup, mathematics read as TeX, fenced code as listings."""

from __future__ import annotations

import html
import re
from collections.abc import Iterable

from driftproof.texts.readers.source_text import LISTING, PROSE, Block, Insertion, Piece, SourceText, joined
from driftproof.texts.readers.tex import tex_prose, with_macros_expanded

_FRONT_MATTER = re.compile(r"\A---[ \t]*\n.*?\n(?:---|\.\.\.)[ \t]*\n", re.DOTALL)
_FENCE = re.compile(
    r"^[ \t>]*(?P<fence>`{3,}+|~{3,}+|:{3,}+)(?P<info>[^\n`]*)\n(?P<body>.*?)(?:^[ \t>]*(?P=fence)[`~:]*[ \t]*$|\Z)",
    re.DOTALL | re.MULTILINE,
)
_NAME = re.compile(r"[A-Za-z][\w+-]*")
# MyST: the name of a directive before its argument, and its options, which are not shown.
_DIRECTIVE = re.compile(r"[ \t]*\{(?P<name>[A-Za-z][\w:.-]*)\}[ \t]*")
_OPTIONS = re.compile(
    r"(?:[ \t]*---[ \t]*\n.*?\n[ \t]*---[ \t]*(?:\n|\Z)|(?:[ \t]*:[\w-]+:[^\n]*(?:\n|\Z))+)", re.DOTALL
)
# Directives whose argument is a file or a number of columns; that are not read at all; whose body is read as prose.
NO_TITLES = {"grid", "figure", "image", "csv-table", "literalinclude", "include", "video", "iframe", "download"}
MACHINE_DIRECTIVES = {
    "image", "literalinclude", "include", "toctree", "tableofcontents", "contents", "bibliography", "raw", "index",
    "video", "iframe", "mermaid", "glue:figure", "bokeh-plot", "footbibliography", "tags",
}  # fmt: skip
_PROSE_DIRECTIVES = """
note tip hint warning important caution danger error attention seealso todo admonition topic figure table list-table
csv-table epigraph pull-quote sidebar margin aside dropdown card grid grid-item tab-set tab-item exercise solution
example versionadded versionchanged deprecated glossary container div
"""
_READ = frozenset(_PROSE_DIRECTIVES.split())
# Roles whose text is a key that is not shown, unless a text precedes it: {ref}`the figure <fig-1>`.
_KEYS = {"ref", "numref", "eq", "doc", "label", "download", "nb-download", "footcite", "footcitet", "eval", "glue"}
# Also not shown: targets, comments, substitutions, block breaks, and the label after a displayed equation.
_TARGET = re.compile(
    r"^\([\w:.-]+\)=[ \t]*$\n?|^% [^\n]*$\n?|\{\{ [^{}\n]{1,200} \}\}|^\+\+\+(?: [^\n]*)?$\n?"
    r"|(?<=\$\$) \([\w:.-]+\)[ \t]*$",
    re.MULTILINE,
)
# What is not read as Markdown: code, mathematics, comments.
_KEPT = re.compile(
    r"(?P<gone><!--.*?(?:-->|\Z)|<(?P<tag>script|style)\b.*?(?:</(?P=tag)\s*>|\Z))"
    r"|(?:\{(?P<role>[A-Za-z][\w:.+-]*)\})?(?<!`)(?P<ticks>`++)(?P<code>[^`]{1,2000}?)(?<!`)(?P=ticks)(?!`)"
    r"|\\begin\{(?P<env>(?:equation|align|gather|multline|eqnarray)\*?)\}(?P<amsmath>.{1,5000}?)\\end\{(?P=env)\}"
    r"|\$\$(?P<display>[^$]{1,5000})\$\$|\\\[(?P<bracket>.{1,5000}?)\\\]|\\\((?P<paren>[^\n]{1,500}?)\\\)"
    r"|(?<![\\$\w])\$(?P<inline>(?! )[^$\n]{1,500}(?:\n[^$\n]{1,500})?(?<! ))\$(?![\w$])",
    re.DOTALL | re.IGNORECASE,
)
SHOWN = re.compile(r"(?P<a>[^<]*\S)\s*<[^<>]*>\Z")
CELL_OF_LIST = re.compile(r"(?m)^[ \t]*(?P<row>[*-] +)- ?|\n[ \t]+- ?")
# Levels of directives inside directives: more than a grid of cards of tabs has.
DEEPEST = 8
_MATHEMATICS = ("amsmath", "display", "bracket", "paren", "inline")
# Punctuation that is not markup is shielded: mapped to private-use characters until the markup is gone.
_PUNCTUATION = re.compile(r"[!-/:-@\[-`{-~]")
_FIRST_SHIELD = ord("\ue100")
_SHIELDED = re.compile(f"[{chr(_FIRST_SHIELD)}-{chr(_FIRST_SHIELD + ord('~'))}]")

# The first run is possessive: with backtracking, the lookahead would take n² steps for n marks.
_DELIMITER_ROW = re.compile(r"^[ \t>]*+\|?(?=[^\n]*\|)[ \t]*:?-{2,}[-:| \t]*$\n?", re.MULTILINE)
# The mark of a footnote in a text, and before the footnote itself.
_FOOTNOTE = re.compile(r"\[\^[^\]\s]{1,100}\](?::(?=[ \t]))?")
_DEFINITION = re.compile(r"^ {0,3}\[[^\]\n]{1,200}\]:[ \t]+\S+[^\n]*$", re.MULTILINE)
_LINE_MARK = re.compile(r"^[ \t]*(?:>[ \t]?)*(?:#{1,6}[ \t]+|[-*+][ \t]+)?", re.MULTILINE)
_ESCAPED = re.compile(r"\\([!-/:-@\[-`{-~])")
_LINK = re.compile(
    r"!?\[(?P<a>[^\[\]]{0,500})\](?:\([^()\s]{0,500}(?:\s+[\"'][^\n]{0,200}[\"'])?\)|\[[^\[\]\n]{0,200}\])"
)
_ADDRESS = re.compile(r"<https?:[^<>\s]{1,500}>")
TAG = re.compile(r"<(?P<end>/?)(?P<name>[A-Za-z][A-Za-z0-9-]{0,30})(?:\s[^<>]{0,1000})?/?>")
ENTITY = re.compile(r"&(?:#[0-9]{1,7}|#[xX][0-9a-fA-F]{1,6}|[A-Za-z][A-Za-z0-9]{1,31});")
_STRONG = re.compile(r"(\*\*|__)(?=\S)(?P<a>[^\n]{1,500}?)(?<=\S)\1")
_STRESSED = re.compile(
    r"(?<![\w*])\*(?=\S)(?P<a>[^*\n]{1,500}?)(?<=\S)\*(?![\w*])|(?<!\w)_(?=\S)(?P<b>[^_\n]{1,500}?)(?<=\S)_(?!\w)"
)


def markdown_blocks(source: SourceText) -> list[Block]:
    """The blocks of a Markdown text: prose without markup, and fenced listings; front matter is left out."""
    source = with_macros_expanded(source)
    front = _FRONT_MATTER.match(source.text)
    return _parts(source[front.end() if front else 0 :], 0)


def _parts(source: SourceText, depth: int) -> list[Block]:
    """The blocks of a part of the text; bodies of directives are read recursively, at most DEEPEST levels deep."""
    blocks: list[Block] = []
    done = 0
    for match in _FENCE.finditer(source.text):
        blocks.append(Block(PROSE, markdown_prose(source[done : match.start()])))
        blocks += _fenced(source, match, depth)
        done = match.end()
    return [*blocks, Block(PROSE, markdown_prose(source[done:]))]


def _fenced(source: SourceText, match: re.Match[str], depth: int) -> list[Block]:
    """The blocks of a fence: mathematics, a listing, or the body of a directive without its options."""
    directive, start = _DIRECTIVE.match(match["info"]), match.start("body")
    name = directive["name"].lower() if directive else ""
    if directive and (options := _OPTIONS.match(match["body"])):
        start += options.end()
    body, names = source[start : match.end("body")], _NAME.findall(match["info"])
    if names[:1] == ["math"]:
        return [Block(PROSE, tex_prose(body))]
    if name in MACHINE_DIRECTIVES:
        return []
    if name == "list-table":  # "* - " begins a row, "  - " a cell
        body = body.rewritten(CELL_OF_LIST, lambda match: ["| " if match["row"] else " | "])
    if depth < DEEPEST and (name in _READ or name.startswith(("prf:", "proof:")) or match["fence"].startswith(":")):
        info = source[match.start("info") : match.end("info")]
        title = [Block(PROSE, markdown_prose(info[directive.end() :]))] if directive and name not in NO_TITLES else []
        return [*title, *_parts(body, depth + 1)]
    language = next((name for name in names if name not in ("code-cell", "code-block", "code", "sourcecode")), "")
    return [Block(LISTING, body, language.lower())]


def markdown_prose(text: SourceText) -> SourceText:
    """A piece of Markdown without fences, its markup removed."""
    text = _code_and_mathematics_shielded(text.removed(_TARGET))
    text = text.removed(_DELIMITER_ROW).removed(_FOOTNOTE).removed(_DEFINITION).removed(_LINE_MARK)
    text = text.rewritten(_ESCAPED, lambda match: [_shield(match[1])]).removed(_ADDRESS)
    for pattern in (_LINK, _LINK, _STRONG, _STRESSED):  # twice, as the text of a link may be a link or a picture
        text = text.rewritten(pattern, lambda match: [match.span("b" if match["a"] is None else "a")])
    text = text.rewritten(TAG, tag_pieces).rewritten(ENTITY, lambda match: [html.unescape(match[0])])
    return unshielded(text)


def _shield(punctuation: str) -> str:
    return chr(_FIRST_SHIELD + ord(punctuation))


def shielded(text: SourceText) -> SourceText:
    """The text with its punctuation mapped to private-use characters, which are no markup."""
    return text.rewritten(_PUNCTUATION, lambda sign: [_shield(sign[0])])


def shielded_in_role(kept: SourceText, role: str) -> SourceText:
    """The shielded text of a role, raised or lowered by sup and sub."""
    if role in _SCRIPTS:
        before = Insertion(_SCRIPTS[role], kept.origin(0))
        kept = joined([before, kept, Insertion("}", kept.origin(len(kept.text)))])
    return shielded(kept)


def is_key(role: str) -> bool:
    """True if the text of the role is a key, which is not shown."""
    return not _KEYS.isdisjoint(role.split(":")) or role.startswith("cite")


def unshielded(text: SourceText) -> SourceText:
    """The text with the punctuation that was shielded."""
    return text.rewritten(_SHIELDED, lambda match: [chr(ord(match[0]) - _FIRST_SHIELD)])


def _code_and_mathematics_shielded(text: SourceText) -> SourceText:
    pieces, done = [], 0
    for match in _KEPT.finditer(text.text):
        pieces.append(text[done : match.start()])
        done = match.end()
        if match["gone"]:
            continue
        name, role = next((name for name in _MATHEMATICS if match[name]), "code"), (match["role"] or "").lower()
        kept = text[match.start(name) : match.end(name)]
        if is_key(role):
            shown = SHOWN.match(kept.text)
            kept = kept[slice(*shown.span("a"))] if shown else kept[:0]
        kept = kept if name == "code" and role != "math" else tex_prose(kept)
        pieces.append(shielded_in_role(kept, role))
    return joined([*pieces, text[done:]])


_SCRIPTS = {"sup": "^{", "sub": "_{"}
# Tags that separate the text around them, and the separators.
_PARTING = {
    "br": "\n", "p": "\n", "div": "\n", "tr": "\n", "table": "\n", "li": "\n", "ul": "\n", "ol": "\n", "hr": "\n",
    "td": " | ", "th": " | ",
}  # fmt: skip


def tag_pieces(match: re.Match[str]) -> Iterable[Piece]:
    """What stands for a tag: a sign of what is raised or lowered, what parts the text around it, or nothing."""
    name = match["name"].lower()
    if match["end"]:
        return ["}" if name in _SCRIPTS else ""]
    return [_SCRIPTS.get(name, _PARTING.get(name, ""))]
