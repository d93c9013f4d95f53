"""The page as a file: whole, the same each time, with nothing to fetch, and no panel that a scene leaves out."""

import hashlib
import re
from dataclasses import replace
from fractions import Fraction as Q
from html import escape
from html.parser import HTMLParser

import pytest

from driftproof.methods.catalogue import METHODS
from driftproof.numeric.run import run_method
from driftproof.numeric.scenes import PANELS, PRESETS, READOUTS, Scene
from driftproof.reports import scene_view
from driftproof.reports.page.document import POLICY, document

VOID = {"meta", "link", "input"}
REFERENCES = ("for", "aria-labelledby", "aria-describedby")
LOADING = {"script", "img", "iframe", "object", "embed", "video", "audio", "source", "use", "image", "base", "form"}
NAMES = (
    "body caption circle dd desc details div dl dt figcaption figure footer h1 h2 h3 h4 head header html i label li "
)
NAMES += "main p path section style summary svg table tbody td text th thead title tr ul"
PLAIN = Scene("plain", "rk4", Q(1, 4), Q(1), readouts=("energy",))


class Read(HTMLParser):
    """The elements of a page, its texts by the id of the nearest element above that has one, and what is wrong."""

    def __init__(self, page):
        super().__init__()
        self.open = []
        self.elements = []
        self.wrong = []
        self.feed(page)
        self.close()
        self.ids = [attributes["id"] for _, attributes in self.elements if "id" in attributes]
        self.wrong += [f"twice: {i}" for i in set(self.ids) if self.ids.count(i) > 1]
        self.wrong += [f"open: {tag}" for tag in self.open]
        self.wrong += [
            f"{tag} {key} points nowhere: {attributes[key]}"
            for tag, attributes in self.elements
            for key in REFERENCES
            if key in attributes and attributes[key] not in self.ids
        ]

    def handle_starttag(self, tag, attrs):
        self.elements.append((tag, dict(attrs)))
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attrs):
        self.elements.append((tag, dict(attrs)))

    def handle_endtag(self, tag):
        if not self.open or self.open.pop() != tag:
            self.wrong.append(f"closed without being open: {tag}")

    def all(self, tag):
        return [attributes for name, attributes in self.elements if name == tag]


@pytest.fixture(scope="module")
def page():
    return document(list(PRESETS.values()))


def test_page_is_well_formed_and_every_reference_has_its_target(page):
    assert Read(page).wrong == []
    assert {tag for tag, _ in Read(page).elements} <= {*NAMES.split(), *VOID}


@pytest.mark.parametrize(
    ("planted", "found"),
    [
        ("<p id='a'></p><p id='a'></p>", "twice"), ("<div>", "open"), ("</p>", "closed"),
        ("<label for='b'></label>", "nowhere"),
    ],
)  # fmt: skip
def test_a_broken_page_is_noticed(planted, found):
    assert any(found in complaint for complaint in Read(planted).wrong)


def test_page_holds_nothing_that_loads_nor_says_when_and_where_it_was_made(page):
    assert not re.search(r"20[2-9]\d-|\b\d\d:\d\d\b|/tmp|/home", page)
    read = Read(page)
    assert {tag for tag, _ in read.elements} & LOADING == set()
    assert [link["href"] for link in read.all("link")] == ["data:,"]
    assert not re.search(r"url\(|@import|//", page.replace("-//", ""))
    assert {"http-equiv": "Content-Security-Policy", "content": POLICY} in read.all("meta")
    assert all(not key.startswith("on") and key != "style" for _, attributes in read.elements for key in attributes)


def test_figures_are_those_of_every_preset_and_method(page):
    ids = [figure["id"] for figure in Read(page).all("figure")]
    methods = ("forward_euler", "symplectic_euler", "rk4")
    each = [f"scene-{i}-{key}-{panel}" for i in range(1, 5) for key in methods for panel in ("position", "phase_plane")]
    assert set(ids) == {*each, "scene-1-work", *(f"scene-{i}-growth" for i in range(1, 5))}
    assert len(ids) == len(set(ids)) == 29


def test_every_picture_has_title_description_and_numbers(page):
    pictures = re.findall(r"<figure .*?</figure>", page, re.DOTALL)
    assert len(pictures) == 29
    for picture in pictures:
        (title,) = re.findall(r'<title id="[^"]*-title">([^<]+)</title>', picture)
        (description,) = re.findall(r'<desc id="[^"]*-desc">([^<]+)</desc>', picture)
        assert len(description) > len(title) > 10
        assert len(re.findall("<tr>", picture)) > 5


def test_same_scenes_make_the_same_bytes(page, fresh_python):
    code = (
        "import hashlib\nfrom driftproof.reports.page.document import document\n"
        "from driftproof.numeric.scenes import PRESETS\n"
        "print(hashlib.sha256(document(list(PRESETS.values())).encode()).hexdigest())"
    )
    assert fresh_python(code) == hashlib.sha256(page.encode()).hexdigest()


def test_page_selects_the_method_of_the_scene_first(page):
    read = Read(page)
    checked = [box["id"] for box in read.all("input") if "checked" in box]
    selected = [f"scene-{i}-{scene.selected}-shown" for i, scene in enumerate(PRESETS.values(), 1)]
    assert sorted(checked, key=str) == sorted(["scene-1-shown", *selected])
    assert all(box["type"] == "radio" for box in read.all("input"))
    assert len(read.all("input")) == 4 + 12


def test_single_scene_with_a_single_method_leaves_nothing_to_choose():
    read = Read(document([PLAIN]))
    assert read.all("input") == []
    assert read.wrong == []


