"""The example of a web lesson in Chromium: numbers, remarks by pointer and by key, both schemes, 360 px, errors."""

import threading
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

import pytest

from driftproof.texts.values.published import VALUE_FORMATS, published_values
from tests.browser import opened, started

EXAMPLE = Path(__file__).parents[2] / "examples" / "web" / "index.html"


class Silent(SimpleHTTPRequestHandler):
    """Serves files and writes no log."""

    def log_message(self, *_):
        """Nothing."""


@pytest.fixture(scope="module")
def chromium():
    with started() as browser:
        yield browser


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    """The address of a folder made as index.html says."""
    folder = tmp_path_factory.mktemp("site")
    (folder / "index.html").write_bytes(EXAMPLE.read_bytes())
    for name, form in (("driftproof.mjs", "js"), ("values.json", "json")):
        (folder / name).write_text(VALUE_FORMATS[form](published_values()), encoding="utf-8")
    with ThreadingHTTPServer(("127.0.0.1", 0), partial(Silent, directory=str(folder))) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        yield f"http://127.0.0.1:{server.server_port}/"
        server.shutdown()


@pytest.fixture(params=[(1200, "light"), (360, "light"), (360, "dark")], ids=["wide", "narrow", "dark"])
def shown(request, chromium, site):
    with opened(chromium, site, width=request.param[0], scheme=request.param[1]) as shown:
        yield ready(shown)


@pytest.fixture
def plain(chromium, site):
    with opened(chromium, site) as shown:
        yield ready(shown)


def ready(shown):
    shown.page.wait_for_function("document.querySelector('#energy').textContent")
    return shown


@pytest.mark.slow(keep=1)
def test_numbers_are_shown_and_say_what_they_are(shown):
    page = shown.page
    numbers = page.locator("driftproof-value data")
    assert numbers.count() == page.locator("driftproof-value").count() == 8
    assert numbers.first.text_content() == "0.877604"
    assert numbers.first.get_attribute("value") == "0.877604166666666666666666666667"
    assert page.locator("#energy").text_content() == "0.499894883898"
    for number in page.locator("driftproof-value").all():
        tip = number.locator("[role=tooltip]")
        assert tip.is_hidden()
        page.mouse.move(0, 0)  # a remark stays while the pointer is on it, and may lie over the next number
        number.locator("data").hover()
        assert tip.is_visible()
        box = tip.bounding_box()
        assert 0 <= box["x"] <= box["x"] + box["width"] <= page.viewport_size["width"]
        assert number.locator("data").get_attribute("aria-describedby") == tip.get_attribute("id")
    assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")
    assert shown.console == shown.errors == []
    names = [address.removeprefix(shown.address) for address in shown.requests]
    assert sorted(names) == ["", "driftproof.mjs", "values.json"]


@pytest.mark.slow(keep=1)
def test_remark_opens_with_the_focus_and_closes_with_escape(shown):
    page = shown.page
    tips = page.locator("[role=tooltip]")
    page.keyboard.press("Tab")
    assert tips.nth(0).is_visible()
    assert tips.nth(0).text_content() == "= 337/384, proved"
    page.keyboard.press("Tab")
    assert [tips.nth(i).is_visible() for i in (0, 1)] == [False, True]
    assert tips.nth(1).text_content() == "= cos(1/2), certified"
    page.keyboard.press("Escape")
    assert tips.nth(1).is_hidden()


@pytest.mark.slow(keep=1)
def test_remark_is_readable_in_either_scheme(shown):
    """Text and ground differ as WCAG 2.2 asks: 4.5 : 1 at least."""
    tip = "getComputedStyle(document.querySelector('[role=tooltip]'))"
    colours = [shown.page.evaluate(f"{tip}.{name}") for name in ("color", "backgroundColor")]
    light, dark = sorted(map(_luminance, colours), reverse=True)
    assert (light + 0.05) / (dark + 0.05) >= 4.5


def _luminance(colour):
    channels = [int(part) / 255 for part in colour.removeprefix("rgb(").removesuffix(")").split(",")]
    linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in channels]
    return sum(weight * c for weight, c in zip((0.2126, 0.7152, 0.0722), linear, strict=True))


NOT_SHOWN = [
    ('of="no.such.id" digits="6"', 'driftproof: no value has the id "no.such.id"'),
    ('digits="6"', "driftproof: an element needs the attribute of, the id of a value"),
    ('of="rk4.first_step.q"', "driftproof: rk4.first_step.q needs either the attribute digits or places"),
    (
        'of="rk4.default.state_error" digits="31"',
        "driftproof: rk4.default.state_error is not certified to so many digits",
    ),
    ('of="rk4.first_step.q" digits="six"', "driftproof: digits is six; it must be a whole number from 1 to 10000"),
    (
        'of="&lt;img src=x onerror=alert(1)&gt;" places="2"',
        'driftproof: no value has the id "<img src=x onerror=alert(1)>"',
    ),
]


def test_what_cannot_be_shown_is_a_visible_error(plain):
    page = plain.page
    for attributes, message in NOT_SHOWN:
        element = f"<driftproof-value {attributes}>0.5</driftproof-value>"
        page.evaluate("html => { document.body.innerHTML = html; }", element)
        assert page.locator("driftproof-value").text_content() == message
        assert page.locator("driftproof-value [role=alert]").is_visible()
    assert plain.console == plain.errors == []


def test_element_follows_its_attributes(plain):
    page = plain.page
    page.evaluate("document.querySelector('driftproof-value').setAttribute('digits', '3')")
    assert page.locator("driftproof-value data").first.text_content() == "0.878"
    page.fill("#count", "41")
    assert page.locator("#energy").text_content() == "0.49989488389756944444444444444444444444444"
    page.close()


@pytest.mark.slow
def test_text_kept_for_pages_without_script_is_what_a_script_shows(plain, chromium, site):
    texts = plain.page.locator("driftproof-value data").all_inner_texts()
    with opened(chromium, site, script=False) as shown:
        assert shown.page.locator("driftproof-value").all_inner_texts() == texts != []
