"""The command line: its answers to the letter, its JSON byte for byte, and one line for everything it cannot answer."""

from __future__ import annotations

import json
import shlex
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from driftproof import __version__, cli, text, values
from driftproof.arguments import BAD_INPUT, LONG_RUN, progress
from driftproof.cli import NO_ANSWER, main
from methods.catalogue import METHODS

Run = Callable[..., tuple[int, str, str]]


@pytest.fixture
def run(capsys: pytest.CaptureFixture[str]) -> Run:
    """run(*arguments): exit status, standard output and standard error of `driftproof` with these arguments."""

    def call(*arguments: str) -> tuple[int, str, str]:
        try:
            status = main(arguments)
        except SystemExit as stopped:  # argparse leaves this way
            status = int(stopped.code or 0)
        out, err = capsys.readouterr()
        return status, out, err

    return call


@pytest.fixture
def answer(run: Run) -> Callable[..., str]:
    """answer(*arguments): standard output of a question that is answered, which is silent on standard error."""

    def call(*arguments: str) -> str:
        status, out, err = run(*arguments)
        assert (status, err) == (0, "")
        return out

    return call


Answer = Callable[..., str]

STEP = """\
Classical RK4 (rk4): one step of h = 1/2 from (1, 0)

final state q  0.877604166666667      = 337/384
final state v  -0.479166666666667     = -23/48
energy         0.499894883897569      = 147425/294912
energy change  -0.000105116102430556  = -31/294912

15 digits, rounded half-even, certified
"""

RUN = """\
Forward Euler (forward_euler): 40 steps of h = 1/4 from (1, 0) to t = 10

final state q  -3.12900713279485795083259563110
final state v  1.22937903463293923853576097167
exact state q  -0.839071529076452452258863947824         = cos(10)
exact state v  0.544021110889369813404747661851          = -sin(10)
state error    2.39029716830675147537827059350
energy         5.65102922393805771725009208643
energy change  5.15102922393805771725009208643
phase error    -11.5080564137640654522887417745 degrees
steps          40
evaluations    40

30 digits, rounded half-even, certified
"""


def test_step_prints_fractions_with_decimals(answer: Answer) -> None:
    assert answer("step", "rk4", "--h", "1/2", "--state", "1,0") == STEP


def test_run_prints_every_certified_readout(answer: Answer) -> None:
    assert answer("run", "forward_euler", "--h", "1/4", "--t", "10", "--digits", "30") == RUN


def test_step_as_json_has_every_number_as_a_string(answer: Answer) -> None:
    found = json.loads(answer("step", "rk4", "--h", "0.5", "--format", "json"))
    assert found["final_state"] == {
        "q": {"exact": "337/384", "decimal": "0.877604166666667"},
        "v": {"exact": "-23/48", "decimal": "-0.479166666666667"},
    }
    assert (found["h"], found["start"], found["digits"], found["rounding"]) == ("1/2", ["1", "0"], 15, "half-even")


def test_run_as_json_has_units_counts_and_undefined_as_null(answer: Answer) -> None:
    found = json.loads(answer("run", "rk4", "--h", "1/4", "--t", "10", "--format", "json"))
    assert (found["steps"], found["evaluations"]) == (40, 160)
    assert found["phase_error"]["unit"] == "degrees"
    assert found["exact_state"]["q"]["exact"] == "cos(10)"
    assert found["state_error"]["exact"] is None
    undefined = json.loads(answer("run", "rk4", "--h", "1/4", "--t", "10", "--state", "0,0", "--format", "json"))
    assert undefined["phase_error"] is None
    assert "undefined at the origin" in answer("run", "rk4", "--h", "1/4", "--t", "10", "--state", "0,0")


JSON_COMMANDS = [
    ("step", "symplectic_euler", "--h", "0.5", "--state", "0,1"),
    ("run", "rk4", "--h", "0.01", "--t", "100", "--state", "0,1"),
    ("scene", "stability_boundary"),
]


@pytest.mark.parametrize("command", JSON_COMMANDS, ids=lambda command: command[0])
def test_json_is_canonical_and_byte_stable(command: tuple[str, ...], answer: Answer) -> None:
    first = answer(*command, "--format", "json")
    assert first == answer(*command, "--format", "json")
    assert first == json.dumps(json.loads(first), indent=1, sort_keys=True, ensure_ascii=False) + "\n"


def test_same_bytes_come_from_processes_with_other_hash_seeds() -> None:
    command = [sys.executable, "-m", "driftproof", *JSON_COMMANDS[1], "--format", "json"]
    root = Path(__file__).parents[1]
    outputs = {
        subprocess.run(
            command, cwd=root, env={"PYTHONHASHSEED": seed}, capture_output=True, check=True, timeout=60
        ).stdout
        for seed in ("0", "1")
    }
    assert len(outputs) == 1


