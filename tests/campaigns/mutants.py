"""Small errors planted in a copy of the package, one at a time: do the tests notice? Writes docs/mutants.md.

Which errors are planted is drawn by a seed, as many in each room. An error is tried on the test file that mirrors the
module, on those that import it or stand beside it, and on the catalogue's; the checkout itself is never touched.
"""

from __future__ import annotations

import argparse
import ast
import os
import random
import re
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
import tomllib
from collections import Counter
from collections.abc import Container, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from functools import cache
from pathlib import Path
from queue import SimpleQueue
from textwrap import shorten
from typing import NamedTuple

from tqdm import tqdm

ROOT = Path(__file__).parents[2]
ROOMS = ("methods", "symbolic", "numeric", "blackbox", "enclosure", "texts", "reports")
KILLED, SURVIVED, EQUIVALENT, UNDECIDED = OUTCOMES = ("killed", "survived", "equivalent", "undecided")
PAGE, JUDGED = ROOT / "docs" / "mutants.md", Path(__file__).with_name("equivalent.toml")
# Of one mutant's tests: longer than any of them takes on two busy cores. A mutant that runs on is noticed by it.
LIMIT = 300.0

SWAPS: dict[type[ast.AST], type[ast.AST]] = {
    **{ast.Add: ast.Sub, ast.Sub: ast.Add, ast.Mult: ast.Add, ast.Div: ast.Mult, ast.FloorDiv: ast.Mult},
    **{ast.Mod: ast.Mult, ast.Pow: ast.Mult, ast.LShift: ast.RShift, ast.RShift: ast.LShift, ast.And: ast.Or},
    **{ast.Or: ast.And, ast.Lt: ast.LtE, ast.LtE: ast.Lt, ast.Gt: ast.GtE, ast.GtE: ast.Gt, ast.Eq: ast.NotEq},
    **{ast.NotEq: ast.Eq, ast.Is: ast.IsNot, ast.IsNot: ast.Is, ast.In: ast.NotIn, ast.NotIn: ast.In},
}
# Functions that do not know the order of their arguments.
SYMMETRIC = ("max", "min", "maximum", "minimum", "hypot", "gcd", "lcm", "divisor", "dot", "distance")
SYMMETRIC += ("same", "_is_same", "suppress", "isclose")  # the last is that of math; NumPy's is not
# What a bound on rounding errors is called; and how constants are written that bound what is measured.
BOUND, SMALL = re.compile(r"\.of\(|\.u\b|\b(allowed|rounding|slack|noise)\b"), re.compile(r"2\.0 \*\* \(-\d+\)|1e-\d+")
# What is computed of pairs of numbers in either order, as in sum(x * y for x, y in
EITHER_WAY = r"[\[(](?:([a-z]) [*+] ([a-z]) for \1, \2|abs\(([a-z]) - ([a-z])\) for \3, \4) in "
# Keywords that declare an intent: no answer of a program that is right changes with them.
DECLARED = {"zip": ("strict",), "dataclass": ("frozen", "slots"), "TypeVar": ("covariant", "contravariant")}
DECLARED["lru_cache"] = ("maxsize",)


HEAD = """\
# Planted errors, and whether the tests notice

Written by `{command}`; from another tree the same seed draws others.

Each mutant is one small error in a copy of the package: an operator, a comparison, a constant or a digit is changed,
a sign or a statement dropped, two arguments are swapped. It is killed where a test that passes without it fails with
it, among the test file that mirrors the module, those that import the module, those beside it, and the catalogue's.
Nothing is planted in what declares an intent and changes no answer of a right program: `strict` of `zip`, `frozen` and
`slots` of dataclasses, what an `assert` would say. The score leaves out what no test could notice, each with its
reason: `tests/campaigns/equivalent.toml`; there stand, too, the lines of numbers that were chosen, states, steps, bits
of balls, where others do as well: another number that survives there is equivalent, and so is the very edge of a bound
on what is measured. What the time limit ended, and what failed without the mutant too, is tried once more; what is
undecided then counts as not killed. Survivors that were met have got tests since: only a seed that nobody has tried
says what share of new errors would be noticed.

| room | mutants | killed | survived | equivalent | undecided | score |
|---|---|---|---|---|---|---|"""


