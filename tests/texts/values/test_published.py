"""The published values: every form to the letter, patterns over ids, never a blank, and what LaTeX makes of them."""

import json
import re
import shutil
import subprocess
from fractions import Fraction
from pathlib import Path

import pytest

from driftproof.commands.arguments import BAD_INPUT
from driftproof.symbolic.algebra.certified import significant
from driftproof.texts.values import published as module
from driftproof.texts.values.published import MACROS_FILE, MOST_MACRO_DIGITS, VALUE_FORMATS, published_values

EXAMPLE = Path(__file__).parents[3] / "examples" / "tex" / "lesson.tex"
PDFLATEX = shutil.which("pdflatex")


DOCUMENT = {
    "rounding": "half-even",
    "values": {
        "a.h": {"exact": "1/4", "decimal": "0.25", "printed": {"L1": "0.25"}, "evidence": "PROVED"},
        "b.state_error": {
            "exact": None, "decimal": "2.390", "printed": {"L3": "2.390", "L2": "2.39", "L4": "2.39"},
            "evidence": "CERTIFIED",
        },
    },
}  # fmt: skip

ROWS = "| `a.h` | `1/4` | 0.25 | 0.25 |\n| `b.state_error` |  | 2.390 | 2.39, 2.390 |\n"


@pytest.fixture
def published(monkeypatch):
    monkeypatch.setattr(module, "_document", lambda: json.loads(json.dumps(DOCUMENT)))


@pytest.mark.usefixtures("published")
def test_values_as_json_are_canonical_and_as_javascript_the_same(answer):
    assert json.loads(answer("values")) == DOCUMENT
    script = answer("values", "--format", "js").split("export const values = ")[1]
    assert json.JSONDecoder().raw_decode(script)[0] == DOCUMENT["values"]


@pytest.mark.usefixtures("published")
def test_only_takes_a_shell_pattern_in_every_format(answer, run):
    assert set(json.loads(answer("values", "--only", "a.*"))["values"]) == {"a.h"}
    head = "| id | exact | decimal | printed |\n|---|---|---|---|\n"
    assert answer("values", "--format", "md") == head + ROWS
    assert answer("values", "--only", "*error", "--format", "md") == head + ROWS.splitlines(keepends=True)[1]
    assert run("values", "--only", "A.*")[0] == BAD_INPUT


@pytest.mark.usefixtures("published")
def test_missing_decimal_is_an_error_and_never_a_blank(run, monkeypatch):
    monkeypatch.setattr(module, "_document", lambda: {"values": {"x": {"exact": "1", "printed": {}, "evidence": "P"}}})
    for form in ("tex", "md"):
        with pytest.raises(KeyError):
            run("values", "--format", form)


def value(exact, decimal, *printed):
    return {"exact": exact, "decimal": decimal, "printed": dict(enumerate(printed)), "evidence": "PROVED"}


@pytest.mark.parametrize(
    ("found", "exact", "printed", "third"),
    [
        (value("337/384", "0.8776041666", "0.877604", "337/384"), r"\ensuremath{\frac{337}{384}}", "0.877604", "0.878"),
        (value("-1/4", "-0.25", "-0.25"), r"\ensuremath{-\frac{1}{4}}", r"\ensuremath{-0.25}", r"\ensuremath{-0.250}"),
        (value("40", "40.0000", "40"), "40", "40", "40.0"),
        (value("cos(10)", "-0.8390715290764", "-0.839"), r"\ensuremath{\cos(10)}", *[r"\ensuremath{-0.839}"] * 2),
        (value(None, "0.00032530841267", "3.3e-4", "0.000325"), "", "0.000325", "0.000325"),
        (value("sqrt(2)", "1.41421356237310", "√2"), r"\ensuremath{\sqrt{2}}", "1.41421356237310", "1.41"),
        (
            value("1/80000000", "1.25e-8"),
            *[rf"\ensuremath{{{x}}}" for x in (r"\frac{1}{80000000}", *[r"1.25 \cdot 10^{-8}"] * 2)],
        ),
    ],
)
def test_definition_has_exact_form_printed_decimal_and_digits(found, exact, printed, third):
    line = VALUE_FORMATS["tex"]({"x": found}).splitlines()[-1]
    assert line.startswith(rf"\driftproofvalue{{x}}{{{exact}}}{{{printed}}}{{\or ")
    assert line.removesuffix("}").split(r"\or ")[3] == third
    assert line.count(r"\or ") == MOST_MACRO_DIGITS


