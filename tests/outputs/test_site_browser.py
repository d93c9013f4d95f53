"""The site, and results in a notebook, as readers see them in a real browser: legible at any width and on paper."""

import os
import subprocess
from pathlib import Path

import numpy as np
import pytest

import driftproof
from tests.browser import CONTRAST, CONTRASTS, SHEET_WIDTH, SMALL_TEXT, SMALLEST_TEXT, opened, overflow
from tests.looping import exactly, some

ROOT = Path(__file__).parents[2]
PYTHON = ROOT / "build" / "site-environment" / "bin" / "python"
WAYS = [(width, scheme, "screen") for width in (360, 1200) for scheme in ("light", "dark")]
WAYS += [(SHEET_WIDTH, "light", "print")]
# A logo without words of its own is a link of another colour.
TEXTS = "h1, h2, h3, h4, p, li, dt, dd, th, td, a:not(.logo), code, pre, pre span, summary, caption"
# Boxes that would show on paper only their left part.
CUT = """[...document.querySelectorAll("pre, .pst-scrollable-table-container, .out")]
    .filter(box => box.scrollWidth > box.clientWidth + 1).map(box => box.textContent.trim().slice(0, 40))"""


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    if not PYTHON.exists():
        missing = "`make site` has not made its environment"
        (pytest.fail if os.environ.get("DRIFTPROOF_BROWSER") == "required" else pytest.skip)(missing)
    folder = tmp_path_factory.mktemp("site")
    build = [PYTHON, "-m", "sphinx", "--fail-on-warning", "--keep-going", "--quiet", "-b", "html", "docs", folder]
    done = subprocess.run(build, cwd=ROOT, capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, "")
    return folder


def faults(shown, media):
    """What a reader would miss: text beyond the window or the sheet, faint or small text, an error in the console."""
    shown.page.emulate_media(media=media)
    frames = exactly(len(shown.page.frames), shown.page.frames)
    seen = [frame.evaluate(CONTRASTS, [TEXTS, "color", CONTRAST]) for frame in frames]
    assert min(count for count, _ in seen) > 20
    small = [] if media == "print" else [text for frame in frames for text in frame.evaluate(SMALL_TEXT, SMALLEST_TEXT)]
    said = [line for line in shown.console + shown.errors if not line.startswith("log: ")]
    asked = [address for address in shown.requests if not address.startswith(("file:", "about:"))]
    wide = [width for frame in frames if (width := overflow(frame))]
    cut = shown.page.evaluate(CUT) if media == "print" else []
    return [fault for faint in seen for fault in faint[1]] + small + said + asked + wide + cut


@pytest.mark.slow
@pytest.mark.parametrize("name", ["index", "tutorials/engineer", "tutorials/choosing", "texts", "api", "gallery"])
def test_a_page_of_the_site_is_legible_everywhere(name, chromium, site):
    for width, scheme, media in exactly(5, WAYS):
        with opened(chromium, site / f"{name}.html", width=width, scheme=scheme) as shown:
            assert faults(shown, media) == [], (width, scheme, media)


@pytest.mark.slow
def test_a_spoiled_page_is_noticed(chromium, site):
    with opened(chromium, site / "api.html", width=SHEET_WIDTH) as shown:
        for spoiled in some(
            (".bd-article p { color: #aaa }", "pre { white-space: pre !important }", "p { width: 900px }")
        ):
            shown.page.reload()
            shown.page.add_style_tag(content=spoiled)
            assert faults(shown, "print"), spoiled


# What JupyterLab says of outputs, in its two themes.
NOTEBOOK = """<!DOCTYPE html><html><head><meta charset="utf-8"><meta name="color-scheme" content="light dark"><style>
body { background: Canvas; color: CanvasText; font: 14px sans-serif } .out { overflow-x: auto }
table { border-collapse: collapse; font-size: 12px } th, td { padding: 0.5em; text-align: right }
p { margin: 0 0 1em } pre { margin: 0; font-family: inherit }</style></head><body>"""


@pytest.mark.slow
def test_results_in_a_notebook_are_legible_everywhere(chromium, tmp_path):
    t = np.arange(9) / 4
    results = [
        driftproof.facts("rk4"),
        driftproof.run("rk4", "1/4", 10),
        driftproof.roundoff("rk4", "1/4"),
        driftproof.scene("default"),
        driftproof.stability("stiff_oscillator", "rk4,backward Euler"),
        driftproof.certify("y1; -y0", t, np.stack([np.cos(t), -np.sin(t)], 1)),
        driftproof.verify(lambda q, v, h: (q + h * v, v - h * q), "rk4", isolate=False, examples=5),
        driftproof.report({"rates": ["y1", "-sin(y0)"], "start": [2, 0], "end": 1}, methods="rk4"),
    ]
    outputs = [f'<div class="out">{result._repr_html_()}</div>' for result in exactly(8, results)]
    (tmp_path / "notebook.html").write_text(NOTEBOOK + "".join(outputs), encoding="utf-8")
    for width, scheme, media in exactly(5, WAYS):
        with opened(chromium, tmp_path / "notebook.html", width=width, scheme=scheme) as shown:
            assert len(shown.page.frames) == 2
            assert faults(shown, media) == [], (width, scheme, media)
