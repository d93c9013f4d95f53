"""`driftproof render`: a text from its template, with values where the template asks for them."""

from __future__ import annotations

import argparse
from pathlib import Path

from driftproof.commands.arguments import Commands, Refuted, add_output
from driftproof.texts.questions.style import ROUNDINGS

SUFFIX = ".j2"

EXAMPLES = """\
examples:
  driftproof render lesson.md.j2
  driftproof render lesson.md.j2 -o lesson.html
  driftproof render lesson.md.j2 --check          is lesson.md what it renders? else a diff, and status 1

The name of the output says what it is: Markdown (.md, .markdown, .myst), HTML (.html, .htm) or TeX (.tex). In the
template, value("...") takes an id of `driftproof values` or a question of `driftproof value`, and | digits(6),
| places(3), | exact, | tex or | mathml say how it is written. docs/texts.md teaches the rest.

lesson.md.j2:
  q = {{ value("rk4.first_step.q") | digits(6) }}, which is {{ value("step rk4 h=1/2 : q") }}.
  {{ methods_table(["forward_euler", "rk4"], ["state_error digits 4", "evaluations"], h="1/4", t="10") }}
"""


def add(commands: Commands) -> None:
    """Describe the command."""
    parser = commands.add_parser(
        "render",
        help="a text from its template, with proved values in it",
        description="Render a Jinja2 template, in a sandbox, with proved values and tables of methods in it. Needs the"
        " extra: pip install 'driftproof[text]'.",
        epilog=EXAMPLES,
    )
    parser.add_argument(
        "templates", nargs="+", type=Path, metavar="TEMPLATE", help="a text with {{ value(...) }} in it"
    )
    add_output(parser, "default: the template's name without .j2")
    parser.add_argument("--check", action="store_true", help="write nothing; fail with a diff if the output is another")
    parser.add_argument(
        "--style", choices=("plain", "printed"), help="-3.3e-4 or −3.3×10⁻⁴ (default plain, in TeX printed)"
    )
    parser.add_argument("--rounding", choices=ROUNDINGS, help="what a tie becomes (default: a tie is an error)")
    parser.set_defaults(answer=answer)


def answer(options: argparse.Namespace) -> str:
    """One line for each output, or, with --check, the differences. Raises Refuted if there are any."""
    from driftproof.support.files import whole
    from driftproof.texts.templates.rendering import difference, render

    outputs = _outputs(options.templates, options.output)
    rendered = {out: render(template, out, options.style, options.rounding) for out, template in outputs.items()}
    if options.check:
        diffs = [difference(out, rendered[out].text, template) for out, template in outputs.items()]
        if any(diffs):
            raise Refuted("\n".join(filter(None, diffs)))
        return "\n".join(f"{out} is what {template} renders" for out, template in outputs.items())
    for out, found in rendered.items():
        with whole(out) as draft:
            Path(draft).write_bytes(found.text.encode("utf-8"))
    return "\n".join(f"{out}: {found.asked} values" for out, found in rendered.items())


def _outputs(templates: list[Path], output: Path | None) -> dict[Path, Path]:
    """Output -> template. Raises ValueError where two have one output, or a template would be overwritten."""
    from driftproof.texts.templates.kinds import kind_of

    if output is not None and len(templates) > 1:
        raise ValueError("--output names one file, and there are several templates; render them one by one")
    found: dict[Path, Path] = {}
    for template in templates:
        if output is None and template.suffix != SUFFIX:
            raise ValueError(f"{template}: the name does not end in {SUFFIX}; name the output with -o")
        out = output or template.with_suffix("")
        kind_of(out)
        if out in found or out.resolve() in {path.resolve() for path in templates}:
            raise ValueError(f"{out} is already a template or an output here; name another with -o")
        found[out] = template
    return found