class Mutant(NamedTuple):
    """`old` at bytes `start` to `end` of the file becomes `new`; `line` is the line as it was, for the reader."""

    place: str
    start: int
    end: int
    old: str
    new: str
    line: str
    nth: int

    @property
    def name(self) -> str:
        """What it is called in the page and in equivalent.toml, lines that move or not; `nth` counts its namesakes."""
        again = f" ({self.nth})" if self.nth > 1 else ""
        return f"{self.where} | {self.old} -> {self.new}{again}"

    @property
    def where(self) -> str:
        """Its file and line, as equivalent.toml names those of chosen numbers."""
        return f"{self.place} | {self.line}"


def variants(node: ast.AST, digits: bool) -> Iterator[str]:
    """What may stand instead of the node."""
    if isinstance(node, ast.BinOp) and type(node.op) in SWAPS:
        yield ast.unparse(ast.BinOp(node.left, SWAPS[type(node.op)](), node.right))
    elif isinstance(node, ast.BoolOp):
        yield ast.unparse(ast.BoolOp(SWAPS[type(node.op)](), node.values))
    elif isinstance(node, ast.Compare):
        for i, operator in enumerate(node.ops):
            changed = [*node.ops[:i], SWAPS[type(operator)](), *node.ops[i + 1 :]]
            yield ast.unparse(ast.Compare(node.left, changed, node.comparators))
    elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub | ast.Not):
        yield ast.unparse(node.operand)
    elif isinstance(node, ast.Constant) and type(node.value) in (int, float):
        yield from (repr(node.value + 1), repr(node.value - 1))
    elif isinstance(node, ast.Constant) and type(node.value) is bool:
        yield repr(not node.value)
    elif isinstance(node, ast.Constant) and digits and re.search(r"\d\.\d+", str(node.value)):
        for match in list(re.finditer(r"\.\d*(\d)", str(node.value)))[-1:]:  # its last digit after the point
            at, text = match.start(1), str(node.value)
            yield repr(f"{text[:at]}{(int(text[at]) + 1) % 10}{text[at + 1 :]}")
    elif isinstance(node, ast.Call) and len(node.args) > 1 and _called(node) not in SYMMETRIC:
        swapped = ast.Call(node.func, [node.args[1], node.args[0], *node.args[2:]], node.keywords)
        if not any(isinstance(x, ast.Starred) for x in node.args) and ast.dump(swapped) != ast.dump(node):
            yield ast.unparse(swapped)
    elif isinstance(node, ast.AugAssign | ast.Raise | ast.Break | ast.Continue | ast.Expr | ast.Assign):
        kept = ast.Constant | ast.Yield | ast.YieldFrom  # docstrings, and what makes a generator of a function
        names = isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name | ast.Tuple)
        if not names and not (isinstance(node, ast.Expr) and isinstance(node.value, kept)):
            yield "pass"


def nodes(tree: ast.AST) -> Iterator[ast.AST]:
    """Every node that says what is computed: no annotation, declaration, docstring or import, no part of f-strings."""
    declared = DECLARED.get(ast.unparse(tree.func), ()) if isinstance(tree, ast.Call) else ()
    for field, value in ast.iter_fields(tree):
        if field in ("annotation", "returns", "type_params", "msg") or (field == "value" and _is_alias(tree)):
            continue
        for child in value if isinstance(value, list) else [value]:
            docstring = isinstance(child, ast.Expr) and isinstance(child.value, ast.Constant)
            if docstring or (isinstance(child, ast.keyword) and child.arg in declared):
                continue
            if isinstance(child, ast.AST) and not isinstance(child, ast.JoinedStr | ast.Import | ast.ImportFrom):
                yield child
                yield from nodes(child)


def _called(node: ast.Call) -> str:
    """The last word of the name that is called, as in greatest_common_divisor."""
    return re.split("[._]", ast.unparse(node.func))[-1]


def _is_alias(node: ast.AST) -> bool:
    return isinstance(node, ast.AnnAssign) and "TypeAlias" in ast.unparse(node.annotation)


