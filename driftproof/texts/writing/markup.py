"""Write exact forms and decimals as TeX or MathML, from the parsed tree of a form."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from html import escape

from driftproof.methods.formulas import expression_tree as tree

# Characters of an exact form that is shown beside a decimal in texts.
LONGEST_IN_TEXT = 24
GREEK = {
    **{"alpha": "α", "beta": "β", "gamma": "γ", "delta": "δ", "theta": "θ"},
    **{"lambda": "λ", "mu": "μ", "omega": "ω", "sigma": "σ", "tau": "τ"},
}


@dataclass(frozen=True)
class Writer:
    """Functions that write the parts of a formula; except for names and digits, arguments are already written.

    `operator` writes +, -, ·, or the empty string for a product without a sign; `words` writes text that is no formula.
    """

    number: Callable[[str], str]
    symbol: Callable[[str], str]
    operator: Callable[[str], str]
    row: Callable[[Sequence[str]], str]
    fraction: Callable[[str, str], str]
    power: Callable[[str, str], str]
    root: Callable[[str, int], str]
    function: Callable[[str, str], str]
    bracket: Callable[[str], str]
    words: Callable[[str], str]


def _tex_bracket(inner: str) -> str:
    return rf"\left({inner}\right)" if r"\frac" in inner else f"({inner})"


TEX = Writer(
    number=str,
    symbol=lambda name: r"\infty" if name == "oo" else rf"\{name}" if name in GREEK else name,
    operator=lambda sign: {"": " ", "·": r" \cdot "}.get(sign, sign),
    row="".join,
    fraction=lambda above, below: rf"\frac{{{above}}}{{{below}}}",
    power=lambda base, exponent: f"{base}^{{{exponent}}}",
    root=lambda inner, degree: rf"\sqrt{{{inner}}}" if degree == 2 else rf"\sqrt[{degree}]{{{inner}}}",
    function=lambda name, inner: rf"\{'arccos' if name == 'acos' else name}{_tex_bracket(inner)}",
    bracket=_tex_bracket,
    words=lambda tex: rf"\text{{{tex}}}",
)


_APPLIED = "<mo>\N{FUNCTION APPLICATION}</mo>"
_OPERATORS = {"-": "\N{MINUS SIGN}", "": "\N{INVISIBLE TIMES}"}


def _mathml_row(parts: Sequence[str]) -> str:
    row = "".join(parts)
    return row if len(parts) == 1 else f"<mrow>{row}</mrow>"


def _mathml_bracket(inner: str) -> str:
    return f"<mrow><mo>(</mo>{inner}<mo>)</mo></mrow>"


MATHML = Writer(
    number=lambda digits: f"<mn>{digits}</mn>",
    symbol=lambda name: f"<mi>{GREEK.get(name, '∞' if name == 'oo' else name)}</mi>",
    operator=lambda sign: f"<mo>{_OPERATORS.get(sign, sign)}</mo>",
    row=_mathml_row,
    fraction=lambda above, below: f"<mfrac>{above}{below}</mfrac>",
    power=lambda base, exponent: f"<msup>{base}{exponent}</msup>",
    root=lambda inner, degree: f"<msqrt>{inner}</msqrt>" if degree == 2 else f"<mroot>{inner}<mn>{degree}</mn></mroot>",
    function=lambda name, inner: _mathml_row([f"<mi>{name}</mi>", _APPLIED, _mathml_bracket(inner)]),
    bracket=_mathml_bracket,
    words=lambda text: f"<mtext>{escape(text, quote=False)}</mtext>",
)


def formula(text: str, write: Writer) -> str:
    """Write an exact form in SymPy's syntax, e.g. "2*sqrt(2)/3". Raises ExpressionError if it is no formula."""
    return _Formula(write).of(tree.parse_form(text))


def rational_markup(numerator: str, denominator: str, write: Writer) -> str:
    """Write a fraction, given as two integers in decimal, with its sign in front."""
    size = numerator.removeprefix("-")
    body = write.number(size) if denominator == "1" else write.fraction(write.number(size), write.number(denominator))
    return body if size == numerator else write.row([write.operator("-"), body])


