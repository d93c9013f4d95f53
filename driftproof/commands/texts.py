"""`driftproof render` and `check`: a text rendered from its template, and a text checked against its claims."""

from __future__ import annotations

import sys
from argparse import Namespace
from pathlib import Path

from driftproof.commands import arguments as cli


@cli.command(
    cli.option("templates", "a text with {{ value(...) }} in it", nargs="+", type=Path, metavar="TEMPLATE"),
    cli.output_option("the output (default: the template's name without .j2)"),
    cli.flag("--check", "write nothing; exit with 1 and a diff if the output is out of date"),
    cli.option("--style", "-3.3e-4 or −3.3×10⁻⁴ (default plain, in TeX printed)", choices=("plain", "printed")),
    cli.rounding_option("how ties are rounded (default: a tie is an error)"),
)
def render_command(options: Namespace) -> str:
    """Render a Jinja2 template, in a sandbox, with proved values in it.
    Needs the extra: pip install 'driftproof[text]'.

    examples:
      driftproof render lesson.md.j2
      driftproof render lesson.md.j2 -o lesson.html
      driftproof render lesson.md.j2 --check          is lesson.md up to date? if not: a diff, and status 1

    The ending of the output decides its kind: Markdown (.md, .markdown, .myst), HTML (.html, .htm) or TeX (.tex). In
    the template, value("...") takes an id that `driftproof value --only '*'` lists or a question (`driftproof value
    --help`), and | digits(6), | places(3), | exact, | tex, | mathml say how it is written. Files that it names, such as
    mine.toml, are looked for beside the template first.

    lesson.md.j2:
      q = {{ value("rk4.first_step.q") | digits(6) }}, which is {{ value("step rk4 h=1/2 : q") }}.
    """
    from os.path import realpath  # unlike Path.resolve, it passes circular links on

    from driftproof.support.files import require_file
    from driftproof.texts.templates.rendering import output_of, render

    if options.output is not None and len(options.templates) > 1:
        raise ValueError("--output takes a single template; render several one by one")
    outputs, taken = [output_of(each, options.output) for each in options.templates], list[str]()
    for out in outputs:
        require_file(out)
        if realpath(out) in (*taken, *map(realpath, options.templates)):
            raise ValueError(f"{out} is one of the templates or outputs already; name another with -o")
        taken.append(realpath(out))
    rendered = [render(each, options.output, options.style, options.rounding) for each in options.templates]
    if options.check:
        if diffs := list(filter(None, (each.difference() for each in rendered))):
            raise cli.Refuted("\n".join(diffs))
        return "\n".join(f"{each.output} is up to date with {each.template}" for each in rendered)
    return "\n".join(each.write() for each in rendered)