def mutants_of(root: Path, place: str, only: Container[str] | None = None) -> list[Mutant]:
    """Every mutant of the file that still compiles; of the lines in `only`, given without their blanks, if it is."""
    source = (root / place).read_bytes()
    begins, lines = [0], source.splitlines(keepends=True)
    for text in lines:
        begins.append(begins[-1] + len(text))
    found, named, tree = [], Counter[tuple[str, ...]](), ast.parse(source)
    for node in nodes(tree):
        if node in tree.body:  # what the nodes up to the next such are parts of: it alone is compiled
            first = min(x.lineno for x in (node, *getattr(node, "decorator_list", ())))  # type: ignore[attr-defined]
            opening, closing = begins[first - 1], begins[node.end_lineno]  # type: ignore[attr-defined]
        line = lines[node.lineno - 1].decode().strip() if hasattr(node, "lineno") else ""
        for new in variants(node, "/tables/" in place) if only is None or line in only else ():
            first, last = begins[node.lineno - 1], begins[node.end_lineno - 1]  # type: ignore[attr-defined]
            start, end = first + node.col_offset, last + node.end_col_offset  # type: ignore[attr-defined]
            new = f"({new})" if isinstance(node, ast.BinOp | ast.BoolOp | ast.Compare | ast.UnaryOp) else new
            with suppress(SyntaxError, ValueError):
                compile(source[opening:start] + new.encode() + source[end:closing], place, "exec")
                words = (place, line, " ".join(source[start:end].decode().split()), new)
                named[words] += 1
                found.append(Mutant(place, start, end, words[2], new, line, named[words]))
    return found


def sample(root: Path, seed: int, number: int) -> list[Mutant]:
    """As many of each room, room after room, so that whoever stops early has a fair sample, too."""
    draw, rooms = random.Random(seed), []
    for room in ROOMS:
        files = sorted(path.relative_to(root).as_posix() for path in (root / "driftproof" / room).rglob("*.py"))
        rooms.append([m for place in files for m in mutants_of(root, place)])
        draw.shuffle(rooms[-1])
    return [mutant for turn in zip(*rooms, strict=False) for mutant in turn][:number]


def checks_of(root: Path, place: str) -> list[str]:
    """The mirrored file first, then those that import the module, those beside it, and the catalogue's."""
    path = Path(place)
    mirrored = root / "tests" / path.relative_to("driftproof").with_name(f"test_{path.name}")
    module = ".".join(path.with_suffix("").parts)
    importing = re.compile(rf"from {module.rpartition('.')[0]} import .*\b{path.stem}\b|\b{re.escape(module)}\b")
    found = [mirrored] if mirrored.exists() else []
    found += [p for p in sorted((root / "tests").rglob("test_*.py")) if importing.search(p.read_text(encoding="utf-8"))]
    found += sorted(mirrored.parent.glob("test_*.py"))
    if path.parts[1] in ("methods", "symbolic", "numeric"):
        found.append(root / "tests" / "catalogue" / "test_conformance.py")
    return [p.relative_to(root).as_posix() for p in dict.fromkeys(found)]


