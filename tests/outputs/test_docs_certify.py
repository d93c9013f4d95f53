"""docs/certify.md is true: its commands and sessions are run, its pictures drawn again, its tests pass and fail."""

import re
from pathlib import Path

import pytest

from docs.pages import refreshed
from tests.looping import exactly

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "certify.md").read_text(encoding="utf-8")
FIRST_LINES = re.search(r"```python no-session\n(.*?)```", PAGE, re.DOTALL)


@pytest.mark.slow
def test_page_and_pictures_are_what_their_commands_make_and_a_wrong_number_is_put_right(monkeypatch):
    monkeypatch.chdir(ROOT)
    pictures = [ROOT / "docs" / name for name in re.findall(r"!\[[^]]*\]\(([\w.]+)\)", PAGE)]
    before = [path.read_bytes() for path in exactly(2, pictures)]
    wrong = PAGE.replace("truncation 9.299099762e-7", "truncation 9.299099763e-7")
    assert wrong != PAGE
    assert refreshed(wrong, {}) == PAGE, "run `make docs`"
    assert [path.read_bytes() for path in pictures] == before, "run `make docs`"


def test_the_first_test_of_the_page_passes_and_the_second_fails():
    pytest.importorskip("scipy.integrate")
    names = {}
    exec(compile(FIRST_LINES[1], "docs/certify.md", "exec"), names)
    names["test_the_pendulum_is_right_to_nine_digits"]()
    with pytest.raises(AssertionError, match=r"off by 0\.\d+, more than 1e-09: .* \(proved\)\nrtol = 0\.001 allows"):
        names["test_the_default_tolerances_are_too_coarse_for_that"]()
