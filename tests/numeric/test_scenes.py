"""Scenes: the presets, a user's TOML with its errors, and that nothing is paid for that a scene does not name."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from fractions import Fraction as Q
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given

from driftproof.numeric.scenes import (
    LARGEST_LESSON_H,
    LONGEST_FILE,
    PRESETS,
    READOUTS,
    Scene,
    SceneError,
    read_scene,
    scene_named,
)
from driftproof.reports.scene_view import scene_json, scene_text, show_scene
from driftproof.strategies import rationals

ASKED = 'readouts = ["energy"]\n'
MINIMAL = 'selected = "rk4"\nh = "1/8"\nt = 10\n' + ASKED


def written(folder: Path, text: str) -> Path:
    path = folder / "mine.toml"
    path.write_text(text, encoding="utf-8")
    return path


def test_presets_are_those_of_the_lesson() -> None:
    shown = {name: (scene.selected, scene.h, scene.t, scene.steps) for name, scene in PRESETS.items()}
    assert shown == {
        "default": ("forward_euler", Q(1, 4), 10, 40),
        "small_steps": ("forward_euler", Q(1, 10), 10, 100),
        "compare": ("forward_euler", Q(1, 2), 10, 20),
        "stability_boundary": ("symplectic_euler", 2, 10, 5),
    }
    assert all(scene.methods == ("forward_euler", "symplectic_euler", "rk4") for scene in PRESETS.values())
    assert all(0 < scene.h <= LARGEST_LESSON_H == Q(5, 2) for scene in PRESETS.values())
    assert all(name == scene.name and scene.start == (1, 0) for name, scene in PRESETS.items())


def test_minimal_file_means_the_lesson_start_and_the_file_name(tmp_path: Path) -> None:
    scene = read_scene(written(tmp_path, MINIMAL))
    assert scene == Scene("mine", "rk4", Q(1, 8), Q(10), readouts=("energy",))
    assert scene.steps == 80


def test_full_file_is_read_as_written(tmp_path: Path) -> None:
    text = MINIMAL + (
        'name = "all of it"\nstart = [0.1, "-1/3"]\nmethods = ["rk4", "heun2"]\n'
        'certified = ["phase_error"]\npanels = ["table", "position"]\n'
    )
    scene = scene_named(str(written(tmp_path, text)))
    assert (scene.name, scene.start) == ("all of it", (Q(1, 10), Q(-1, 3)))
    assert (scene.methods, scene.certified, scene.panels) == (
        ("rk4", "heun2"),
        ("phase_error",),
        ("table", "position"),
    )


@given(h=rationals(max_denominator=10**6).filter(bool))
def test_decimals_and_fractions_in_a_file_are_exact(h: Q, tmp_path_factory: pytest.TempPathFactory) -> None:
    folder = tmp_path_factory.mktemp("scene")
    text = f'selected = "rk4"\nh = "{h}"\nt = "{7 * h}"\n{ASKED}'
    assert (read_scene(written(folder, text)).h, read_scene(written(folder, text)).steps) == (h, 7)


def test_decimal_in_a_file_is_not_the_nearest_double(tmp_path: Path) -> None:
    scene = read_scene(written(tmp_path, f'selected = "rk4"\nh = 0.1\nt = 10.0\n{ASKED}'))
    assert (scene.h, scene.steps) == (Q(1, 10), 100)
    assert scene.h != Q(0.1)


BAD_FILES = {
    "h = 1\nt = 1\n" + ASKED: "'selected' is missing",
    'selected = "rk4"\nt = 1\n' + ASKED: "'h' is missing",
    'selected = "rk4"\nh = 1\n' + ASKED: "'t' is missing",
    'selected = "rk4"\nh = 1\nt = 1\n': "scene 'mine' asks for nothing; name readouts, certified or panels",
    MINIMAL + "colour = 1": "a scene has no key 'colour'; there are name, selected, h, t, start",
    'selected = "rk5"\nh = 1\nt = 1\n' + ASKED: "scene 'mine': unknown method 'rk5'; did you mean rk4 or rk38?",
    MINIMAL + 'methods = ["rk4", "euler"]': "unknown method 'euler'; did you mean",
    MINIMAL + "methods = 5": "methods is 5; write a list",
    MINIMAL + 'methods = "rk4"': "methods is 'rk4'; write a list",
    MINIMAL + "methods = [1]": "methods[0] is 1; write a text in quotes",
    MINIMAL + 'certified = ["steps"]': "unknown certified readout 'steps'; choose from final_state",
    MINIMAL + 'panels = ["pie"]': "unknown panel 'pie'; choose from table, position, phase_plane",
    MINIMAL + 'panels = ["table"]': "has a table but names no methods to compare",
    MINIMAL.replace("energy", "enegry"): "unknown readout 'enegry'; choose from final_state",
    MINIMAL.replace("rk4", "__import__('os')"): "unknown method \"__import__('os')\"",
    MINIMAL.replace('"1/8"', '"__import__(1)"'): "h: '__import__(1)' is not a rational number",
    MINIMAL.replace('"1/8"', "0"): "h = 0 never reaches t = 10",
    MINIMAL.replace('"1/8"', "0.3"): "h = 3/10 does not divide t = 10 (t / h = 100/3); nearest that do: 10/33 and 5/17",
    MINIMAL.replace('"1/8"', "-1"): "h = -1 leads away from t = 10",
    MINIMAL.replace('"1/8"', "true"): "h is True; write a number or a quoted fraction like '1/4'",
    MINIMAL.replace('"1/8"', "nan"): "h: 'nan' is not a rational number",
    MINIMAL.replace('"1/8"', "inf"): "h: 'inf' is not a rational number",
    MINIMAL.replace('"1/8"', "1e999999999"): "h: '1e999999999' is too long",
    MINIMAL.replace('"1/8"', "1979-05-27"): "h is datetime.date(1979, 5, 27); write a number",
    MINIMAL.replace('"1/8"', "[1]"): "h is [1]; write a number",
    MINIMAL + "start = [1]": "start has 1 entries, 2 are needed",
    MINIMAL + "start = 1": "start is 1; write a list",
    MINIMAL + 'start = [1, "x"]': "start[1]: 'x' is not a rational number",
    MINIMAL + 'name = "../elsewhere"': "scene '../elsewhere': a name has no folders in it",
    MINIMAL + "name = 5": "name is 5; write a text in quotes",
    MINIMAL + 'name = "two"\nname = "names"': "not TOML: a key is given twice",
    "h = ": "not TOML: Invalid value",
    "x = " + "[" * 20_000: "nested too deeply",
    "x = " + "9" * 5000: "not TOML: Exceeds the limit",
    "#" * (LONGEST_FILE + 1): f"too large; at most {LONGEST_FILE} bytes are read",
}


@pytest.mark.parametrize("text", BAD_FILES, ids=range(len(BAD_FILES)))
def test_bad_file_is_refused_in_one_line_that_names_the_file(text: str, tmp_path: Path) -> None:
    path = written(tmp_path, text)
    with pytest.raises(SceneError) as caught:
        read_scene(path)
    message = str(caught.value)
    assert message.startswith(f"{path}: ")
    assert BAD_FILES[text] in message
    assert "\n" not in message


def test_file_that_cannot_be_read_is_refused_in_one_line(tmp_path: Path) -> None:
    binary = tmp_path / "binary.toml"
    binary.write_bytes(b"\xff\xfe")
    for path, reason in [
        (tmp_path / "none.toml", "No such file"),
        (tmp_path, "directory"),
        (binary, "byte 0 is not UTF-8 text"),
    ]:
        with pytest.raises(SceneError, match=reason):
            read_scene(path)


def test_unknown_scene_names_the_closest() -> None:
    with pytest.raises(SceneError, match="unknown scene 'defualt'; did you mean default"):
        scene_named("defualt")
    with pytest.raises(SceneError, match="compare or default or small_steps or stability_boundary"):
        scene_named("zzz")


def test_scene_is_frozen_and_checked_when_replaced() -> None:
    with pytest.raises(dataclasses.FrozenInstanceError):
        PRESETS["default"].h = Q(1)  # type: ignore[misc]
    with pytest.raises(SceneError, match="does not divide"):
        dataclasses.replace(PRESETS["default"], h=Q(3))
    assert dataclasses.replace(PRESETS["default"], h=Q(1, 8)).steps == 80


def test_default_scene_shows_what_the_lesson_shows() -> None:
    shown = scene_text(PRESETS["default"], show_scene(PRESETS["default"], 15))
    lines = [" ".join(line.split()) for line in shown.splitlines()]
    assert set(LESSON_DEFAULT) <= set(lines)


LESSON_DEFAULT = [
    "Numerical (q, v) (-3.129, 1.229)",
    "Exact (q, v) (-0.839, 0.544)",
    "State error 2.390297",
    "Final energy 5.651029",
    "Energy change 5.151029",
    "Wrapped phase error (degrees) -11.508",
    "Steps 40",
    "Acceleration evaluations 40",
    "Forward Euler 2.390 5.151 40",
    "Symplectic Euler 0.090 -0.054 40",
    "Classical RK4 3.3e-4 -6.7e-5 160",
]


def test_shown_parts_are_those_named() -> None:
    every = {"readouts", "certified", "table"}
    for part, changed in {
        "readouts": {"readouts": ("energy",)},
        "certified": {"certified": ("energy",)},
        "table": {"panels": ("table",), "methods": ("rk4",)},
    }.items():
        scene = Scene("one", "rk4", Q(1, 4), Q(1), **changed)  # type: ignore[arg-type]
        assert set(show_scene(scene, 5)) & every == {part}


def test_overflowing_method_has_its_message_and_the_others_their_numbers() -> None:
    scene = Scene(
        "edge", "rk4", Q(2), Q(2000), methods=("forward_euler", "rk4"), readouts=("energy",), panels=("table",)
    )
    shown = show_scene(scene, 5)
    assert shown["table"]["forward_euler"] == "overflow: the state is no longer finite after step 883"
    assert isinstance(shown["table"]["rk4"], dict)
    assert "overflow: the state is no longer finite after step 883" in scene_text(scene, shown)


def test_no_zero_is_shown_with_a_sign() -> None:
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


def test_enormous_number_is_shown_with_an_exponent() -> None:
    scene = Scene(
        "edge", "forward_euler", Q(2), Q(800), methods=("forward_euler",), readouts=READOUTS, panels=("table",)
    )
    shown = scene_text(scene, show_scene(scene, 5))
    assert max(map(len, shown.splitlines())) < 80
    assert "e+139" in shown


def test_scene_json_holds_strings_that_read_back_to_the_same_bits() -> None:
    scene = Scene("s", "rk4", Q(1, 4), Q(1), readouts=READOUTS, certified=("final_state",))
    shown = show_scene(scene, 20)
    answer = scene_json(scene, shown)
    assert [float(x) for x in answer["readouts"]["final_state"]] == list(shown["readouts"]["final_state"])
    assert [[float(x) for x in row] for row in answer["readouts"]["trajectory"][1]] == shown["readouts"]["trajectory"][
        1
    ].tolist()
    assert answer["certified"]["final_state"]["q"]["decimal"].startswith("0.54")
    undefined = Scene("s", "rk4", Q(1, 4), Q(1), (Q(0), Q(0)), readouts=("phase_error",), certified=("phase_error",))
    shown = show_scene(undefined, 5)
    assert scene_json(undefined, shown)["readouts"] == {"phase_error": None}
    assert scene_text(undefined, shown).count("undefined at the origin") == 2


SceneFile = Callable[[str], str]


@pytest.fixture
def runs_scene(tmp_path: Path) -> SceneFile:
    """runs_scene(text): code that shows the scene of this TOML on the command line, with --figures."""

    def code(text: str) -> str:
        path = written(tmp_path, 'selected = "rk4"\nh = "1/4"\nt = 10\n' + text)
        return f"from driftproof.cli import main; main(['scene', {str(path)!r}, '--figures', {str(tmp_path)!r}])"

    return code


Modules = Callable[[str], set[str]]


def test_scene_never_imports_a_plotting_library(runs_scene: SceneFile, modules_after: Modules) -> None:
    text = 'readouts = ["energy", "trajectory"]\nmethods = ["rk4"]\npanels = ["table", "position", "phase_plane"]'
    assert "matplotlib" not in modules_after(runs_scene(text))


def test_scene_without_exact_readouts_never_imports_sympy(runs_scene: SceneFile, modules_after: Modules) -> None:
    every = 'readouts = ["final_state", "state_error", "energy", "phase_error", "evaluations"]'
    loaded = modules_after(runs_scene(every))
    assert loaded & {"sympy", "flint"} == set()
    assert {"sympy", "flint"} <= modules_after(runs_scene('certified = ["energy"]'))


PEAK = """
import tracemalloc
from fractions import Fraction
from driftproof.numeric.run import run_method
from driftproof.numeric.scenes import Scene
scene = Scene("s", "forward_euler", Fraction(1, 10**6), Fraction(1, 10), readouts=({asked!r},))
tracemalloc.start()
run_method(scene, "forward_euler")
print(tracemalloc.get_traced_memory()[1])
"""


def test_scene_without_a_trajectory_keeps_none(fresh_python: Callable[[str], str]) -> None:
    """100 000 states of two floats take megabytes; the run itself takes almost nothing."""
    peak = {asked: int(fresh_python(PEAK.format(asked=asked))) for asked in ("final_state", "trajectory")}
    assert peak["final_state"] < 10**5 < 10**6 < peak["trajectory"]


def test_certified_scene_is_answered_without_any_float_run(monkeypatch: pytest.MonkeyPatch) -> None:
    from driftproof.reports import scene_view

    def forbidden(*_: Any) -> Any:
        raise AssertionError("a float run was made")

    monkeypatch.setattr(scene_view, "run_method", forbidden)
    scene = Scene("s", "rk4", Q(1, 4), Q(10), certified=("state_error",))
    assert show_scene(scene, 5)["certified"]["state_error"]["decimal"] == "0.00032531"
    with pytest.raises(AssertionError, match="float run"):
        show_scene(dataclasses.replace(scene, readouts=("energy",)), 5)
