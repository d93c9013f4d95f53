"""What steps look like: ascending polynomials, stages in their order, numbers without radicals in digits."""

from __future__ import annotations

import pytest
import sympy

from driftproof.symbolic.derivation.derive import derive
from driftproof.symbolic.derivation.formulas import (
    ARGUMENT,
    DET,
    Derived,
    ProofStep,
    chain_tex,
    chain_text,
    plain_words,
)

h = sympy.Symbol("h")
K = sympy.symbols("k_1 k_2", commutative=False)
MATRIX = sympy.ImmutableMatrix([[1 - h**2, h], [-h, 1]])


@pytest.mark.parametrize(
    ("expression", "text", "tex"),
    [
        (sympy.Add(h**4 / 4, -(h**2), 1, evaluate=False), "1 - h**2 + h**4/4", r"1 - h^{2} + \frac{h^{4}}{4}"),
        (sympy.Add(ARGUMENT, 1, evaluate=False), "1 + z", "1 + z"),
        (sympy.Add(K[0] / 2, K[1], evaluate=False), "k_1/2 + k_2", r"\frac{k_{1}}{2} + k_{2}"),
        (MATRIX, "[1 - h**2, h; -h, 1]", r"\begin{pmatrix}1 - h^{2} & h\\- h & 1\end{pmatrix}"),
        (DET, "det M", r"\det M"),
        (sympy.CRootOf(h**5 - h - 1, 0), "1.16730397826...", r"1.16730397826\ldots"),
    ],
)
def test_expression_is_written_as_an_author_would(expression: sympy.Basic, text: str, tex: str) -> None:
    assert (chain_text([expression]), chain_tex([expression])) == (text, tex)
    assert chain_text([DET, expression]) == f"det M = {text}"


def test_a_formula_that_nobody_reads_is_begun_in_text_and_whole_in_data() -> None:
    long = derive("kahan_li8").invariant
    assert len(long.text) < 1500
    assert long.text.count("characters, whole in JSON and in TeX)") == 2
    assert len(str(long.value)) > 30_000
    assert "characters" not in derive("dormand_prince54").roots.text


def test_words_lose_what_only_tex_needs() -> None:
    words = plain_words(r"A step multiplies by $\det M$, and $E = |z|^{2}/2$.")
    assert words == "A step multiplies by det M, and E = |z|^2/2."
    assert plain_words(r"They turn by $\pm\theta$.") == "They turn by ±theta."


def test_missing_value_says_why_in_every_form() -> None:
    derived = Derived("invariant", DET, None, (ProofStep("So $h$ is:", (h, h**2)),), "$h$ is odd")
    assert derived.text == "Invariant\n  So h is:\n      h = h**2\n  There is none: h is odd."
    assert derived.derivation_tex.splitlines() == [
        r"\paragraph{Invariant}", "So $h$ is:", r"\[ h = h^{2} \]", "There is none: $h$ is odd.",
    ]  # fmt: skip
    assert derived.tex == r"\text{none: $h$ is odd}"
    steps = [{"because": "So $h$ is:", "chain": ["h", "h**2"], "tex": "h = h^{2}"}]
    assert derived.data() == {"value": None, "tex": derived.tex, "missing": "$h$ is odd", "steps": steps}


def test_limit_without_radicals_is_shown_in_digits_and_by_its_polynomial() -> None:
    limit = derive("dormand_prince54").stability_limit
    assert "H = 0.997189008633..." in limit.text
    assert limit.steps[-1].chain == (h**6 - 25 * h**4 + 225 * h**2 - 200, 0)
    assert r"H = 0.997189008633\ldots" == limit.tex
