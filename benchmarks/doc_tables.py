"""Tables in Markdown, and their places in the pages."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path


def table(headings: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Rows of cells below their headings."""
    lines = [headings, ("---",) * len(headings), *rows]
    return "\n".join(f"| {' | '.join(cells)} |" for cells in lines)


def rows_of(page: Path, begin: str, end: str) -> list[list[str]]:
    """Cells of the rows of the table between its marks in a page, without the headings."""
    text = page.read_text().split(begin)[1].split(end)[0]
    lines = [line for line in text.splitlines() if line.startswith("| ")]
    return [[cell.strip() for cell in line.strip("| ").split(" | ")] for line in lines[2:]]


def put(page: Path, begin: str, end: str, text: str) -> None:
    """Put a text between its marks in a page."""
    before, rest = page.read_text().split(begin)
    _, after = rest.split(end)
    page.write_text(f"{before}{begin}\n{text}\n{end}{after}")
