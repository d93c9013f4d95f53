"""Scenes and problems as one page of HTML, written to a file or shown in a notebook."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from driftproof.methods.given_methods import GivenMethods, methods_of
from driftproof.methods.numbers.rationals import ExactNumber
from driftproof.numeric.scenes import PRESETS, Scene
from driftproof.reports.page.document import Part, document, scene_title
from driftproof.reports.problem_page import STIFF_METHODS, problem_part, stiff_part
from driftproof.reports.progress import count_steps
from driftproof.reports.scenes import scene_given
from driftproof.reports.stability import STABILITY_METHODS
from driftproof.reports.studies import errors_wanted
from driftproof.reports.user_problem import GivenProblem, names_problem, problem_given
from driftproof.support.files import atomic_write, require_file
from driftproof.support.plain_text import as_json
from driftproof.support.results import Printable


@dataclass(frozen=True, repr=False)
class Page(Printable):
    """A page of HTML about some scenes, and the file that it was written to, if there is one."""

    html: str
    scenes: tuple[str, ...]
    output: Path | None = None

    def written(self, form: str) -> str:
        """The page as "html"; as "text" or "json", where it was written."""
        if form == "html":
            return self.html
        if form == "json":
            return as_json({"scenes": self.scenes, "output": None if self.output is None else str(self.output)})
        return f"wrote {self.output}" if self.output else f"a page of {', '.join(self.scenes)}; its HTML is in .html"

    def _repr_html_(self) -> str:
        """The page itself, in a frame of its own."""
        from html import escape

        return f'<iframe srcdoc="{escape(self.html)}" width="100%" height="800" style="border: 0"></iframe>'


def report(
    *scenes: GivenProblem | Scene | Sequence[GivenProblem | Scene],
    output: str | Path | None = None,
    methods: GivenMethods = (),
    error: ExactNumber | Sequence[ExactNumber] = (),
) -> Page:
    """Scenes and problems as one page of HTML, written to `output`; the presets if none is named.

    A scene is a preset or a .toml file; a problem is one of ours, or a .toml file of your own, shown with `methods`, as
    is "stiff", a table of all stiff problems. `error` is the accuracy that you want on problems, or several: the page
    says which method reaches it, with which h and at what cost. Raises ValueError for what cannot be shown.

    >>> from driftproof import report
    >>> print(report("default"))
    a page of Default; its HTML is in .html
    """
    path = None if output is None else Path(output)
    if path is not None:
        require_file(path)
    named: list[Any] = [each for given in scenes for each in (given if isinstance(given, list | tuple) else [given])]
    wanted = errors_wanted(error)
    parts = [_part(each, methods, wanted) for each in named or PRESETS]
    if (methods or wanted) and all(isinstance(part, Scene) for part in parts):
        what, otherwise = ("methods", "; `driftproof scene NAME --methods` takes them") if methods else ("errors", "")
        raise ValueError(f"{what} are for problems, and none is named{otherwise}")
    titles = tuple(scene_title(part) if isinstance(part, Scene) else part.title for part in parts)
    page = Page(document(parts, count_steps), titles, path)
    if path is not None:
        with atomic_write(path) as draft:
            Path(draft).write_text(page.html, encoding="utf-8", newline="\n")
    return page


def _part(given: GivenProblem | Scene, methods: GivenMethods, wanted: Sequence[float]) -> Scene | Part:
    """The scene, or the part of the page for a problem."""
    if isinstance(given, Scene):
        if given.problem is None:
            return given
        return problem_part(given.problem, methods_of(given.methods or methods or STABILITY_METHODS), given, wanted)
    if given == "stiff":
        return stiff_part(methods_of(methods or STIFF_METHODS))
    if str(given) not in PRESETS and names_problem(given):
        return problem_part(problem_given(given), methods_of(methods or STABILITY_METHODS), wanted=wanted)
    return _part(scene_given(str(given)), methods, wanted)
