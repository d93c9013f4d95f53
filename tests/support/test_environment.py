"""What is installed is asked before work is done; the machine is described without its name."""

import platform
import re
import sys

import pytest

from driftproof.support.environment import installed, machine_description, require_package, versions_of


def test_missing_package_says_what_to_install(monkeypatch):
    assert installed("json")
    require_package("json", "text", "templates need json")
    monkeypatch.setitem(sys.modules, "jinja2", None)
    with pytest.raises(ValueError, match=r"Jinja2; install it with pip install 'driftproof\[text\]'$"):
        require_package("jinja2", "text", "templates need Jinja2")


def test_description_names_processor_and_system_and_no_machine():
    words = machine_description()
    assert platform.system() in words
    assert re.match(r"\w.*, \d+ processors, ", words)
    assert platform.node() not in words


def test_versions_are_those_that_are_there():
    found = versions_of(["pytest", "no-such-package"])
    assert found["python"].endswith(platform.python_version())
    assert (found["pytest"], found["no-such-package"]) == (pytest.__version__, "not installed")