def heads(scene):
    """The third-level headings of a page, and the kinds of its figures."""
    shown = document([scene])
    kinds = {figure["id"] or "" for figure in Read(shown).all("figure")}
    return set(re.findall(r"<h3>(.*?)</h3>", shown)) | {kind.rpartition("-")[2] for kind in kinds}


@pytest.mark.parametrize(
    ("panel", "expected"),
    [
        ("table", {"Side by side"}), ("position", {"Classical RK4", "position"}),
        ("phase_plane", {"Classical RK4", "phase_plane"}), ("work_precision", {"Work", "work"}),
        ("stability", {"Stability", "growth"}),
    ],
)  # fmt: skip
def test_page_has_the_panel_that_the_scene_names_and_no_other(panel, expected):
    methods = ("rk4",) if panel == "table" else ()
    assert heads(Scene("one", "rk4", Q(1, 4), Q(1), methods=methods, panels=(panel,))) == expected
    assert set(PANELS) == {"table", "position", "phase_plane", "work_precision", "stability"}


def test_nothing_is_run_for_a_scene_that_asks_for_no_run(monkeypatch):
    def forbidden(*_):
        raise AssertionError("a float run was made")

    monkeypatch.setattr(scene_view, "run_scene", forbidden)
    assert "bounded" in document([Scene("s", "rk4", Q(1), Q(1), panels=("stability",))])
    with pytest.raises(AssertionError, match="float run"):
        document([PLAIN])


@pytest.mark.parametrize(
    ("asked", "expected"),
    [
        ({"panels": ("position",)}, {"rk4": {"trajectory"}}),
        ({"readouts": ("energy",)}, {"rk4": {"energy"}}),
        ({"panels": ("table",), "methods": ("heun2",)}, {"heun2": {"state_error", "energy_change", "evaluations"}}),
    ],
)
def test_runs_are_made_once_and_yield_what_is_named_and_no_more(monkeypatch, asked, expected):
    made = []

    def recorded(scene, key, *rest):
        made.append((key, set(scene.readouts)))
        return run_method(scene, key, *rest)

    monkeypatch.setattr(scene_view, "run_scene", recorded)
    document([Scene("s", "rk4", Q(1, 4), Q(1), **asked)])
    assert made == list(expected.items())


def test_page_without_stability_imports_no_sympy(modules_after):
    code = "from fractions import Fraction as Q; from driftproof.reports.page.document import document; "
    code += "from driftproof.numeric.scenes import Scene; "
    asked = "document([Scene('s', 'rk4', Q(1, 4), Q(1), methods=('rk4',), readouts=('energy',), panels={})])"
    loaded = modules_after(code + asked.format("('table', 'position', 'phase_plane')"))
    assert loaded & {"sympy", "flint", "numba", "hypothesis"} == set()
    assert "flint" in modules_after(code + asked.format("('stability',)"))


def test_run_that_overflows_has_its_message_and_the_others_their_figures():
    scene = Scene("edge", "rk4", Q(2), Q(2000), methods=("forward_euler",), readouts=("energy",), panels=PANELS)
    shown = document([scene])
    assert shown.count("overflow: the state is no longer finite after step 883") == 2
    assert 'id="scene-1-rk4-position"' in shown
    assert 'id="scene-1-forward_euler-position"' not in shown


def test_trajectory_without_a_figure_is_a_table_of_samples():
    shown = document([Scene("t", "rk4", Q(1, 4), Q(1), readouts=("trajectory",))])
    assert "<figure" not in shown
    assert shown.count("<tr>") == 2 * (1 + 5)


def test_name_of_a_scene_is_text_and_no_markup():
    evil = replace(PLAIN, name='<script>alert(1)<\\script>"&\x00')
    shown = document([evil, evil])
    read = Read(shown)
    assert read.wrong == []
    assert read.all("script") == []
    assert "\x00" not in shown
    assert "&lt;script&gt;alert(1)" in shown


def test_every_readout_has_its_place_on_the_page():
    scene = Scene("all", "rk4", Q(1, 4), Q(1), readouts=READOUTS)
    shown = document([scene])
    assert shown.count("<dt>") == len(READOUTS) - 1


def test_command_writes_the_page(answer, tmp_path, page):
    path = tmp_path / "new folder" / "report.html"
    assert answer("report", "-o", str(path)) == f"wrote {path}\n"
    assert path.read_text(encoding="utf-8") == page
    assert [file.name for file in path.parent.iterdir()] == ["report.html"]


def test_command_takes_scenes_by_name_and_from_files(answer, tmp_path):
    mine = tmp_path / "mine.toml"
    mine.write_text('selected = "heun2"\nh = 0.1\nt = 1\nreadouts = ["energy"]\n', encoding="utf-8")
    answer("report", str(mine), "compare", "-o", str(tmp_path / "r.html"))
    assert re.findall("<h2>(.*?)</h2>", (tmp_path / "r.html").read_text(encoding="utf-8")) == ["Mine", "Compare"]
    assert escape(METHODS["heun2"].title) in (tmp_path / "r.html").read_text(encoding="utf-8")


def test_page_that_fails_leaves_the_old_one_as_it_was(run, tmp_path):
    path = tmp_path / "report.html"
    path.write_text("old", encoding="utf-8")
    scene = tmp_path / "back.toml"
    scene.write_text('selected = "rk4"\nh = -1\nt = -3\npanels = ["work_precision"]\n', encoding="utf-8")
    assert run("report", "default", str(scene), "-o", str(path))[0] == 2
    assert path.read_text(encoding="utf-8") == "old"
    assert len(list(tmp_path.iterdir())) == 2