class Workshop:
    """A copy of the tree in which mutants are planted, and its tests run."""

    def __init__(self, folder: Path) -> None:
        """Copy what git knows of, and what it does not ignore."""
        listed = ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"]
        names = subprocess.run(listed, cwd=ROOT, capture_output=True, text=True, check=True).stdout.split("\0")
        self.root, self.stamp = folder, int(time.time())
        self.passing: set[str] = set()
        for name in filter(None, names):
            if (ROOT / name).exists():
                (folder / name).parent.mkdir(parents=True, exist_ok=True)
                shutil.copy2(ROOT / name, folder / name, follow_symlinks=False)

    def write(self, place: str, content: bytes) -> None:
        """With a time of its own, whole seconds later than the last: bytecode is told apart by that."""
        self.stamp += 2
        (self.root / place).write_bytes(content)
        os.utime(self.root / place, (self.stamp, self.stamp))

    def run(self, tests: list[str], limit: float) -> tuple[int | None, str]:
        """pytest's exit status, None past the limit, and the first test that failed, "" for none."""
        command = [sys.executable, "-m", "pytest", "-m", "not long", "-x", "-q", "-rfE", "--no-header", *tests]
        environment = {**os.environ, "PYTHONPATH": str(self.root), "HYPOTHESIS_PROFILE": "ci"}
        running = subprocess.Popen(
            command, cwd=self.root, env=environment, start_new_session=True,
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors="replace",
        )  # fmt: skip
        try:
            out, _ = running.communicate(timeout=limit)
        except subprocess.TimeoutExpired:
            os.killpg(running.pid, signal.SIGKILL)
            running.communicate()
            return None, ""
        failed = re.search(r"(?m)^(?:FAILED|ERROR) (\S+?\.py(?:::\S+)?)", out)
        return running.returncode, failed[1] if failed else ""

    def outcome(self, mutant: Mutant) -> str:
        """Killed by a test that passes without the mutant; undecided where the time limit ended it, or no test ran.

        The first file, which mirrors the module and notices most, is run alone: all of them take long to collect.
        """
        right = (self.root / mutant.place).read_bytes()
        self.write(mutant.place, right[: mutant.start] + mutant.new.encode() + right[mutant.end :])
        try:
            found = checks_of(self.root, mutant.place)
            for tests in filter(None, (found[:1], found[1:])):
                status, failed = self.run(tests, LIMIT)
                if status != 0:
                    break
        finally:
            self.write(mutant.place, right)
        if status == 0:
            return SURVIVED
        tests = [failed.partition("[")[0]] if failed else tests
        if not self.passing.issuperset(tests) and self.run(tests, LIMIT / 2)[0] == 0:
            self.passing.update(tests)
        return KILLED if self.passing.issuperset(tests) else UNDECIDED


def judged() -> dict[str, str]:
    """The mutants that no test could notice, by name, each with the reason."""
    return {entry["mutant"]: entry["because"] for entry in tomllib.loads(JUDGED.read_text(encoding="utf-8"))["judged"]}


def chosen(formulas: bool = False) -> dict[str, str]:
    """The lines of numbers that were chosen, where others do as well, each with the reason; or of formulas alone."""
    groups = tomllib.loads(JUDGED.read_text(encoding="utf-8"))["chosen"]
    groups = [group for group in groups if group.get("formulas", not formulas)]
    return {line: group["because"] for group in groups for line in group["lines"]}


def edge(mutant: Mutant) -> list[str]:
    """Both sides of the comparison whose edge alone it moves, < to <= and the like; [] where it does another thing."""
    if re.search(r"[<>]", mutant.new):
        old, new = (ast.parse(text, mode="eval").body for text in (mutant.old, mutant.new))
        if isinstance(old, ast.Compare) and isinstance(new, ast.Compare):
            sides = [ast.unparse(x) for x in (old.left, *old.comparators)]
            for i, (x, y) in enumerate(zip(old.ops, new.ops, strict=True)):
                if type(x) is not type(y) and isinstance(x, ast.Lt | ast.LtE | ast.Gt | ast.GtE):
                    return sides[i : i + 2]
    return []


@cache
def small_floats(place: str) -> frozenset[str]:
    """The file's constants 2.0**-n and 1e-n, and those that it imports: what is measured is compared with them."""
    found = set[str]()
    for node in ast.parse((ROOT / place).read_text(encoding="utf-8")).body:
        if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name | ast.Tuple):
            names = ast.unparse(node.targets[0]).strip("()").split(", ")
            values = node.value.elts if isinstance(node.value, ast.Tuple) else [node.value]
            found |= {x for x, y in zip(names, values, strict=False) if SMALL.fullmatch(ast.unparse(y))}
        elif isinstance(node, ast.ImportFrom):
            path = f"{(node.module or '').replace('.', '/')}.py"
            found |= {x.name for x in node.names if (ROOT / path).is_file() and x.name in small_floats(path)}
    return frozenset(found)


