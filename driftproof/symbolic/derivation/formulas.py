"""Symbols and steps of derivations, and how they are written in TeX, as plain text and in JSON."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import sympy
from sympy.polys.matrices import DomainMatrix

from driftproof.symbolic.algebra.certified import significant
from driftproof.symbolic.derivation.expression_balls import enclose_expression
from driftproof.symbolic.derivation.one_step import expression

# Significant digits shown of a number without radicals; chosen to fit into a formula.
_DIGITS_SHOWN = 12
# Plain text shows only the beginning of a longer formula; those of splittings with long decimals can reach 30 kB.
_LONGEST_SHOWN, _BEGUN = 4000, 80

# The state, the step size, and the map J(q, v) = (v, -q), whose products with stages do not commute.
POSITION, VELOCITY, STEP_SIZE = sympy.symbols("q v h")
STATE, TURN = sympy.symbols("z J", commutative=False)
MATRIX, NEW_STATE, STABILITY, ARGUMENT = sympy.symbols("M z_1 R z")
ENERGY_RATIO, INVARIANT, DISCRIMINANT, THETA, LIMIT = sympy.symbols("mu I Delta theta H")
ROOTS = sympy.symbols("lambda_1 lambda_2")
DET, TRACE, GRAM = sympy.Symbol("det M"), sympy.Symbol("tr M"), sympy.Symbol("M^T M")
AREA_FORM, CHARACTERISTIC = sympy.Symbol("det(z, M z)"), sympy.Symbol("det(lambda I - M)")
COSINE, TANGENT = sympy.Symbol("cos(theta)"), sympy.Symbol("tan(theta)")
# The TeX of the symbols that stand for a formula.
TEX_NAMES = {
    DET: r"\det M",
    TRACE: r"\operatorname{tr} M",
    GRAM: r"M^{\mathsf T} M",
    AREA_FORM: r"\det(z, M z)",
    CHARACTERISTIC: r"\det(\lambda I - M)",
    COSINE: r"\cos\theta",
    TANGENT: r"\tan\theta",
}


@dataclass(frozen=True)
class ProofStep:
    """One step of a derivation: why it holds, with formulas between dollars, and a chain of equal expressions."""

    because: str
    chain: tuple[sympy.Basic, ...]


@dataclass(frozen=True)
class Derived:
    """A derivation: `symbol` = `value` with its steps; or None for the value and, in `missing`, why there is none."""

    name: str
    symbol: sympy.Basic
    value: sympy.Basic | None
    steps: tuple[ProofStep, ...]
    missing: str | None = None

    @property
    def tex(self) -> str:
        """The equation symbol = value in TeX, or the reason why there is no value."""
        return chain_tex((self.symbol, self.value)) if self.value is not None else rf"\text{{none: {self.missing}}}"

    @property
    def derivation_tex(self) -> str:
        """The steps as a LaTeX paragraph: a sentence and a displayed formula for each."""
        lines = [rf"\paragraph{{{self.title}}}"]
        for step in self.steps:
            lines += [step.because, rf"\[ {chain_tex(step.chain)} \]"]
        return "\n".join([*lines, f"There is none: {self.missing}."] if self.missing else lines)

    @property
    def text(self) -> str:
        """The title and the steps as plain text, with formulas in SymPy's syntax."""
        lines = [self.title]
        for step in self.steps:
            lines += [f"  {plain_words(step.because)}", f"      {chain_text(step.chain)}"]
        return "\n".join([*lines, f"  There is none: {plain_words(self.missing)}."] if self.missing else lines)

    @property
    def title(self) -> str:
        """The name as a heading."""
        return self.name.replace("_", " ").capitalize()

    def data(self) -> dict[str, Any]:
        """A dictionary for JSON: "value" in SymPy's syntax, "tex", "missing" and "steps"."""
        steps = [
            {"because": s.because, "chain": [str(x) for x in s.chain], "tex": chain_tex(s.chain)} for s in self.steps
        ]
        value = None if self.value is None else str(self.value)
        return {"value": value, "tex": self.tex, "missing": self.missing, "steps": steps}

    def _repr_latex_(self) -> str:
        return rf"$\displaystyle {self.tex}$"


def as_matrix(m: DomainMatrix) -> sympy.ImmutableMatrix:
    """The matrix as a SymPy matrix of expressions in h."""
    return sympy.ImmutableMatrix([[expression(x) for x in row] for row in m.to_list()])


def chain_tex(chain: Sequence[sympy.Basic]) -> str:
    """The expressions in TeX, joined by equals signs, with polynomials in ascending powers."""
    settings = {"symbol_names": TEX_NAMES, "mat_str": "pmatrix", "mat_delim": "", "inv_trig_style": "full"}
    return " = ".join(
        rf"{_digits(x)}\ldots" if _is_long(x) else sympy.latex(x, order=_order(x), **settings) for x in chain
    )


def chain_text(chain: Iterable[sympy.Basic]) -> str:
    """The expressions in SymPy's syntax, joined by equals signs, shortened if very long; matrices as [1, h; -h, 1]."""
    return " = ".join(_begun(_text(x)) for x in chain)


def _begun(text: str) -> str:
    if len(text) <= _LONGEST_SHOWN:
        return text
    return f"{text[:_BEGUN]}... ({len(text)} characters, whole in JSON and in TeX)"


def plain_words(words: str) -> str:
    """A sentence with TeX formulas as plain text, without dollars, backslashes and braces."""
    return words.replace(r"\pm", "±").translate({ord(c): None for c in "$\\{}"})


def _text(x: sympy.Basic) -> str:
    if isinstance(x, sympy.MatrixBase):
        return f"[{'; '.join(', '.join(_text(entry) for entry in row) for row in x.tolist())}]"
    return f"{_digits(x)}..." if _is_long(x) else str(sympy.sstr(x, order=_order(x)))


def _order(x: sympy.Basic) -> str:
    """The printing order of the terms: polynomials in h or in z ascend, other expressions stay as written."""
    return "rev-lex" if x.free_symbols <= {STEP_SIZE} or x.free_symbols <= {ARGUMENT} else "none"


def _is_long(x: sympy.Basic) -> bool:
    """True for a number without radicals: it contains a root of an irreducible polynomial."""
    return bool(x.atoms(sympy.CRootOf)) and not x.free_symbols and not isinstance(x, sympy.MatrixBase)


def _digits(x: sympy.Basic) -> str:
    return significant(partial(enclose_expression, x), _DIGITS_SHOWN)
