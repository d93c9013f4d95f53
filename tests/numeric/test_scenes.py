"""Scenes: the presets, a user's TOML with its errors, and that nothing is paid for that a scene does not name."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction as Q
from pathlib import Path

import pytest
from hypothesis import given

from driftproof.methods.catalogue import METHODS
from driftproof.numeric.problems.catalogue import PROBLEMS
from driftproof.numeric.scenes import (
    LARGEST_LESSON_H,
    PRESETS,
    Scene,
    SceneError,
    read_scene,
)
from driftproof.reports.scenes import scene_given
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
        "default": ("forward_euler", Q(1, 4), 10, 40), "small_steps": ("forward_euler", Q(1, 10), 10, 100),
        "compare": ("forward_euler", Q(1, 2), 10, 20), "stability_boundary": ("symplectic_euler", 2, 10, 5),
    }  # fmt: skip
    assert all(scene.methods == ("forward_euler", "symplectic_euler", "rk4") for scene in PRESETS.values())
    assert all(0 < scene.h <= LARGEST_LESSON_H == Q(5, 2) for scene in PRESETS.values())
    assert all(name == scene.name and scene.start == (1, 0) for name, scene in PRESETS.items())


def test_minimal_file_means_the_lesson_start_and_the_file_name(tmp_path: Path) -> None:
    scene = read_scene(written(tmp_path, MINIMAL))
    assert scene == Scene("mine", "rk4", Q(1, 8), Q(10), readouts=("energy",))
    assert scene.steps == 80


def test_methods_of_your_own_have_names_and_tell_scenes_apart(tmp_path: Path) -> None:
    own = [replace(METHODS[key], key="mine") for key in ("heun2", "midpoint2")]
    scenes = [Scene("x", "mine", Q(1, 4), Q(10), readouts=("energy",), own=(("mine", each),)) for each in own]
    assert [scene.method("mine") for scene in scenes] == own
    assert scenes[0] != scenes[1]
    with pytest.raises(SceneError, match="a scene has no key 'own'"):
        read_scene(written(tmp_path, MINIMAL + "own = []"))


def test_full_file_is_read_as_written(tmp_path: Path) -> None:
    text = MINIMAL + (
        'name = "all of it"\nstart = [0.1, "-1/3"]\nmethods = ["rk4", "heun2"]\npanels = ["table", "position"]\n'
    )
    scene = scene_given(str(written(tmp_path, text)))
    assert (scene.name, scene.start) == ("all of it", (Q(1, 10), Q(-1, 3)))
    assert (scene.methods, scene.panels) == (("rk4", "heun2"), ("table", "position"))


def test_a_file_that_names_a_problem_is_of_that_to_its_end(tmp_path: Path) -> None:
    text = MINIMAL.replace("t = 10", 'problem = "kepler"')
    assert (read_scene(path := written(tmp_path, text)).problem, scene_given(path).t) == (PROBLEMS["kepler"], Q(20))
    for more, said in (
        ('panels = ["stability"]', "has no panel stability; choose from table"),
        ('readouts = ["energy", "phase_error"]', "has no readout phase_error; choose from final_state"),
    ):
        with pytest.raises(SceneError, match=f"the problem kepler {said}"):
            read_scene(written(tmp_path, text.replace(ASKED, more)))


@given(h=rationals(max_denominator=10**6).filter(bool))
def test_decimals_and_fractions_in_a_file_are_exact(h: Q, tmp_path_factory: pytest.TempPathFactory) -> None:
    folder = tmp_path_factory.mktemp("scene")
    text = f'selected = "rk4"\nh = "{h}"\nt = "{7 * h}"\n{ASKED}'
    assert (read_scene(written(folder, text)).h, read_scene(written(folder, text)).steps) == (h, 7)


BAD_FILES = {
    "h = 1\nt = 1\n" + ASKED: "'selected' is missing", 'selected = "rk4"\nt = 1\n' + ASKED: "'h' is missing",
    'selected = "rk4"\nh = 1\n' + ASKED: "'t' is missing",
    'selected = "rk4"\nh = 1\nt = 1\n': "scene 'mine' computes nothing; give readouts or panels",
    MINIMAL + "colour = 1": "a scene has no key 'colour'; its keys are name, selected, h, t, start",
    'selected = "rk5"\nh = 1\nt = 1\n' + ASKED: "scene 'mine': unknown method 'rk5'; did you mean rk4 or ",
    MINIMAL + 'methods = ["rk4", "oiler"]': "unknown method 'oiler' (`driftproof methods`",
    MINIMAL + 'methods = "rk4"': "methods is 'rk4'; write a list",
    MINIMAL + "methods = [1]": "methods[0] is 1; write text in quotes",
    MINIMAL + 'panels = ["pie"]': "unknown panel 'pie'; choose from table, position, phase_plane",
    MINIMAL + 'panels = ["table"]': "has the panel table, but no methods to compare; give methods",
    MINIMAL.replace("energy", "enegry"): "unknown readout 'enegry'; did you mean energy",
    MINIMAL.replace("rk4", "__import__('os')"): "unknown method \"__import__('os')\"",
    MINIMAL.replace('"1/8"', '"__import__(1)"'): "h: '__import__(1)' is not a rational number",
    MINIMAL.replace('"1/8"', "0"): "h = 0 never reaches t = 10",
    MINIMAL.replace('"1/8"', "0.3"): "h = 3/10 does not divide t = 10 (t / h = 100/3); nearest that do: 10/33 and 5/17",
    MINIMAL.replace('"1/8"', "-1"): "h = -1 leads away from t = 10",
    MINIMAL.replace('"1/8"', "nan"): "h: 'nan' is not a rational number",
    MINIMAL.replace('"1/8"', "1979-05-27"): "h is datetime.date(1979, 5, 27); write a number",
    MINIMAL + "start = [1]": "start has 1 entries, 2 are needed",
    MINIMAL + 'start = [1, "x"]': "start[1]: 'x' is not a rational number",
    MINIMAL + 'name = "../elsewhere"': "scene '../elsewhere': the name must not contain a folder",
    MINIMAL + 'name = "two"\nname = "names"': "not TOML: a key is given twice",
    "#" * 65_537: "too large; at most 65536 bytes are read",
}  # fmt: skip


@pytest.mark.parametrize("text", BAD_FILES, ids=range(len(BAD_FILES)))
def test_bad_file_is_refused_in_one_line_that_names_the_file(text: str, tmp_path: Path) -> None:
    path = written(tmp_path, text)
    with pytest.raises(SceneError) as caught:
        read_scene(path)
    message = str(caught.value)
    assert message.startswith(f"{path}: ")
    assert BAD_FILES[text] in message
    assert "\n" not in message


def test_unknown_scene_names_the_closest() -> None:
    for wrong, near in (("defualt", "default"), ("stability_compare", "stability_boundary")):
        with pytest.raises(SceneError, match=rf"unknown scene '{wrong}'; did you mean {near}\b"):
            scene_given(wrong)
    with pytest.raises(SceneError, match=r"unknown scene 'zzz' \(`driftproof scene` lists them"):
        scene_given("zzz")
