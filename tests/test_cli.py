"""The command line: one line and a non-zero exit where there is no answer, help by example, a start that is light."""

import io
import json
import os
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

from driftproof import __version__
from driftproof.cli import main
from driftproof.commands.listing import COMMANDS, command_named
from driftproof.support import plain_text
from driftproof.texts.values.published import VALUES_FILE
from tests.looping import some

ROOT = Path(__file__).parents[1]
DRIFTPROOF = (sys.executable, "-m", "driftproof")
GONE = "the answer is lost: standard output"
REFUSED = {
    (): "driftproof: give a command (`driftproof --help` lists the commands)\n",
    ("-x", "step"): "driftproof: unknown option -x (`driftproof --help` lists the commands)\n",
    ("stepp",): "driftproof: unknown command 'stepp'; did you mean step? (see `driftproof --help`)\n",
    ("x" * 9999,): f"driftproof: unknown command {'x' * 57 + '...'!r} (see `driftproof --help`)\n",
    ("methods", "more\nwords"): "driftproof methods: unrecognized arguments: more words (`driftproof methods --help`",
    ("scene", "two\nlines.toml"): "driftproof scene: two lines.toml: No such file or directory\n",
}


@pytest.mark.parametrize("arguments", REFUSED, ids=range(len(REFUSED)))
def test_what_cannot_be_understood_gets_one_line(arguments, refusal):
    assert REFUSED[arguments] in refusal(*arguments)


@pytest.mark.parametrize(
    ("error", "status", "line"),
    [
        (ValueError("one\n  two\n"), 2, "one two"),
        (FileNotFoundError(2, "No such file", "x.toml"), 2, "x.toml: No such file"),
        (OSError("odd"), 2, "odd"),
        (ArithmeticError("too long"), 3, "too long"),
        (KeyboardInterrupt("it goes on"), 130, "interrupted; it goes on"),
    ],
    ids=lambda value: type(value).__name__,
)
def test_what_goes_wrong_while_answering_gets_one_line_too(error, status, line, run, monkeypatch):
    def broken(*_, **__):
        raise error

    monkeypatch.setattr(plain_text, "table", broken)
    assert run("methods") == (status, "", f"driftproof methods: {line}\n")


def test_a_complaint_that_nobody_can_read_leaves_its_status(monkeypatch):
    monkeypatch.setattr(sys, "stderr", None)
    assert main(["stepp"]) == 2


def test_defect_of_the_program_is_not_dressed_as_bad_input(run, monkeypatch):
    monkeypatch.setattr(plain_text, "table", lambda *_, **__: 1 + "a defect")
    with pytest.raises(TypeError):
        run("methods")


def test_real_process_has_the_same_manners_and_nobody_has_to_read_its_answer(tmp_path):
    def process(*words, **how):
        return subprocess.run([*DRIFTPROOF, *words], cwd=ROOT, stderr=subprocess.PIPE, text=True, timeout=60, **how)

    done = process("step", "rk5", "--h", "1/2", stdout=subprocess.PIPE)
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (2, "", 1)
    for name, number in (("old.json", 1), ("new.json", 2)):
        number = {"exact": str(number), "decimal": str(number)}
        (tmp_path / name).write_text(json.dumps({"values": {"x": number}}), encoding="utf-8")
    read, write = os.pipe()
    os.close(read)
    done = process("diff", str(tmp_path / "old.json"), str(tmp_path / "new.json"), stdout=write)
    os.close(write)
    assert (done.returncode, done.stderr) == (141, ""), "as head leaves it"


@pytest.mark.parametrize("words", [["--version"], ["--help"], ["run", "--help"], ["step", "rk4", "--h", "1/2"]])
@pytest.mark.parametrize(("to", "why"), [(">/dev/full", "No space left on device"), (">&-", "is closed")])
def test_answer_that_is_lost_is_no_success(words, to, why):
    command = f"{shlex.join([*DRIFTPROOF, *words])} {to}"
    done = subprocess.run(["/bin/sh", "-c", command], cwd=ROOT, capture_output=True, text=True, timeout=60)
    assert done.returncode == 3
    assert done.stderr.count("\n") == 1
    assert GONE in done.stderr
    assert why in done.stderr


def test_answer_is_written_in_utf_8_where_the_encoding_of_a_file_has_not_its_characters():
    words, given = [*DRIFTPROOF, "facts", "rk4"], {**os.environ, "PYTHONIOENCODING": "cp1252"}
    done = subprocess.run(words, cwd=ROOT, capture_output=True, env=given, timeout=60)
    assert (done.returncode, done.stderr, "τ" in done.stdout.decode("utf-8")) == (0, b"", True)


