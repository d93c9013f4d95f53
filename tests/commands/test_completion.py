"""Completion in a real shell: commands, their options, choices, and names of methods."""

import re
import shutil
import subprocess
from pathlib import Path

import pytest

from driftproof.commands.listing import COMMANDS
from tests.looping import exactly, some

# Words before the cursor, and what bash then offers.
OFFERED = {
    "fa": ["facts"], "facts --on": ["--only"], "facts rk3": ["rk38"], "facts rk4 --format t": ["text", "tex"],
    "verify mine:step --method velo": ["velocity_verlet"],
    "stability kepler_": ["kepler_eccentric", "kepler_extreme"],
    "scene com": ["compare"], "value --styl": ["--style"], "facts mine.tom": [],
    "stability kepler --methods rk4,heun2,velo": ["rk4,heun2,velocity_verlet"],
    "facts rk4 --only order,imagin": ["order,imaginary_limit", "order,imaginary_limit_within_digits"],
    "value --only imagin": [],
}  # fmt: skip
TOUR = (Path(__file__).parents[2] / "docs" / "tour.md").read_text(encoding="utf-8")
TOLD = re.findall(r"`driftproof ([^`]*)`\sinto\s`([^`]*)`", TOUR)
OFFERED |= {typed: [offered] for typed, offered in exactly(2, TOLD)}


@pytest.mark.parametrize("typed", OFFERED)
def test_bash_offers(typed, answer):
    words = ["driftproof", *typed.split(" ")]
    ask = f"COMP_WORDS=({' '.join(words)}); COMP_CWORD={len(words) - 1}; _driftproof; printf '%s\\n' ${{COMPREPLY[@]}}"
    script = f"{answer('completion', 'bash')}\n{ask}"
    done = subprocess.run(["bash", "-c", script], capture_output=True, text=True, timeout=60, check=True)
    assert done.stdout.split() == OFFERED[typed]


def test_other_shells_know_every_command(answer):
    assert answer("completion", "zsh") == f"autoload -U bashcompinit && bashcompinit\n{answer('completion', 'bash')}"
    fish = answer("completion", "fish")
    assert f"-n '__fish_use_subcommand' -a '{' '.join(COMMANDS)}'\n" in fish
    assert all(f"__fish_seen_subcommand_from {name}'" in fish for name in some(COMMANDS, 15))
    assert "-n '__fish_seen_subcommand_from facts' -l format -xa 'text json tex'" in fish
    assert "-n '__fish_seen_subcommand_from completion' -a 'bash zsh fish'" in fish


@pytest.mark.parametrize("shell", ["fish", "zsh"])
def test_script_is_read_where_the_shell_is_here(shell, answer, tmp_path):
    if shutil.which(shell) is None:
        pytest.skip(f"no {shell} here")
    path = tmp_path / "script"
    path.write_text(answer("completion", shell))
    subprocess.run([shell, "-n", str(path)], check=True, timeout=60)