def decimal_markup(text: str, write: Writer) -> str:
    """Write a decimal such as "-6.7e-5"."""
    mantissa, _, exponent = text.partition("e")
    size = mantissa.removeprefix("-")
    parts = [write.operator("-")] if size != mantissa else []
    parts.append(write.number(size))
    if exponent:
        parts += [write.operator("·"), write.power(write.number("10"), rational_markup(exponent, "1", write))]
    return write.row(parts)


def in_any_mode(tex: str) -> str:
    """TeX for text and mathematics alike: a formula in \\ensuremath, and plain digits as they are."""
    return tex if tex.replace(".", "").isdigit() else rf"\ensuremath{{{tex}}}"


class _Formula:
    """A writer of formulas: one method per kind of node."""

    def __init__(self, write: Writer) -> None:
        self.write = write

    def of(self, node: tree.ExpressionNode) -> str:
        write = self.write
        match node:
            case tree.NumberNode():
                return write.number(str(node.value))
            case tree.NameNode():
                return write.symbol(node.name)
            case tree.NegatedNode():
                return write.row([write.operator("-"), self.factor(node.node)])
            case tree.CallNode():
                inner = self.of(*node.arguments)
                return write.root(inner, 2) if node.function == "sqrt" else write.function(node.function, inner)
            case tree.PowerNode():
                return self.power(node.base, node.exponent)
            case tree.ChainNode():
                return self.sum(node) if _is_sum(node) else self.product(node)

    def factor(self, node: tree.ExpressionNode) -> str:
        """Write a factor, or a term after the first: in brackets if it is a sum or begins with a sign."""
        return self.write.bracket(self.of(node)) if _is_sum(node) or _is_negative(node) else self.of(node)

    def sum(self, node: tree.ChainNode) -> str:
        parts = [self.of(node.first)]
        for sign, term in node.rest:
            parts += [self.write.operator(sign.text), self.factor(term)]
        return self.write.row(parts)

    def product(self, node: tree.ChainNode) -> str:
        """Write factors side by side, divisors in a denominator, and a sign in front of all."""
        first = node.first.node if isinstance(node.first, tree.NegatedNode) else node.first
        factors = [first, *(factor for sign, factor in node.rest if sign.text == "*")]
        above = [factor for factor in factors if getattr(factor, "value", 0) != 1] or factors[:1]
        below = [factor for sign, factor in node.rest if sign.text == "/"]
        body = self.side_by_side(above)
        if below:
            body = self.write.fraction(body, self.side_by_side(below))
        return body if first is node.first else self.write.row([self.write.operator("-"), body])

    def side_by_side(self, factors: Sequence[tree.ExpressionNode]) -> str:
        """Write factors, with a sign between those that would run together as numbers."""
        if len(factors) == 1:
            return self.of(*factors)
        parts = [self.factor(factors[0])]
        for factor in factors[1:]:
            parts += [self.write.operator("·" if _begins_with_digit(factor) else ""), self.factor(factor)]
        return self.write.row(parts)

    def power(self, base: tree.ExpressionNode, exponent: Fraction) -> str:
        """Write a power, or a root if the exponent is 1/n."""
        if exponent.numerator == 1 and exponent.denominator != 1:
            return self.write.root(self.of(base), exponent.denominator)
        plain = isinstance(base, tree.NameNode) or (isinstance(base, tree.NumberNode) and base.value.denominator == 1)
        written = self.of(base) if plain else self.write.bracket(self.of(base))
        raised = rational_markup(str(exponent.numerator), str(exponent.denominator), self.write)
        return self.write.power(written, raised)


def _is_sum(node: tree.ExpressionNode) -> bool:
    return isinstance(node, tree.ChainNode) and any(sign.text in "+-" for sign, _ in node.rest)


def _is_negative(node: tree.ExpressionNode) -> bool:
    """True if the written node begins with a minus sign."""
    return isinstance(node, tree.NegatedNode) or (
        isinstance(node, tree.ChainNode) and not _is_sum(node) and _is_negative(node.first)
    )


def _begins_with_digit(node: tree.ExpressionNode) -> bool:
    """True if the written node begins with a digit, so that it would run into a number before it."""
    if isinstance(node, tree.PowerNode):
        return node.exponent.denominator == 1 and isinstance(node.base, tree.NumberNode)
    if isinstance(node, tree.ChainNode) and not _is_sum(node):
        return all(sign.text == "*" for sign, _ in node.rest) and _begins_with_digit(node.first)
    return isinstance(node, tree.NumberNode)