def test_terminal_is_shown_a_character_that_it_has_not_in_its_code(monkeypatch):
    shown = io.BytesIO()
    terminal = io.TextIOWrapper(shown, encoding="ascii")
    terminal.isatty = lambda: True
    monkeypatch.setattr(sys, "stdout", terminal)
    assert main(["facts", "rk4"]) == 0
    assert b"\\u03c4" in shown.getvalue()


@pytest.mark.parametrize("module", ["driftproof.commands.arguments", "driftproof.symbolic.derivation.derive"])
def test_interrupt_while_something_is_imported_gets_one_line(module, run, monkeypatch):
    real = __import__

    def interrupted(name, *more, **named):
        if name == module:
            raise KeyboardInterrupt
        return real(name, *more, **named)

    monkeypatch.setattr("builtins.__import__", interrupted)
    found = run("derive", "rk4")
    monkeypatch.undo()
    assert found == (130, "", "driftproof derive: interrupted\n")


FOREIGN = "\x1b[2J\x9b31m\u202e\x07"


@pytest.mark.slow
def test_foreign_text_has_no_say_over_the_terminal(run, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(tmp_path)
    title = "".join(f"\\u{ord(c):04x}" for c in FOREIGN)
    Path("m.toml").write_text(
        f'family = "runge_kutta"\ntitle = "{title}"\nA = [[0, 0], ["1/2", 0]]\nb = [0, 1]\n', encoding="utf-8"
    )
    Path("mine_is_odd.py").write_text(
        f"def step(q, v, h):\n    {FOREIGN!r}\n    print({FOREIGN!r})\n    raise ValueError({FOREIGN!r})\n",
        encoding="utf-8",
    )
    for words in (
        ("facts", "m.toml", "--only", "order"),
        ("scene", f"{FOREIGN}.toml"),
        ("scene", "default", FOREIGN),
        (FOREIGN,),
        ("diff", f"{FOREIGN}.json", "x"),
        *(("identify", "mine_is_odd:step", "--format", form) for form in ("text", "json", "markdown")),
    ):
        _, out, err = run(*words)
        assert out + err
        assert not set(out + err) & set("\x1b\x9b\u202e\x07"), words


JSON_COMMANDS = [
    ("step", "symplectic_euler", "--h", "0.5", "--state", "0,1"),
    ("run", "rk4", "--h", "0.01", "--t", "100", "--state", "0,1"),
    ("scene", "stability_boundary"),
]


@pytest.mark.parametrize("command", JSON_COMMANDS, ids=lambda command: command[0])
def test_json_is_canonical_and_byte_stable(command, answer):
    first = answer(*command, "--format", "json")
    assert first == answer(*command, "--format", "json")
    assert first == json.dumps(json.loads(first), indent=1, sort_keys=True, ensure_ascii=False) + "\n"


def test_same_bytes_come_from_processes_with_other_hash_seeds():
    command = [*DRIFTPROOF, *JSON_COMMANDS[1], "--format", "json"]
    run = {"cwd": ROOT, "capture_output": True, "check": True, "timeout": 60}
    assert len({subprocess.run(command, env={"PYTHONHASHSEED": seed}, **run).stdout for seed in ("0", "1")}) == 1


# What the examples of `identify`, `verify` and `certify` are about, and the claims of `check`.
FILES = {
    "mylib/integrators.py": """
def step(q, v, h):
    v = v - h / 2 * q
    q = q + h * v
    return q, v - h / 2 * q

def rk_step(f, t, y, h):
    k1 = f(t, y)
    return y + h * (k1 / 4 + 3 * f(t + 2 * h / 3, y + 2 * h / 3 * k1) / 4)
""",
    "mylib/implicit.py": """
def step(q, v, h):
    v = (v - h * q) / (1 + h * h)
    return q + h * v, v
""",
    "mylib/models.py": """
import numpy as np

def pendulum(t, y):
    return np.array([y[1], -np.sin(y[0])])
""",
    "pendulum.toml": 'rates = ["y1", "-g * sin(y0)"]\nparameters.g = 1\n',
    "run.csv": (ROOT / "examples" / "trajectories" / "pendulum_RK45.csv").read_text(encoding="utf-8"),
    "chapter.md": """5 min read. Then the state is (337/384, −23/48) after one step.
RK4 makes four calls, takes 40 steps of h = 0.25 and is off by 3.3×10⁻⁴ at the end.
""",
}
# The files that a command's --help shows.
SHOWN_FILES = {"scene": "mine.toml", "facts": "tableau.toml", "render": "lesson.md.j2", "check": "claims.toml"}
# Seconds each: all are parsed, and run with -m long; one of each is run by tests/commands.
SLOW = {"identify", "report", "verify", "work-precision"}


def parser_of(command):
    return command_named(command).parser(f"driftproof {command}")


def examples_of(command):
    """The words of each example in the help, without the remark beside it."""
    lines = (line.strip() for line in parser_of(command).epilog.splitlines())
    found = [shlex.split(line.split("      ")[0])[2:] for line in lines if line.startswith(f"driftproof {command}")]
    assert found
    return found


@pytest.mark.parametrize("command", [(), *((name,) for name in COMMANDS)], ids=" ".join)
def test_help_teaches_by_example(command, answer):
    shown = answer(*command, "--help")
    assert f"driftproof {' '.join(command)}".strip() in shown.split("example", 1)[1]
    assert command or all(f"  {name:14}  {what}\n" in shown for name, (_, what) in COMMANDS.items())
    assert "docs/" not in shown  # which is not installed


@pytest.mark.parametrize("command", COMMANDS)
def test_examples_in_the_help_are_understood(command):
    for words in some(examples_of(command)):
        assert parser_of(command).parse_args(words)


@pytest.mark.parametrize("command", [pytest.param(c, marks=pytest.mark.long) if c in SLOW else c for c in COMMANDS])
def test_examples_in_the_help_are_answered(command, run, tmp_path, monkeypatch):
    shown = {file: parser_of(name).epilog.split(f"{file}:\n")[1].splitlines() for name, file in SHOWN_FILES.items()}
    plain = {file: "\n".join(line.strip().split("     ")[0] for line in lines) for file, lines in shown.items()}
    plain |= {"book/chapter.md": FILES["chapter.md"], "book/chapter.md.claims.toml": plain["claims.toml"]}
    values = dict.fromkeys(("old.json", "new.json"), VALUES_FILE.read_text(encoding="utf-8"))
    for name, content in {**FILES, **plain, **values}.items():
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(content, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(tmp_path)
    for words in some(examples_of(command)):
        assert run(command, *words)[0] == 0, words


def test_version_is_the_package_version(answer):
    assert answer("--version") == f"driftproof {__version__}\n"


HEAVY = {"sympy", "flint", "numpy", "numba", "hypothesis", "tqdm", "jinja2", "mpmath", "distributed", "dask"}
HELP_LOADS = {"driftproof", "driftproof.cli", "driftproof.commands", "driftproof.commands.listing"}


@pytest.mark.parametrize("words", ["--version", "--help"])
def test_version_and_help_load_no_parser_and_no_command(words, modules_after):
    loaded = modules_after(f"from driftproof.cli import main; main([{words!r}])")
    assert {name for name in loaded if name.startswith("driftproof")} == HELP_LOADS
    assert not loaded & {"argparse", "typing", "fractions", "dataclasses", *HEAVY}


@pytest.mark.slow(keep=2)
@pytest.mark.parametrize("command", COMMANDS)
def test_help_of_a_command_loads_that_command_alone(command, modules_after):
    start = "import contextlib; from driftproof.cli import main"
    loaded = modules_after(f"{start}\n    with contextlib.suppress(SystemExit): main([{command!r}, '--help'])")
    mine = {name for name in loaded if name.startswith("driftproof.commands.")}
    assert mine == {f"driftproof.commands.{name}" for name in ("listing", "arguments", COMMANDS[command][0])}
    assert not loaded & HEAVY


# What an answer may need of the heavy libraries, and no more.
NEEDED = {
    "methods": {"flint"}, "scenes": {"flint", "numpy"}, "values --only rk4.first_step.q": set(),
    "step rk4 --h 1/2": {"flint"}, "run rk4 --h 1/4 --t 10": {"flint"}, "facts rk4 --only order": {"flint"},
    "value rk4.first_step.q": {"flint"}, "value 'run rk4 h=1/4 t=10 : state_error'": {"flint"},
    "value 'order rk4'": {"flint"}, "roundoff rk4 --h 1/4": {"flint", "numpy"}, "stability": {"flint", "numpy"},
    "derive rk4 --only determinant": {"flint", "sympy", "mpmath"},
    "sweep default --h 1/4": {"numpy"},
}  # fmt: skip


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize("line", NEEDED)
def test_answer_loads_what_it_needs(line, modules_after):
    loaded = modules_after(f"from driftproof.cli import main; main({shlex.split(line)!r})")
    assert loaded & HEAVY <= NEEDED[line]
    assert ("sympy" in loaded) == line.startswith("derive")
    assert "http.client" not in loaded  # as xml.sax.saxutils and other small things would bring along
    assert "driftproof.cli" in loaded
