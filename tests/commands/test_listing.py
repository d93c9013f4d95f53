"""Every command has its module, its own words, and names that are not taken twice."""

import pytest

from driftproof.commands.listing import ALIASES, COMMANDS, command_named


def test_every_name_leads_to_a_command():
    assert all(command_named(name).answer.__name__ == f"{name.replace('-', '_')}_command" for name in COMMANDS)
    assert not ALIASES.keys() & COMMANDS.keys()
    assert all(words[0] in COMMANDS for words in ALIASES.values())
    with pytest.raises(ValueError, match="unknown command 'fact'; did you mean facts"):
        command_named("fact")
