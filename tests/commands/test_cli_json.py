"""JSON of every command that has it: canonical, and the same bytes in every process."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

Answer = Callable[..., str]

JSON_COMMANDS = [
    ("step", "symplectic_euler", "--h", "0.5", "--state", "0,1"),
    ("run", "rk4", "--h", "0.01", "--t", "100", "--state", "0,1"),
    ("scene", "stability_boundary"),
]


@pytest.mark.parametrize("command", JSON_COMMANDS, ids=lambda command: command[0])
def test_json_is_canonical_and_byte_stable(command: tuple[str, ...], answer: Answer) -> None:
    first = answer(*command, "--format", "json")
    assert first == answer(*command, "--format", "json")
    assert first == json.dumps(json.loads(first), indent=1, sort_keys=True, ensure_ascii=False) + "\n"


def test_same_bytes_come_from_processes_with_other_hash_seeds() -> None:
    command = [sys.executable, "-m", "driftproof", *JSON_COMMANDS[1], "--format", "json"]
    root = Path(__file__).parents[2]
    outputs = {
        subprocess.run(
            command, cwd=root, env={"PYTHONHASHSEED": seed}, capture_output=True, check=True, timeout=60
        ).stdout
        for seed in ("0", "1")
    }
    assert len(outputs) == 1
