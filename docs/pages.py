"""Pages that are held true: their commands, their Python sessions and their tables are written anew and compared.

`python docs/pages.py` rewrites docs/differences.md, certify.md, language.md, lesson.md and public_texts.md in place.
In a page, a block that opens with ```console and `$ driftproof ...` shows what the command prints; a block that opens
with ```python holds a session with `>>>`; and a table follows the comment <!-- table: NAME -->, NAME in TABLES of the
page's own module, which makes it from the rows that stand there. A tutorial is run in an empty folder, from its first
line to its last: a block after a line that ends in a file's name and a colon is that file, and commands of a console
block are run one after the other.
"""

from __future__ import annotations

import contextlib
import doctest
import io
import os
import re
import shlex
import subprocess
import sys
import tempfile
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

ROOT = Path(__file__).parents[1]
TUTORIALS = sorted((ROOT / "docs" / "tutorials").glob("*.md"))
sys.path.insert(0, str(ROOT))  # the checkout's own packages, whatever else is installed

CONSOLE = re.compile(r"```console\n\$ driftproof (.*?)\n(.*?)```", re.DOTALL)
FILE_OR_CONSOLE = re.compile(
    r"`([\w/-]+[.][\w.]+)`[^`\n]*:\n\n```(?!console)\w*\n(.*?)```|```console\n(.*?)```", re.DOTALL
)
COMMAND = re.compile(r"^\$ (.*)$", re.MULTILINE)
# How long pytest took.
SECONDS = re.compile(r" in \d+\.\d\ds\b")
SESSION = re.compile(r"```python\n(.*?)```", re.DOTALL)
TABLE = re.compile(r"<!-- table: (\w+) -->\n+((?:\|.*\n)*)\n*")
# Makes a table anew, its header first, from the rows that stand there.
Table = Callable[[Sequence[Sequence[str]]], list[list[str]]]


def printed(command: str) -> str:
    """What `driftproof command` prints. Raises ValueError if it exits with an error; that the answer is no is none."""
    from driftproof.cli import main
    from driftproof.commands.arguments import REFUTED

    with contextlib.redirect_stdout(io.StringIO()) as out:
        status = main(shlex.split(command))
    if status not in (0, REFUTED):
        raise ValueError(f"driftproof {command}: exit code {status}")
    return out.getvalue()


def journey(page: str, folder: Path, programs: Path) -> str:
    """The tutorial as it is now: its files written to the empty folder, its commands run there.

    `programs` is the folder in which driftproof and python are found, before any other.
    """
    given = {**os.environ, "PATH": f"{programs}{os.pathsep}{os.environ['PATH']}", "COLUMNS": "120", "CI": "1"}

    def done(match: re.Match[str]) -> str:
        name, content, console = match.groups()
        if name:
            (folder / name).write_text(content, encoding="utf-8")
            return match[0]
        answers = "\n".join(map(said, COMMAND.findall(console)))  # a blank line before the next command
        return f"```console\n{answers}```"

    def said(command: str) -> str:
        ran = subprocess.run(
            ["bash", "-c", command], cwd=folder, env=given, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
        )
        ended = "" if ran.stdout.endswith("\n") or not ran.stdout else "\n"  # head -c may cut a line
        return f"$ {command}\n{SECONDS.sub(' in 1.00s', ran.stdout)}{ended}"

    return FILE_OR_CONSOLE.sub(done, page)


class _Recorder(doctest.DocTestRunner):
    """Runs examples and keeps what they print, right or wrong."""

    def __init__(self) -> None:
        super().__init__(verbose=False)
        self.got: list[str] = []

    def report_start(self, *_: object) -> None:
        """Nothing to say."""

    def report_success(self, out: object, test: object, example: object, got: str) -> None:
        """As expected."""
        self.got.append(got)

    report_failure = report_success

    def report_unexpected_exception(self, out: object, test: object, example: doctest.Example, exc_info: tuple) -> None:
        """A session that raises is no session. Raises what it raised."""
        raise exc_info[1]


def session(text: str, names: dict[str, object]) -> str:
    """The session with the output that it has now; `names` are the variables, which it may change."""
    examples = doctest.DocTestParser().get_examples(text)
    runner, test = _Recorder(), doctest.DocTest(examples, {}, "page", None, None, text)
    test.globs = names  # not a copy, so that the next session knows them
    runner.run(test, clear_globs=False)
    lines = []
    for example, got in zip(examples, runner.got, strict=True):
        first, *more = example.source.splitlines()
        lines += [f">>> {first}", *(f"... {line}".rstrip() for line in more)]
        lines += got.splitlines()
    return "\n".join(lines) + "\n"


def markdown(rows: Sequence[Sequence[str]]) -> str:
    """A table in Markdown, its header first."""
    header, *body = rows
    lines = [header, ["---"] * len(header), *body]
    return "".join(f"| {' | '.join(cell.replace('|', chr(92) + '|') for cell in line)} |\n" for line in lines)


def rows_of(table: str) -> list[list[str]]:
    """The rows of a table in Markdown, without its header."""
    lines = [line[2:-2] for line in table.splitlines()[2:]]
    return [[cell.replace(r"\|", "|") for cell in re.split(r"(?<!\\) \| ", line)] for line in lines]


def refreshed(page: str, tables: Mapping[str, Table]) -> str:
    """The page with every block and every table as they are now; the sessions of a page share their variables."""
    names: dict[str, object] = {}
    page = CONSOLE.sub(lambda m: f"```console\n$ driftproof {m[1]}\n{printed(m[1])}```", page)
    page = SESSION.sub(lambda m: f"```python\n{session(m[1], names)}```", page)
    return (
        TABLE.sub(lambda m: f"<!-- table: {m[1]} -->\n\n{markdown(tables[m[1]](rows_of(m[2])))}\n", page).rstrip()
        + "\n"
    )


def main() -> None:
    """Rewrite the pages."""
    from docs import language_tables, lesson_tables, public_text_tables, tables

    pages: dict[str, Mapping[str, Table]] = {"differences.md": tables.TABLES, "certify.md": {}}
    pages |= {"language.md": language_tables.TABLES, "lesson.md": lesson_tables.TABLES}
    pages["public_texts.md"] = public_text_tables.TABLES
    for name, of_page in pages.items():
        path = ROOT / "docs" / name
        path.write_text(refreshed(path.read_text(encoding="utf-8"), of_page), encoding="utf-8")
    for path in TUTORIALS:
        with tempfile.TemporaryDirectory() as folder:
            told = journey(path.read_text(encoding="utf-8"), Path(folder), Path(sys.executable).parent)
            path.write_text(told, encoding="utf-8")


if __name__ == "__main__":
    main()
