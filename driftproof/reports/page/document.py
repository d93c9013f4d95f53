"""The page: scenes, one at a time, in a document that asks nobody for anything."""

from __future__ import annotations

from collections.abc import Sequence
from importlib.resources import files

from driftproof.numeric.run import Counter
from driftproof.numeric.scenes import Scene
from driftproof.reports.page.panels import Option, choice, scene_section
from driftproof.reports.page.svg import element, text

# The browser is told to load nothing at all: the style sheet is in the page, the icon is empty, there is no script.
POLICY = "default-src 'none'; style-src 'unsafe-inline'; img-src data:"


def document(scenes: Sequence[Scene], digits: int, *, times: bool = False, counter: Counter = range) -> str:
    """The page as HTML, the same bytes for the same scenes, unless `times` are measured for panels of work.

    Raises ValueError for a scene that cannot be shown.
    """
    options = [
        Option(f"scene-{i}", scene.name, scene_section(scene, f"scene-{i}", digits, times=times, counter=counter))
        for i, scene in enumerate(scenes, 1)
    ]
    title = f"driftproof: {', '.join(scene.name for scene in scenes)}"
    body = element("body", _header(), element("main", choice(options, "Scene")), _footer())
    return f"<!DOCTYPE html>\n{element('html', _head(title), body, lang='en')}\n"


def _head(title: str) -> str:
    style = files("driftproof.reports.page").joinpath("style.css").read_text(encoding="utf-8")
    return (
        '<head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        '<meta name="color-scheme" content="light dark">'
        f'<meta http-equiv="Content-Security-Policy" content="{text(POLICY)}">'
        f'<link rel="icon" href="data:,"><title>{text(title)}</title><style>\n{style}</style></head>'
    )


def _header() -> str:
    equations = "<i>q</i>′ = <i>v</i>, <i>v</i>′ = −<i>q</i>"
    return element(
        "header",
        element("h1", "An oscillator, step by step"),
        element("p", f"{equations}: what each method computes, beside the exact motion."),
    )


def _footer() -> str:
    words = "Runs are in binary64. What is called proved, and every limit, is exact. Written by driftproof report."
    return element("footer", element("p", words))
