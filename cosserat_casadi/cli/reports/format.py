"""Common parts of reports."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path

from rich.console import Console
from rich.markup import escape
from rich.table import Table


def title_line(title: str | None) -> str:
    """The title of a scene, bold."""
    return f"[bold]{escape(title or 'Untitled scene')}[/]"


def print_outcome(console: Console, title: str | None, message: str, *, good: bool, doubtful: bool = False) -> None:
    """Print the title of a scene and the outcome of its computation, in green, yellow if doubtful, or red."""
    colour = "yellow" if doubtful else "green"
    console.print(title_line(title))
    console.print(f"[bold {colour if good else 'red'}]{escape(message)}[/]")


def print_written(console: Console, files: Iterable[Path], *, soft_wrap: bool = False) -> None:
    """Print the names of the written files."""
    for file in files:
        console.print(f"wrote {escape(str(file))}", soft_wrap=soft_wrap)


def table_of(
    *headings: str, right: Sequence[str] = (), unbroken: Sequence[str] = (), fold: Sequence[str] = ()
) -> Table:
    """An empty table.

    Args:
        headings: headings of text columns.
        right: headings of the following number columns, which are right-aligned.
        unbroken: text columns without line breaks.
        fold: text columns with line breaks inside long words, so that names are not cut off.
    """
    table = Table()
    for heading in headings:
        table.add_column(heading, no_wrap=heading in unbroken, overflow="fold" if heading in fold else "ellipsis")
    for heading in right:
        table.add_column(heading, justify="right")
    return table


def listed(numbers: Sequence[int], noun: str) -> str:
    """Noun and numbers, such as "row 3" or "rows 3, 7"."""
    numbers_text = ", ".join(str(number) for number in numbers)
    if len(numbers) > 1:
        noun = f"{noun}s"
    return f"{noun} {numbers_text}"


def print_warnings(console: Console, warnings: Iterable[str]) -> None:
    """Print warnings on a result, such as a discontinuous load."""
    for warning in warnings:
        console.print(f"[bold yellow]Warning:[/] {escape(warning)}", soft_wrap=True)
