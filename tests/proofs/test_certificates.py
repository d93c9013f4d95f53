"""The certificates for Coq are written the same by every process."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from proofs.kernel.certificates import ORDER, source

# Generates all files again, in another process with another hash seed.
WRITE = "from proofs.kernel.certificates import ORDER, source; print(*map(source, ORDER), sep='', end='')"


@pytest.mark.slow
def test_files_are_written_byte_for_byte_alike() -> None:
    """Another process generates the same bytes."""
    command = [sys.executable, "-c", WRITE]
    root = Path(__file__).parents[2]
    again = subprocess.run(command, cwd=root, env={"PYTHONHASHSEED": "7"}, capture_output=True, check=True).stdout
    assert again.decode() == "".join(map(source, ORDER))