def test_decimal_that_settles_no_digit_is_refused():
    with pytest.raises(ValueError, match=r"x: the certified decimal 0.125 does not settle 2 digits"):
        VALUE_FORMATS["tex"]({"x": value(None, "0.125")})
    assert r"\or 0.12\or " in VALUE_FORMATS["tex"]({"x": value("1/8", "0.125")})  # half-even, of a number that is a tie


def test_macros_say_how_many_digits_there_are():
    macros = MACROS_FILE.read_text(encoding="utf-8")
    assert macros.count(f"1 to {MOST_MACRO_DIGITS} digits") == 2
    assert f"1 ... {MOST_MACRO_DIGITS} significant" in macros
    assert macros.isascii()


@pytest.fixture
def latex(tmp_path):
    """latex(document): exit status, log and uncompressed PDF of a LaTeX run beside values.tex."""
    (tmp_path / "values.tex").write_text(VALUE_FORMATS["tex"](published_values()) + "\n", encoding="utf-8")

    def run(document):
        (tmp_path / "lesson.tex").write_text(document, encoding="utf-8")
        environment = {
            "PATH": f"{Path(PDFLATEX).parent}:/usr/bin:/bin",
            "HOME": str(tmp_path),
            "max_print_line": "10000",
        }
        command = [PDFLATEX, "-interaction=nonstopmode", r"\pdfcompresslevel=0 \pdfobjcompresslevel=0 \input{lesson}"]
        done = subprocess.run(command, cwd=tmp_path, capture_output=True, env=environment, timeout=120)
        pdf = tmp_path / "lesson.pdf"
        return done.returncode, done.stdout.decode(errors="replace"), pdf.read_bytes() if pdf.exists() else b""

    return run


def document(body):
    return f"\\documentclass{{article}}\n\\input{{values}}\n\\begin{{document}}\n{body}\n\\end{{document}}\n"


@pytest.mark.long
@pytest.mark.skipif(PDFLATEX is None, reason="there is no pdflatex")
def test_example_is_built_with_the_values_in_it(latex):
    status, log, pdf = latex(EXAMPLE.read_text(encoding="utf-8"))
    assert status == 0, log
    assert "Warning" not in log
    # In mathematics the point comes from a font of its own: of such a number the digits after it are looked for.
    for shown in (b"0.877604", b"0.8776041667", b"2.390297", b"5.151029", b"000067"):
        assert shown in pdf


@pytest.mark.long
@pytest.mark.skipif(PDFLATEX is None, reason="there is no pdflatex")
def test_every_value_is_found_by_its_id_to_every_number_of_digits(latex):
    values = published_values()
    asked = [(key, n) for key in values for n in range(1, MOST_MACRO_DIGITS + 1)]
    lines = [rf"\typeout{{SAID {key} {n} \driftproofdigits{{{n}}}{{{key}}}}}" for key, n in asked]
    status, log, _ = latex(document("\n".join([*lines, "x"])))
    assert status == 0, log
    said = {(m[1], int(m[2])): m[3] for m in re.finditer(r"^SAID (\S+) (\d+) (.*)$", log, re.MULTILINE)}
    assert said.keys() == set(asked)
    for key, n in asked:
        exact = values[key]["exact"] or ""
        x = Fraction(exact if re.fullmatch(r"[-\d/]+", exact) else values[key]["decimal"])
        plain = re.sub(r"\\cdot *10\^\{(.*?)\}", r"e\1", said[key, n])
        assert re.sub(r"\\ensuremath|\\protect|[{} ]", "", plain) == significant(x, n), (key, n)


@pytest.mark.long
@pytest.mark.skipif(PDFLATEX is None, reason="there is no pdflatex")
@pytest.mark.parametrize(
    ("asked", "message"),
    [
        (r"\driftproof{no_such.id}", "driftproof: no value has the id no_such.id"),
        (r"\driftproofexact{rk4.default.state_error}", "driftproof: no exact form is known of rk4.default.state_error"),
        (r"\driftproofdigits{6}{no_such.id}", "driftproof: no value has the id no_such.id"),
        (r"\driftproofdigits{0}{rk4.first_step.q}", "driftproof: rk4.first_step.q has 1 to 12 digits here, not 0"),
        (r"\driftproofdigits{13}{rk4.first_step.q}", "driftproof: rk4.first_step.q has 1 to 12 digits here, not 13"),
        (r"\section{\driftproof{no_such.id}}", "driftproof: no value has the id no_such.id"),
    ],
)
def test_what_is_not_known_is_an_error_of_tex_and_stands_in_the_text(asked, message, latex):
    status, log, pdf = latex(document(asked))
    assert status == 1
    assert f"! {message}." in log
    assert b"[driftproof:" in pdf
