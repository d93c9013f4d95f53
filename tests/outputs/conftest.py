"""What tests of this folder are given: the wheel, built once, and an environment that it is installed in."""

import os
import subprocess
import sys
import sysconfig
from pathlib import Path

import pytest

from tests.browser import started

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def chromium():
    with started() as browser:
        yield browser


@pytest.fixture(scope="session")
def wheel(tmp_path_factory):
    folder = tmp_path_factory.mktemp("wheel")
    command = [sys.executable, "-m", "build", "--wheel", "--no-isolation", "--outdir", str(folder), str(ROOT)]
    workflow = os.environ | {"GITHUB_REPOSITORY": "people/driftproof", "GITHUB_SERVER_URL": "https://example.org"}
    subprocess.run(command, check=True, capture_output=True, timeout=120, env=workflow)
    (built,) = folder.glob("*.whl")
    return built


@pytest.fixture(scope="session")
def installed(wheel, tmp_path_factory):
    """The interpreter of an environment with the wheel, and with what it needs from ours; not with the checkout."""
    home = tmp_path_factory.mktemp("environment")
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", str(home)], check=True, timeout=120)
    python = home / "bin" / "python"
    install = ["-m", "pip", "--python", str(python), "install", "--quiet", "--no-deps", "--no-index", str(wheel)]
    subprocess.run([sys.executable, *install], check=True, capture_output=True, timeout=120)
    version = f"python{sys.version_info.major}.{sys.version_info.minor}"
    # A path in a .pth file is a path only: the .pth file of the editable install in it is not read.
    needs = home / "lib" / version / "site-packages" / "dependencies.pth"
    needs.write_text(sysconfig.get_path("purelib") + "\n", encoding="utf-8")
    return python