def reason(mutant: Mutant) -> str:
    """Why no test could notice it, "" where one could."""
    if re.search(EITHER_WAY + re.escape(mutant.old), mutant.line):
        return "A product, or a distance, of two numbers is the same from either side."
    for side in edge(mutant):
        if BOUND.search(side) or small_floats(mutant.place).intersection(re.findall(r"\w+", side)):
            return (
                "Whether a bound on what is measured, or on its rounding, is itself allowed: nothing measured meets it."
            )
        for where, because in chosen().items() if side.isupper() else ():
            place, _, line = where.partition(" | ")
            if place == mutant.place and side in line.partition(" = ")[0].split(", "):
                return because
    number = re.fullmatch(r"[\d.e-]+", mutant.old)
    return judged().get(mutant.name) or chosen(formulas=not number).get(mutant.where, "")


def campaign(mutants: list[Mutant], minutes: float, workers: int) -> dict[Mutant, str]:
    """Every mutant's outcome, as far as the time allows."""
    found: dict[Mutant, str] = {m: EQUIVALENT for m in mutants if m.name in judged()}
    until, lock = time.monotonic() + 60 * minutes, threading.Lock()
    with tempfile.TemporaryDirectory() as folder, tqdm(total=len(mutants), initial=len(found), unit="mutant") as bar:
        shops: SimpleQueue[Workshop] = SimpleQueue()
        for i in range(workers):
            shops.put(Workshop(Path(folder, str(i))))

        def look(mutant: Mutant) -> None:
            if time.monotonic() > until:
                return
            shop = shops.get()
            try:
                outcome = shop.outcome(mutant)
            finally:
                shops.put(shop)
            with lock:
                found[mutant] = outcome
                bar.update()
                if outcome != KILLED:
                    bar.write(f"{outcome}: {mutant.name}", file=sys.stderr)

        with ThreadPoolExecutor(workers) as pool:
            list(pool.map(look, [m for m in mutants if m not in found]))
        shop = shops.get()  # once more and alone: on a busy machine time ends what is right, too
        found |= {m: shop.outcome(m) for m, outcome in found.items() if outcome == UNDECIDED}
    found |= {m: EQUIVALENT for m, outcome in found.items() if outcome == SURVIVED and reason(m)}
    return {m: found[m] for m in mutants if m in found}


def page(found: dict[Mutant, str], command: str) -> str:
    """docs/mutants.md."""
    lines = [HEAD.format(command=command)]
    for room in (*ROOMS, "all"):
        count = Counter(x for mutant, x in found.items() if room in ("all", mutant.place.split("/")[1]))
        against = count.total() - count[EQUIVALENT]
        score = f"{100 * count[KILLED] / against:.0f} %" if against else "-"
        lines.append(f"| {room} | {count.total()} | {' | '.join(str(count[x]) for x in OUTCOMES)} | {score} |")
    for title, wanted in (("Survivors", SURVIVED), ("Undecided", UNDECIDED), ("Equivalent", EQUIVALENT)):
        listed = [m for m, outcome in found.items() if outcome == wanted]
        lines += ["", f"## {title}", ""] if listed else []
        for m in listed:
            because = f": {reason(m)}" if wanted == EQUIVALENT else ""
            line, old, new = (shorten(text, 100) for text in (m.line, m.old, m.new))
            lines.append(f"- `{m.place}`, `{line}`: `{old}` becomes `{new}`{because}")
    return "\n".join(lines) + "\n"


def main() -> None:
    """Draw, try, and write the page."""
    arguments = argparse.ArgumentParser(description=__doc__)
    arguments.add_argument("--seed", type=int, default=1)
    arguments.add_argument("--number", type=int, default=300)
    arguments.add_argument("--minutes", type=float, default=60, help="after which no further mutant is begun")
    arguments.add_argument("--workers", type=int, default=2)
    given = arguments.parse_args()
    _, most = resource.getrlimit(resource.RLIMIT_DATA)  # not of addresses, of which Node.js takes more than it uses
    resource.setrlimit(resource.RLIMIT_DATA, (8 << 30, most))  # of each process: a mutant may run wild
    found = campaign(sample(ROOT, given.seed, given.number), given.minutes, given.workers)
    command = f"python -m tests.campaigns.mutants --seed {given.seed} --number {len(found)}"
    PAGE.write_text(page(found, command), encoding="utf-8")


if __name__ == "__main__":
    main()
