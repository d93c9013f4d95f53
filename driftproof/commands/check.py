"""`driftproof check`: whether the numbers of a text are what its claims say, and which numbers no claim covers."""

from __future__ import annotations

import argparse

from driftproof.commands.arguments import Commands, Refuted, positive_number

EXAMPLES = """\
examples:
  driftproof check chapter.md --init                     claims drafted from the text, to be read and completed
  driftproof check chapter.md --claims claims.toml
  driftproof check chapter.md --claims claims.toml --coverage
  driftproof check chapter.md --claims claims.toml --run --format github

A phrase stands as the text does, but for minus signs, kinds of space, ends of lines and raised or lowered digits, and
never inside a longer word or number. A value is an id or a question, which `driftproof value --help` teaches.

Read are plain text, Markdown, HTML, TeX and notebooks, by the file's ending: markup, comments, front matter and
attributes are left out. Numbers are integers, decimals, fractions, percentages, powers and what has an exponent; words
for numbers are not read. Labels by themselves are whole numbers after a letter (RK4), indices (q₁), what follows
Section, Figure and the like, versions, dates, numbers of items, [1], addresses and formats such as :.6f.

--run runs the Python listings of the text, in order, in one process without a shell, within the time limit and 2 GiB,
and compares what each prints with the block that follows it, or with the lines under "Expected output:". This executes
the code of the text with your rights: use it on texts that you trust.

exit status: 0 if every claim holds, 1 if one does not, 2 if the claims or the text make no sense.

claims.toml:
  [text]
  coverage = "95%"                              # with fewer numbers covered the check fails; format = "tex" is possible
  [[claim]]
  id = "rk4 state"
  phrase = "the state is ({q}, {v}) after"      # stands once, or as often as count says
  values = { q = "rk4.first_step.q", v = "step rk4 h=1/2 : v" }
  exact = true                                  # or places = 6, or digits = 2; with none of them the number in full
  [[claim]]
  id = "error at ten"
  phrase = "off by {value} at the end"
  value = "run rk4 h=1/4 t=10 : state_error"
  digits = 2                                    # 3.3e-4, 0.00033 and 3.3×10⁻⁴ are the same
  [[claim]]
  id = "steps"
  phrase = "takes {steps} steps of h = 0.25"
  values = { steps = "run rk4 h=1/4 t=10 : steps" }
  given = "our choice of h"                     # why a number of the phrase is no value; true will do
  [[label]]
  phrase = "{n} min read"                       # numbers that belong to names are not counted
  why = "reading time"
"""


def add(commands: Commands) -> None:
    """Describe the command."""
    parser = commands.add_parser(
        "check",
        help="whether the numbers of a text are right, and which nobody claims",
        description=(
            "Hold a text to a file of claims: each phrase, with its values worked out and rounded here, has to stand\n"
            "in the text exactly as often as it says. Reports line, column, expected and found, and the coverage."
        ),
        epilog=EXAMPLES,
    )
    parser.add_argument("text", help="a text: .txt, .md, .html, .tex, .ipynb; anything else is read as plain text")
    how = parser.add_mutually_exclusive_group(required=True)
    how.add_argument("--claims", metavar="FILE", help="the claims, in TOML")
    how.add_argument("--init", action="store_true", help="draft the claims from the text instead")
    parser.add_argument("--coverage", action="store_true", help="list the numbers no claim covers, with suggestions")
    parser.add_argument("--run", action="store_true", help="run the Python listings and compare what they print")
    parser.add_argument(
        "--time-limit", type=positive_number("time limit"), default=10.0, help="seconds for --run (default 10)"
    )
    parser.add_argument("--format", choices=("text", "json", "github"), default="text", help="json is canonical")
    parser.set_defaults(answer=answer)


def answer(options: argparse.Namespace) -> str:
    """The report in the format asked for, or drafted claims. Raises Refuted with the report where a claim fails."""
    from driftproof.texts.claims.claims import Claims, read_claims
    from driftproof.texts.claims.drafting import draft
    from driftproof.texts.claims.report import Report
    from driftproof.texts.claims.running import run_listings
    from driftproof.texts.readers.document import read_document

    if options.init and (options.run or options.coverage or options.format != "text"):
        raise ValueError("--init drafts claims; --run, --coverage and --format need --claims")
    claims = Claims() if options.init else read_claims(options.claims)
    document = read_document(options.text, claims.form)
    if options.init:
        return draft(document, options.text)
    ran = run_listings(document, options.time_limit) if options.run else None
    report = Report.of(options.text, document, claims, ran, options.coverage)
    if not report.passed:
        raise Refuted(report.written(options.format))
    return report.written(options.format)
