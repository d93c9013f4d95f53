"""What is written in the house keeps its rules: exact numbers, docstrings that are sentences, sources that there are.

Guards of it, and for each what is planted to try it out; `tests/test_architecture.py` runs them.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Callable, Iterator
from fractions import Fraction
from functools import cache
from pathlib import Path

from tests.looping import idle_tests, parsed

PACKAGE = "driftproof"
Guard = Callable[[Path], list[str]]


@cache
def text_of(path: Path) -> str:
    return path.read_text(encoding="utf-8")


@cache
def files(root: Path, folder: str) -> tuple[Path, ...]:
    """Every Python file below the folder, links not followed; each is read once, whatever asks."""
    return tuple(sorted(path for path in (root / folder).rglob("*.py") if not path.is_symlink()))


def house(root: Path) -> tuple[Path, ...]:
    return files(root, PACKAGE)


def inexact_literals(root: Path) -> list[str]:
    """Floats written in the exact rooms; in proofs, which also speak of floats, those that are not what they say."""
    exact = [f for room in ("methods", "symbolic") for f in _floats(files(root, f"{PACKAGE}/{room}"))]
    misread = [f for f in _floats(files(root, "proofs")) if "j" in f[1] or Fraction(f[1]) != Fraction(float(f[1]))]
    return [f"{where} holds {text}" for where, text in exact + misread]


def _floats(paths: tuple[Path, ...]) -> Iterator[tuple[str, str]]:
    for path in paths:
        for node in ast.walk(parsed(path)):
            if isinstance(node, ast.Constant) and isinstance(node.value, float | complex):
                yield f"{path.name}:{node.lineno}", ast.get_source_segment(text_of(path), node) or ""


GUESSING = {"sympify", "nsimplify", "N", "parse_expr"}


def guessing_calls(root: Path) -> list[str]:
    return [
        f"{path.name}:{node.lineno} calls {_last_name(node.func)}"
        for path in (*house(root), *files(root, "proofs"))
        for node in ast.walk(parsed(path))
        if isinstance(node, ast.Call) and (_last_name(node.func) in GUESSING or _is_name(node.func, "eval"))
    ]


def _is_name(node: ast.expr, name: str) -> bool:
    """True for the builtin; polynomials have a method of the same name, which evaluates them."""
    return isinstance(node, ast.Name) and node.id == name


TOLERANCE = {"atol", "rtol", "approx", "isclose", "allclose", "assert_allclose", "abs_tol", "rel_tol"}


def tolerances(root: Path) -> list[str]:
    return [
        f"{path.name}:{getattr(node, 'lineno', '?')} names {name}"
        for path in files(root, "proofs")
        for node in ast.walk(parsed(path))
        for name in _names(node)
        if name in TOLERANCE
    ]


def _last_name(node: ast.expr) -> str | None:
    return node.id if isinstance(node, ast.Name) else node.attr if isinstance(node, ast.Attribute) else None


def _names(node: ast.AST) -> list[str | None]:
    if isinstance(node, ast.Name | ast.Attribute):
        return [_last_name(node)]
    return [node.arg] if isinstance(node, ast.keyword | ast.arg) else [node.name] if isinstance(node, ast.alias) else []


def undocumented(root: Path) -> list[str]:
    return [
        f"{path.name}: {getattr(node, 'name', 'the module')}"
        for path in (*house(root), *files(root, "proofs"))
        for node in _public(parsed(path))
        if not ast.get_docstring(node)
    ]


def _public(node: ast.Module | ast.ClassDef) -> Iterator[ast.Module | ast.ClassDef | ast.FunctionDef]:
    """The module or class, and its public functions and classes; what is defined inside functions is private."""
    yield node
    for inner in node.body:
        if isinstance(inner, ast.ClassDef) and not inner.name.startswith("_"):
            yield from _public(inner)
        elif isinstance(inner, ast.FunctionDef) and not inner.name.startswith("_"):
            hook = inner.name.startswith("pytest_")  # pytest documents its hooks
            again = any(_last_name(d) in ("setter", "overload", "register") for d in inner.decorator_list)
            if not hook and not again:
                yield inner


# A docstring that opens so is the end of a sentence whose beginning the reader has to find.
FRAGMENT = re.compile(r"(Of|By|In|On|From|To|So|As|That|Those|Where|With|Without|Beside)\b")


def fragments(root: Path) -> list[str]:
    return [
        f"{path.name}: {docstring.splitlines()[0]}"
        for path in house(root)
        for node in ast.walk(parsed(path))
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef)
        if FRAGMENT.match(docstring := ast.get_docstring(node) or "")
    ]


KEY = re.compile(r"\b[a-z]+(?:-[a-z0-9]+)*-(?:1[6-9]|20)\d\d\b")


def cited(root: Path) -> dict[str, str]:
    """Every citation key in a docstring, a comment or a string of the house, with a file that cites it."""
    return {key: path.name for path in (*house(root), *files(root, "proofs")) for key in KEY.findall(text_of(path))}


def dangling_citations(root: Path) -> list[str]:
    known = re.findall(r"@\w+\s*\{\s*([^,\s]+)\s*,", text_of(root / "references.bib"))
    return [f"{file} cites {key}" for key, file in cited(root).items() if key not in known]


def talking_inits(root: Path) -> list[str]:
    """The __init__.py of the rooms that hold more than a docstring, or none."""
    inits = [path for path in house(root) if path.name == "__init__.py" and path.parent.name != PACKAGE]
    return [str(p) for p in inits if not ast.get_docstring(parsed(p)) or len(parsed(p).body) > 1]


NARROWING = re.compile(r".* is not None|(not )?isinstance\(.*\)")


def deciding_asserts(root: Path) -> list[str]:
    """Assert statements, which python -O leaves out: in the package they narrow types and decide nothing."""
    return [
        f"{path.name}:{node.lineno} asserts {ast.unparse(node.test)}"
        for path in house(root)
        for node in ast.walk(parsed(path))
        if isinstance(node, ast.Assert) and not NARROWING.fullmatch(ast.unparse(node.test))
    ]


def idle_loops(root: Path) -> list[str]:
    """Tests, and helpers of tests, that would pass if what they loop over were empty."""
    return [found for path in (*files(root, "tests"), *files(root, "proofs")) for found in idle_tests(root, path)]


RULES: list[Guard] = [
    *(inexact_literals, guessing_calls, tolerances, undocumented, fragments, dangling_citations, talking_inits),
    *(deciding_asserts, idle_loops),
]
BROKEN: list[tuple[Guard, str, str]] = [
    (inexact_literals, "driftproof/methods/a.py", "x = 0.5"),
    (inexact_literals, "proofs/a.py", "x = -1e-12"),
    (inexact_literals, "proofs/a.py", "h = 2j"),
    (guessing_calls, "driftproof/symbolic/a.py", "import sympy\nsympy.nsimplify(x)"),
    (guessing_calls, "driftproof/a.py", "eval('1')"),
    (guessing_calls, "proofs/a.py", "from sympy import N\nN(2)"),
    (tolerances, "proofs/a.py", "import math\nassert math.isclose(1, 2)"),
    (tolerances, "proofs/a.py", "from pytest import approx as near"),
    (tolerances, "proofs/a.py", "def close(a, b, atol): ..."),
    (undocumented, "driftproof/numeric/a.py", "x = 1"),
    (undocumented, "driftproof/methods/a.py", '"""Doc."""\ndef f(): ...'),
    (undocumented, "driftproof/methods/a.py", '"""Doc."""\nclass P:\n    """Doc."""\n    def f(self): ...'),
    (fragments, "driftproof/numeric/a.py", '"""Doc."""\nclass P:\n    """Of n equations."""'),
    (fragments, "driftproof/texts/a.py", '"""Doc."""\ndef _f():\n    """As `g`."""'),
    (dangling_citations, "driftproof/symbolic/a.py", '"""True (nobody-1999, 3.1)."""'),
    (talking_inits, "driftproof/numeric/__init__.py", '"""Doc."""\nfrom driftproof.numeric import run'),
    (talking_inits, "driftproof/symbolic/deeper/__init__.py", ""),
    (deciding_asserts, "driftproof/texts/a.py", "assert 1 < 2"),
    (idle_loops, "tests/a/test_b.py", "def test_c():\n    for x in found():\n        assert x"),
    (idle_loops, "proofs/test_a.py", "def test_b():\n    assert all(x for x in found())"),
]  # fmt: skip
