"""The page: scenes, one at a time, in a document that loads nothing."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from driftproof.numeric.readouts import TRAJECTORY
from driftproof.numeric.run import Counter, Readouts
from driftproof.numeric.scenes import FIGURES, STABILITY, TABLE, WORK_PRECISION, Scene
from driftproof.reports import scene_view
from driftproof.reports.page.figure import style_sheet
from driftproof.reports.page.markup import element, escaped, html_table
from driftproof.reports.page.trajectory import DRAWN, SampledRun, require_drawable, setting

# Browsers may load nothing at all: the style sheet is in the page, the icon is empty, there is no script.
POLICY = "default-src 'none'; style-src 'unsafe-inline'; img-src data:"


@dataclass(frozen=True)
class Part:
    """A part of the page that is not a scene: its title, and its content as a function of the prefix of its ids."""

    title: str
    content: Callable[[str], str]


def document(parts: Sequence[Scene | Part], counter: Counter = range) -> str:
    """The page as HTML, with the same bytes for the same scenes. Raises ValueError for a scene that cannot be shown."""
    options = []
    for identity, part in ((f"scene-{i}", part) for i, part in enumerate(parts, 1)):
        if isinstance(part, Scene):
            title, content = scene_title(part), scene_section(part, identity, counter)
        else:
            title, heading = part.title, element("h2", escaped(part.title))
            content = element("section", heading, part.content(identity), class_="scene")
        options.append(Option(identity, title, content))
    if all(isinstance(part, Scene) for part in parts):
        equations = "<i>q</i>′ = <i>v</i>, <i>v</i>′ = −<i>q</i>"
        about = element("p", f"{equations}: what each method computes, next to the exact motion.")
        head = element("h1", "An oscillator, step by step")
    else:
        about = element("p", "What each method computes, next to the solution, which is exact or enclosed.")
        head = element("h1", "Methods, step by step")
    title = f"driftproof: {', '.join(option.label for option in options)}"
    words = "Runs are in binary64. Limits, and whatever is called proved, are exact. Written by driftproof report."
    main = element("main", choice(options, "Scene"))
    body = element("body", element("header", head, about), main, element("footer", element("p", words)))
    return f"<!DOCTYPE html>\n{element('html', _head(title), body, lang='en')}\n"


def _head(title: str) -> str:
    return (
        '<head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        '<meta name="color-scheme" content="light dark">'
        f'<meta http-equiv="Content-Security-Policy" content="{escaped(POLICY)}">'
        f'<link rel="icon" href="data:,"><title>{escaped(title)}</title><style>\n{style_sheet()}</style></head>'
    )


@dataclass(frozen=True)
class Option:
    """One of several things to look at: its id, its label, its content."""

    identity: str
    label: str
    content: str


def choice(options: Sequence[Option], name: str, first: int = 0) -> str:
    """The options, shown one at a time, at first `first`, by radio buttons and a rule of the style sheet, not a script.

    Without the style sheet they follow each other. A single option gets no button.
    """
    if len(options) == 1:
        return element("div", options[0].content, id=options[0].identity)
    parts = []
    for i, option in enumerate(options):
        button = f"{option.identity}-shown"
        checked = "" if i == first else None
        parts += [
            element("input", type="radio", name=name, id=button, checked=checked, autocomplete="off"),
            element("label", escaped(option.label), for_=button),
            element("div", option.content, class_="option", id=option.identity),
        ]
    return element("div", *parts, class_="choice", role="group", aria_label=name)


@dataclass(frozen=True)
class _Shown:
    """A scene with its runs; `identity` is the prefix of the ids of its parts."""

    scene: Scene
    identity: str
    runs: Mapping[str, Readouts | str]

    def identity_of(self, key: str) -> str:
        """The prefix of the ids of a method's parts: its key, or its file's name with hyphens for other characters."""
        return f"{self.identity}-{re.sub(r'[^A-Za-z0-9_]+', '-', key)}"


def scene_section(scene: Scene, identity: str, counter: Counter = range) -> str:
    """The scene under a heading: readouts and figures of each method, then the panels about all methods."""
    shown = _Shown(scene, identity, _runs(scene, counter))
    parts = [element("h2", escaped(scene_title(scene))), element("p", escaped(setting(scene)), class_="setting")]
    if scene.readouts or set(FIGURES) & set(scene.panels):
        options = [
            Option(shown.identity_of(key), scene.method(key).title, _method(shown, key)) for key in scene.every_method
        ]
        first = scene.every_method.index(scene.selected)
        parts.append(choice(options, f"Method shown, {scene_title(scene)}", first))
    for panel, (title, content) in _PANELS.items():
        if panel in scene.panels:
            parts.append(element("section", element("h3", escaped(title)), content(shown), class_="panel"))
    return element("section", *parts, class_="scene")


def scene_title(scene: Scene) -> str:
    """The title of a scene on the page: its name in words."""
    words = scene.name.replace("_", " ")
    return words[:1].upper() + words[1:]


def _runs(scene: Scene, counter: Counter) -> dict[str, Readouts | str]:
    """One run of each method that the scene shows or compares, with all the readouts that it needs."""
    wanted = dict.fromkeys(scene.readouts)
    if set(FIGURES) & set(scene.panels):
        wanted[TRAJECTORY] = None
    keys = dict.fromkeys(scene.every_method if wanted else ())
    if TABLE in scene.panels:
        wanted |= dict.fromkeys(scene_view.COMPARED_READOUTS)
        keys |= dict.fromkeys(scene.methods)
    if TRAJECTORY in wanted:
        require_drawable(scene)
    return scene_view.runs_of(scene, wanted, keys, counter) if keys else {}


def _method(shown: _Shown, key: str) -> str:
    """The readouts of one method, and its figures."""
    scene, run, parts = shown.scene, shown.runs.get(key), [element("h3", escaped(shown.scene.method(key).title))]
    if isinstance(run, str):
        parts.append(element("p", escaped(run), class_="message"))
    elif run is not None:
        readouts = {name: run[name] for name in scene.readouts if name != TRAJECTORY}
        parts.append(_cards(scene_view.readout_rows(readouts)))
    if run is not None and not isinstance(run, str) and TRAJECTORY in run:
        times, states = run[TRAJECTORY]
        drawn = SampledRun(scene, key, times, states, shown.identity_of(key))
        figures = [DRAWN[panel](drawn).markup() for panel in DRAWN if panel in scene.panels]
        parts.append(element("div", *figures, class_="figures") if figures else drawn.samples_table())
    return "".join(parts)


def _cards(rows: Sequence[Sequence[str]]) -> str:
    cards = [element("div", element("dt", escaped(label)), element("dd", escaped(value))) for label, value in rows]
    return element("dl", *cards, class_="readouts") if cards else ""


def _table(shown: _Shown) -> str:
    rows, remarks = scene_view.comparison_rows(shown.scene, {key: shown.runs[key] for key in shown.scene.methods})
    compared = html_table(rows, f"At t = {shown.scene.t}, each with h = {shown.scene.h}", "methods")
    return compared + "".join(element("p", escaped(remark)) for remark in remarks)


def _work_precision(shown: _Shown) -> str:
    from driftproof.reports.page.work import work_curves, work_figure, work_table
    from driftproof.symbolic.claimed_orders import stated_orders

    found, stated = work_curves(shown.scene), stated_orders(map(shown.scene.method, shown.scene.every_method))
    figure = work_figure(found, shown.identity, shown.scene.t, shown.scene.steps).markup()
    return element("div", figure, work_table(found, stated), class_="beside")


def _stability(shown: _Shown) -> str:
    from driftproof.reports.page.stability import growth_figure, verdict, verdicts_table

    found = [verdict(shown.scene.method(key), shown.scene.h) for key in shown.scene.every_method]
    figure = growth_figure(shown.scene, found, shown.identity).markup()
    return element("div", figure, verdicts_table(shown.scene, found), class_="beside")


# Panels about all methods of a scene, in the order in which they stand on the page.
_PANELS: dict[str, tuple[str, Callable[[_Shown], str]]] = {
    TABLE: ("Side by side", _table),
    WORK_PRECISION: ("Work", _work_precision),
    STABILITY: ("Stability", _stability),
}
