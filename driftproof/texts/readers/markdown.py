"""Markdown as its reader sees it, and MyST: markup gone, mathematics read as TeX, fences as listings."""

from __future__ import annotations

import html
import re
from collections.abc import Iterable

from driftproof.texts.readers.source_text import LISTING, PROSE, Block, Piece, SourceText, joined
from driftproof.texts.readers.tex import tex_prose

_FRONT_MATTER = re.compile(r"\A---[ \t]*\n.*?\n(?:---|\.\.\.)[ \t]*\n", re.DOTALL)
_FENCE = re.compile(
    r"^[ \t>]*(?P<fence>`{3,}+|~{3,}+)(?P<info>[^\n`]*)\n(?P<body>.*?)(?:^[ \t>]*(?P=fence)[`~]*[ \t]*$|\Z)",
    re.DOTALL | re.MULTILINE,
)
_NAME = re.compile(r"[A-Za-z][\w+-]*")
# What is not read as Markdown: code, mathematics, comments.
_KEPT = re.compile(
    r"(?P<gone><!--.*?(?:-->|\Z)|<(?P<tag>script|style)\b.*?(?:</(?P=tag)\s*>|\Z))"
    r"|(?P<role>\{math\})?(?<!`)(?P<ticks>`++)(?P<code>[^`]{1,2000}?)(?<!`)(?P=ticks)(?!`)"
    r"|\$\$(?P<display>[^$]{1,5000})\$\$|\\\[(?P<bracket>.{1,5000}?)\\\]|\\\((?P<paren>[^\n]{1,500}?)\\\)"
    r"|(?<![\\$\w])\$(?P<inline>(?! )[^$\n]{1,500}(?:\n[^$\n]{1,500})?(?<! ))\$(?![\w$])",
    re.DOTALL | re.IGNORECASE,
)
_MATHEMATICS = ("display", "bracket", "paren", "inline")
# Punctuation that is not to be taken for markup is moved out of the way meanwhile, to characters of no other use.
_PUNCTUATION = re.compile(r"[!-/:-@\[-`{-~]")
_FIRST_SHIELD = 0xE100
_SHIELDED = re.compile(f"[{chr(_FIRST_SHIELD)}-{chr(_FIRST_SHIELD + 127)}]")

# Its first run gives nothing back: tried at each of n marks, the look ahead to the end of the line would be n² steps.
_DELIMITER_ROW = re.compile(r"^[ \t>]*+\|?(?=[^\n]*\|)[ \t]*:?-{2,}[-:| \t]*$\n?", re.MULTILINE)
_DEFINITION = re.compile(r"^ {0,3}\[[^\]\n]{1,200}\]:[ \t]+\S+[^\n]*$", re.MULTILINE)
_LINE_MARK = re.compile(r"^[ \t]*(?:>[ \t]?)*(?:#{1,6}[ \t]+|[-*+][ \t]+)?", re.MULTILINE)
_ESCAPED = re.compile(r"\\([!-/:-@\[-`{-~])")
_LINK = re.compile(
    r"!?\[(?P<a>[^\[\]]{0,500})\](?:\([^()\s]{0,500}(?:\s+[\"'][^\n]{0,200}[\"'])?\)|\[[^\[\]\n]{0,200}\])"
)
_ADDRESS = re.compile(r"<https?:[^<>\s]{1,500}>")
_TAG = re.compile(r"<(?P<end>/?)(?P<name>[A-Za-z][A-Za-z0-9-]{0,30})(?:\s[^<>]{0,1000})?/?>")
_ENTITY = re.compile(r"&(?:#[0-9]{1,7}|#[xX][0-9a-fA-F]{1,6}|[A-Za-z][A-Za-z0-9]{1,31});")
_STRONG = re.compile(r"(\*\*|__)(?=\S)(?P<a>[^\n]{1,500}?)(?<=\S)\1")
_STRESSED = re.compile(
    r"(?<![\w*])\*(?=\S)(?P<a>[^*\n]{1,500}?)(?<=\S)\*(?![\w*])|(?<!\w)_(?=\S)(?P<b>[^_\n]{1,500}?)(?<=\S)_(?!\w)"
)


def markdown_blocks(source: SourceText) -> list[Block]:
    """Prose as it is read, and fenced listings; front matter is for the machine and is left out."""
    front = _FRONT_MATTER.match(source.text)
    blocks, done = [], front.end() if front else 0
    for match in _FENCE.finditer(source.text, done):
        blocks.append(Block(PROSE, markdown_prose(source[done : match.start()])))
        body, names = source[match.start("body") : match.end("body")], _NAME.findall(match["info"])
        if names[:1] == ["math"]:
            blocks.append(Block(PROSE, tex_prose(body)))
        else:
            language = next((name for name in names if name not in ("code-cell", "code-block", "code")), "")
            blocks.append(Block(LISTING, body, language.lower()))
        done = match.end()
    return [*blocks, Block(PROSE, markdown_prose(source[done:]))]


def markdown_prose(text: SourceText) -> SourceText:
    """A piece of Markdown without fences, as it is read."""
    text = _code_and_mathematics_shielded(text)
    text = text.removed(_DELIMITER_ROW).removed(_DEFINITION).removed(_LINE_MARK)
    text = text.rewritten(_ESCAPED, lambda match: [_shield(match[1])]).removed(_ADDRESS)
    for pattern in (_LINK, _LINK, _STRONG, _STRESSED):  # a link may be the text of a link: a picture is
        text = text.rewritten(pattern, _inside)
    text = text.rewritten(_TAG, _tag).rewritten(_ENTITY, lambda match: [html.unescape(match[0])])
    return text.rewritten(_SHIELDED, lambda match: [chr(ord(match[0]) - _FIRST_SHIELD)])


def _shield(punctuation: str) -> str:
    return chr(_FIRST_SHIELD + ord(punctuation))


def _code_and_mathematics_shielded(text: SourceText) -> SourceText:
    pieces, done = [], 0
    for match in _KEPT.finditer(text.text):
        pieces.append(text[done : match.start()])
        done = match.end()
        if match["gone"]:
            continue
        name = next((name for name in _MATHEMATICS if match[name]), "code")
        kept = text[match.start(name) : match.end(name)]
        kept = kept if name == "code" and not match["role"] else tex_prose(kept)
        pieces.append(kept.rewritten(_PUNCTUATION, lambda sign: [_shield(sign[0])]))
    return joined([*pieces, text[done:]])


def _inside(match: re.Match[str]) -> Iterable[Piece]:
    """What stands between the marks."""
    return [match.span("b" if match["a"] is None else "a")]


# Tags that part what stands around them.
_PARTING = {
    "br": "\n", "p": "\n", "div": "\n", "tr": "\n", "table": "\n", "li": "\n", "ul": "\n", "ol": "\n", "hr": "\n",
    "td": " | ", "th": " | ",
}  # fmt: skip


def _tag(match: re.Match[str]) -> Iterable[Piece]:
    name = match["name"].lower()
    if name in ("sup", "sub"):
        return ["}" if match["end"] else "^{" if name == "sup" else "_{"]
    return ["" if match["end"] else _PARTING.get(name, "")]
