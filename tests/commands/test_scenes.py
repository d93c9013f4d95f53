"""`driftproof scenes`, `scene`, `sweep` and `report`: the list, a scene's numbers and figures, refusals in one line."""

import json

import pytest


def test_list_names_every_scene(answer):
    assert [line.split() for line in answer("scenes").splitlines()[1:]] == [
        ["default", "forward_euler", "1/4", "10", "40"],
        ["small_steps", "forward_euler", "1/10", "10", "100"],
        ["compare", "forward_euler", "1/2", "10", "20"],
        ["stability_boundary", "symplectic_euler", "2", "10", "5"],
    ]


def test_scene_shows_the_state_after_the_boundary_run(answer):
    found = json.loads(answer("scene", "stability_boundary", "--format", "json"))
    assert found["readouts"]["final_state"] == ["-11.0", "-10.0"]


def test_scene_figures_are_written_where_asked(answer, tmp_path):
    folder = tmp_path / "new" / "folder"
    assert answer("scene", "compare", "--figures", str(folder)).endswith(f"wrote {folder}/compare_phase_plane.svg\n")
    assert len(list(folder.iterdir())) == 2


def test_scene_that_outlasts_the_float_range_says_so_where_its_numbers_would_be(answer, tmp_path):
    path = tmp_path / "far.toml"
    path.write_text('selected = "forward_euler"\nh = 2\nt = 4000\nreadouts = ["energy"]\n', encoding="utf-8")
    assert "overflow: the state is no longer finite after step 883" in answer("scene", str(path))


def test_sweep_has_a_point_for_each_combination_whoever_works(answer):
    words = (
        "sweep",
        "default",
        "--methods",
        "rk4,heun2",
        "--h",
        "1/4",
        "--h",
        "1/8",
        "--state",
        "0,1",
        "--format",
        "json",
    )
    found = answer(*words)
    assert [(p["selected"], p["h"]) for p in json.loads(found)["points"]] == [
        (method, h) for method in ("rk4", "heun2") for h in ("1/4", "1/8")
    ]
    assert answer(*words, "--workers", "2") == found


def test_report_says_where_it_is(answer, tmp_path):
    page = tmp_path / "page.html"
    assert answer("report", "default", "-o", str(page)) == f"wrote {page}\n"
    assert page.read_text(encoding="utf-8").startswith("<!DOCTYPE html>")


REFUSED = {
    ("scene", "defualt"): "unknown scene 'defualt'; did you mean default?",
    ("scene", "none.toml"): "none.toml: No such file or directory",
    ("scene",): "required: name",
    ("scene", "default", "--figures", "pyproject.toml"): "pyproject.toml is a file; name a folder",
    ("sweep", "default", "--workers", "0"): "'0' is not a number of processes from 1 to 1024",
    ("sweep", "default", "--workers", "1", "--cluster", "tcp://x:1"): "not allowed with argument --workers",
    ("report", "default", "-o", "/proc/page.html"): "/proc/page.html: No such file or directory",
    ("report", "default", "-o", "tests"): "tests is a folder; name a file in it",
    ("report", "default"): "required: -o/--output",
}


@pytest.mark.parametrize("words", REFUSED, ids=range(len(REFUSED)))
def test_refusal_is_one_line(words, refusal):
    assert REFUSED[words] in refusal(*words)
