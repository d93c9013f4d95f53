"""The environment: which packages are installed, in which versions, and on what machine times are measured."""

from __future__ import annotations

import os
import platform
from collections.abc import Iterable
from importlib.util import find_spec
from pathlib import Path


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
