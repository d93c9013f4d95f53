"""The list of commands, with the module of each and a line of description, and their aliases."""

from __future__ import annotations

from driftproof import TYPE_CHECKING

if TYPE_CHECKING:
    from driftproof.commands.arguments import Command

# Command -> the module of driftproof.commands that has it, and its line in `driftproof --help`.
COMMANDS = {
    "methods": ("methods", "list the methods, and the families with a free parameter"),
    "facts": ("methods", "every exact fact of a method or of a family of methods"),
    "derive": ("methods", "derive facts on the oscillator line by line, as text or TeX"),
    "step": ("oscillator", "one step, exactly"),
    "run": ("oscillator", "a whole run, certified to any number of digits"),
    "roundoff": ("oscillator", "the rounding bound of one step, derived by running it"),
    "stability": ("problems", "which steps a method can take on a problem: proved, and observed"),
    "identify": ("steppers", "which method a float stepper really is; with --method, the same as verify"),
    "verify": ("steppers", "whether a float stepper is the method its name says, to roundoff"),
    "certify": ("certify", "the true error of a float trajectory, from any solver"),
    "scene": ("scenes", "run a scene in floats and show its readouts; or list the scenes"),
    "sweep": ("scenes", "run a scene at every point of a grid of steps, times, starts and methods"),
    "report": ("scenes", "write scenes as a page of HTML"),
    "work-precision": ("problems", "error against evaluations and against run time"),
    "value": ("values", "a number for a text, from a question in a small language; or the published ones"),
    "render": ("texts", "write a text from its template, with proved values"),
    "check": ("texts", "check the numbers of a text against its claims, and list those without one"),
    "diff": ("values", "what changed between two files of values: value, digits or wording"),
    "completion": ("completion", "a script that completes commands and options in bash, zsh or fish"),
}
# Alias -> the command, and arguments that are put before those given.
ALIASES = {"scenes": ("scene",), "values": ("value", "--only", "*")}


def command_named(name: str) -> Command:
    """Import and return the command. Raises ValueError, with the names nearest to it, for one that does not exist."""
    from importlib import import_module

    from driftproof.support.plain_text import did_you_mean

    if not name or name.startswith("-"):
        wrong = f"unrecognized arguments: {name}" if name else "the following arguments are required: COMMAND"
        raise ValueError(f"{wrong} (`driftproof --help` shows how)")
    if name not in COMMANDS:
        raise ValueError(f"unknown command {name[:60]!r}{did_you_mean(name, COMMANDS)} (`driftproof --help` lists all)")
    module = import_module(f"driftproof.commands.{COMMANDS[name][0]}")
    command: Command = getattr(module, f"{name.replace('-', '_')}_command")
    return command
