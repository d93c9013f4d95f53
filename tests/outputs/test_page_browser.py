"""The page as readers see it, in a real browser: silent, self-contained, legible at any width, selectable, to scale."""

import re
from itertools import combinations

import pytest

from driftproof.numeric.scenes import PRESETS
from driftproof.reports.page.document import document
from tests.browser import CONTRAST, CONTRASTS, SHEET, SHEET_WIDTH, SMALL_TEXT, SMALLEST_TEXT, opened, overflow, started
from tests.looping import some

MARK_CONTRAST = 3  # WCAG 2.2, 1.4.11
# Of two scenes with three methods each: two figures a method, one of work, two of growth.
FIGURES = 2 * 3 * 2 + 1 + 2


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    path = tmp_path_factory.mktemp("page") / "report.html"
    path.write_text(document([PRESETS["default"], PRESETS["stability_boundary"]]), encoding="utf-8")
    return path


UNTITLED = """() => [...document.querySelectorAll("figure")].filter(figure => {
    const drawn = figure.querySelector(":scope > svg[role=img]")
    const words = key => document.getElementById(drawn?.getAttribute(key))?.textContent ?? ""
    const cells = figure.querySelectorAll("details table tbody td").length
    const heading = document.getElementById(figure.getAttribute("aria-labelledby"))?.textContent ?? ""
    return !drawn || !heading || !words("aria-labelledby") || words("aria-describedby").length < 40 || cells < 10
}).map(figure => figure.id || figure.outerHTML.slice(0, 60))"""

TEXTS = "h1, h2, h3, h4, p, label, dt, dd, li, summary, caption, th, td, i"
MARKS = "svg .path, svg .dots, svg .own, svg .exact.end, svg .axis"


def faint(page):
    """What is too faint: text, text of pictures, marks of pictures. Fails where it finds nothing to look at."""
    complaints = []
    for selector, key, least in [
        (TEXTS, "color", CONTRAST),
        ("svg text", "fill", CONTRAST),
        (MARKS, "stroke", MARK_CONTRAST),
        ("svg .samples.end", "fill", MARK_CONTRAST),
    ]:
        count, found = page.evaluate(CONTRASTS, [selector, key, least])
        assert count > 1
        complaints += found
    return complaints


def shown_figures(page):
    """The ids of the figures that can be seen."""
    return [figure.get_attribute("id") or "" for figure in page.locator("figure:visible").all()]


@pytest.mark.slow(keep=1)
@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("width", [360, 1200])
def test_page_is_silent_and_legible_everywhere(chromium, page, width, scheme):
    """No complaint, no request; nothing wider than the window, however it is; no small and no faint text."""
    with opened(chromium, page, width=width, scheme=scheme) as shown:
        assert shown.requests == [shown.address]
        assert shown.complaints == []
        for label in shown.page.locator("main > .choice > label").all():
            label.click()
            for folded in shown.page.locator("details:visible > summary").all():
                folded.click()
            assert overflow(shown.page) == 0
            assert shown.page.evaluate(SMALL_TEXT, SMALLEST_TEXT) == []
            assert faint(shown.page) == []
        assert shown.complaints == []


@pytest.mark.slow
def test_every_figure_is_titled_described_and_has_its_numbers(chromium, page):
    with opened(chromium, page) as shown:
        assert shown.page.locator("figure").count() == FIGURES
        assert shown.page.evaluate(UNTITLED) == []
        assert shown.page.get_by_role("img", name="Phase plane: Forward Euler").count() == 1


@pytest.mark.slow
@pytest.mark.parametrize("script", [True, False])
def test_scene_and_method_are_selected_with_and_without_script(chromium, page, script):
    with opened(chromium, page, script=script) as shown:
        own = ["scene-1-work", "scene-1-growth"]
        euler = ["scene-1-forward_euler-position", "scene-1-forward_euler-phase_plane"]
        assert shown_figures(shown.page) == euler + own
        shown.page.locator("label:visible", has_text="Classical RK4").click()
        assert shown_figures(shown.page) == [name.replace("forward_euler", "rk4") for name in euler] + own
        shown.page.locator("label:visible", has_text="Stability boundary").click()
        boundary = [f"scene-2-symplectic_euler-{panel}" for panel in ("position", "phase_plane")]
        assert shown_figures(shown.page) == [*boundary, "scene-2-growth"]


@pytest.mark.slow
def test_selection_works_from_the_keyboard(chromium, page):
    with opened(chromium, page) as shown:
        shown.page.keyboard.press("Tab")
        shown.page.keyboard.press("ArrowRight")
        assert shown_figures(shown.page)[0] == "scene-2-symplectic_euler-position"
        outline = "label => getComputedStyle(label).outlineStyle"
        assert shown.page.locator("label", has_text="Stability boundary").evaluate(outline) == "solid"


@pytest.mark.slow
def test_print_shows_every_scene_and_every_method_and_the_schemes_differ(chromium, page):
    with opened(chromium, page) as shown:
        colour = "getComputedStyle(document.body).color"
        light = shown.page.evaluate(colour)
        shown.page.emulate_media(color_scheme="dark")
        assert shown.page.evaluate(colour) != light
        shown.page.emulate_media(media="print", color_scheme="light")
        assert len(shown_figures(shown.page)) == FIGURES
        assert shown.page.locator("label:visible").count() == 0


BOXES = """() => [...document.querySelectorAll("figure.square")].filter(f => f.checkVisibility()).map(figure => {
    const box = element => element.getBoundingClientRect()
    const lines = [...figure.querySelectorAll("svg .grid, svg .axis")].map(box)
    const circle = box(figure.querySelector("svg circle.exact.path"))
    return {
        x: lines.filter(b => b.width < b.height).map(b => b.x), y: lines.filter(b => b.width > b.height).map(b => b.y),
        xlabels: [...figure.querySelectorAll("svg .tick.x")].map(e => e.textContent),
        ylabels: [...figure.querySelectorAll("svg .tick.y")].map(e => e.textContent),
        width: circle.width, height: circle.height, frame: box(figure.querySelector(":scope > svg")).width,
    }
})"""