def test_negative_values_are_values_and_not_options(answer: Answer) -> None:
    back = answer("step", "rk4", "--h", "-1/2", "--state", "-1,0")
    assert "one step of h = -1/2 from (-1, 0)" in back
    assert "= -337/384" in back
    assert answer("step", "rk4", "--h=-1/2", "--state=-1,0") == back
    assert "h = -1/4" in answer("run", "rk4", "--h", "-.25", "--t", "-10", "--state", "-1/3,-2")


def test_minus_sign_of_printed_text_is_understood(answer: Answer) -> None:
    minus = "\N{MINUS SIGN}"
    assert answer("step", "rk4", "--h", f"{minus}1/2") == answer("step", "rk4", "--h", "-1/2")


def test_rounding_of_a_tie_is_as_asked(answer: Answer) -> None:
    tie = ("step", "forward_euler", "--h", "1/8", "--state", "5/2,0", "--digits", "1")
    assert "final state q  2 " in answer(*tie)
    assert "final state q  3 " in answer(*tie, "--rounding", "half-away")


def test_no_time_and_the_origin_have_exact_answers(answer: Answer) -> None:
    found = json.loads(answer("run", "rk4", "--h", "1", "--t", "0", "--state", "1/3,3/20", "--format", "json"))
    assert found["state_error"] == {"exact": "0", "decimal": "0"}
    assert found["phase_error"] == {"exact": "0", "decimal": "0", "unit": "degrees"}
    assert found["exact_state"]["q"] == found["final_state"]["q"]
    assert (found["steps"], found["evaluations"]) == (0, 0)


def test_ten_million_steps_and_far_more_are_answered(answer: Answer) -> None:
    million = answer("run", "symplectic_euler", "--h", "1/4", "--t", "2500000", "--digits", "20")
    assert "10000000 steps" in million
    assert "2.5e" not in million
    assert "1" + 44 * "0" in answer("run", "symplectic_euler", "--h", "1", "--t", "1e44")


def test_huge_exact_fractions_are_printed_and_not_refused(answer: Answer) -> None:
    found = json.loads(answer("step", "rk4", "--h", "1/2", "--state", "1e1200,1e-1200", "--format", "json"))
    assert len(found["energy"]["exact"]) > 4300  # Python's own limit for printing an integer
    assert found["energy"]["decimal"] == "4.99894883897569e2399"


def test_lists_name_every_method_and_every_scene(answer: Answer) -> None:
    methods, scenes = answer("methods").splitlines(), answer("scenes").splitlines()
    assert methods[0].split() == ["method", "family", "order", "title", "source"]
    assert [line.split()[0] for line in methods[1:]] == list(METHODS)
    assert [line.split() for line in scenes[1:]] == [
        ["default", "forward_euler", "1/4", "10", "40"],
        ["small_steps", "forward_euler", "1/10", "10", "100"],
        ["compare", "forward_euler", "1/2", "10", "20"],
        ["stability_boundary", "symplectic_euler", "2", "10", "5"],
    ]


def test_scene_shows_the_state_after_the_boundary_run(answer: Answer) -> None:
    found = json.loads(answer("scene", "stability_boundary", "--format", "json"))
    assert found["readouts"]["final_state"] == ["-11.0", "-10.0"]


def test_scene_figures_are_written_where_asked(answer: Answer, tmp_path: Path) -> None:
    out = answer("scene", "compare", "--figures", str(tmp_path / "new" / "folder"))
    assert out.endswith(f"wrote {tmp_path / 'new' / 'folder' / 'compare_phase_plane.svg'}\n")
    assert len(list((tmp_path / "new" / "folder").iterdir())) == 2


DOCUMENT = {
    "rounding": "half-even",
    "values": {
        "a.h": {"exact": "1/4", "decimal": "0.25", "printed": {"L1": "0.25"}, "evidence": "PROVED"},
        "b.state_error": {
            "exact": None,
            "decimal": "2.390",
            "printed": {"L3": "2.390", "L2": "2.39", "L4": "2.39"},
            "evidence": "CERTIFIED",
        },
    },
}
RENDERED = {
    "md": "| id | exact | decimal | printed |\n|---|---|---|---|\n| `a.h` | `1/4` | 0.25 | 0.25 |\n"
    "| `b.state_error` |  | 2.390 | 2.39, 2.390 |\n",
    "tex": "\\driftproofvalue{a.h}{0.25}\n\\driftproofvalue{b.state_error}{2.390}\n",
    "csv": "id,exact,decimal,printed,evidence\na.h,1/4,0.25,0.25,PROVED\nb.state_error,,2.390,2.39 2.390,CERTIFIED\n",
}


