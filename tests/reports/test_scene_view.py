"""A scene shown: readouts as the lesson labels them, the table of methods, and nothing paid for what it leaves out."""

import dataclasses
from fractions import Fraction as Q

import pytest

from driftproof.numeric.problems.catalogue import PROBLEMS
from driftproof.numeric.scenes import PRESETS, READOUTS, Scene
from driftproof.reports.scene_view import scene_json, scene_text, show_scene


def test_default_scene_shows_what_the_lesson_shows():
    shown = scene_text(PRESETS["default"], show_scene(PRESETS["default"]))
    lines = [" ".join(line.split()) for line in shown.splitlines()]
    assert set(LESSON_DEFAULT) <= set(lines)
    heads, *rows = shown.splitlines()[-4:]
    assert {len(row) for row in rows} == {len(heads)}  # numbers stand at the right of their columns


LESSON_DEFAULT = [
    "Numerical (q, v) (-3.129, 1.229)", "Exact (q, v) (-0.839, 0.544)", "State error 2.390297",
    "Final energy 5.651029", "Energy change 5.151029", "Wrapped phase error (degrees) -11.508", "Steps 40",
    "Acceleration evaluations 40", "Forward Euler 2.390 5.151 40", "Symplectic Euler 0.090 -0.054 40",
    "Classical RK4 3.3e-4 -6.7e-5 160",
]  # fmt: skip


def test_shown_parts_are_those_named():
    every = {"readouts", "table"}
    for part, changed in {
        "readouts": {"readouts": ("energy",)},
        "table": {"panels": ("table",), "methods": ("rk4",)},
    }.items():
        scene = Scene("one", "rk4", Q(1, 4), Q(1), **changed)
        assert set(show_scene(scene)) & every == {part}


def test_overflowing_method_has_its_message_and_the_others_their_numbers():
    scene = Scene(
        "far", "rk4", Q(2), Q(2000), methods=("forward_euler", "rk4"), readouts=("energy",), panels=("table",)
    )
    shown = show_scene(scene)
    assert shown["table"]["forward_euler"] == "overflow: the state is no longer finite after step 883"
    assert "overflow: the state is no longer finite after step 883" in scene_text(scene, shown)


def test_no_zero_is_shown_with_a_sign():
    """Also where rounding makes it one; what is not rounded to zero keeps its sign, and JSON keeps the bits."""
    readouts = {"final_state": (-0.0004, -0.0), "energy_change": -4e-7, "phase_error": -0.0004}
    scene = Scene("s", "rk4", Q(1, 4), Q(1), readouts=tuple(readouts))
    shown = scene_text(scene, {"readouts": readouts})
    assert "(0.000, 0.000)" in shown
    assert "-0" not in shown
    assert scene_json(scene, {"readouts": readouts})["readouts"]["final_state"] == ["-0.0004", "-0.0"]
    negative = {"final_state": (-0.0006, -1.0), "energy_change": -6e-7, "phase_error": -0.0006}
    shown = scene_text(scene, {"readouts": negative})
    assert all(text in shown for text in ("(-0.001, -1.000)", "-0.000001", "-0.001"))


def test_state_of_a_problem_is_shown_to_six_digits():
    scene = Scene("s", "rk4", Q(1, 4), Q(20), problem=PROBLEMS["kepler"], readouts=("final_state",))
    assert "(0.333333, 6.66667e-8)" in scene_text(scene, {"readouts": {"final_state": (1 / 3, 2e-7 / 3)}})


def test_enormous_number_is_shown_with_an_exponent():
    scene = Scene(
        "far", "forward_euler", Q(2), Q(800), methods=("forward_euler",), readouts=READOUTS, panels=("table",)
    )
    shown = scene_text(scene, show_scene(scene))
    assert max(map(len, shown.splitlines())) < 80
    assert "e+139" in shown


def test_scene_json_holds_strings_that_read_back_to_the_same_bits():
    scene = Scene("s", "rk4", Q(1, 4), Q(1), readouts=READOUTS)
    shown = show_scene(scene)
    answer = scene_json(scene, shown)
    assert [float(x) for x in answer["readouts"]["final_state"]] == list(shown["readouts"]["final_state"])
    assert [[float(x) for x in row] for row in answer["readouts"]["trajectory"][1]] == shown["readouts"]["trajectory"][
        1
    ].tolist()
    undefined = Scene("s", "rk4", Q(1, 4), Q(1), (Q(0), Q(0)), readouts=("phase_error",))
    shown = show_scene(undefined)
    assert scene_json(undefined, shown)["readouts"] == {"phase_error": None}
    assert scene_text(undefined, shown).count("undefined at the origin") == 1


def test_scene_without_exact_readouts_never_imports_sympy(modules_after, tmp_path):
    path, every = tmp_path / "mine.toml", '["final_state", "state_error", "energy", "phase_error", "evaluations"]'
    code = f"from driftproof.cli import main; main(['scene', {str(path)!r}, '--figures', {str(tmp_path)!r}])"
    path.write_text(f'selected = "rk4"\nh = "1/4"\nt = 10\npanels = ["position"]\nreadouts = {every}', encoding="utf-8")
    assert modules_after(code) & {"sympy", "flint"} == set()


def test_a_scene_of_a_problem_takes_methods_of_several_states_and_says_what_they_start_with():
    methods = ("bdf3", "rodas4")
    scene = Scene("s", "bdf3", Q(1, 8), Q(1), panels=("table",), methods=methods, problem=PROBLEMS["kaps"])
    shown = show_scene(scene)
    assert [shown["table"][key]["evaluations"] for key in methods] == [shown["table"]["bdf3"]["evaluations"], 6 * 8]
    assert scene_text(scene, shown).endswith("\n\nFirst values of BDF, 3 steps: steps of radau_iia3")
    assert scene_json(scene, shown)["started"] == {"bdf3": "radau_iia3"}
    rodas = dataclasses.replace(scene, selected="rodas4", methods=("rodas4",))
    assert "started" not in scene_json(rodas, show_scene(rodas))
    with pytest.raises(ValueError, match="bdf3 is a linear multistep method: `driftproof stability`, `work"):
        dataclasses.replace(scene, problem=None)
