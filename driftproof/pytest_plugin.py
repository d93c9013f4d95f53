"""For pytest: the verdict in the short summary, time limits by a marker, and a folder of reports for CI.

Loaded by pytest wherever driftproof is installed; it imports nothing else of the package before a test does.
"""

from __future__ import annotations

import json
import re
from collections.abc import Generator
from hashlib import sha256
from pathlib import Path
from typing import Any

import pytest

from driftproof.support.assertions import AssertedVerdict, VerdictError, listeners, time_limit_of_test
from driftproof.support.files import atomic_write, require_folder
from driftproof.support.plain_text import as_json

MARKER = "driftproof(time_limit): seconds that assert_verified may take in this test"
SUMMARY = "summary.md"
# Of the part of a file's name that is the test's: on most systems a name has 255 bytes.
_LONGEST_NAME = 180


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add --driftproof-report."""
    group = parser.getgroup("driftproof")
    words = (
        "write what assert_verified and assert_accurate found into FOLDER: a JSON file for each test, and summary.md"
    )
    group.addoption("--driftproof-report", metavar="FOLDER", help=words)


def pytest_configure(config: pytest.Config) -> None:
    """Make the marker known, and listen where a folder is asked for."""
    config.addinivalue_line("markers", MARKER)
    folder = config.getoption("--driftproof-report")
    if folder is not None:
        try:
            require_folder(Path(folder))
            Path(folder).mkdir(parents=True, exist_ok=True)
        except (OSError, ValueError) as error:
            raise pytest.UsageError(f"--driftproof-report: {error}") from None
        # Absolute: a test may go to another folder, and stay there.
        config.pluginmanager.register(_Reports(Path(folder).absolute(), is_worker=hasattr(config, "workerinput")))


@pytest.hookimpl(wrapper=True)
def pytest_runtest_call(item: pytest.Item) -> Generator[None, Any, Any]:
    """Give the test the time limit of its marker."""
    marker = item.get_closest_marker("driftproof")
    given = None if marker is None else _time_limit(item, marker)
    token = time_limit_of_test.set(given)
    try:
        yield
    finally:
        time_limit_of_test.reset(token)


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(call: pytest.CallInfo[Any]) -> Generator[None, Any, Any]:
    """Let the short summary begin with the verdict, where pytest would write the name of the exception."""
    report: Any = yield
    error = None if call.excinfo is None else call.excinfo.value
    crash = getattr(report.longrepr, "reprcrash", None)
    if isinstance(error, VerdictError) and crash is not None:
        crash.message = error.verdict.headline
    return report


def _time_limit(item: pytest.Item, marker: pytest.Mark) -> float:
    given = marker.kwargs.get("time_limit", *marker.args[:1])
    if isinstance(given, int | float) and not isinstance(given, bool) and given > 0:
        return given
    raise pytest.UsageError(f"{item.nodeid}: mark it driftproof(time_limit=SECONDS), a positive number, not {given!r}")


class _Reports:
    """Writes the verdicts of each test as one JSON file, and at the end all of them as Markdown."""

    def __init__(self, folder: Path, *, is_worker: bool) -> None:
        """`is_worker`: of pytest-xdist, whose controller writes the summary."""
        self.folder, self.is_worker, self.found = folder, is_worker, list[AssertedVerdict]()
        self.tests, self.failed = set[str](), set[str]()

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_protocol(self, item: pytest.Item) -> Generator[None, Any, Any]:
        """Listen while the test runs, and write down what it found, in the place of what it found another time."""
        self.found.clear()
        self._file_of(item.nodeid).unlink(missing_ok=True)
        listeners.append(self.found.append)
        try:
            return (yield)
        finally:
            listeners.remove(self.found.append)
            if self.found:
                told = [
                    {"subject": x.subject, "verdict": x.words, "passed": x.passed, "report": x.report, **x.data}
                    for x in self.found
                ]
                self._write(self._file_of(item.nodeid), as_json({"test": item.nodeid, "verdicts": told}))

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """Keep which tests ran, in whatever process, and which failed."""
        self.tests.add(report.nodeid)
        if report.failed:
            self.failed.add(report.nodeid)

    def pytest_sessionfinish(self) -> None:
        """Write the summary of the tests that ran: a line for each verdict, what did not pass first.

        A verdict that does not hold in a test that did not fail is what that test expects: xfail, `pytest.raises`.
        """
        if self.is_worker:
            return
        paths = filter(Path.exists, map(self._file_of, sorted(self.tests)))
        told = [json.loads(path.read_text(encoding="utf-8")) for path in paths]
        found = [(each["test"], one) for each in told for one in each["verdicts"]]
        found.sort(key=lambda pair: (pair[1]["passed"] is True, pair[0] not in self.failed))
        rows = []
        for name, one in found:
            cells = (self._word(name, one["passed"]), f"`{name}`", f"{one['subject']} {one['verdict']}")
            rows.append(f"| {' | '.join(cell.replace('|', chr(92) + '|') for cell in cells)} |")
        parts = ["| | test | verdict |\n| --- | --- | --- |\n" + "\n".join(rows)] if rows else ["no verdict"]
        parts += [f"### `{name}`\n\n```\n{one['report']}\n```" for name, one in found]
        self._write(self.folder / SUMMARY, "\n\n".join(parts) + "\n")

    def _word(self, test: str, passed: bool | None) -> str:
        if passed:
            return "passed"
        word = "undecided" if passed is None else "FAILED"
        return word if test in self.failed else f"{word.lower()}, as expected"

    def _file_of(self, test: str) -> Path:
        """Named after the test, and by a digest, as names of tests may have characters that those of files have not."""
        named = re.sub(r"[^\w.-]+", "_", test)[-_LONGEST_NAME:]
        return self.folder / f"{named}-{sha256(test.encode()).hexdigest()[:8]}.json"

    def _write(self, path: Path, text: str) -> None:
        with atomic_write(path) as draft:
            Path(draft).write_text(text, encoding="utf-8")
