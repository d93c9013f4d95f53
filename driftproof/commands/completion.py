"""`driftproof completion`: scripts that let bash, zsh and fish complete commands, options, their choices and names."""

from __future__ import annotations

from argparse import Namespace
from collections.abc import Iterator, Sequence
from itertools import chain

from driftproof.commands import arguments as cli
from driftproof.commands.listing import COMMANDS, command_named

SHELLS = ("bash", "zsh", "fish")
_BASH = """\
_driftproof() {{
  local words last="${{COMP_WORDS[COMP_CWORD]}}" before=""
  case "$COMP_CWORD ${{COMP_WORDS[1]}} ${{COMP_WORDS[COMP_CWORD-1]}}" in
    "1 "*) words="{commands}" ;;
{cases}
  esac
  if [[ $last == *,* ]]; then before="${{last%,*}},"; fi
  COMPREPLY=($(compgen -P "$before" -W "$words" -- "${{last##*,}}"))
}}
complete -o default -F _driftproof driftproof"""


@cli.command(cli.option("shell", "the shell that you use", choices=SHELLS))
def completion_command(options: Namespace) -> str:
    """Print a script that completes commands, options, their choices, and names of methods, problems and scenes.

    examples:
      driftproof completion bash      put it into ~/.local/share/bash-completion/completions/driftproof
      driftproof completion zsh       in ~/.zshrc: source <(driftproof completion zsh)
      driftproof completion fish      put it into ~/.config/fish/completions/driftproof.fish
    """
    completed = {name: dict(_completed(name)) for name in COMMANDS}
    if options.shell == "fish":
        return "\n".join(chain(_fish("__fish_use_subcommand", tuple(COMMANDS)), *map(_fish_command, completed.items())))
    cases = []
    for name, words in completed.items():
        cases += [f'    *" {name} {option}") words="{" ".join(found)}" ;;' for option, found in words.items() if option]
        cases.append(f'    *" {name} "*) words="{" ".join(words[""])}" ;;')
    script = _BASH.format(commands=" ".join(COMMANDS), cases="\n".join(cases))
    return f"autoload -U bashcompinit && bashcompinit\n{script}" if options.shell == "zsh" else script


def _completed(name: str) -> Iterator[tuple[str, Sequence[str]]]:
    """Pairs of an option and the words that may follow it; "" comes with the command's options and own arguments."""
    actions, own = command_named(name).parser("")._actions, list[str]()
    names = _names(name)
    for action in actions:
        known = [str(choice) for choice in action.choices or names.get(action.dest, ())]
        own += action.option_strings or known
        if known:
            yield from ((option, known) for option in action.option_strings)
    yield "", own


def _names(command: str) -> dict[str, Sequence[str]]:
    """The names that each option or argument of a command takes, by its own name."""
    from driftproof.methods.catalogue import FURTHER_METHODS, METHODS
    from driftproof.numeric.problems.catalogue import PROBLEMS
    from driftproof.numeric.scenes import PRESETS
    from driftproof.symbolic.facts import FACTS, ON_REQUEST

    return {
        **dict.fromkeys(("method", "methods"), (*METHODS, *FURTHER_METHODS)),
        **dict.fromkeys(("scene", "scenes", "name"), tuple(PRESETS)),
        "problem": tuple(PROBLEMS),
        "only": (*FACTS, *ON_REQUEST) if command == "facts" else (),
    }


def _fish_command(entry: tuple[str, dict[str, Sequence[str]]]) -> Iterator[str]:
    name, words = entry
    seen = f"__fish_seen_subcommand_from {name}"
    yield from _fish(seen, [word for word in words[""] if not word.startswith("-")])
    for option in (word for word in words[""] if word.startswith("--")):
        arguments = f" -xa '{' '.join(words[option])}'" if option in words else ""
        yield f"complete -c driftproof -n '{seen}' -l {option.removeprefix('--')}{arguments}"


def _fish(condition: str, words: Sequence[str]) -> Iterator[str]:
    if words:
        yield f"complete -c driftproof -n '{condition}' -a '{' '.join(words)}'"
