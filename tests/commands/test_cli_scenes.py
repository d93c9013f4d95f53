"""`driftproof methods`, `scenes` and `scene`: nothing left out of a list; a scene shows its numbers and figures."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

from driftproof.methods.catalogue import METHODS
from driftproof.methods.families import FAMILIES

Answer = Callable[..., str]


def test_lists_name_every_method_and_every_scene(answer: Answer) -> None:
    methods, scenes = answer("methods").splitlines(), answer("scenes").splitlines()
    assert methods[0].split() == ["method", "family", "order", "title", "source"]
    assert [line.split()[0] for line in methods[1:]] == [*METHODS, *FAMILIES]
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


def test_scene_that_outlasts_the_float_range_says_so_where_its_numbers_would_be(answer: Answer, tmp_path: Path) -> None:
    path = tmp_path / "far.toml"
    path.write_text('selected = "forward_euler"\nh = 2\nt = 4000\nreadouts = ["energy"]\n', encoding="utf-8")
    assert "overflow: the state is no longer finite after step 883" in answer("scene", str(path))
