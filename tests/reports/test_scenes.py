"""A scene from Python: numbers, figures where asked."""

from driftproof import scene


def test_a_scene_has_its_numbers_as_numbers(tmp_path):
    shown = scene("stability_boundary", figures=tmp_path)
    assert shown.found["readouts"]["final_state"] == (-11.0, -10.0)
    assert shown["readouts"]["final_state"] == ["-11.0", "-10.0"]
    assert all(f"wrote {path}" in str(shown) for path in sorted(tmp_path.iterdir()))
