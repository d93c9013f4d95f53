"""A scene from Python: numbers, figures where asked."""

from dataclasses import replace
from fractions import Fraction as Q

import pytest

from driftproof import METHODS, read_method, report, scene, sweep
from tests.looping import some


def test_a_scene_has_its_numbers_as_numbers(tmp_path):
    shown = scene("stability_boundary", figures=(folder := tmp_path / "new" / "folder"))
    assert shown.found["readouts"]["final_state"] == (-11.0, -10.0)
    assert shown["readouts"]["final_state"] == ["-11.0", "-10.0"]
    assert all(f"wrote {path}" in str(shown) for path in some(folder.iterdir()))


def test_without_a_name_the_presets_are_listed_numbers_to_the_right():
    _, *lines = str(scene()).splitlines()
    assert [line.split() for line in lines] == [
        ["default", "forward_euler", "1/4", "10", "40"],
        ["small_steps", "forward_euler", "1/10", "10", "100"],
        ["compare", "forward_euler", "1/2", "10", "20"],
        ["stability_boundary", "symplectic_euler", "2", "10", "5"],
    ]
    assert len({(line.rindex(" 10 "), len(line)) for line in lines}) == 1
    assert len({line.index(f" {line.split()[2]} ") + len(line.split()[2]) for line in lines}) == 1


OWN = 'rates = ["y1", "-y0"]\nstart = ["1", "0"]\nend = "10"\nenergy = "(y0^2 + y1^2)/2"\n'
ABOUT = 'selected = "rk4"\nh = "1/4"\nreadouts = ["state_error", "energy_change", "evaluations"]\n'


def test_a_scene_and_a_sweep_of_ones_own_problem_are_those_of_the_oscillator_that_it_is(tmp_path):
    (tmp_path / "own.toml").write_text(OWN)
    path = tmp_path / "mine.toml"
    path.write_text(f'problem = "{tmp_path}/own.toml"\n{ABOUT}methods = ["rk4", "gauss4"]\npanels = ["table"]')
    shown, lesson = scene(path).found, sweep("default", methods="rk4", h=["1/4", "1/8"]).found
    swept = sweep(path, h=["1/4", "1/8"], output=tmp_path / "kept.jsonl").found
    for found, known in some(zip([x.found for x in swept], [x.found for x in lesson], strict=True)):
        # The oscillator's readouts round some ten times, the problem's once.
        assert found["state_error"] == pytest.approx(known["state_error"], rel=1e-9)
        assert found["energy_change"] == pytest.approx(known["energy_change"], rel=1e-9)
        assert found["evaluations"] == known["evaluations"]
    assert shown["readouts"] == swept[0].found
    assert all(word in str(scene(path)) for word in ("own.toml", "Gauss"))
    (tmp_path / "own.toml").write_text(OWN.replace("-y0", "-2*y0").replace("y0^2 +", "2*y0^2 +"))
    with pytest.raises(ValueError, match="belongs to another sweep"):
        sweep(path, h=["1/4", "1/8"], output=tmp_path / "kept.jsonl")
    with pytest.raises(ValueError, match="the problem fixes the start"):
        sweep(path, state=[(0, 1)])


def test_a_problem_itself_is_swept_to_its_end(tmp_path):
    own = tmp_path / "own.toml"
    own.write_text(OWN)
    for problem in (own, str(own), {"rates": ["y1", "-y0"], "start": [1, 0], "end": 10}):
        found = sweep(problem, methods=["rk4", "heun2"], h=["1/2", "1/4"]).found
        assert [point.values["h"] for point in found] == [Q(1, 2), Q(1, 4)] * 2
        known = sweep("default", methods=["rk4", "heun2"], h=["1/2", "1/4"]).found
        for ours, theirs in zip(found, known, strict=True):
            assert ours.found["state_error"] == pytest.approx(theirs.found["state_error"], rel=1e-9)
            assert ("energy_change" in ours.found) is not isinstance(problem, dict)
    for lacks in ({}, {"methods": "rk4"}, {"h": "1/10"}):
        with pytest.raises(ValueError, match="pendulum is a problem; a sweep of it needs methods and h, such as"):
            sweep("pendulum", **lacks)


def test_a_page_of_a_scene_on_a_problem_shows_the_problem_and_a_problem_is_no_scene(tmp_path):
    path = tmp_path / "mine.toml"
    path.write_text('problem = "dahlquist_1"\nselected = "rk4"\nh = 0.1\nmethods = ["rk4"]\npanels = ["table"]')
    assert report(path).scenes == report("dahlquist_1", methods="rk4").scenes
    path.write_text('rates = ["-y"]\nstart = 1\nend = 1')
    with pytest.raises(ValueError, match="it is a problem; write a scene with problem = "):
        scene(path)


def test_a_method_that_does_not_apply_says_so_in_its_row(tmp_path):
    path = tmp_path / "mine.toml"
    path.write_text(
        'problem = "robertson"\nselected = "rk4"\nh = 100000000000\nmethods = ["velocity_verlet"]\npanels = ["table"]'
    )
    assert "a second-order system has as many velocities as positions" in str(scene(path))


def test_scenes_and_sweeps_take_methods_that_are_objects(tmp_path):
    """A method from a file, and one with the key of another, beside one of the catalogue; also in other processes."""
    (tmp_path / "own.toml").write_text('family = "runge_kutta"\nA = [[0, 0], ["1/2", 0]]\nb = [0, 1]\n')
    own, mine = read_method(tmp_path / "own.toml"), replace(METHODS["heun2"], title="Mine")
    table = scene("default", methods=[own, mine, "midpoint2"]).found["table"]
    assert list(table) == ["own", "heun2 of your own", "midpoint2"]
    assert table["own"] == table["midpoint2"]
    asked = {"methods": [own, mine, "midpoint2"], "h": "1/4", "output": tmp_path / "kept.jsonl"}
    found = [sweep("default", **asked, workers=workers).found for workers in (1, 2)]  # the second is read from the file
    errors = {answer.values["selected"]: answer.found["state_error"] for answer in found[0]}
    assert errors["own"] == errors["midpoint2"]
    assert found[0] == found[1]
    assert [each["selected"] for each in sweep("pendulum", methods=own, h="1/4").data["points"]] == ["own"]
