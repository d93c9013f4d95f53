r"""TeX as people see it: no comments or commands, \frac{a}{b} as a/b, \num{...} as the number, h^{6} as h^6."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator
from functools import partial
from unicodedata import lookup

from driftproof.texts.readers.source_text import LISTING, PROSE, Block, Piece, SourceText

# Nested braces are resolved one level at a time; no text that people write is nested deeper.
_DEEPEST = 20

_VERBATIM = re.compile(
    r"\\begin\{(?P<name>verbatim\*?|lstlisting|minted|Verbatim)\}"
    r"(?P<options>(?:\[[^\]\n]{0,200}\])?(?:\{[^}\n]*\})?)[ \t]*\n?"
    r"(?P<body>.*?)(?:\\end\{(?P=name)\}|\Z)",
    re.DOTALL,
)
_LANGUAGE = re.compile(r"language\s*=\s*(\w+)|\{(\w+)\}")
_COMMENT = re.compile(r"(?<!\\)(?P<a>(?:\\\\)*)%[^\n]*\n?[ \t]*")
# Commands whose argument is not shown.
_UNSEEN = re.compile(
    r"\\(?:begin|end|label|[A-Za-z]*ref|cite[a-z]*|includegraphics|usepackage|documentclass|input|"
    r"include|bibliography(?:style)?|driftproof|hspace|vspace|setlength|color|textcolor|url)\*?"
    r"(?:\s*\[[^\]\n]{0,200}\])*\s*\{[^{}]*\}(?:\[[^\]\n]{0,200}\]|(?<=tabular\})\{[^{}]*\}|(?<=array\})\{[^{}]*\})?"
)
# Letters and functions, without which a formula would be another one.
_GREEK = "alpha beta gamma delta epsilon zeta eta theta iota kappa mu nu xi pi rho sigma tau upsilon phi chi psi omega"
_FUNCTIONS = "cos sin tan cot sec csc exp ln log lg cosh sinh tanh coth arccos arcsin arctan min max sup inf det"
_SIGNS = {
    "times": "×", "cdot": "·", "pm": "±", "mp": "∓", "le": "≤", "leq": "≤", "ge": "≥", "geq": "≥", "ne": "≠",
    "neq": "≠", "approx": "≈", "sim": "~", "infty": "∞", "prime": "′", "circ": "°", "degree": "°", "percent": "%",
    "to": "→", "sqrt": "√", "varepsilon": "ε", "vartheta": "θ", "varphi": "φ", "lambda": "λ", "Lambda": "Λ",
    "lvert": "|", "rvert": "|", "vert": "|", "lfloor": "⌊", "lceil": "⌈", "ell": "ℓ", "partial": "∂", "nabla": "∇",
    "int": "∫", "sum": "∑", "prod": "∏", "quad": " ", "qquad": " ", "hat": "ˆ", "widehat": "ˆ", "bar": "ˉ",
    **{name: f"{name} " for name in re.split(" ", _FUNCTIONS)},
    **{name: lookup(f"greek small letter {name}") for name in re.split(" ", _GREEK)},
    **{name.capitalize(): lookup(f"greek capital letter {name}") for name in re.split(" ", _GREEK)},
}  # fmt: skip
_LETTERS = "|".join(["[dtcs]?frac", *(name for name, sign in _SIGNS.items() if sign[0].isalpha())])
_NESTED = r"[^{}]*(?:\{[^{}]*\}[^{}]*)*"
# A derivative as a quotient whose d stands apart, as an upright one does.
_QUOTIENT = re.compile(r"\(d(?P<n>\^2)? ?(?P<of>[^\W\d]\w*)\)/\(d ?(?P<t>[tx])(?P<m>\^2)?\)")
# Before a factor a blank follows, as 2/3 x is no 2/(3x).
_FRACTION = re.compile(
    rf"\\(?:[dtcs]?frac|nicefrac|xfrac|flatfrac)\s*(?:\{{(?P<a>{_NESTED})\}}|(?P<c>[0-9]))\s*(?:\{{(?P<b>{_NESTED})\}}|(?P<d>[0-9]))"
    rf"(?P<factor>(?=[A-Za-z(]|\\(?:{_LETTERS})))?"
)
_SINGLE = re.compile(r"\s*(?:[0-9]+(?:\.[0-9]+)?|[^\W\d]\w*|\\[A-Za-z]+)\s*")
_PRIMES = re.compile(r"\^\s*(?:\{(?:\s*\\prime(?![A-Za-z]))+\s*\}|\\prime(?![A-Za-z]))")
# A derivative in time: x' with the prime after the index, as in x_1'.
_DOTS = re.compile(
    r"\\d(?P<second>d?)ot(?![A-Za-z])\s*(?:\{(?P<a>[^{}]*)\}|(?P<c>[A-Za-z]|\\[A-Za-z]+))(?P<index>_(?:\w|\{[^{}]*\}))?"
)
_SPANNING = re.compile(r"\\multicolumn\s*\{(?P<n>[1-9])\}\s*\{[^{}]*\}\s*\{(?P<a>[^{}]*)\}")
_ROOT = re.compile(r"\\sqrt\s*(?:\[(?P<n>[0-9]+)\])?(?:\{(?P<a>[^{}]*)\}|(?P<c>\w))")
_NUMBER = re.compile(
    r"\\(?:num|ang|qty|SI|text[a-z]*|math[a-z]+|operatorname|emph|mbox|boxed|underline|section|subsection|"
    r"subsubsection|chapter|paragraph|title|caption|footnote)\*?(?:\[[^\]\n]{0,200}\])?\{(?P<a>[^{}]*)\}"
)
_SCRIPT = re.compile(r"(?P<sign>[\^_])\s*\{(?P<a>[^{}]*)\}")
_THIN = re.compile(r"(?<=[0-9])(?:\\,|\{,\}|\{\\,\})(?=[0-9]{3}(?![0-9]))")
_COMMAND = re.compile(
    r"\\(?:(?P<name>[A-Za-z]+)\*?[ \t]*|(?P<break>\\)(?:\[[^\]\n]{0,200}\])?|(?P<sign>[\s\S]))|(?P<other>[~&$])"
)
# Stand-ins for the braces of superscripts and subscripts while braces that only group are removed.
_OPEN, _CLOSE = "\ue010", "\ue011"

# The body of a macro that the author defines, with up to three levels of nested braces.
_INNER = r"[^{}]*+(?:\{[^{}]*+\}[^{}]*+)*+"
_BODY = rf"[^{{}}]*+(?:\{{{_INNER}(?:\{{{_INNER}\}}{_INNER})*+\}}[^{{}}]*+)*+"
_DEFINITION = re.compile(
    r"\\(?:(?:re)?newcommand|providecommand|DeclareMathOperator)\*?\s*(?:\{\s*\\(?P<name>[A-Za-z]+)\s*\}|\\(?P<bare>[A-Za-z]+))"
    rf"\s*(?:\[(?P<count>[1-9])\])?\s*\{{(?P<body>{_BODY})\}}"
    rf"|\\def\s*\\(?P<plain>[A-Za-z]+)(?P<places>(?:\#[1-9])*)\s*\{{(?P<inside>{_BODY})\}}"
)
# Macros may use others: at most so many rounds of expansion, and only up to so many times the length of the text.
_MOST_ROUNDS, _MOST_GROWTH = 5, 4


def with_macros_expanded(text: SourceText) -> SourceText:
    r"""The text with the macros that it defines by \newcommand, \def or \DeclareMathOperator expanded."""
    macros = {}
    for match in _DEFINITION.finditer(text.text):
        count = int(match["count"] or "0") if match["plain"] is None else len(match["places"]) // 2
        macros[match["name"] or match["bare"] or match["plain"]] = (count, match["body"] or match["inside"] or "")
    if not macros:
        return text
    text, longest = text.removed(_DEFINITION), _MOST_GROWTH * len(text.text)
    for _ in range(_MOST_ROUNDS):
        before = text
        for name, (count, body) in macros.items():
            arguments = "".join(rf"\s*(?:\{{(?P<b{k}>{_BODY})\}}|(?P<c{k}>[0-9A-Za-z]))" for k in range(1, count + 1))
            use = re.compile(rf"\\{name}(?![A-Za-z]){arguments}")
            text = text.rewritten(use, partial(_expanded, body))
            if len(text.text) > longest:
                return before
        if text.text == before.text:
            break
    return text


def _expanded(body: str, match: re.Match[str]) -> Iterator[Piece]:
    """The body of a macro in braces, with the arguments of one use inserted."""
    yield "{"
    for piece in re.split(r"(#[1-9])", body):
        if re.fullmatch(r"#[1-9]", piece) and f"b{piece[1]}" in match.re.groupindex:
            yield match.span(f"b{piece[1]}" if match[f"b{piece[1]}"] is not None else f"c{piece[1]}")
        else:
            yield piece
    yield "}"


def tex_blocks(source: SourceText) -> list[Block]:
    """The blocks of a TeX text: prose and mathematics without markup, and verbatim environments as listings."""
    source = with_macros_expanded(source)
    blocks, done = [], 0
    for match in _VERBATIM.finditer(source.text):
        blocks.append(Block(PROSE, tex_prose(source[done : match.start()])))
        named = _LANGUAGE.search(match["options"])
        language = (named[1] or named[2]).lower() if named else ""
        blocks.append(Block(LISTING, source[match.start("body") : match.end("body")], language))
        done = match.end()
    return [*blocks, Block(PROSE, tex_prose(source[done:]))]


def tex_prose(text: SourceText) -> SourceText:
    """A piece of TeX without listings, its markup removed."""
    text = text.rewritten(_COMMENT, _inside).removed(_UNSEEN).rewritten(_THIN, lambda match: [","])
    for _ in range(_DEEPEST):  # from the inside out
        before = text.text
        for pattern, become in _STEPS:
            text = text.rewritten(pattern, become)
        if text.text == before:
            break
    text = text.rewritten(_COMMAND, _command).removed(re.compile(r"[{}]"))
    text = text.rewritten(re.compile(f"[{_OPEN}{_CLOSE}]"), lambda match: ["{" if match[0] == _OPEN else "}"])
    return text.rewritten(_QUOTIENT, lambda m: ["d", m.span("n"), m.span("of"), "/d", m.span("t"), m.span("m")])


def _inside(match: re.Match[str]) -> Iterable[Piece]:
    return [match.span("a")]


def _in_brackets(match: re.Match[str], *names: str) -> Iterable[Piece]:
    """The first of these groups that matched, in brackets unless it is a single number, name or command."""
    name = next(name for name in names if match[name] is not None)
    single = _SINGLE.fullmatch(match[name])
    return [match.span(name)] if single else ["(", match.span(name), ")"]


def _root(match: re.Match[str], of: list[Piece]) -> Iterable[Piece]:
    return [*of, "^" + _OPEN + "1/", match.span("n"), _CLOSE] if match["n"] else ["√", *of]


def _apart(match: re.Match[str]) -> str:
    """A blank after a letter, a number or a bracket, since g sin x is no gsin x."""
    return " " if re.match(r"[\w)'}]", match.string[max(0, match.start() - 1) : match.start()]) else ""


def _dotted(match: re.Match[str]) -> Iterable[Piece]:
    of = match.span("a" if match["c"] is None else "c")
    return [_apart(match), of, match.span("index"), "''" if match["second"] else "'"]


_STEPS: tuple[tuple[re.Pattern[str], Callable[[re.Match[str]], Iterable[Piece]]], ...] = (
    (_FRACTION, lambda m: [*_in_brackets(m, "a", "c"), "/", *_in_brackets(m, "b", "d"), " " * (m["factor"] == "")]),
    (_ROOT, lambda match: _root(match, [*_in_brackets(match, "a", "c")])),
    (_PRIMES, lambda match: ["'" * match[0].count("prime")]),
    (_DOTS, _dotted),
    (_SCRIPT, lambda match: [match["sign"] + _OPEN, match.span("a"), _CLOSE]),
    (_SPANNING, lambda match: [match.span("a"), " | " * (int(match["n"]) - 1)]),
    (_NUMBER, _inside),
)


def _command(match: re.Match[str]) -> Iterable[Piece]:
    """The sign that a command stands for, the character that it escapes, or nothing."""
    if match["name"]:
        shown = _SIGNS.get(match["name"], "")
        return [_apart(match) * shown.endswith(" "), shown]
    if match["break"]:
        return ["\n"]
    if match["other"]:
        return [{"~": " ", "&": " | ", "$": ""}[match["other"]]]
    return [match.span("sign")] if match["sign"] in "%$&#_{}" else [" " if match["sign"] in ",;: \n" else ""]
