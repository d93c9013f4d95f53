"""TeX is read as it is set: commands gone, fractions on one line, verbatim environments as listings."""

from __future__ import annotations

import pytest

from tests.texts.readers.reading import blocks, read, standing

READ = [
    ("a % 5\nb\\% \\label{eq:1}\\cite{x2} \\emph{c} \\num{0.5}~d", "a b% c 0.5 d"),
    ("$\\frac{337}{384}$, $\\tfrac12$, $\\frac{h^2}{2}$", "337/384, 1/2, (h^2)/2"),
    ("$2\\sqrt{2}$ $3.3\\times 10^{-4}$ $1\\,000$ $q_{n+1}$", "2√2 3.3×10^{-4} 1,000 q_{n+1}"),
    ("\\begin{tabular}{lr} a & 0.5 \\\\ b & 1 \\end{tabular}", "a | 0.5\nb | 1"),
]


@pytest.mark.parametrize(("source", "text"), READ)
def test_tex_is_read_as_people_read_it(source: str, text: str) -> None:
    assert read("tex", source) == text


def test_number_stands_where_the_file_has_it() -> None:
    assert standing("tex", "% 1\none $\\frac{x}{y} \\num{-42.5}$", "42.5").startswith("42.5")


def test_verbatim_environment_is_a_listing() -> None:
    source = "\\begin{lstlisting}[language=Python]\nx\n\\end{lstlisting}"
    assert blocks("tex", source) == [("listing", "python", "x")]