@pytest.fixture
def published(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(values, "_document", lambda: json.loads(json.dumps(DOCUMENT)))


@pytest.mark.usefixtures("published")
@pytest.mark.parametrize("form", RENDERED)
def test_values_are_rendered(form: str, answer: Answer) -> None:
    assert answer("values", "--format", form) == RENDERED[form]


@pytest.mark.usefixtures("published")
def test_values_as_json_are_canonical_and_as_javascript_the_same(answer: Answer) -> None:
    assert json.loads(answer("values")) == DOCUMENT
    script = answer("values", "--format", "js").rstrip("\n")
    assert json.loads(script.removeprefix("export const values = ").removesuffix(";")) == DOCUMENT["values"]


@pytest.mark.usefixtures("published")
def test_only_takes_a_shell_pattern_in_every_format(answer: Answer, run: Run) -> None:
    assert set(json.loads(answer("values", "--only", "a.*"))["values"]) == {"a.h"}
    assert answer("values", "--only", "*error", "--format", "tex") == "\\driftproofvalue{b.state_error}{2.390}\n"
    assert run("values", "--only", "A.*")[0] == BAD_INPUT


@pytest.mark.usefixtures("published")
def test_missing_decimal_is_an_error_and_never_a_blank(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(values, "_document", lambda: {"values": {"x": {"exact": "1", "printed": {}, "evidence": "P"}}})
    for form in RENDERED:
        with pytest.raises(KeyError):
            run("values", "--format", form)


RK4 = ("rk4", "--h", "1/2")
BAD_INPUTS: list[tuple[tuple[str, ...], str]] = [
    ((), "required: COMMAND"),
    (("fly",), "invalid choice: 'fly'"),
    (("step", "rk5", "--h", "1/2"), "unknown method 'rk5'; did you mean rk4 or rk38?"),
    (("step", "__import__('os')", "--h", "1"), 'unknown method "__import__'),
    (("step", "rk4"), "required: --h"),
    (("step", "rk4", "--h", "1//2"), "h: '1//2' is not a rational number; write an integer, a fraction like 1/4"),
    (("step", "rk4", "--h", "1/0"), "h: '1/0' divides by zero"),
    (("step", "rk4", "--h", "__import__('os').getpid()"), "is not a rational number"),
    (("step", "rk4", "--h", "nan"), "h: 'nan' is not a rational number"),
    (("step", "rk4", "--h", "1e999999999"), "h: '1e999999999' is too long"),
    (("step", "rk4", "--h", "1e999_999_999"), "h: '1e999_999_999' is too long"),
    (("step", "rk4", "--h", "9" * 5000), "is too long; at most 1200 characters"),
    (("step", "rk4", "--h", "0"), "a step of size 0 goes nowhere"),
    (("step", "rk4", "--h", "-0.0"), "a step of size 0 goes nowhere"),
    (("step", *RK4, "--state", "1"), "'1' is not a state; write position,velocity like 1,0"),
    (("step", *RK4, "--state", "1,0,0"), "'1,0,0' is not a state"),
    (("step", *RK4, "--state", "1,x"), "v: 'x' is not a rational number"),
    (("step", *RK4, "--state", "1e999999999,0"), "q: '1e999999999' is too long"),
    (("step", *RK4, "--digits", "0"), "'0' is not a number of digits from 1 to 10000"),
    (("step", *RK4, "--digits", "-3"), "'-3' is not a number of digits"),
    (("step", *RK4, "--digits", "1000000000"), "'1000000000' is not a number of digits"),
    (("step", *RK4, "--digits", "10001"), "'10001' is not a number of digits"),
    (("step", *RK4, "--digits", "1.5"), "'1.5' is not a number of digits"),
    (("step", *RK4, "--digits", "\u0663"), "is not a number of digits"),
    (("step", *RK4, "--rounding", "up"), "invalid choice: 'up'"),
    (("step", *RK4, "--format", "xml"), "invalid choice: 'xml'"),
    (("step", *RK4, "more\nwords"), "unrecognized arguments: more words"),
    (("run", *RK4), "required: --t"),
    (("run", "rk4", "--h", "0.3", "--t", "10"), "h = 3/10 does not divide t = 10"),
    (("run", "rk4", "--h", "-1/2", "--t", "10"), "h = -1/2 leads away from t = 10"),
    (("run", "rk4", "--h", "1/2", "--t", "ten"), "t: 'ten' is not a rational number"),
    (("scene", "defualt"), "unknown scene 'defualt'; did you mean default?"),
    (("scene", "none.toml"), "none.toml: No such file or directory"),
    (("scene", "two\nlines.toml"), "No such file or directory"),
    (("scene",), "required: name"),
    (("values", "--only", "no such id"), "no published value has an id that matches 'no such id'"),
    (("values", "--format", "xml"), "invalid choice: 'xml'"),
]


@pytest.mark.parametrize(("arguments", "message"), BAD_INPUTS, ids=range(len(BAD_INPUTS)))
def test_bad_input_gives_one_line_and_a_nonzero_exit(arguments: tuple[str, ...], message: str, run: Run) -> None:
    status, out, err = run(*arguments)
    assert (status, out) == (BAD_INPUT, "")
    assert message in err
    assert err.startswith("driftproof")
    assert err.count("\n") == 1
    assert err.endswith("\n")


def test_question_without_an_answer_gives_one_line_and_its_own_exit(run: Run) -> None:
    status, out, err = run("run", "forward_euler", "--h", "1/4", "--t", "1e100")
    assert (status, out) == (NO_ANSWER, "")
    assert err == "driftproof run: the number lies outside 10**-78000 .. 10**78000, too long to write out\n"


def test_scene_that_outlasts_the_float_range_says_so_where_its_numbers_would_be(answer: Answer, tmp_path: Path) -> None:
    path = tmp_path / "far.toml"
    path.write_text('selected = "forward_euler"\nh = 2\nt = 4000\nreadouts = ["energy"]\n', encoding="utf-8")
    assert "overflow: the state is no longer finite after step 883" in answer("scene", str(path))


def test_real_process_has_the_same_manners(tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-m", "driftproof", "step", "rk5", "--h", "1/2"],
        cwd=Path(__file__).parents[1],
        capture_output=True,
        text=True,
        timeout=60,
    )
    assert (done.returncode, done.stdout) == (BAD_INPUT, "")
    assert done.stderr.count("\n") == 1
    assert "Traceback" not in done.stderr


def test_interrupted_question_says_so_in_one_line(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted() -> str:
        raise KeyboardInterrupt

    monkeypatch.setattr(text, "methods_text", interrupted)
    assert run("methods") == (130, "", "driftproof methods: interrupted\n")


def test_message_of_many_lines_is_printed_on_one(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    def broken() -> str:
        raise ValueError("one\n  two\n")

    monkeypatch.setattr(text, "methods_text", broken)
    assert run("methods") == (BAD_INPUT, "", "driftproof methods: one two\n")


def test_defect_of_the_program_is_not_dressed_as_bad_input(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    def broken() -> str:
        raise TypeError("a defect")

    monkeypatch.setattr(text, "methods_text", broken)
    with pytest.raises(TypeError):
        run("methods")


def commands() -> list[str]:
    (choices,) = (action.choices for action in cli._parser()._actions if action.dest == "command")
    return list(choices or ())


def test_commands_are_all_there() -> None:
    assert set(commands()) >= {"methods", "step", "run", "scenes", "scene", "values"}


@pytest.mark.parametrize("command", [(), *((name,) for name in commands())], ids=" ".join)
def test_help_teaches_by_example(command: tuple[str, ...], answer: Answer) -> None:
    shown = answer(*command, "--help")
    assert f"driftproof {' '.join(command)}".strip() in shown.split("example", 1)[1]


def test_examples_in_the_help_are_answered(run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    for command, name in (("scene", "mine.toml"), ("facts", "tableau.toml")):
        (tmp_path / name).write_text(help_file(command, name), encoding="utf-8")
    examples = [line.strip() for name in commands() for line in help_text(name).splitlines()]
    shown = [line for line in examples if line.startswith("driftproof ")]
    assert len(shown) >= 10
    for line in shown:
        words = shlex.split(line.split("      ")[0])[1:]
        assert run(*words)[0] == 0, line


def help_text(command: str) -> str:
    (choices,) = (action.choices for action in cli._parser()._actions if action.dest == "command")
    return str(choices[command].epilog)


def help_file(command: str, name: str) -> str:
    """The file that the command's --help shows, without its remarks."""
    lines = help_text(command).split(f"{name}:\n")[1].splitlines()
    return "\n".join(line.strip().split("     ")[0] for line in lines)


def test_version_is_the_package_version(answer: Answer) -> None:
    assert answer("--version") == f"driftproof {__version__}\n"


def test_start_of_the_command_line_loads_no_heavy_library(modules_after: Callable[[str], set[str]]) -> None:
    loaded = modules_after("from driftproof.cli import main; main(['scenes'])")
    assert loaded & {"sympy", "flint", "matplotlib", "numpy", "tqdm"} == set()


def test_progress_bar_is_for_long_runs_on_a_terminal_only(monkeypatch: pytest.MonkeyPatch) -> None:
    assert progress(LONG_RUN * 10) == range(LONG_RUN * 10)  # standard error is no terminal here
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True, raising=False)
    assert progress(10) == range(10)
    bar = progress(LONG_RUN)
    assert not isinstance(bar, range)
    assert len(bar) == LONG_RUN
    bar.close()
