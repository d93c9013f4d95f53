"""pytest hooks that keep and print the ledger, and publish the values if and only if all proofs pass."""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Iterator
from functools import cached_property
from pathlib import Path
from typing import Any

import pytest

from driftproof.support.files import atomic_write
from driftproof.support.progress import working
from driftproof.symbolic.family_facts import FamilyFacts
from driftproof.symbolic.linear.facts import FactsOfFamily, LinearFacts
from driftproof.texts.values.changes import changes
from driftproof.texts.values.published import VALUES_FILE
from proofs.claims import CERTIFIED, PROVED, RESTRICTED
from proofs.ledger import Entry, Ledger
from proofs.printed import published

LEDGER_FILE = Path(__file__).with_name("ledger.md")
FILES = {path.name for path in Path(__file__).parent.glob("test_*.py")}
PUBLISHED = "published"
NEEDED = "Needed:"
BY_DERIVATION = (PROVED, RESTRICTED, CERTIFIED)
FACTS_BY_NAME = (LinearFacts, FactsOfFamily, FamilyFacts)
_LEDGER = pytest.StashKey[Ledger]()


def pytest_configure(config: pytest.Config) -> None:
    config.stash[_LEDGER] = Ledger()


@pytest.hookimpl(wrapper=True, tryfirst=True)
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> Iterator[None]:
    # Before -k and -m deselect, so that the ledger can list deselected claims as "not run".
    here = [item for item in items if Path(__file__).parent in item.path.parents]
    entries = [entry for item in here for entry in _entries(item)]
    try:
        config.stash[_LEDGER].add((item.nodeid for item in here), entries)
    except ValueError as error:
        raise pytest.UsageError(str(error)) from None
    yield


def _entries(item: pytest.Item) -> list[Entry]:
    marker = item.get_closest_marker("claim")
    if marker is None:
        return []
    parameters = getattr(item, "callspec", None)
    row = parameters.params.get("row") if parameters else None
    documented: Any = item
    statement = row.sentence if row else _statement(documented.function.__doc__, marker.kwargs["evidence"], item.nodeid)
    return [
        Entry(claim, item.nodeid, statement, marker.kwargs["evidence"], marker.kwargs["by"]) for claim in marker.args
    ]


def _statement(docstring: str | None, evidence: str, test: str) -> str:
    """The first line of the docstring; for a RESTRICTED claim also the hypothesis after "Needed:"."""
    first, _, rest = (docstring or "").strip().partition("\n")
    if evidence != RESTRICTED:
        return first
    needed = " ".join(rest.partition(NEEDED)[2].split("\n\n")[0].split())
    if not needed:
        raise pytest.UsageError(f"{test} is RESTRICTED, so its docstring has to say what is {NEEDED!r}")
    return f"{first} {NEEDED} {needed}"


@pytest.fixture
def publish(request: pytest.FixtureRequest) -> Any:
    """Return publish(id, text, value), which records the proved exact value of the test's claim for values.json.

    Its digits are computed from the value; the file is written only if every proof of the whole run passes.
    """
    marker = request.node.get_closest_marker("claim")
    (claim,), evidence = marker.args, marker.kwargs["evidence"]
    return lambda *value: request.node.user_properties.append((PUBLISHED, published(claim, evidence, *value)))


@pytest.fixture
def values_so_far(pytestconfig: pytest.Config) -> list[dict[str, Any]]:
    """The values that this process has published until now."""
    return pytestconfig.stash[_LEDGER].published


@pytest.hookimpl(wrapper=True)
def pytest_runtest_protocol(item: pytest.Item) -> Iterator[Any]:
    """Show the seconds of a long proof at a terminal, after the dots of its file."""
    terminal: Any = item.config.get_terminal_writer()
    with working("", terminal._file):  # captured output does not reach the terminal
        return (yield)


@pytest.hookimpl(wrapper=True)
def pytest_runtest_call(item: pytest.Item) -> Iterator[Any]:
    """Fail a proof that reads a fact by name, of a claim that is to be proved: it would hold for a wrong fact, too."""
    marker = item.get_closest_marker("claim")
    with pytest.MonkeyPatch.context() as during:
        for kind in FACTS_BY_NAME if marker and marker.kwargs["evidence"] in BY_DERIVATION else ():
            during.setattr(kind, "__getattribute__", _refused)
        return (yield)


