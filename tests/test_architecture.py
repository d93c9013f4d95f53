"""The house keeps its rules: import table, lazy imports, docstrings, exactness, citations; each guard is tried out."""

from __future__ import annotations

import ast
import re
import sys
from collections.abc import Callable, Iterator
from fractions import Fraction
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]

# A -> what A may import of the house, and of the world (None: anything).
FLOOR = {"methods": (), "symbolic": ("methods",), "numeric": ("methods",)}
FLOOR["driftproof"] = ("methods", "symbolic", "numeric")
FLOOR["proofs"] = tuple(FLOOR)
FLOOR["tests"] = tuple(FLOOR)
WORLD = {"methods": (), "symbolic": ("sympy", "flint"), "numeric": ("numpy", "numba")}

Tree = tuple[Path, ast.Module]


def sources(root: Path, *packages: str) -> Iterator[Tree]:
    for package in packages:
        for path in sorted((root / package).rglob("*.py")):
            yield path, ast.parse(path.read_text(encoding="utf-8"))


def imported(path: Path, tree: ast.Module) -> Iterator[str]:
    """Every module that the file imports, anywhere in it, by its full name."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            yield ("." * node.level) + (node.module or "")
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


def import_violations(root: Path) -> list[str]:
    found = []
    for package, allowed in FLOOR.items():
        for path, tree in sources(root, package):
            for name in imported(path, tree):
                top = name.split(".")[0]
                outside = top not in FLOOR and top not in sys.stdlib_module_names
                if (top in FLOOR and top not in (package, *allowed)) or (
                    outside and top not in WORLD.get(package, (top,))
                ):
                    found.append(f"{path.name} of {package} imports {name}")
    return found


def import_cycle(root: Path) -> list[str]:
    """The modules of a cycle of imports, deferred ones included; empty if there is none."""
    modules = {
        ".".join(path.relative_to(root).with_suffix("").parts).removesuffix(".__init__"): (path, tree)
        for path, tree in sources(root, *FLOOR)
    }
    graph = {name: {other for other in imported(*source) if other in modules} for name, source in modules.items()}
    for name in graph:  # every module imports its package first, which is no cycle
        graph[name] -= {name, name.split(".")[0]}
    try:
        TopologicalSorter(graph).prepare()
    except CycleError as error:
        return list(error.args[1])
    return []


def inexact_literals(root: Path) -> list[str]:
    """Floats written in the exact packages; in proofs, which also speak of floats, those that are not what they say."""
    exact = [f for f in _floats(root, "methods", "symbolic") if not f[0].endswith("cutoff")]
    misread = [f for f in _floats(root, "proofs") if "j" in f[1] or Fraction(f[1]) != Fraction(float(f[1]))]
    return [f"{place} holds {text}" for place, text in exact + misread]


def _floats(root: Path, *packages: str) -> Iterator[tuple[str, str]]:
    for path, tree in sources(root, *packages):
        for node in ast.walk(tree):
            for child in ast.iter_child_nodes(node):
                if isinstance(child, ast.Constant) and isinstance(child.value, float | complex):
                    text = ast.get_source_segment(path.read_text(encoding="utf-8"), child) or ""
                    keyword = f" {node.arg}" if isinstance(node, ast.keyword) else ""
                    yield f"{path.name}:{child.lineno}{keyword}", text


GUESSING = {"sympify", "nsimplify", "N", "parse_expr"}


def guessing_calls(root: Path) -> list[str]:
    return [
        f"{path.name}:{node.lineno} calls {_last_name(node.func)}"
        for path, tree in sources(root, "methods", "symbolic", "proofs", "driftproof")
        for node in ast.walk(tree)
        if isinstance(node, ast.Call) and (_last_name(node.func) in GUESSING or _is_name(node.func, "eval"))
    ]


def _is_name(node: ast.expr, name: str) -> bool:
    """True for the builtin; polynomials have a method of the same name, which evaluates them."""
    return isinstance(node, ast.Name) and node.id == name


TOLERANCE = {"atol", "rtol", "approx", "isclose", "allclose", "assert_allclose", "abs_tol", "rel_tol"}


def tolerances(root: Path) -> list[str]:
    return [
        f"{path.name}:{getattr(node, 'lineno', '?')} names {name}"
        for path, tree in sources(root, "proofs")
        for node in ast.walk(tree)
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
        for path, tree in sources(root, "methods", "symbolic", "numeric", "driftproof", "proofs")
        for node in _public(tree)
        if not ast.get_docstring(node)
    ]


Documented = ast.Module | ast.ClassDef | ast.FunctionDef


def _public(node: ast.Module | ast.ClassDef) -> Iterator[Documented]:
    """The module or class, and its public functions and classes; what is defined inside functions is private."""
    yield node
    for inner in node.body:
        if isinstance(inner, ast.ClassDef) and not inner.name.startswith("_"):
            yield from _public(inner)
        elif isinstance(inner, ast.FunctionDef) and not inner.name.startswith("_"):
            hook = inner.name.startswith("pytest_")  # pytest documents its hooks
            overload = any(_last_name(d) == "setter" for d in inner.decorator_list)
            if not hook and not overload:
                yield inner


KEY = re.compile(r"\b[a-z]+(?:-[a-z0-9]+)*-(?:1[6-9]|20)\d\d\b")


def cited(root: Path) -> dict[str, str]:
    """Every citation key in a docstring, a comment or a string of the house, with a file that cites it."""
    return {
        key: path.name
        for package in ("methods", "symbolic", "numeric", "driftproof", "proofs")
        for path in sorted((root / package).rglob("*.py"))
        for key in KEY.findall(path.read_text(encoding="utf-8"))
    }


def dangling_citations(root: Path) -> list[str]:
    known = re.findall(r"@\w+\s*\{\s*([^,\s]+)\s*,", (root / "references.bib").read_text(encoding="utf-8"))
    return [f"{file} cites {key}" for key, file in cited(root).items() if key not in known]


def talking_inits(root: Path) -> list[str]:
    """The __init__.py that hold more than a docstring, or none."""
    inits = (f for f in sources(root, "methods", "symbolic", "numeric") if f[0].name == "__init__.py")
    return [str(path) for path, tree in inits if not ast.get_docstring(tree) or len(tree.body) > 1]


GUARDS: list[Callable[[Path], list[str]]] = [
    import_violations,
    import_cycle,
    inexact_literals,
    guessing_calls,
    tolerances,
    undocumented,
    dangling_citations,
    talking_inits,
]


@pytest.mark.parametrize("guard", GUARDS, ids=lambda guard: guard.__name__)
def test_house_has_none_of(guard: Callable[[Path], list[str]]) -> None:
    assert guard(ROOT) == []


PLANTED = [
    (import_violations, "symbolic/a.py", "import driftproof.numeric.run"),
    (import_violations, "numeric/a.py", "def f():\n    from driftproof.symbolic.derivation.one_step import H"),
    (import_violations, "methods/a.py", "import numpy"),
    (import_violations, "numeric/a.py", "import sympy"),
    (import_violations, "driftproof/a.py", "from tests import helpers"),
    (import_violations, "symbolic/a.py", "import proofs.setting"),
    (import_violations, "numeric/a.py", "from . import b"),
    (import_cycle, "methods/a.py", "import methods.b"),
    (inexact_literals, "methods/a.py", "x = 0.5"),
    (inexact_literals, "proofs/a.py", "x = -1e-12"),
    (inexact_literals, "proofs/a.py", "h = 0.1"),
    (inexact_literals, "proofs/a.py", "h = 2j"),
    (inexact_literals, "symbolic/a.py", "x = 1j"),
    (guessing_calls, "symbolic/a.py", "import sympy\nsympy.nsimplify(x)"),
    (guessing_calls, "driftproof/a.py", "eval('1')"),
    (guessing_calls, "proofs/a.py", "from sympy import N\nN(2)"),
    (guessing_calls, "methods/a.py", "sp.sympify('1')"),
    (tolerances, "proofs/a.py", "import math\nassert math.isclose(1, 2)"),
    (tolerances, "proofs/a.py", "close(1, 2, rtol=tiny)"),
    (tolerances, "proofs/a.py", "from pytest import approx as near"),
    (tolerances, "proofs/a.py", "def close(a, b, atol): ..."),
    (undocumented, "numeric/a.py", "x = 1"),
    (undocumented, "methods/a.py", '"""Doc."""\ndef public(): ...'),
    (undocumented, "methods/a.py", '"""Doc."""\nclass P:\n    """Doc."""\n    def public(self): ...'),
    (dangling_citations, "symbolic/a.py", '"""True (nobody-1999, 3.1)."""'),
    (dangling_citations, "methods/a.py", 'SOURCE = "no-body-2001, II.2"'),
    (talking_inits, "numeric/__init__.py", '"""Doc."""\nfrom numeric import run'),
    (talking_inits, "symbolic/deeper/__init__.py", ""),
]


@pytest.mark.parametrize(("guard", "file", "text"), PLANTED)
def test_guard_notices_what_is_planted(
    guard: Callable[[Path], list[str]], file: str, text: str, tmp_path: Path
) -> None:
    _plant(tmp_path, file, text)
    assert guard(tmp_path) != []


@pytest.mark.parametrize("guard", GUARDS, ids=lambda guard: guard.__name__)
def test_guard_passes_a_clean_tree(guard: Callable[[Path], list[str]], tmp_path: Path) -> None:
    _plant(tmp_path, "symbolic/a.py", '"""True (hairer-1999, 3.1)."""\nimport sympy\nfrom methods import b\nx = 1\n')
    _plant(tmp_path, "proofs/a.py", '"""Proof."""\nx = 0.25\np.eval(x)\n')
    assert guard(tmp_path) == []


def _plant(root: Path, file: str, text: str) -> None:
    files = {"references.bib": "@book{hairer-1999,\n}", "methods/b.py": '"""B."""\nimport methods.a\n', file: text}
    for name, content in files.items():
        path = root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(content, encoding="utf-8")


def test_guards_read_the_house_and_not_nothing() -> None:
    read = {path.parent.name for path, _ in sources(ROOT, *FLOOR)}
    assert read >= {*FLOOR}
    assert {"hairer-norsett-wanner-1993", "butcher-2016"} <= set(cited(ROOT))


HEAVY = {"sympy", "flint", "matplotlib", "mpmath", "hypothesis", "tqdm", "numba", "jinja2", "distributed", "dask"}


def _all_modules(package: str) -> str:
    files = sorted((ROOT / package).rglob("*.py"))
    names = (".".join(file.relative_to(ROOT).with_suffix("").parts) for file in files)
    return "import " + ", ".join(name.removesuffix(".__init__") for name in names)


@pytest.mark.parametrize("code", [_all_modules("numeric"), _all_modules("methods"), "import driftproof"])
def test_import_loads_nothing_heavy(code: str, modules_after: Callable[[str], set[str]]) -> None:
    loaded = modules_after(code)
    assert {name.split(".")[0] for name in loaded} & HEAVY == set()


def test_import_of_driftproof_and_of_methods_loads_no_numpy(modules_after: Callable[[str], set[str]]) -> None:
    assert "numpy" not in modules_after(f"import driftproof; {_all_modules('methods')}")


def test_guard_of_heavy_imports_notices_sympy(modules_after: Callable[[str], set[str]]) -> None:
    loaded = modules_after("import driftproof.numeric.run, driftproof.symbolic.derivation.one_step")
    assert {"sympy", "numpy"} <= loaded


def test_strategies_register_no_profile_on_import(fresh_python: Callable[[str], str]) -> None:
    profiles = "sorted(hypothesis.settings._profiles)"
    code = f"import hypothesis\nbefore = {profiles}\nimport driftproof.strategies\nprint(before == {profiles})"
    assert fresh_python(code) == "True"


def test_every_public_name_of_driftproof_resolves() -> None:
    import driftproof

    assert driftproof.__all__
    for name in driftproof.__all__:
        assert getattr(driftproof, name) is not None
    assert set(driftproof.__all__) < set(dir(driftproof))
    with pytest.raises(AttributeError, match="no attribute 'missing'"):
        _ = driftproof.missing
