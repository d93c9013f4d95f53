"""A page as a browser shows it: headless Chromium, at a width and a colour scheme, and what it complains of or fetches.

In a test file:

    @pytest.fixture(scope="module")        # one start, about a second, for all its tests
    def chromium() -> Iterator[Browser]:
        with started() as browser:
            yield browser

    def test_page_is_silent(chromium: Browser, tmp_path: Path) -> None:
        with opened(chromium, tmp_path / "report.html", width=360, scheme="dark") as shown:
            assert shown.complaints == []  # console, uncaught errors, and every request but the file's own
            assert shown.page.locator("figure").count() == 4

Where there is no Chromium, such tests are skipped; with DRIFTPROOF_BROWSER=required in the environment they fail.
"""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

import pytest
from playwright.sync_api import Browser, Frame, Page, sync_playwright

# No sandbox: tests often run as root. The others keep the browser from talking to anybody of its own accord.
FLAGS = (
    *("--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking"),
    *("--disable-component-update", "--disable-sync"),
)

Scheme = Literal["light", "dark"]

SMALLEST_TEXT = 10.5  # CSS pixels
CONTRAST = 4.5  # WCAG 2.2, 1.4.3, of text
# CSS pixels of an A4 sheet between its margins of 12 and 13 mm.
SHEET, SHEET_WIDTH = (297 - 2 * 12) / 25.4 * 96, int((210 - 2 * 13) / 25.4 * 96)

SMALL_TEXT = """least => [...document.querySelectorAll("body *")].filter(element => {
    const own = [...element.childNodes].some(node => node.nodeType === 3 && node.data.trim())
    if (!own || !element.checkVisibility() || !element.getClientRects().length) return false
    const svg = element.closest("svg")
    const scale = svg ? svg.getBoundingClientRect().width / svg.viewBox.baseVal.width : 1
    return parseFloat(getComputedStyle(element).fontSize) * scale < least
}).map(element => element.textContent.slice(0, 40))"""

# The page paints plain colours only, so that the background of a thing is the nearest one above it that is not clear.
CONTRASTS = """([selector, key, least]) => {
    const channels = colour => colour.match(/[0-9.]+/g).map(Number)
    const light = colour => channels(colour).slice(0, 3).map(c => c / 255)
        .map(c => c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4)
        .reduce((sum, c, i) => sum + c * [0.2126, 0.7152, 0.0722][i], 0)
    const behind = element => {
        for (; element; element = element.parentElement) {
            const colour = getComputedStyle(element).backgroundColor
            if ((channels(colour)[3] ?? 1) > 0) return colour
        }
        return "rgb(255, 255, 255)"
    }
    const ratio = element => {
        const [high, low] = [light(getComputedStyle(element)[key]), light(behind(element))].sort((a, b) => b - a)
        return (high + 0.05) / (low + 0.05)
    }
    const seen = [...document.querySelectorAll(selector)].filter(element => element.checkVisibility())
    return [seen.length, seen.filter(e => ratio(e) < least).map(e => `${e.outerHTML.slice(0, 60)}: ${ratio(e)}`)]
}"""


@dataclass
class Shown:
    """An open page with what it wrote to the console, its uncaught errors, and the addresses it asked for."""

    page: Page
    address: str
    console: list[str] = field(default_factory=list)
    errors: list[str] = field(default_factory=list)
    requests: list[str] = field(default_factory=list)

    @property
    def complaints(self) -> list[str]:
        """What a page that stands by itself does none of: warnings and errors, and requests beyond its own file."""
        return self.console + self.errors + [address for address in self.requests if address != self.address]


@contextmanager
def started() -> Iterator[Browser]:
    """A browser, closed at the end. Not for a whole session: meanwhile its thread can run no other event loop."""
    program = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
    if program is None:
        missing = "there is no Chromium to look at pages with"
        if os.environ.get("DRIFTPROOF_BROWSER") == "required":
            pytest.fail(missing)
        pytest.skip(missing)
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=program, args=list(FLAGS))
        try:
            yield browser
        finally:
            browser.close()


@contextmanager
def opened(
    browser: Browser, of: Path | str, *, width: int = 1200, scheme: Scheme = "light", script: bool = True
) -> Iterator[Shown]:
    """A file, without a network, or an address, loaded in a window `width` pixels wide, with or without script."""
    context = browser.new_context(
        viewport={"width": width, "height": 900}, color_scheme=scheme, java_script_enabled=script
    )
    try:
        page = context.new_page()
        shown = Shown(page, of if isinstance(of, str) else of.resolve().as_uri())
        context.set_offline(isinstance(of, Path))
        page.on("console", lambda message: shown.console.append(f"{message.type}: {message.text}"))
        page.on("pageerror", lambda error: shown.errors.append(str(error)))
        page.on("request", lambda request: shown.requests.append(request.url))
        page.goto(shown.address, wait_until="load")
        yield shown
    finally:
        context.close()


def overflow(page: Page | Frame) -> float:
    """By how many pixels the page is wider than its window."""
    return float(page.evaluate("document.documentElement.scrollWidth - document.documentElement.clientWidth"))