def _refused(facts: Any, name: str) -> Any:
    if name.startswith("_") or not isinstance(getattr(type(facts), name, None), cached_property):
        return object.__getattribute__(facts, name)
    pytest.fail(
        f"reads the fact {name!r}, and no fact is evidence for itself: derive it from the method, with what "
        "proofs/setting.py has; a test below tests/symbolic/ can compare the fact with that",
        pytrace=False,
    )


def pytest_sessionfinish(session: pytest.Session) -> None:
    if hasattr(session.config, "workeroutput"):  # a worker of pytest-xdist: the controller collects nothing itself
        ledger = session.config.stash[_LEDGER]
        session.config.workeroutput["ledger"] = {
            "tests": sorted(ledger.tests),
            "entries": [dataclasses.asdict(entry) for entry in ledger.entries.values()],
        }


class _Controller:
    """Collects reports from this process or, under pytest-xdist, from all workers."""

    def __init__(self, ledger: Ledger) -> None:
        self.ledger = ledger

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        if report.when == "call" or report.outcome != "passed":
            self.ledger.record(report.nodeid, report.outcome)
        if report.when == "call" and report.passed:
            self.ledger.published += [value for name, value in report.user_properties if name == PUBLISHED]

    @pytest.hookimpl(optionalhook=True)
    def pytest_testnodedown(self, node: Any) -> None:
        sent = getattr(node, "workeroutput", {}).get("ledger")
        if sent:
            self.ledger.add(sent["tests"], [Entry(**entry) for entry in sent["entries"]])

    @pytest.hookimpl(trylast=True)
    def pytest_sessionfinish(self, session: pytest.Session) -> None:
        """Fail a run of all files that leaves a claim without a proof."""
        collected = {Path(test.partition("::")[0]).name for test in self.ledger.tests}
        if session.exitstatus == 0 and self.ledger.missing and FILES <= collected:
            session.exitstatus = pytest.ExitCode.TESTS_FAILED

    def pytest_terminal_summary(self, terminalreporter: Any, exitstatus: int) -> None:
        if not self.ledger.entries:
            return
        width = terminalreporter._tw.fullwidth
        terminalreporter.section("ledger")
        terminalreporter.write_line(self.ledger.text(width))
        terminalreporter.write_line(_publish(self.ledger, exitstatus))


@pytest.hookimpl(trylast=True)
def pytest_sessionstart(session: pytest.Session) -> None:
    if not hasattr(session.config, "workerinput"):
        session.config.pluginmanager.register(_Controller(session.config.stash[_LEDGER]), "driftproof-ledger")


def _publish(ledger: Ledger, exitstatus: int) -> str:
    """Write values.json and ledger.md if every proof passed; return one line that says what was done."""
    if exitstatus != 0 or not ledger.complete:
        return f"{VALUES_FILE.name} not written: only a whole run in which every proof passes may publish"
    before = VALUES_FILE.read_text(encoding="utf-8") if VALUES_FILE.exists() else "{}"
    changed = [path.name for path, text in _files(ledger) if _write_if_changed(path, text)]
    if not changed:
        return f"{VALUES_FILE.name} and {LEDGER_FILE.name} are up to date"
    return "\n".join([f"wrote {' and '.join(changed)}, which differed from what is proved", *_differences(before)])


def _differences(before: str) -> list[str]:
    """A line for each value that the file had otherwise, or had not, or that is gone."""
    old, new = (json.loads(text).get("values", {}) for text in (before, VALUES_FILE.read_text(encoding="utf-8")))
    return [f"  {change.id}: {change}" for change in changes({"values": old}, {"values": new})]


def _files(ledger: Ledger) -> list[tuple[Path, str]]:
    return [(VALUES_FILE, ledger.values()), (LEDGER_FILE, ledger.markdown())]


def _write_if_changed(path: Path, text: str) -> bool:
    if path.exists() and path.read_text(encoding="utf-8") == text:
        return False
    with atomic_write(path) as draft:
        Path(draft).write_text(text, encoding="utf-8")
    return True
