"""`driftproof value` and `diff`: numbers for a text, computed or published, and compared with older ones."""

from __future__ import annotations

from argparse import Namespace
from pathlib import Path

from driftproof.commands import arguments as cli

# The formats of one answer, and those that are only for a table of published values.
OF_ONE, OF_SEVERAL = ("text", "json", "tex", "mathml", "md"), ("js",)
FORM = ("digits", "places", "rounding", "style")


@cli.command(
    cli.option("question", "the question, in quotes; see below", nargs="?"),
    cli.one_of(
        cli.digits_option("significant digits", metavar="N"), cli.places_option("digits after the point", metavar="N")
    ),
    cli.rounding_option("how to round (default half-even, but a tie is refused)"),
    cli.option("--style", "plain: -6.7e-5 (the default); printed: −6.7×10⁻⁵", choices=("plain", "printed")),
    cli.option("--format", "js needs --only; text, mathml a question", choices=(*OF_ONE, *OF_SEVERAL)),
    cli.flag("--list", "list what can be asked"),
    cli.option("--only", "print the published values whose ids match, such as 'rk4.*'", metavar="PATTERN"),
)
def value_command(options: Namespace) -> str:
    r"""Answer one question exactly, and print the number as a text needs it: in digits, rounding and style.

    what can be asked, with [optional parts] and any of a|b:
      ID                                                       a published value; --only '*' lists them
      step METHOD h=1/2 [N=3] [from q,v] : READOUT             q v energy energy_change state_error phase_error
      run METHOD h=1/4 t=10 [from q,v] : READOUT               exact.q exact.v steps evaluations h t k1.q k1.v ...
      exact t=10 [from q,v] : q|v|energy                       the solution itself
      run METHOD problem=NAME h=1/4 1000 steps : READOUT       y0 exact.y0 slope.y0 k1.y0 ... state_error relative_error
      run METHOD rates=(t*sqrt(y0)) from 1 h=1/4 t=1 : READOUT largest_error steps; of a problem, a .toml, your own y'
      run METHOD y'=-2*y y(0)=1 h=1/4 t=1 : READOUT            or x''=-k*x, x(0)=2, x'(0)=0, k=3: x x' exact.x error.x
      run METHOD lambda=-2 h=1/4 t=1 : READOUT                 the same of y' = lambda y, y(0) = 1
      run AB2 started=rk4 y'=-y y(0)=1 h=1/4 t=1 : READOUT     a multistep method; its first values, or started=exact
      FACT METHOD [at VALUE] [h=1/4] [: PART]                  order, energy_multiplier, imaginary_limit, a_stable, ...
      + - * / ** ( ) pi e abs sqrt exp ln log2 log10 cos sin   of all of these; ratio(a, b) = |a|/|b|, percent, power
    METHOD is a key, a .toml file or what people call it: Heun, velocity Verlet. "error of Heun with h=0.1 at t=1 on
    y'=-y, y(0)=1", "local error of", "amplification factor of RK4 at z=-2" are understood, and error for state_error.
    Errors on problems have no sign, nor has error.x; (run ... : x) - (run ... : exact.x) has one.
    Give two of h, t and N (or steps) for a run. The default start is 1,0. phase_error may end in deg, rad or turns.

    examples:
      driftproof value rk4.first_step.q --digits 6
      driftproof value 'run symplectic_euler h=1/4 t=10 : phase_error deg' --places 3 --style printed
      driftproof value 'energy_multiplier rk4' --format tex
      driftproof value 'one_step_matrix rk4 h=1/2 : M_qq'
      driftproof value 'ratio(run rk4 h=1/2 t=10 : state_error, run rk4 h=1/4 t=10 : state_error)' --digits 3
      driftproof value "error of Heun with h=0.1 at t=1 on y'=-y, y(0)=1" --digits 3
      driftproof value 'order sdirk_order_2 at (1/2 + sqrt(3)/6)'
      driftproof value --list                          every head, readout, fact, function and id
      driftproof value --only 'rk4.*' --format md      what the lesson prints, by id, as last proved
      driftproof value --only '*' --format js          a module for web pages: save it as driftproof.mjs
      driftproof value --only '*' --format tex         definitions for \driftproof{id}: save it as values.tex

    With --digits or --places only the number is printed, ready for a text. A tie is refused unless --rounding is given;
    away rounds bounds. --list shows the whole language.
    """
    from dataclasses import replace

    from driftproof.texts.questions.decimals import PLAIN, PRINTED
    from driftproof.texts.questions.errors import QUESTION_SECONDS, time_limit
    from driftproof.texts.questions.evaluate import value, vocabulary

    if options.question is not None and (options.list or options.only is not None):
        raise ValueError("a question cannot be combined with --list or --only")
    if options.list:
        cli.refuse(options, ("only", "format", *FORM), "with --list")
        return vocabulary()
    if options.only is not None:
        return _published(options)
    if options.question is None:
        raise ValueError("give a question in quotes, --only PATTERN or --list")
    if options.format in OF_SEVERAL:
        raise ValueError(f"--format {options.format} needs --only PATTERN")
    style = replace(PRINTED if options.style == "printed" else PLAIN, rounding=options.rounding)
    with time_limit(options.question, QUESTION_SECONDS):
        found = value(options.question)
        return found.written(options.format or "text", digits=options.digits, places=options.places, style=style)


def _published(options: Namespace) -> str:
    from driftproof.texts.values.published import VALUE_FORMATS, published_values

    form = options.format or "json"
    cli.refuse(options, FORM, "with --only, which prints the published values as they are")
    if form not in VALUE_FORMATS:
        raise ValueError(f"--format {form} takes one question; with --only, choose from {', '.join(VALUE_FORMATS)}")
    return VALUE_FORMATS[form](published_values(options.only))


@cli.command(
    cli.option("old", "values printed before, as JSON", type=Path),
    cli.option("new", "values printed now", type=Path),
    cli.format_option("text json"),
)
def diff_command(options: Namespace) -> str:
    """Compare two files of values: which changed in value, which only in digits or wording, which are new or gone.

    examples:
      driftproof diff old.json new.json

    old.json and new.json are outputs of `driftproof value --only '*'`, or of `driftproof value`, `facts`, `step` or
    `run` with --format json. A number changed in value if its exact forms differ, or if its decimals cannot be
    roundings of the same number; it changed only in digits if more or fewer are shown.
    exit status: 0 if no value changed, 1 if one did, 2 if a file cannot be read.
    """
    from driftproof.texts.values.changes import diff

    found = diff(options.old, options.new)
    if not found.same:
        raise cli.Refuted(found.written(options.format))
    return found.written(options.format)
