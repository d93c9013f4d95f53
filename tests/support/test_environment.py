"""What is installed is asked before work is done; the machine is described without its name."""

import platform
import re
import sys

import pytest

from driftproof.support.environment import (
    OWN_CODE_RUNS,
    imported_object,
    installed,
    machine_description,
    require_package,
    versions_of,
)


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


def test_a_package_below_src_is_not_found_and_is_said_to_be_there(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "src" / "our_kit").mkdir(parents=True)
    with pytest.raises(ValueError, match="it is in src: pip install"):
        imported_object("our_kit.steps:rk4", "stepper")


NO_NAMES = {
    "mine.py:step": "names a file; write mine:step$",
    "codes/own.py:step": "names a file; write codes.own:step$",
    "codes.own.step": "names no stepper; write package.module:function, perhaps codes.own:step$",
    "mine/rk4.toml": "is a table, and no .*; `driftproof facts mine/rk4.toml` tells what",
    "step": "names no stepper; write package.module:function$",
    "a-b.c": "names no stepper; write package.module:function$",
    "a:b c": "names no stepper; write package.module:function$",
    "no_such_module_of_ours:f": "cannot be imported: ModuleNotFoundError: ",
    "math:nothing": "cannot be imported: AttributeError: ",
}


@pytest.mark.parametrize("named", NO_NAMES)
def test_what_names_no_object_is_told_how_to_write_it(named):
    with pytest.raises(ValueError, match=NO_NAMES[named]):
        imported_object(named, "stepper")


def test_object_is_imported_from_the_current_directory_unless_code_is_forbidden(tmp_path, monkeypatch):
    (tmp_path / "module_of_a_user.py").write_text("class A:\n    number = 7")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", [*sys.path])
    before = OWN_CODE_RUNS.set(False)
    try:
        with pytest.raises(ValueError, match=r"^thing 'module_of_a_user:A' is Python code, which templates"):
            imported_object("module_of_a_user:A", "thing")
    finally:
        OWN_CODE_RUNS.reset(before)
    assert "module_of_a_user" not in sys.modules
    assert imported_object("module_of_a_user:A.number", "number") == 7
