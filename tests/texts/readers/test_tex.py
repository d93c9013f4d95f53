"""TeX is read as it is set: commands gone, fractions on one line, verbatim environments as listings."""

from itertools import pairwise

import pytest

from tests.texts.readers.reading import blocks, read, standing

READ = [
    ("a % 5\nb\\% \\label{eq:1}\\cite{x2} \\emph{c} \\num{0.5}~d", "a b% c 0.5 d"),
    ("$\\frac{337}{384}$, $\\tfrac12$, $\\frac{h^2}{2}, \\frac1{2y}$", "337/384, 1/2, (h^2)/2, 1/(2y)"),
    ("$\\frac{2}{3}x\\frac12\\frac13(a)\\frac12\\sin\\frac12\\right)$", "2/3 x1/2 1/3 (a)1/2 sin 1/2)"),
    ("$2\\sqrt{2}$ $3.3\\times 10^{-4}$ $1\\,000$ $q_{n+1}$", "2√2 3.3×10^{-4} 1,000 q_{n+1}"),
    ("\\newcommand{\\half}{\\tfrac{1}{2}}\\newcommand\\pow[2]{#1^{#2}}$\\half\\pow{h}{12}\\pow h3$", "1/2h^{12}h^3"),
    ("\\def\\a{\\b}\\def\\b{\\a}\\DeclareMathOperator{\\tr}{tr} \\a 5 \\tr 6", "5 tr 6"),
    ("\\def\\a{1234567890123}" + "\\a" * 12, "1234567890123" * 12),  # 180 characters of 45
    ("a\\;b\\-c $\\frac{\\frac{1}{2}}{3}$", "a bc (1/2)/3"),
    ("$\\sqrt[3]{x+1} \\sqrt[3]8 -\\lvert x\\rvert \\ell y$", "(x+1)^{1/3} 8^{1/3} -|x|ℓy"),
    ("$y^\\prime + y^{\\prime\\prime} x^{2\\prime}$", "y' + y'' x^{2'}"),
    ("$-\\cos 10 \\log\\theta$ $\\Delta t = \\kappa\\tanh x$", "-cos 10 log θ Δt = κ tanh x"),
    ("$\\hat y_1 = \\bar{x}$", "ˆy_1 = ˉx"),
    ("$\\nicefrac{1}{4}$ and $\\sfrac{3}{8}$, \\tablevref{t-5} and \\href{u7}{b}", "1/4 and 3/8, and b"),
    ("$\\dot x=v, \\ddot{\\theta}(0), \\dot\\omega_{12} \\ddot x_1$\\dotfill 3 \\dots", "x'=v, θ''(0), ω_{12}' x_1''3"),
    ("& \\multicolumn{2}{c}{Euler} & \\multicolumn{1}{l|}{RK4}\\\\ 0.1", "| Euler | | RK4\n0.1"),
    ("\\newcommand{\\dd}{\\mathrm{d}}$\\frac{\\dd y}{\\dd t} = 2, \\dfrac{\\dd{x}}{\\dd{t}}$", "dy/dt = 2, dx/dt"),
    (
        "$\\frac{\\mathrm{d}^2x}{\\mathrm{d}t^2}, \\frac{1}{1+\\frac{a}{b}}, \\frac{{a}}{b} y$",
        "d^2x/dt^2, 1/(1+a/b), (a)/b y",
    ),
    ("\\begin{tabular}{lr} a & 0.5 \\\\ b & 1 \\end{tabular}", "a | 0.5\nb | 1"),
]


@pytest.mark.parametrize(("source", "text"), READ)
def test_tex_is_read_as_people_read_it(source, text):
    assert read("tex", source) == text


def test_macros_that_grow_without_end_are_left_at_four_times_the_text():
    assert 0 < len(read("tex", "x \\a y" + "\\def\\a{\\a\\a\\a 1}")) < 80
    many = "".join(f"\\def\\{a}{{" + f"\\{b}" * 9 + "}" for a, b in pairwise("abcdefghijklmn"))
    assert len(read("tex", many + "\\a\\def\\n{1}")) < 10_000
    source = "\\newcommand{\\x}[1]{#1}\nis \\x{42.5}"
    assert standing("tex", source, "42.5") == "42.5}"


def test_macros_are_put_in_five_times_and_braces_opened_twenty_times():
    """\\a is \\b, and so on: one round puts in all that were defined before, so these are defined backwards."""
    for rounds, read_as in ((5, "7"), (6, "")):
        names = "abcdefg"[: rounds + 1]
        chain = "".join(f"\\def\\{a}{{\\{b}}}" for a, b in reversed([*pairwise(names)])) + f"\\def\\{names[-1]}{{7}}"
        assert read("tex", f"{chain}x \\a y" + " z" * 99).split()[1] == (read_as or "y"), rounds
    deep = lambda n: "\\emph{" * n + "x" + "}" * n
    assert read("tex", deep(20)) == "x"


def test_verbatim_environment_is_a_listing():
    for environment, options in (("lstlisting", "[language=Python]"), ("minted", "{Python}")):
        source = f"a\\begin{{{environment}}}{options}\nx\n\\end{{{environment}}}"
        assert blocks("tex", source) == [("prose", "", "a"), ("listing", "python", "x")]
