"""Scenes run in floats: one shown, or several as a page."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from driftproof.numeric.scenes import PRESETS, Scene, scene_named
from driftproof.reports.page.document import document
from driftproof.reports.page.trajectory import write_figures
from driftproof.reports.progress import count_steps
from driftproof.reports.scene_view import scene_json, scene_text, show_scene
from driftproof.support.files import atomic_write, require_file, require_folder
from driftproof.support.plain_text import as_json, table
from driftproof.support.results import Answered, Printable


def scene(name: str | Path | Scene | None = None, *, digits: int = 15, figures: str | Path | None = None) -> Answered:
    """A preset, or a scene of your own, run in floats: the readouts, certified readouts and table that it asks for.

    Without a name, the presets: the method shown, h, t and the number of steps.

    `found` has them as numbers. `figures` names a folder for the scene's figures, as SVG. Raises ValueError.

    >>> from driftproof import scene
    >>> scene("stability_boundary").found["readouts"]["final_state"]
    (-11.0, -10.0)
    """
    if name is None:
        header = ("scene", "selected", "h", "t", "steps")
        rows = [[x.name, x.selected, str(x.h), str(x.t), str(x.steps)] for x in PRESETS.values()]
        listed = [dict(zip(header, row, strict=True)) for row in rows]
        return Answered(listed, lambda _: table([header, *rows], right=(2, 3, 4)))
    about = scene_named(name)
    if figures is not None:
        require_folder(Path(figures))
    shown, wrote = show_scene(about, digits, count_steps), ""
    if figures is not None:
        wrote = "\n".join(f"wrote {path}" for path in write_figures(about, Path(figures)))
    text = "\n\n".join(filter(None, [scene_text(about, shown), wrote]))
    return Answered(scene_json(about, shown), lambda _: text, shown)


@dataclass(frozen=True, repr=False)
class Page(Printable):
    """A page of HTML about some scenes, and the file that it was written to, if there is one."""

    html: str
    scenes: tuple[str, ...]
    output: Path | None = None

    def written(self, form: str) -> str:
        """The page as "html"; as "text" or "json" where it is."""
        if form == "html":
            return self.html
        if form == "json":
            return as_json({"scenes": self.scenes, "output": None if self.output is None else str(self.output)})
        return f"wrote {self.output}" if self.output else f"a page of {', '.join(self.scenes)}; .html has it"

    def _repr_html_(self) -> str:
        """The page itself, in a frame of its own."""
        from html import escape

        return f'<iframe srcdoc="{escape(self.html)}" width="100%" height="800"></iframe>'


def report(*scenes: str | Path | Scene, output: str | Path | None = None, digits: int = 15) -> Page:
    """Presets, or scenes of your own, all presets where none is named, as one page of HTML, written to `output`.

    Raises ValueError for a scene that cannot be shown.

    >>> from driftproof import report
    >>> print(report("default"))
    a page of default; .html has it
    """
    path = None if output is None else Path(output)
    if path is not None:
        require_file(path)
    asked = [scene_named(each) for each in scenes or PRESETS]
    page = Page(document(asked, digits, count_steps), tuple(each.name for each in asked), path)
    if path is not None:
        with atomic_write(path) as draft:
            Path(draft).write_text(page.html, encoding="utf-8", newline="\n")
    return page