@pytest.mark.slow
@pytest.mark.parametrize("width", [360, 1200])
def test_phase_planes_have_equal_scales_as_they_are_rendered(chromium, page, width):
    """Between the same ticks there are as many pixels across as up, and the exact circle is as wide as it is high."""
    with opened(chromium, page, width=width) as shown:
        boxes = []
        for label in shown.page.locator("main > .choice > label").all():
            label.click()
            boxes += shown.page.evaluate(BOXES)
        assert len(boxes) == 2
        for box in boxes:
            # Places are rounded to hundredths of a unit of a picture 330 units wide, layout to 1/64 of a pixel.
            slack = 0.02 * box["frame"] / 330 + 1 / 32
            assert box["xlabels"] == box["ylabels"]
            assert len(box["x"]) == len(box["y"]) == len(box["xlabels"]) >= 3
            for i, k in combinations(range(len(box["x"])), 2):
                assert abs((box["x"][k] - box["x"][i]) - (box["y"][i] - box["y"][k])) <= slack
            assert abs(box["width"] - box["height"]) <= slack
            assert box["width"] > 10


BROKEN = {
    "a request": '<img src="http://127.0.0.1:9/x.png">',
    "a font": "<style>@font-face { font-family: F; src: url(http://127.0.0.1:9/f) } p { font: 1rem F }</style><p>x</p>",
    "an error": "<script>nowhere()</script>",
    "a warning": "<script>console.warn('old')</script>",
}


@pytest.mark.slow
def test_page_that_asks_or_complains_is_found(chromium, tmp_path):
    path = tmp_path / "broken.html"
    for what in BROKEN.values():
        path.write_text(f"<!DOCTYPE html><title>b</title>{what}", encoding="utf-8")
        with opened(chromium, path) as shown:
            assert shown.complaints


def test_the_page_s_own_policy_blocks_what_is_smuggled_in(chromium, page, tmp_path):
    """A script in the page does not run, and an image is not loaded: the browser says so instead."""
    path = tmp_path / "smuggled.html"
    smuggled = '<script>document.title = "run"</script><img src="http://127.0.0.1:9/x.png"></body>'
    path.write_text(page.read_text(encoding="utf-8").replace("</body>", smuggled), encoding="utf-8")
    with opened(chromium, path) as shown:
        assert shown.page.title() != "run"
        assert len([message for message in shown.console if "violates" in message and "'none'" in message]) == 1
        assert len([message for message in shown.console if "violates" in message and "img-src" in message]) == 1


@pytest.mark.slow
def test_figure_that_is_spoiled_is_found(chromium, page):
    """Each check is tried out on the page itself, with one thing taken away or made worse."""
    spoilers = [
        "document.querySelector('figure > svg > title').textContent = ''",
        "document.querySelector('figure > svg > desc').remove()",
        "document.querySelector('figure details').remove()",
        "document.querySelector('figure').removeAttribute('aria-labelledby')",
    ]
    with opened(chromium, page) as shown:
        for spoiler in spoilers:
            shown.page.reload()
            shown.page.evaluate(spoiler)
            assert shown.page.evaluate(UNTITLED) == ["scene-1-forward_euler-position"]
        shown.page.reload()
        shown.page.add_style_tag(content=".note { color: #888 } figure.wide svg text { font-size: 3px }")
        assert any("note" in complaint for complaint in faint(shown.page))
        assert "time t" in shown.page.evaluate(SMALL_TEXT, SMALLEST_TEXT)
        shown.page.add_style_tag(content=".scroll { overflow: visible; min-width: 1500px; max-width: none }")
        assert overflow(shown.page) > 0
        shown.page.add_style_tag(content="figure.square > svg { transform: scaleY(0.9) }")
        (box,) = shown.page.evaluate(BOXES)
        assert abs(box["width"] - box["height"]) > 5


def test_missing_browser_skips_and_fails_where_it_is_required(monkeypatch):
    monkeypatch.setattr("tests.browser.shutil.which", lambda _: None)
    monkeypatch.delenv("DRIFTPROOF_BROWSER", raising=False)
    with pytest.raises(pytest.skip.Exception, match="no Chromium"), started():
        pass
    monkeypatch.setenv("DRIFTPROOF_BROWSER", "required")
    with pytest.raises(pytest.fail.Exception, match="no Chromium"), started():
        pass


@pytest.mark.slow
def test_all_presets_print_on_at_most_twelve_pages_without_a_split_box(chromium, tmp_path):
    path = tmp_path / "all.html"
    path.write_text(document([*PRESETS.values()]), encoding="utf-8")
    with opened(chromium, path, width=SHEET_WIDTH) as shown:
        pages = re.findall(rb"/Type\s*/Page[^s]", shown.page.pdf(prefer_css_page_size=True))
        shown.page.emulate_media(media="print")
        inside = "box => [getComputedStyle(box).breakInside, box.offsetHeight]"
        boxes = [shown.page.locator(kind).evaluate_all(f"all => all.map({inside})") for kind in ("figure", "dl", "tr")]
        cut = shown.page.locator(".scroll:visible").evaluate_all(
            "all => all.map(box => box.scrollWidth - box.clientWidth)"
        )
    assert 4 <= len(pages) <= 12
    assert max(some(cut, 8)) <= 0
    for kept, height in some([box for kind in boxes for box in kind if box[1]], 40):
        assert (kept, height < SHEET) == ("avoid", True)
