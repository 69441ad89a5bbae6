"""``cosserat docs``."""

from __future__ import annotations

import sys
from typing import Annotated

import typer
from rich.markdown import Markdown
from rich.markup import escape

from cosserat_casadi.cli.reports.format import table_of
from cosserat_casadi.cli.shipped import page_title, pages
from cosserat_casadi.cli.terminal import Console
from cosserat_casadi.errors import Problem, SceneError


def docs(
    page: Annotated[
        str | None,
        typer.Argument(metavar="[PAGE]", help="Page to show; the list by default.", show_default=False),
    ] = None,
) -> None:
    """Show a page of the documentation. Exit codes: 0 shown, 2 there is none of this name."""
    found = pages()
    console = Console()
    if page is None:
        table = table_of("page", "title")
        for name, file in found.items():
            table.add_row(name, escape(page_title(file)))
        console.print(table)
        console.print("To show a page: cosserat docs PAGE")
        return
    if page not in found:
        raise SceneError(Problem("PAGE", f"there is no page {page}", "cosserat docs lists them"))
    text = found[page].read_text(encoding="utf-8")
    if not console.is_terminal:
        # Whoever reads it from a pipe looks for words.
        sys.stdout.write(text)
        return
    with console.pager(styles=True, links=True):
        console.print(Markdown(text))
