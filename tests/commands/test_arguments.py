"""What commands are made of: readers that take a value or complain in one line, options as data."""

from argparse import ArgumentTypeError
from fractions import Fraction as Q
from inspect import cleandoc

import pytest

from driftproof.commands import arguments as cli

digits = cli.integer_in(1, 10000, "digits")
MINUS = "\N{MINUS SIGN}"

READ = [
    (cli.exactly("t"), "0.1", Q(1, 10)), (cli.exactly("t"), f"{MINUS}1/4", Q(-1, 4)),
    (cli.nonzero_step, "-.25", Q(-1, 4)), (cli.initial_state, "-1/3, 2", (Q(-1, 3), Q(2))), (digits, "10000", 10000),
    (cli.integer_in(0, 9, "places"), "0", 0), (cli.positive_number("limit"), "1/4", 0.25),
    (cli.several(cli.nonzero_step), "1/4, 1/8", [Q(1, 4), Q(1, 8)]),
    (cli.read_by(Q), "1/3", Q(1, 3)),
]  # fmt: skip


@pytest.mark.parametrize(("reader", "text", "value"), READ, ids=range(len(READ)))
def test_value_is_read_exactly(reader, text, value):
    assert reader(text) == value


REFUSED = [
    (cli.exactly("t"), "1//2", "t: '1//2' is not a rational number; write an integer, a fraction like 1/4"),
    (cli.exactly("t"), "__import__('os').getpid()", "is not a rational number"),
    (cli.exactly("t"), "9" * 5000, "is too long; at most 1200 characters"),
    (cli.nonzero_step, "-0.0", "the step size h must not be 0"),
    (cli.initial_state, "1", "'1' is not a state; write position,velocity like 1,0"),
    (cli.initial_state, "1,x", "v: 'x' is not a rational number"),
    *((digits, text, f"{text!r} is not allowed") for text in ("0", "-3", "10001", "1.5")),
    (digits, "\u0663", "is not allowed: the number of digits"),
    (digits, "1" + "0" * 5000, "'10000000000000000000' is not allowed: the number of digits"),
    (cli.positive_number("limit"), "0", "'0' is not allowed: the limit must be a number above 0"),
    (cli.positive_number("limit"), "1e400", "'1e400' is too large for the limit"),
    (cli.several(cli.nonzero_step), "1/4,,1/8", "h: '' is not a rational number"),
]


@pytest.mark.parametrize(("reader", "text", "complaint"), REFUSED, ids=range(len(REFUSED)))
def test_what_cannot_be_read_is_complained_about_in_one_line(reader, text, complaint):
    with pytest.raises(ArgumentTypeError) as refused:
        reader(text)
    assert complaint in str(refused.value)
    assert "\n" not in str(refused.value)


def command_of(options):
    """Says what it does.

    Here and there:
      indented
    """
    return str(options)


PARSER = cli.Command(
    command_of,
    (
        cli.option("--format", choices=cli.names_in("driftproof.commands.arguments", "__all__"), default="a"),
        cli.list_option("--h", "steps", type=cli.several(cli.nonzero_step)),
        cli.one_of(cli.flag("--this", "this"), cli.flag("--that", "that")),
        cli.option("state", "a start", type=cli.initial_state, nargs="?"),
        cli.option("more", "a formula", nargs="?"),
    ),
)


@pytest.fixture
def parse(monkeypatch):
    monkeypatch.setattr(cli, "__all__", ["a", "b"], raising=False)
    return lambda *words: PARSER.parser("prog").parse_args(words)


def test_options_are_data(parse):
    assert vars(parse()) == {"format": "a", "h": [], "this": False, "that": False, "state": None, "more": None}
    found = parse("--format", "b", "--h", "1/4,1/8", "--that", "--h", "-1/2", "-1,.5")
    assert (found.format, found.h, found.that, found.state) == ("b", [Q(1, 4), Q(1, 8), Q(-1, 2)], True, (-1, Q(1, 2)))
    assert parse().h == []  # nothing is left of the call before
    formulas = ["-y0", "-y", "-y[0]", "-y0+1", "-k*y", "-cos(1)", "-1/2", "-0.5"]
    assert [parse("1,0", formula).more for formula in formulas] == formulas


@pytest.mark.parametrize(
    ("words", "complaint"),
    [
        (("--format", "c"), "prog: argument --format: invalid choice: 'c' (choose from 'a', 'b') (`prog --help` shows"),
        (("--this", "--that"), "prog: argument --that: not allowed with argument --this"),
        (("--h", "0"), "prog: argument --h: the step size h must not be 0"),
        (("1,0", "0", "two\nlines"), "prog: unrecognized arguments: two lines (`prog --help` shows how)\n"),
        (("1,0", "-out"), "prog: unrecognized arguments: -out"),
    ],
)
def test_parser_complains_in_one_line(words, complaint, parse, capsys):
    with pytest.raises(SystemExit) as stopped:
        parse(*words)
    out, err = capsys.readouterr()
    assert (stopped.value.code, out, err.count("\n")) == (cli.BAD_INPUT, "", 1)
    assert complaint in err


@pytest.mark.parametrize("doc", [command_of.__doc__, cleandoc(command_of.__doc__)], ids=["indented", "as in 3.13"])
def test_docstring_is_the_help(doc, parse, monkeypatch):
    monkeypatch.setattr(command_of, "__doc__", doc)
    with pytest.raises(cli.Help) as shown:
        parse("--help")
    _, about, *_, examples = str(shown.value).split("\n\n")
    assert (about, examples) == ("Says what it does.", "Here and there:\n  indented")
