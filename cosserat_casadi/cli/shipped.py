"""Files that come with the package: examples and pages of the documentation.

In a wheel they are inside the package; in a checkout they are in the repository's folders, from which setup.py copies
them into wheels.
"""

from __future__ import annotations

import ast
import json
import os
import re
import tomllib
from dataclasses import dataclass
from pathlib import Path

PACKAGE = Path(__file__).resolve().parents[1]


def shipped_folder(name: str) -> Path:
    """The folder ``examples`` or ``docs``."""
    inside = PACKAGE / name
    if inside.is_dir():
        return inside
    return PACKAGE.parent / name


@dataclass(frozen=True)
class Example:
    """An example that comes with the package.

    Attributes:
        name: path in the folder of examples, without suffix.
        file: a scene, a table of a sweep, a program, or a notebook.
        title: one sentence.
        needs: further files of the folder of examples that it reads or mentions.
    """

    name: str
    file: Path
    title: str
    needs: tuple[Path, ...]


def examples() -> dict[str, Example]:
    """All examples by name: scenes, tables of sweeps, programs, notebooks."""
    folder = shipped_folder("examples")
    found = {}
    for pattern in ("*.toml", "sweeps/*.toml", "validation/*.toml", "*.py", "*.ipynb"):
        for file in sorted(folder.glob(pattern)):
            name = file.relative_to(folder).with_suffix("").as_posix()
            found[name] = Example(name, file, _title(file), _needs(file, folder))
    return found


def pages() -> dict[str, Path]:
    """Pages of the documentation by name: their paths in the folder of pages, without suffix."""
    folder = shipped_folder("docs")
    files = [*sorted(folder.glob("*.md")), *sorted(folder.glob("api/*.md"))]
    return {file.relative_to(folder).with_suffix("").as_posix(): file for file in files}


def page_title(page: Path) -> str:
    """The first heading of a page."""
    lines = page.read_text(encoding="utf-8").splitlines()
    return next(line.removeprefix("# ") for line in lines if line.startswith("# "))


def _needs(file: Path, folder: Path) -> tuple[Path, ...]:
    """Other files that an example reads or mentions.

    Tables that a scene names, and what their folder says of source and licence; modules that a program imports from a
    folder beside it; scenes and sources in C whose names stand in a program, its modules, a notebook, or a table of a
    sweep.
    """
    if file.suffix == ".toml" and file.parent.name != "sweeps":
        scene = tomllib.loads(file.read_text(encoding="utf-8"))
        entries = [*scene.get("measurements", []), *scene.get("motions", [])]
        tables = {Path(os.path.normpath(file.parent / entry["file"])) for entry in entries if "file" in entry}
        notices = {table.with_name("README.md") for table in tables}
        return tuple(sorted(tables | {notice for notice in notices if notice.exists()}))
    words = _words(file)
    modules = [module for module in sorted(folder.glob("*/*.py")) if {module.stem, module.parent.name} <= words]
    words = words.union(*map(_words, modules))
    others = [*sorted(folder.glob("*.toml")), *sorted(folder.glob("*.c"))]
    return (*modules, *(other for other in others if other.stem in words))


def _words(file: Path) -> set[str]:
    return set(re.findall(r"\w+", file.read_text(encoding="utf-8")))


def _title(file: Path) -> str:
    """The title of a scene, else its first comment; the first line of a program or a notebook."""
    text = file.read_text(encoding="utf-8")
    if file.suffix == ".ipynb":
        return str(json.loads(text)["cells"][0]["source"][0]).lstrip("# ").strip()
    if file.suffix == ".py":
        doc = ast.get_docstring(ast.parse(text)) or ""
        return doc.partition("\n")[0]
    title = tomllib.loads(text).get("title")
    if title is not None:
        return str(title)
    return text.partition("\n")[0].lstrip("# ")
