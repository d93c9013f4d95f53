"""The pytest plugin: verdicts in the short summary, a marker for time limits, and a folder of reports for CI.

pytest loads it wherever driftproof is installed; therefore it imports only `driftproof.support`.
"""

from __future__ import annotations

import json
import os
import re
import shutil
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
# The property of a failed test, in JUnit's files, too, that is its verdict.
_PROPERTY = "driftproof"
# Characters of a report's file name that come from the name of the test; most systems allow names of 255 bytes.
_LONGEST_NAME = 180


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add the option --driftproof-report."""
    group = parser.getgroup("driftproof")
    words = "write what each assert_... of driftproof found into FOLDER: a JSON file per test, and summary.md"
    group.addoption("--driftproof-report", metavar="FOLDER", help=words)


def pytest_configure(config: pytest.Config) -> None:
    """Register the marker, and collect verdicts if a folder for reports is given."""
    config.addinivalue_line("markers", MARKER)
    folder = config.getoption("--driftproof-report")
    if folder is not None:
        try:
            if not folder:
                raise ValueError("name a folder")
            require_folder(Path(folder))
            Path(folder).mkdir(parents=True, exist_ok=True)
        except (OSError, ValueError) as error:
            raise pytest.UsageError(f"--driftproof-report: {error}") from None
        # The path is made absolute because a test may change the working directory for good.
        config.pluginmanager.register(_Reports(Path(folder).absolute(), is_worker=hasattr(config, "workerinput")))


@pytest.hookimpl(wrapper=True)
def pytest_runtest_call(item: pytest.Item) -> Generator[None, Any, Any]:
    """Run the test with the time limit of its marker."""
    marker = item.get_closest_marker("driftproof")
    given = None if marker is None else _time_limit(item, marker)
    token = time_limit_of_test.set(given)
    try:
        yield
    finally:
        time_limit_of_test.reset(token)


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(call: pytest.CallInfo[Any]) -> Generator[None, Any, Any]:
    """Begin the line of the short summary with the verdict instead of the name of the exception."""
    report: Any = yield
    error = None if call.excinfo is None else call.excinfo.value
    crash = getattr(report.longrepr, "reprcrash", None)
    if isinstance(error, VerdictError) and crash is not None:
        crash.message = error.verdict.headline
        report.user_properties.append((_PROPERTY, crash.message))
    return report


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Write in full the verdicts that the short summary, which follows, has no room for; on CI it cuts none."""
    room = shutil.get_terminal_size().columns
    for report in () if os.environ.get("CI") else terminalreporter.stats.get("failed", ()):
        verdict = dict(report.user_properties).get(_PROPERTY, "")
        if verdict and len(f"FAILED {report.nodeid} - {verdict}") > room:
            terminalreporter.write_line(f"{report.nodeid}: {verdict}")


def _time_limit(item: pytest.Item, marker: pytest.Mark) -> float:
    given = marker.kwargs.get("time_limit", *marker.args[:1]) if {*marker.kwargs} <= {"time_limit"} else None
    if isinstance(given, int | float) and not isinstance(given, bool) and given > 0:
        return given
    shown = ", ".join([*map(repr, marker.args), *(f"{name}={value!r}" for name, value in marker.kwargs.items())])
    wanted = "mark it driftproof(time_limit=SECONDS), a positive number"
    pytest.fail(f"{item.nodeid}: {wanted}, not driftproof({shown})", pytrace=False)


class _Reports:
    """The plugin that writes the verdicts of each test to a JSON file, and in the end a summary of all in Markdown."""

    def __init__(self, folder: Path, *, is_worker: bool) -> None:
        """`is_worker` is True in the workers of pytest-xdist, whose controller writes the summary."""
        self.folder, self.is_worker, self.found = folder, is_worker, list[AssertedVerdict]()
        self.tests, self.failed = set[str](), set[str]()

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_protocol(self, item: pytest.Item) -> Generator[None, Any, Any]:
        """Collect the verdicts of the test, and write them to its file in place of those of an earlier run."""
        self.found.clear()
        self._file_of(item.nodeid).unlink(missing_ok=True)
        listeners.append(self.found.append)
        try:
            return (yield)
        finally:
            listeners.remove(self.found.append)
            if self.found:
                verdicts = [
                    {"subject": x.subject, "verdict": x.words, "passed": x.passed, "report": x.report, **x.data}
                    for x in self.found
                ]
                self._write(self._file_of(item.nodeid), as_json({"test": item.nodeid, "verdicts": verdicts}))

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """Record which tests ran, in this process or in a worker, and which of them failed."""
        self.tests.add(report.nodeid)
        if report.failed:
            self.failed.add(report.nodeid)

    def pytest_sessionfinish(self) -> None:
        """Write the summary of the tests that ran: a line for each verdict, those that did not pass first, then
        those of tests that failed for another reason, such as a warning.

        If a verdict does not hold but its test did not fail, the test expected that, by xfail or `pytest.raises`.
        """
        if self.is_worker:
            return
        paths = filter(Path.exists, map(self._file_of, sorted(self.tests)))
        reports = [json.loads(path.read_text(encoding="utf-8")) for path in paths]
        found = [(each["test"], one) for each in reports for one in each["verdicts"]]
        found.sort(key=lambda pair: (pair[1]["passed"] is True, pair[0] not in self.failed))
        rows = []
        for name, one in found:
            cells = (self._word(name, one["passed"]), f"`{name}`", f"{one['subject']} {one['verdict']}")
            rows.append(f"| {' | '.join(cell.replace('|', chr(92) + '|') for cell in cells)} |")
        parts = ["| | test | verdict |\n| --- | --- | --- |\n" + "\n".join(rows)] if rows else ["no verdict"]
        if silent := sorted(self.failed - {name for name, _ in found}):
            parts.append(f"failed without a verdict: {', '.join(f'`{name}`' for name in silent)}")
        parts += [f"### `{name}`\n\n```\n{one['report']}\n```" for name, one in found]
        self._write(self.folder / SUMMARY, "\n\n".join(parts) + "\n")

    def _word(self, test: str, passed: bool | None) -> str:
        if passed:
            return "passed, but the test FAILED" if test in self.failed else "passed"
        word = "undecided" if passed is None else "FAILED"
        return word if test in self.failed else f"{word.lower()}, as expected"

    def _file_of(self, test: str) -> Path:
        """The file of a test's verdicts: its name without special characters, and a digest that tells tests apart."""
        named = re.sub(r"[^\w.-]+", "_", test)[-_LONGEST_NAME:]
        return self.folder / f"{named}-{sha256(test.encode()).hexdigest()[:8]}.json"

    def _write(self, path: Path, text: str) -> None:
        with atomic_write(path) as draft:
            Path(draft).write_text(text, encoding="utf-8")
