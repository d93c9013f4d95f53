"""The module for web pages rounds as the proofs do, integer by integer; what it does not know is an error."""

import json
import re
import shutil
import subprocess
from fractions import Fraction

import pytest

from driftproof.symbolic.algebra.certified import fixed, significant
from driftproof.texts.values.published import MODULE_FILE, NO_VALUES, VALUE_FORMATS, published_values
from tests.looping import some

NODE = shutil.which("node")
pytestmark = pytest.mark.skipif(NODE is None, reason="there is no Node.js to run the module")

# Whole, halves that are ties, carries, small, large, negative, and numbers that only a decimal is known of.
RATIONALS = ["0", "1", "-7", "1/2", "5/8", "-15/16", "1/3", "99999/100000", "-2/30000000", "123456789", "1/64", "-5/2"]
DECIMALS = {
    "pi": "3.14159265358979323846264338328", "small": "0.0000123456789", "tiny": "-6.72826070465768687e-7",
    "large": "1.2346e12", "carry": "0.99996", "tie": "2500.0",
}  # fmt: skip


@pytest.fixture(scope="module")
def script(tmp_path_factory):
    """script(values, code): what `code`, which has the module's names, returns; in one Node.js process."""
    folder = tmp_path_factory.mktemp("module")

    def run(values, code):
        (folder / "driftproof.mjs").write_text(VALUE_FORMATS["js"](values), encoding="utf-8")
        (folder / "main.mjs").write_text(
            'import * as module from "./driftproof.mjs";\n'
            "const said = (ask) => { try { return ask(); } catch (error) { return `Error: ${error.message}`; } };\n"
            "const { values, value, digits, places, remark, load } = module;\n"
            f"const answer = async () => {{ {code} }};\n"
            "console.log(JSON.stringify(await answer()));\n",
            encoding="utf-8",
        )
        done = subprocess.run([NODE, folder / "main.mjs"], capture_output=True, text=True, timeout=60)
        assert (done.returncode, done.stderr) == (0, "")
        return json.loads(done.stdout)

    return run


def value(exact, decimal):
    return {"exact": exact, "decimal": decimal, "evidence": "PROVED", "printed": {}}


# For each value and n from 0 to 39: to n digits, and to n places.
ALL = """
const answers = {};
for (const id in values) {
  answers[id] = [...Array(40).keys()].map((n) => [said(() => digits(id, n)), said(() => places(id, n))]);
}
return answers;
"""
HALF_WAY = "half-way in the digits that are certified; ask for one digit more or less"


def expected(name, decimal, n):
    """What becomes of a decimal that stands for a number half a unit of its last digit away at most."""
    known = decimal.partition("e")[0].replace(".", "").lstrip("-0")
    if n > len(known):
        return f"Error: driftproof: {name} is not certified to so many digits"
    if known[n:].rstrip("0") == "5":
        return f"Error: driftproof: {name} is {HALF_WAY}"
    return significant(Fraction(decimal), n)


def test_rationals_are_rounded_as_the_proofs_round_them(script):
    answers = script({text: value(text, "0.5") for text in RATIONALS}, ALL)
    for text in RATIONALS:
        for n, (digits, places) in some(enumerate(answers[text]), 10):
            assert places == fixed(Fraction(text), n)
            if n:
                assert digits == significant(Fraction(text), n)
            else:
                assert digits == "Error: driftproof: digits is 0; it must be a whole number from 1 to 10000"


def test_decimals_are_rounded_as_the_proofs_round_them_and_no_further(script):
    answers = script({name: value(None, text) for name, text in DECIMALS.items()}, ALL)
    for name, text in DECIMALS.items():
        assert [digits for digits, _ in answers[name][1:]] == [expected(name, text, n) for n in range(1, 40)]
    assert [answers[name][3][1] for name in ("pi", "small", "carry")] == ["3.142", "0.000", "1.000"]
    assert answers["tiny"][3][1] == "0.000"  # a zero has no sign
    assert answers["large"][3][1] == "Error: driftproof: large is not certified to so many digits"
    assert answers["pi"][29][0] == "3.1415926535897932384626433833"
    assert answers["tie"][1][0].endswith(HALF_WAY)


def test_published_values_come_out_of_the_module_as_they_went_in(script):
    values = published_values()
    answers = script(values, ALL)
    assert script(values, "return values;") == values
    enclosed = {key: found for key, found in values.items() if not re.fullmatch(r"[-\d/]+", found["exact"] or "")}
    assert len(enclosed) > 5
    for key, found in enclosed.items():
        assert [digits for digits, _ in answers[key][1:]] == [expected(key, found["decimal"], n) for n in range(1, 40)]
    assert answers["rk4.first_step.q"][6][0] == "0.877604"


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize(
    ("code", "message"),
    [
        ('digits("no.such.id", 6)', 'no value has the id "no.such.id"'),
        ('value("constructor")', 'no value has the id "constructor"'),
        ('value("__proto__")', 'no value has the id "__proto__"'),
        ("value()", "no value has the id undefined"),
        ('digits("x", 10001)', "digits is 10001; it must be a whole number from 1 to 10000"),
        ('digits("x", "6")', "digits is 6; it must be"),
        ('places("x", 1.5)', "places is 1.5; it must be"),
        ('places("x", -1)', "places is -1; it must be"),
        ('digits("word", 6)', "word is no number and has no digits"),
        ('places("tie", 1)', "tie is half-way in the digits that are certified"),
    ],
)
def test_what_cannot_be_answered_is_an_error(code, message, script):
    values = {"x": value("1/3", "0.333"), "word": value("yes", "yes"), "tie": value(None, "0.250")}
    assert script(values, f"return said(() => {code});").startswith(f"Error: driftproof: {message}")


def test_values_of_a_json_file_take_the_place_of_those_of_the_module(script):
    document = json.dumps({"values": {"b": value("1/3", "0.333")}})
    code = f"await load('data:application/json,{document}'); return [Object.keys(values), digits('b', 5)];"
    assert script({"a": value("1/2", "0.5")}, code) == [["b"], "0.33333"]


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize("document", ["null", "{}", '{"values": null}', '{"values": 3}', "3"])
def test_json_without_values_is_refused_and_changes_nothing(document, script):
    code = f"try {{ await load('data:application/json,{document}'); }} "
    code += "catch (e) { return [e.message, digits('a', 1)]; }"
    message, kept = script({"a": value("1/2", "0.5")}, code)
    assert message.endswith("holds no values")
    assert kept == "0.5"


def test_remark_shows_a_short_exact_form_and_else_the_decimal(script):
    values = {"a": value("337/384", "0.8776"), "b": value("1" * 61, "1.11e60"), "c": value(None, "2.39")}
    values["c"]["evidence"] = "CERTIFIED"
    remarks = ["= 337/384, proved", "≈ 1.11e60, proved", "≈ 2.39, certified"]
    assert script(values, 'return ["a", "b", "c"].map(remark);') == remarks


def test_module_holds_one_place_for_the_values():
    module = MODULE_FILE.read_text(encoding="utf-8")
    assert module.count(NO_VALUES) == 1
    assert NO_VALUES not in VALUE_FORMATS["js"](published_values())
