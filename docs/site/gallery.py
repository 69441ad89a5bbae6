"""The gallery: a card for each example, and a page with its picture, its scene and how its run ended."""

from __future__ import annotations

import ast
import json
import shutil
import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from PIL import Image

from cosserat_casadi.cli.main import app, run
from examples.demo import MOTIONS, PAGES, SCENES, arguments_of, can_write_pages, page_arguments

ROOT = Path(__file__).resolve().parents[2]
EXAMPLES = ROOT / "examples"
FIGURES = (ROOT / "docs" / "figures", ROOT / "docs")

PROGRAMS = (
    "carry_load",
    "design_finger",
    "design_spring",
    "feel_tip_force",
    "tendon_robot_mpc",
    "tendon_robot_swing_free",
    "trace_circle",
)
"""Programs of examples/, whose pictures are those of the pages: they optimise for minutes."""

NO_CONTENTS = "---\nhide:\n  - toc\n---\n\n"
"""Leaves the cards the whole width."""

WORDS = """# Gallery

Every scene and program of `examples/`, and what comes out when it is run. `cosserat examples` copies them for you."""


ROBOT = (0.0, 0.08, 0.54, 0.92)
"""Left, upper, right and lower edge of the robot in a figure of ``--plot``, relative to its size: panels stand beside
it, the title above and the legend below."""

WHOLE = (0.0, 0.0, 1.0, 1.0)

CARD_WIDTH = 560
"""Of the picture of a card, pixels."""


class ExampleError(Exception):
    """An example has not run to its end."""


@dataclass(frozen=True)
class Card:
    """An example in the gallery.

    Attributes:
        name: that of its file, without suffix.
        title: its heading.
        pictures: files that show it, films first.
        edges: left, upper, right and lower edge of what the card shows of a picture, relative to its size.
        sections: Markdown of its page, below heading and pictures.
    """

    name: str
    title: str
    pictures: tuple[Path, ...]
    edges: tuple[float, float, float, float]
    sections: tuple[str, ...]


def draw_examples(runs: Path) -> None:
    """Run the examples whose picture is older than the scene or than the package.

    Args:
        runs: folder of result files and pictures, that of ``make gallery``.

    Raises:
        ExampleError: one of them fails.
    """
    runs.mkdir(parents=True, exist_ok=True)
    sources = max(path.stat().st_mtime for path in (ROOT / "cosserat_casadi").rglob("*.py"))
    for name in (*SCENES, *MOTIONS):
        picture = runs / f"{name}.png"
        newest = max(sources, (EXAMPLES / f"{name}.toml").stat().st_mtime)
        if not picture.exists() or picture.stat().st_mtime < newest:
            run_example(arguments_of(name, runs))
            if name in PAGES and can_write_pages():
                run_example(page_arguments(name, runs))


def run_example(arguments: list[str]) -> None:
    """Run one command line of ``make gallery``.

    Raises:
        ExampleError: it ends with an exit code other than 0.
    """
    exit_code = run(lambda **options: app(arguments, **options))
    if exit_code != 0:
        raise ExampleError(f"cosserat {' '.join(arguments)} ended with exit code {exit_code}")


def write_gallery(folder: Path, runs: Path, examples: tuple[str, ...] | None = None) -> list[Any]:
    """Write the pages of the gallery.

    Args:
        folder: of the pages.
        runs: result files and pictures of the examples; where it has a page ``NAME.html`` too, that of
            ``cosserat export --page``, the page of the example shows it.
        examples: those that have run; by default all.

    Returns:
        the contents of the gallery, as MkDocs takes them.
    """
    folder.mkdir()
    if examples is None:
        examples = (*SCENES, *MOTIONS)
    cards = [_scene_card(name, runs) for name in examples] + [_program_card(name) for name in PROGRAMS]
    for card in cards:
        for picture in card.pictures:
            shutil.copyfile(picture, folder / picture.name)
        _draw_card(card, folder)
        page = runs / f"{card.name}.html"
        if page.exists():
            shutil.copyfile(page, folder / f"{card.name}_live.html")
        (folder / f"{card.name}.md").write_text(_page(card, live=page.exists()))
    listed = "\n".join(_listed(card) for card in cards)
    (folder / "index.md").write_text(f'{NO_CONTENTS}{WORDS}\n\n<div class="gallery" markdown>\n\n{listed}\n\n</div>\n')
    return ["gallery/index.md", *[{card.title: f"gallery/{card.name}.md"} for card in cards]]


def _scene_card(name: str, runs: Path) -> Card:
    text = (EXAMPLES / f"{name}.toml").read_text()
    title = tomllib.loads(text).get("title", name)
    found = json.loads((runs / f"{name}.json").read_text())
    command = " ".join(word.replace(f"{runs}/", "") for word in arguments_of(name, runs))
    command = command.replace(str(EXAMPLES), "examples")
    return Card(
        name=name,
        title=title,
        pictures=_pictures(name, runs),
        edges=ROBOT,
        sections=(
            f"```sh\ncosserat {command}\n```",
            f"{found['message']} {_error_words(found)}",
            f'## The scene\n\n```toml title="examples/{name}.toml"\n{text}```',
        ),
    )


def _pictures(name: str, *folders: Path) -> tuple[Path, ...]:
    """Film and picture of an example, as far as there are any."""
    files = [folder / f"{name}{suffix}" for suffix in (".gif", ".png") for folder in folders]
    return tuple(file for file in files if file.exists())


def _error_words(found: dict[str, Any]) -> str:
    error = found.get("error_estimate")
    if error is None:
        return ""
    return f"Estimated error: {error:.1e} of the length."


def _program_card(name: str) -> Card:
    text = (EXAMPLES / f"{name}.py").read_text()
    doc = ast.get_docstring(ast.parse(text)) or ""
    title, _, more = doc.partition("\n\n")
    return Card(
        name=name,
        title=title.rstrip("."),
        pictures=_pictures(name, *FIGURES),
        edges=WHOLE,
        sections=(
            f"```sh\npython examples/{name}.py --help\n```",
            more,
            f'## The program\n\n```python title="examples/{name}.py"\n{text}```',
        ),
    )


def _page(card: Card, *, live: bool) -> str:
    """The page of an example, with the page of its export where there is one."""
    pictures = [f"![{card.title}]({picture.name})" for picture in card.pictures]
    parts = [f"# {card.title}", *pictures, *card.sections]
    if live:
        frame = f'<iframe class="live" src="{card.name}_live.html" title="{card.title}" loading="lazy"></iframe>'
        parts.insert(1, frame)
    return "\n\n".join(parts) + "\n"


def _draw_card(card: Card, folder: Path) -> None:
    """Write the picture of a card: a film as it is, of the figure of a scene the robot alone."""
    picture = card.pictures[0]
    if picture.suffix == ".gif":
        return
    with Image.open(picture) as figure:
        left, upper, right, lower = card.edges
        box = (left * figure.width, upper * figure.height, right * figure.width, lower * figure.height)
        robot = figure.convert("RGB").crop([round(edge) for edge in box])
    robot.thumbnail((CARD_WIDTH, CARD_WIDTH))
    robot.save(folder / f"{card.name}_card.png")


def _card_picture(card: Card) -> str:
    picture = card.pictures[0]
    if picture.suffix == ".gif":
        return picture.name
    return f"{card.name}_card.png"


def _listed(card: Card) -> str:
    return f"* [![{card.title}]({_card_picture(card)}){{ loading=lazy }}<br>{card.title}]({card.name}.md)"
