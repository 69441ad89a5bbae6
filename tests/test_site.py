"""The site is built without a warning, and a browser shows all of it without asking anyone else."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from PIL import Image

from cosserat_casadi.cli.main import LINES
from docs.site.command_reference import command_page
from docs.site.functions_in_c import functions_page
from docs.site.gallery import ExampleError, draw_examples, run_example, write_gallery
from examples.demo import arguments_of
from tests.browser import browser
from tests.conftest import ROOT

EXAMPLES = ("planar_strip", "nitinol_wire")
"""Few, because each is solved and drawn."""

SIZES = ({"width": 1400, "height": 900}, {"width": 390, "height": 800})
"""Windows, pixels: a desk's and a telephone's."""

NEEDS_THEME = "the site needs the extra docs, which make test-slow installs"

LIVE = "<!DOCTYPE html><title>strip</title><p id=strip>moves</p>"


@pytest.fixture(scope="module")
def runs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("runs")
    for name in EXAMPLES:
        run_example(arguments_of(name, folder))
    (folder / "planar_strip.html").write_text(LIVE)
    return folder


@pytest.fixture(scope="module")
def site(runs: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    pytest.importorskip("material", reason=NEEDS_THEME)
    from docs.site.build import build_site

    folder = tmp_path_factory.mktemp("site")
    build_site(folder, runs, EXAMPLES)
    return folder


class Visit:
    """A page in the browser, and what went wrong on it."""

    def __init__(self, window: Any) -> None:
        self.window = window
        self.faults: list[str] = []
        window.on("console", self._heard)
        window.on("pageerror", lambda error: self.faults.append(str(error)))
        window.on("request", self._asked)
        window.on("requestfailed", lambda request: self.faults.append(f"{request.url} does not load"))

    def _heard(self, message: Any) -> None:
        if message.type in ("error", "warning"):
            self.faults.append(message.text)

    def _asked(self, request: Any) -> None:
        if not request.url.startswith(("file:", "data:")):
            self.faults.append(f"{request.url} is not of the site")


@pytest.fixture(scope="module")
def chromium() -> Iterator[Any]:
    with browser() as opened:
        yield opened


@pytest.fixture
def visit(chromium: Any) -> Iterator[Visit]:
    window = chromium.new_page(viewport=SIZES[0])
    yield Visit(window)
    window.close()


BROKEN_IMAGES = """() => Promise.all([...document.images].map(async (image) => {
    image.loading = "eager";
    await image.decode().catch(() => {});
    return image.naturalWidth ? "" : image.src;
})).then((images) => images.filter(Boolean))"""

WORDS_OF_ARTICLE = """() => {
    const article = document.querySelector("article").cloneNode(true);
    article.querySelectorAll("pre, code, .headerlink").forEach((element) => element.remove());
    return article.textContent;
}"""

UNSEEN_FORMULAS = """() => [...document.querySelectorAll("math")]
    .filter((formula) => formula.getBoundingClientRect().width < 3 || formula.querySelector("merror"))
    .map((formula) => formula.textContent)"""

UNRENDERED = re.compile(r"\\[a-z(\[]+|\$|^\s*(?:\* |\|.*\|$)|\]\(|\*\*|```|<math", flags=re.MULTILINE)
"""TeX or Markdown that is read as it was written."""


@pytest.mark.slow
def test_browser_shows_every_page(site: Path, visit: Visit) -> None:
    # The page of errors is for a server; what an export wrote is no page of ours.
    pages = [page for page in sorted(site.rglob("*.html")) if page.name not in ("404.html", "planar_strip_live.html")]
    assert len(pages) > 30
    for page in pages:
        visit.window.set_viewport_size(SIZES[0])
        visit.window.goto(page.as_uri())
        name = str(page.relative_to(site))
        assert visit.window.evaluate(BROKEN_IMAGES) == [], name
        assert visit.window.evaluate(UNSEEN_FORMULAS) == [], name
        words = visit.window.evaluate(WORDS_OF_ARTICLE)
        unrendered = [words[max(0, found.start() - 60) : found.end() + 60] for found in UNRENDERED.finditer(words)]
        assert unrendered == [], name
        # On a telephone tables and formulas scroll by themselves, the page does not.
        visit.window.set_viewport_size(SIZES[1])
        assert visit.window.evaluate("document.documentElement.scrollWidth") <= SIZES[1]["width"], name
        assert visit.faults == [], name


BROKEN = r"""<!DOCTYPE html>
<article><p>A formula \(x\) as it was written</p><img src="nowhere.png" loading="lazy"></article>
<math><mi></mi></math>
<script>nothing.happens()</script>"""


def test_faults_of_a_page_are_seen(tmp_path: Path, visit: Visit) -> None:
    page = tmp_path / "broken.html"
    page.write_text(BROKEN)
    visit.window.goto(page.as_uri())
    (image,) = visit.window.evaluate(BROKEN_IMAGES)
    assert image.endswith("nowhere.png")
    assert visit.window.evaluate(UNSEEN_FORMULAS) == [""]
    assert UNRENDERED.search(visit.window.evaluate(WORDS_OF_ARTICLE))
    assert "nothing is not defined" in visit.faults
    assert any("nowhere.png does not load" in fault for fault in visit.faults)


@pytest.mark.slow
def test_formulas_are_drawn_in_the_font_of_the_site(site: Path, visit: Visit) -> None:
    visit.window.goto((site / "theory.html").as_uri())
    assert visit.window.evaluate("document.fonts.ready.then(() => document.fonts.check('16px Formulas', 'ξ'))")
    formulas = visit.window.locator("math").count()
    assert formulas > 400
    # Subscripts, fractions and roots are drawn as such: a tall formula is taller than its letters.
    tallest = visit.window.evaluate("Math.max(...[...document.querySelectorAll('math')].map((m) => m.clientHeight))")
    assert tallest > 50


@pytest.mark.slow
def test_search_finds_pages_on_a_site_that_no_server_serves(site: Path, visit: Visit) -> None:
    visit.window.goto((site / "index.html").as_uri())
    visit.window.keyboard.press("f")
    visit.window.locator(".md-search__input").wait_for()
    visit.window.keyboard.type("bifurcation")
    found = visit.window.locator(".md-search-result__item a").first
    found.wait_for()
    assert "paths.html" in found.get_attribute("href")
    assert visit.faults == []


@pytest.mark.slow
def test_gallery_shows_pictures_scenes_and_pages_that_move(site: Path, visit: Visit) -> None:
    visit.window.goto((site / "gallery" / "index.html").as_uri())
    card = visit.window.locator(".gallery li", has_text="Plastic strip")
    assert card.locator("img").count() == 1
    card.locator("a").click()
    article = visit.window.locator("article")
    # The heading of the page is there before all of it is.
    article.get_by_text("Equilibrium found").first.wait_for()
    article.get_by_text('name = "strip"').first.wait_for()
    visit.window.locator("iframe.live").scroll_into_view_if_needed()
    assert visit.window.frame_locator("iframe.live").locator("#strip").inner_text() == "moves"


# What needs no browser


@pytest.mark.slow
def test_contents_of_the_site_are_those_of_the_contents_page(site: Path) -> None:
    page = (site / "index.html").read_text()
    for file in (ROOT / "docs").glob("*.md"):
        name = {"index.md": "contents.md"}.get(file.name, file.name)
        assert f'href="{Path(name).stem}.html"' in page, name


def test_every_command_and_option_is_on_its_page() -> None:
    page = command_page()
    for name in LINES:
        assert f"\n## {name}\n" in page
    assert "| `--tolerance TOLERANCE` |" in page
    assert "| `SCENE` | required | Scene file (TOML). |" in page


def test_every_function_of_a_header_is_on_the_page_of_functions() -> None:
    page = functions_page()
    header = (ROOT / "generated" / "nitinol_wire" / "nitinol_wire.h").read_text()
    declared = set(re.findall(r"^(?:[a-z]\w*|const char) \*?nitinol_wire_(\w+)\(", header, flags=re.MULTILINE))
    assert len(declared) > 15
    for name in declared:
        assert f"nitinol_wire_{name}(" in page or f"`NAME_{name.removesuffix('_wire')}`" in page, name


@pytest.mark.slow
def test_link_that_leads_nowhere_is_an_error(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("material", reason=NEEDS_THEME)
    from docs.site.build import SiteError, build_site

    def stage_with_fault(folder: Path, *_: Any) -> list[Any]:
        (folder / "index.md").write_text("# Start\n\n[Nowhere](index.md#nowhere)\n")
        return [{"Start": "index.md"}]

    monkeypatch.setattr("docs.site.build.stage_pages", stage_with_fault)
    with pytest.raises(SiteError):
        build_site(tmp_path / "site", tmp_path)


@pytest.mark.slow
def test_formula_that_cannot_be_read_is_a_warning(caplog: pytest.LogCaptureFixture) -> None:
    pytest.importorskip("latex2mathml", reason=NEEDS_THEME)
    from docs.site.formulas import mathml

    assert "<mfrac>" in mathml(r"\frac{1}{2}", "inline", "theory.md")
    assert not caplog.records
    mathml(r"\nonsense{1}", "inline", "theory.md")
    assert "nonsense" in caplog.text


def test_examples_are_drawn_once(runs: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    drawn: list[str] = []
    monkeypatch.setattr("docs.site.gallery.SCENES", EXAMPLES)
    monkeypatch.setattr("docs.site.gallery.MOTIONS", ())
    monkeypatch.setattr("docs.site.gallery.run_example", lambda arguments: drawn.append(Path(arguments[1]).stem))
    draw_examples(runs)
    assert drawn == []
    (runs / "planar_strip.png").rename(runs / "kept.png")
    draw_examples(runs)
    (runs / "kept.png").rename(runs / "planar_strip.png")
    assert drawn == ["planar_strip"]


def test_example_that_fails_ends_the_build() -> None:
    with pytest.raises(ExampleError, match="exit code 2"):
        run_example(["solve", "nowhere.toml"])


def test_gallery_has_every_scene_of_the_repository(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from examples.demo import MOTIONS, SCENES

    names = (*SCENES, *MOTIONS)
    assert sorted(names) == sorted(path.stem for path in (ROOT / "examples").glob("*.toml"))
    for name in names:
        (tmp_path / f"{name}.json").write_text(json.dumps({"message": "Done.", "error_estimate": 1e-7}))
        Image.new("RGB", (100, 50)).save(tmp_path / f"{name}.png")
    contents = write_gallery(tmp_path / "gallery", tmp_path)
    cards = (tmp_path / "gallery" / "index.md").read_text()
    for name in names:
        assert f"]({name}.md)" in cards
        assert "Estimated error: 1.0e-07 of the length." in (tmp_path / "gallery" / f"{name}.md").read_text()
    programs = sorted(path.stem for path in (ROOT / "examples").glob("*.py") if path.stem not in ("demo", "__init__"))
    for name in programs:
        assert f"]({name}.md)" in cards
    assert len(contents) == 1 + len(names) + len(programs)
