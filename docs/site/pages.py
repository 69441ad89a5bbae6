"""Every page of the site in one folder: those of docs/, and those that are made when it is built."""

from __future__ import annotations

import re
import shutil
from pathlib import Path
from typing import Any

from docs.site.command_reference import command_page
from docs.site.functions_in_c import functions_page
from docs.site.gallery import write_gallery

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"
THEME = Path(__file__).with_name("theme")

BESIDE_DOCS = {
    ROOT / "README.md": "index.md",
    DOCS / "index.md": "contents.md",
    ROOT / "CHANGELOG.md": "changes.md",
    ROOT / "CONTRIBUTING.md": "contributing.md",
    ROOT / "cosserat_casadi" / "scene" / "scene.schema.json": "scene.schema.json",
}
"""What has another name on the site than in the repository, relative to docs/."""

COPIED = (".md", ".png", ".gif", ".svg")
"""Suffixes of the files of docs/ that the site shows."""

BLOCK_OR_LINK = re.compile(r"^```.*?^```$|(!?)\[([^\]]*)\]\(([^)\s]+)\)", flags=re.DOTALL | re.MULTILINE)

LISTED = re.compile(r"^\* \[([^\]]+)\]\(([^)]+)\)", flags=re.MULTILINE)
"""A page in docs/index.md: its title and its file."""


def stage_pages(folder: Path, runs: Path, examples: tuple[str, ...] | None = None) -> list[Any]:
    """Write all pages into a folder.

    Args:
        folder: an empty one.
        runs: as in :func:`docs.site.build.build_site`.
        examples: likewise.

    Returns:
        the contents of the site, as MkDocs takes them.
    """
    for source in _sources():
        _stage(source, folder / site_name(source))
    (folder / "commands.md").write_text(command_page())
    (folder / "functions-in-c.md").write_text(functions_page())
    gallery = write_gallery(folder / "gallery", runs, examples)
    shutil.copytree(THEME / "assets", folder / "assets", dirs_exist_ok=True)
    return _contents(gallery)


def site_name(source: Path) -> str:
    """Path of a file of the repository on the site."""
    if source in BESIDE_DOCS:
        return BESIDE_DOCS[source]
    return source.relative_to(DOCS).as_posix()


def _sources() -> list[Path]:
    """Files of the repository that the site shows."""
    files = [path for path in sorted(DOCS.rglob("*")) if path.suffix in COPIED and path not in BESIDE_DOCS]
    return [*BESIDE_DOCS, *files]


def _stage(source: Path, target: Path) -> None:
    target.parent.mkdir(parents=True, exist_ok=True)
    if source.suffix != ".md":
        shutil.copyfile(source, target)
        return
    text = BLOCK_OR_LINK.sub(lambda match: _link(match, source, target), source.read_text())
    target.write_text(text)


def _link(match: re.Match[str], source: Path, target: Path) -> str:
    """A link of a page as it leads on the site; one into the source becomes the path that it leads to."""
    mark, words, aim = match.groups()
    if aim is None or aim.startswith(("https://", "#")):
        return match[0]
    file, hash_sign, anchor = aim.partition("#")
    path = (source.parent / file).resolve()
    if path not in BESIDE_DOCS and not path.is_relative_to(DOCS):
        return f"{words} (`{path.relative_to(ROOT)}`)"
    depth = len(Path(site_name(source)).parts) - 1
    return f"{mark}[{words}]({'../' * depth}{site_name(path)}{hash_sign}{anchor})"


def _contents(gallery: list[Any]) -> list[Any]:
    """Contents of the site: the sections of docs/index.md, and what the site has beyond them."""
    _, *parts = re.split(r"^## ", (DOCS / "index.md").read_text(), flags=re.MULTILINE)
    sections = []
    for part in parts:
        title, _, text = part.partition("\n")
        entries = [_entry(words, aim) for words, aim in LISTED.findall(text)]
        sections.append({title: entries})
    start = [{"Start": "index.md"}, {"Contents": "contents.md"}]
    about = [{"Changes": "changes.md"}, {"Contributing": "contributing.md"}]
    return [{"Start": [*start, *about]}, *_each_once(sections), {"Gallery": gallery}]


def _entry(words: str, aim: str) -> dict[str, Any]:
    """A page in the contents; the references that are made for the site stand with those that they go on from."""
    further = {
        "command-line.md": [{"Every command and option": "commands.md"}],
        "c-interface.md": [{"Every function in C": "functions-in-c.md"}],
        "api/index.md": [f"api/{page.name}" for page in sorted((DOCS / "api").glob("*.md")) if page.name != "index.md"],
    }
    if aim in further:
        return {words: [aim, *further[aim]]}
    return {words: aim}


def _each_once(sections: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Sections of the contents in which a page that is listed twice stands where it is listed last."""
    seen: set[str] = set()
    kept = []
    for section in reversed(sections):
        ((title, entries),) = section.items()
        pages = [entry for entry in entries if str(*entry.values()) not in seen]
        seen.update(str(*entry.values()) for entry in entries)
        kept.append({title: pages})
    return kept[::-1]
