"""The environment: which packages are installed, in which versions, and on what machine times are measured."""

from __future__ import annotations

import os
import platform
import re
import sys
from collections.abc import Iterable
from contextvars import ContextVar
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import Any

# False where a user's modules must not be imported: while a template is rendered.
OWN_CODE_RUNS: ContextVar[bool] = ContextVar("OWN_CODE_RUNS", default=True)


def installed(package: str) -> bool:
    """True if the package can be imported."""
    return find_spec(package) is not None


def how_to_install(extra: str) -> str:
    """The command that installs an extra of driftproof."""
    return f"pip install 'driftproof[{extra}]'"


def require_package(package: str, extra: str, need: str) -> None:
    """Raise ValueError if the package is missing, before any work is done; the message is `need` and how to install."""
    if not installed(package):
        raise ValueError(f"{need}; install it with {how_to_install(extra)}")


def imported_object(named: str, what: str) -> Any:
    """The object that `package.module:name` names, also found from the current directory.

    Raises ValueError, with a message of one line, for a text of another form, for what cannot be imported, and where
    OWN_CODE_RUNS is false.
    """
    if not OWN_CODE_RUNS.get():
        raise ValueError(f"{what} {named!r} is Python code, which templates do not run")
    module, colon, path = named.partition(":")
    if module.endswith(".py") and colon:
        raise ValueError(f"{named!r} names a file; write {module[:-3].replace('/', '.').strip('.')}:{path}")
    if not (colon and all(part.isidentifier() for part in (*module.split("."), *path.split(".")))):
        dotted = re.fullmatch(r"([^\W\d][\w.]*)\.(\w+)", named)
        if named.endswith(".toml"):
            facts = f"`driftproof facts {named}` tells what a method in a file is"
            raise ValueError(f"{named!r} is a table, and no {what}, which is code, package.module:function; {facts}")
        example = f", perhaps {dotted[1]}:{dotted[2]}" if dotted else ""
        raise ValueError(f"{named!r} names no {what}; write package.module:function{example}")
    if os.getcwd() not in sys.path:  # and it stays there: what is imported may import its neighbours when it is called
        sys.path.insert(0, os.getcwd())
    try:
        found: Any = import_module(module)
        for part in path.split("."):
            found = getattr(found, part)
    except Exception as error:  # the import of a foreign module may raise anything
        missing = isinstance(error, ModuleNotFoundError) and Path("src", str(error.name).split(".")[0]).exists()
        hint = "; it is in src: pip install -e ., or set PYTHONPATH=src" if missing else ""
        raise ValueError(f"{named} cannot be imported: {type(error).__name__}: {error}{hint}") from error
    return found


def machine_description() -> str:
    """The processor and the operating system in one line, without the name of the machine or a path on it."""
    cpuinfo = Path("/proc/cpuinfo")
    lines = cpuinfo.read_text(encoding="utf-8").splitlines() if cpuinfo.exists() else []
    models = (line.partition(":")[2].strip() for line in lines if line.startswith("model name"))
    model = next(models, "") or platform.processor() or platform.machine()
    return f"{model}, {os.cpu_count()} processors, {platform.system()} {platform.machine()}"


def versions_of(packages: Iterable[str]) -> dict[str, str]:
    """The versions of Python and of the packages, "not installed" for a missing one."""
    from importlib.metadata import PackageNotFoundError, version

    found = {"python": f"{platform.python_implementation()} {platform.python_version()}"}
    for name in packages:
        try:
            found[name] = version(name)
        except PackageNotFoundError:
            found[name] = "not installed"
    return found
