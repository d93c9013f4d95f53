"""The public names: each resolves, has a type that checkers see, and an example that runs."""

import doctest
import re
import subprocess
import sys
from importlib import import_module
from pathlib import Path
from zipfile import ZipFile

import pytest

import driftproof
from tests.looping import some

ROOT = Path(__file__).parents[1]
NAMES = driftproof.__all__

# What a type checker sees of a few names, in part.
SEEN = {
    "METHODS": "driftproof.methods.catalogue.Catalogue",
    "PRESETS": "dict[str, driftproof.numeric.scenes.Scene]",
    "OscillatorRun": "h: fractions.Fraction, t: fractions.Fraction",
    "order_within": "tolerance: fractions.Fraction | int | float | str",
    "stability_function_of": "-> driftproof.symbolic.algebra.rational_functions.RationalFunction | None",
    "published_values": "def (pattern: str =) -> dict[str, dict[str, Any]]",
    "verify": "-> driftproof.blackbox.report.Report",
    "facts": "-> driftproof.reports.fact_sheet.MethodFacts",
    "facts('rk4').order": '"int"',
    "facts('rk4', system='-1')": "driftproof.reports.fact_sheet.FactSheet",
    "run('rk4', '1/4', 10).state_error": "driftproof.symbolic.algebra.certified.EnclosedReal",
    "step": "h: fractions.Fraction | int | float | str",
    "check('a.md', 'claims.toml')": "driftproof.texts.check.TextReport",
    "assert_verified": "examples: int =",
}
# Wrong uses, and the kind of error that each is.
WRONG = {
    "driftproof.assert_verifed": "attr-defined",
    "driftproof.METHODS['rk4'].no_such_fact": "union-attr",
    "driftproof.assert_verified(3)": "call-arg",
    "driftproof.order_within(driftproof.METHODS['rk4'], None)": "arg-type",
    "driftproof.Scene(name='mine')": "call-arg", "driftproof.published_values(3)": "arg-type",
    "driftproof.verify(str, 'rk4', exampels=3)": "call-arg",
    "driftproof.assert_verified(str, 'rk4', exampels=3)": "call-arg",
    "driftproof.value(3)": "arg-type",
    "driftproof.facts('rk4').no_such_fact": "attr-defined",
    "driftproof.step('rk4', None)": "arg-type", "driftproof.sweep('default', steps=[1])": "call-arg",
    "driftproof.check('a.md', init=1)": "call-overload",
}  # fmt: skip


@pytest.fixture(scope="module")
def checked(tmp_path_factory):
    """What mypy --strict says of a user's file: line -> words. Of NumPy and Dask, it reads nothing."""
    folder = tmp_path_factory.mktemp("user")
    lines = [
        "import driftproof",
        *(f"reveal_type(driftproof.{name})" for name in {**dict.fromkeys(NAMES), **SEEN}),
        *WRONG,
    ]
    (folder / "user.py").write_text("\n".join(lines) + "\n", encoding="utf-8")
    others = "[mypy-dask.*,distributed.*,numpy.*]\nfollow_imports = skip\n"
    settings = f"[mypy]\nstrict = true\nfollow_imports = silent\n{others}follow_imports_for_stubs = true\n"
    (folder / "mypy.ini").write_text(settings, encoding="utf-8")
    (folder / "driftproof").symlink_to(ROOT / "driftproof")
    done = subprocess.run(
        [sys.executable, "-m", "mypy", "--config-file", "mypy.ini", "--hide-error-context", "user.py"],
        cwd=folder,
        capture_output=True,
        text=True,
        timeout=600,
    )
    assert done.stderr == ""
    said = {lines[int(n) - 1]: [] for n in re.findall(r"^user\.py:(\d+): ", done.stdout, re.MULTILINE)}
    for number, words in re.findall(r"^user\.py:(\d+): (.*)$", done.stdout, re.MULTILINE):
        said[lines[int(number) - 1]].append(words)
    return said


def test_type_checkers_see_every_name(checked):
    assert (ROOT / "driftproof" / "py.typed").exists()
    for name in {**dict.fromkeys(NAMES), **SEEN}:
        (words,) = checked[f"reveal_type(driftproof.{name})"]
        assert words.startswith("note: Revealed type is ")
        assert words != 'note: Revealed type is "Any"', name
        assert SEEN.get(name, "") in words


def test_type_checkers_see_the_names_that_there_are_also_without_the_source(tmp_path):
    source = ROOT / "driftproof" / "__init__.py"
    seen = re.findall(r"^    from driftproof\.(\S+) import (\w+) as \2$", source.read_text("utf-8"), re.MULTILINE)
    assert {name: module for module, name in seen} == driftproof._MODULES
    with ZipFile(tmp_path / "packed.zip", "w") as packed:
        packed.write(source, "driftproof/__init__.py")
    code = f"import sys; sys.path.insert(0, {packed.filename!r}); import driftproof; print(*driftproof.__all__)"
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True).stdout.split() == NAMES


def test_type_checkers_refuse_wrong_uses(checked):
    for use, kind in WRONG.items():
        assert any(words.startswith("error: ") and words.endswith(f"[{kind}]") for words in checked[use]), use


def test_names_resolve_and_others_do_not():
    assert len(NAMES) > 30
    assert set(NAMES) < set(dir(driftproof))
    assert all(getattr(driftproof, name) is not None for name in NAMES)
    assert not [name for name in NAMES if re.search("(docs|tests|examples)/", documentation(name))]  # not installed
    with pytest.raises(AttributeError, match="module 'driftproof' has no attribute 'missing'"):
        _ = driftproof.missing


def documentation(name):
    """The docstring of a class or a function; of a constant, that of its module."""
    found = getattr(driftproof, name)
    return (found if callable(found) else import_module(f"driftproof.{driftproof._MODULES[name]}")).__doc__


@pytest.mark.slow(keep=6)
@pytest.mark.parametrize("name", NAMES)
def test_name_has_an_example_that_runs_as_it_stands(name, capsys):
    text = documentation(name)
    assert re.search(rf"^ *>>> from driftproof import .*\b{name}\b", text, re.MULTILINE)
    examples = doctest.DocTestParser().get_doctest(text, {}, name, None, None)
    assert doctest.DocTestRunner(verbose=False).run(examples).failed == 0, capsys.readouterr().out


def test_every_function_and_class_stands_in_the_reference():
    reference = (ROOT / "docs" / "api.md").read_text(encoding="utf-8")
    shown = set(re.findall(r"^\.\. auto\w+:: driftproof\.(\w+)$", reference, re.MULTILINE))
    assert shown == {name for name in NAMES if callable(getattr(driftproof, name))}


EXPLAINED = [
    ".".join(path.relative_to(ROOT).with_suffix("").parts)
    for path in sorted((ROOT / "driftproof").rglob("*.py"))
    if ">>> " in path.read_text(encoding="utf-8")
]


@pytest.mark.parametrize("module", EXPLAINED)
def test_examples_of_other_names_run_too(module, capsys):
    found = doctest.DocTestFinder().find(import_module(module))
    for examples in some(test for test in found if test.name.rpartition(".")[2] not in NAMES):
        assert doctest.DocTestRunner(verbose=False).run(examples).failed == 0, capsys.readouterr().out


def test_example_that_is_wrong_would_be_noticed():
    wrong = documentation("fixed").replace("-0.479167", "-0.479166")
    examples = doctest.DocTestParser().get_doctest(wrong, {}, "fixed", None, None)
    assert doctest.DocTestRunner(verbose=False).run(examples, out=lambda _: None).failed == 1
