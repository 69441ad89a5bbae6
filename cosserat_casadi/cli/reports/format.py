"""Pieces that several reports share."""

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
    """Print the title of a scene and how its computation ended: in green, yellow where it is doubtful, or red."""
    colour = "yellow" if doubtful else "green"
    console.print(title_line(title))
    console.print(f"[bold {colour if good else 'red'}]{escape(message)}[/]")


def print_written(console: Console, files: Iterable[Path], *, soft_wrap: bool = False) -> None:
    """Name the files that were written."""
    for file in files:
        console.print(f"wrote {escape(str(file))}", soft_wrap=soft_wrap)


def table_of(
    *headings: str, right: Sequence[str] = (), unbroken: Sequence[str] = (), fold: Sequence[str] = ()
) -> Table:
    """An empty table.

    Args:
        headings: of columns of text.
        right: headings of the columns of numbers behind them, which stand on the right.
        unbroken: which of the first have words that stay on one line.
        fold: which of the first have words that are broken where they are too long: a name cut off names nothing.
    """
    table = Table()
    for heading in headings:
        table.add_column(heading, no_wrap=heading in unbroken, overflow="fold" if heading in fold else "ellipsis")
    for heading in right:
        table.add_column(heading, justify="right")
    return table


def listed(numbers: Sequence[int], noun: str) -> str:
    """Numbers behind their noun, such as "row 3" or "rows 3, 7"."""
    numbers_text = ", ".join(str(number) for number in numbers)
    if len(numbers) > 1:
        noun = f"{noun}s"
    return f"{noun} {numbers_text}"


def print_warnings(console: Console, warnings: Iterable[str]) -> None:
    """Print what limits a result, such as a load that jumps."""
    for warning in warnings:
        console.print(f"[bold yellow]Warning:[/] {escape(warning)}", soft_wrap=True)
