"""The list of commands, with the module of each and a line of description, and their aliases."""

from __future__ import annotations

from driftproof import TYPE_CHECKING

if TYPE_CHECKING:
    from driftproof.commands.arguments import Command

# Command -> the module of driftproof.commands that has it, and its line in `driftproof --help`.
COMMANDS = {
    "methods": ("methods", "list the methods, and the families with a free parameter"),
    "facts": ("methods", "every exact fact of a method or of a family of methods"),
    "derive": ("methods", "derive some facts on the oscillator line by line, as text or TeX"),
    "step": ("oscillator", "one exact step on the oscillator"),
    "run": ("oscillator", "a whole run on the oscillator, certified to any number of digits"),
    "roundoff": ("oscillator", "the rounding error bound of one step, derived from its program"),
    "stability": ("problems", "which step sizes a method can take on a problem: proved, or observed"),
    "identify": ("steppers", "which method a float stepper really is; with --method, like verify"),
    "verify": ("steppers", "whether a float stepper is the method that it should be, up to rounding"),
    "certify": ("certify", "the true error of a float trajectory, from any solver"),
    "scene": ("scenes", "run a scene in floats and show its readouts; without a name, list the scenes"),
    "sweep": ("scenes", "run a scene at every point of a grid of step sizes, times, starts and methods"),
    "report": ("scenes", "write scenes as a page of HTML"),
    "work-precision": ("problems", "error against evaluations and against run time"),
    "value": ("values", "a proved number for a text, from a question; with --only, the published values"),
    "render": ("texts", "write a text from its template, with proved values"),
    "check": ("texts", "check the numbers of a text against its claims, and list those without a claim"),
    "diff": ("values", "compare two files of values: what changed in value, digits or wording"),
    "completion": ("completion", "a script that completes commands and options in bash, zsh or fish"),
}
# Alias -> the command, and arguments that are put before those given.
ALIASES = {"scenes": ("scene",), "values": ("value", "--only", "*")}


def command_named(name: str) -> Command:
    """Import and return the command. Raises ValueError, with the names nearest to it, for one that does not exist."""
    from importlib import import_module

    from driftproof.support.plain_text import unknown

    if not name or name.startswith("-"):
        wrong = f"unknown option {name}" if name else "give a command"
        raise ValueError(f"{wrong} (`driftproof --help` lists the commands)")
    if name not in COMMANDS:
        raise ValueError(unknown("command", name, COMMANDS, "see `driftproof --help`"))
    module = import_module(f"driftproof.commands.{COMMANDS[name][0]}")
    command: Command = getattr(module, f"{name.replace('-', '_')}_command")
    return command