@cli.command(
    cli.option(
        "text",
        "a text (.txt, .md, .rst, .html, .tex, .ipynb; others: plain text), or a folder of texts with claims",
        nargs="+",
        type=Path,
        metavar="TEXT",
    ),
    cli.one_of(
        cli.option("--claims", "the TOML file of the claims (default: TEXT.claims.toml)", metavar="FILE"),
        cli.flag("--init", "draft claims from the text instead of checking it"),
    ),
    cli.option("--ask", "with --init: a question whose value is somewhere in the text", action="append", default=[]),
    cli.flag("--coverage", "list the numbers that no claim covers, with suggestions"),
    cli.flag("--run", "run the Python listings of the text and compare what they print"),
    cli.time_limit_option("seconds for all listings of --run (default 10)"),
    cli.format_option("text json github"),
)
def check_command(options: Namespace) -> str:
    """Check a text against a file of claims: each phrase, with its values computed and rounded here, must occur
    in the text exactly as often as the claim says. Report line, column, expected and found text, and the coverage.

    examples:
      driftproof check chapter.md --init                     draft claims from the text, to be read and completed
      driftproof check chapter.md --init --ask 'run rk4 rates=(-y0) from 1 h=0.1 N={1..10} : {y0,state_error}'
      driftproof check chapter.md --claims claims.toml
      driftproof check book/                                  all texts in it that have a file of claims
      driftproof check chapter.md --claims claims.toml --coverage
      driftproof check chapter.md --claims claims.toml --run --format github

    A phrase is written as in the text; only minus signs, kinds of space, ends of lines and raised or lowered digits may
    differ. It never matches inside a longer word or number. A value is an id or a question: `driftproof value --help`.

    The file's ending decides whether it is read as plain text, Markdown, reStructuredText, HTML, TeX or a notebook;
    markup, comments, front matter and attributes are left out. Numbers are integers, decimals, fractions, percentages,
    powers and numbers with an exponent; words for numbers and growth are counted separately, and checked if a claim
    says spelled. Labels, which need no claim, are whole numbers after a letter (RK4), indices (q₁), numbers after
    Section, Figure and the like, versions, dates, numbers of items, [1], addresses, arguments as in y(1), and formats
    such as :.6f. MyST and macros of TeX are read as they are typeset.

    --init drafts claims for numbers that look like values that driftproof knows, or like those of the questions after
    --ask, where {a,b} stands for a and for b; a value is likelier if its choices stand near the number. A mere guess
    becomes a comment. If the text solves a problem of its own, name it:
    --ask "error of Heun with h={1/10,1/20} at t=1 on y'=-y, y(0)=1".

    --run runs the Python listings of the text, in order, in one process without a shell, within the time limit and
    2 GiB, and compares what each prints with the block that follows it, or with the lines under "Expected output:".
    This executes the code of the text with your rights: use it on texts that you trust.

    Files that a claim names, such as 'order mine.toml', are looked for beside the text, then beside the claims.

    exit status: 0 if every claim holds, 1 if one does not, 2 if the claims or the text cannot be read.

    claims.toml:
      [text]
      coverage = "95%"                              # fails if fewer numbers are covered; format = "tex" is possible
      [[claim]]
      id = "rk4 state"
      phrase = "the state is ({q}, {v}) after"      # must occur once, or as often as count says
      values = { q = "rk4.first_step.q", v = "step rk4 h=1/2 : v" }
      exact = true                                  # or places = 6, or digits = 2; without any, the number in full
      [[claim]]
      id = "error at ten"
      phrase = "off by {value} at the end"
      value = "run rk4 h=1/4 t=10 : state_error"
      digits = 2                                    # 3.3e-4, 0.00033 and 3.3×10⁻⁴ are the same
      [[claim]]
      id = "steps"
      phrase = "takes {steps} steps of h = 0.25"
      values = { steps = "run rk4 h=1/4 t=10 : steps" }
      given = "our choice of h"                     # why a number of the phrase is not computed; or just true
      [[claim]]
      id = "calls"
      phrase = "makes {value} calls"                # sixteen, a third; spelled = "trend": grows, shrinks, by the sign
      value = "stages rk4"
      spelled = "words"
      [[label]]
      phrase = "{n} min read"                       # numbers that belong to names are not counted
      why = "reading time"
    """
    from driftproof.reports.progress import with_progress
    from driftproof.support.plain_text import as_json
    from driftproof.texts.check import TextReport, UncheckedText, check, texts_with_claims
    from driftproof.texts.drafts.drafting import lines_to_look_at

    if not options.run:
        cli.refuse(options, ("time_limit",), "without --run")
    text, *others = options.text
    if (options.init or options.claims) and (others or text.is_dir()):
        raise ValueError("--init and --claims take one text; each of several texts has a claims file of its own")
    if options.init:
        if options.run or options.coverage or options.format != "text":
            raise ValueError("--run, --coverage and --format have no effect with --init")
        drafted = str(check(text, init=True, ask=options.ask))
        sys.stderr.writelines(lines_to_look_at(drafted, str(text)))
        return drafted
    texts = [text] if options.claims else [found for given in options.text for found in texts_with_claims(given)]
    asked = {name: getattr(options, name) for name in ("claims", "ask", "coverage", "run")}
    limit = {} if options.time_limit is None else {"time_limit": options.time_limit}
    reports: list[TextReport | UncheckedText] = []
    for each in with_progress(texts, "text"):
        try:
            reports.append(check(each, **asked, **limit))
        except ValueError as error:
            if len(texts) == 1:
                raise
            reports.append(UncheckedText(str(each), str(error)))
    written = "\n".join(report.written(options.format) for report in reports)
    if options.format == "json" and len(reports) > 1:
        written = as_json([report.as_dict() for report in reports])
    if any(isinstance(report, UncheckedText) for report in reports):
        raise cli.Unread(written)
    if not all(report.passed for report in reports):
        raise cli.Refuted(written)
    return written
