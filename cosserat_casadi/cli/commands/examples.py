"""``cosserat examples``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer
from rich.markup import escape

from cosserat_casadi.cli.reports.format import print_written, table_of
from cosserat_casadi.cli.shipped import Example, shipped_folder
from cosserat_casadi.cli.shipped import examples as shipped_examples
from cosserat_casadi.cli.terminal import Console
from cosserat_casadi.errors import Problem, refuse
from cosserat_casadi.files import write_atomically


def examples(
    names: Annotated[
        list[str] | None,
        typer.Argument(metavar="[NAME]…", help="Examples to copy; all by default.", show_default=False),
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option(metavar="FOLDER", help="Copy the examples into this folder, which is created if needed."),
    ] = None,
) -> None:
    """List the examples that come with the package, or copy them. Exit codes: 0 done, 2 refused."""
    found = shipped_examples()
    unknown = [
        Problem("NAME", f"there is no example {name}", "cosserat examples lists them")
        for name in names or ()
        if name not in found
    ]
    refuse(unknown)
    chosen = [found[name] for name in names or found]
    if output is None:
        _print_list(chosen)
    else:
        _copy(chosen, output)


def _print_list(chosen: list[Example]) -> None:
    console = Console()
    table = table_of("example", "what it shows")
    for example in chosen:
        table.add_row(escape(example.name), escape(example.title))
    console.print(table)
    console.print("To copy examples: cosserat examples NAME… --output FOLDER")


def _copy(chosen: list[Example], folder: Path) -> None:
    """Copy examples, with the files that they need, into a folder, all or none.

    Raises:
        SceneError: a file is there already, with another content.
    """
    root = shipped_folder("examples")
    sources = [source for example in chosen for source in (example.file, *example.needs)]
    targets = {folder / source.relative_to(root): source.read_bytes() for source in sources}
    changed = [file for file, content in targets.items() if file.exists() and file.read_bytes() != content]
    remedy = "nothing is overwritten: remove it, or name another folder"
    refuse(Problem("--output", f"{file} exists already, and differs", remedy) for file in changed)
    for file, content in targets.items():
        file.parent.mkdir(parents=True, exist_ok=True)
        write_atomically(file, content)
    print_written(Console(), targets, soft_wrap=True)
