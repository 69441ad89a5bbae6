"""How dense the source is: for one checkout, or for two side by side.

Usage: ``python benchmarks/readability.py [CHECKOUT [CHECKOUT]] [--rooms]``; by default this checkout.

A function of ten lines that holds as much as one of thirty is no shorter to read: nodes of the syntax tree for each
line of a function's body see that. Beside them stand what is packed, what is chosen inside expressions, and comments.
"""

from __future__ import annotations

import ast
import io
import statistics
import tokenize
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

ROOT = Path(__file__).parents[1]
PACKAGE = "cosserat_casadi"

TOOL_COMMENTS = ("# type:", "# noqa", "# fmt:")
"""Beginnings of comments that are for tools and tell a reader nothing."""


@dataclass(frozen=True)
class Density:
    """What is counted in the sources of a folder.

    Attributes:
        files: number of them.
        lines: all, blank ones too.
        code_lines: lines that hold code: neither blank, nor a comment, nor part of a docstring.
        nodes_per_line: syntax nodes for each line of the body, for each function.
        packed: assignments of several values to as many targets.
        conditional: conditional expressions.
        comments: for readers.
    """

    files: int
    lines: int
    code_lines: int
    nodes_per_line: tuple[float, ...]
    packed: int
    conditional: int
    comments: int

    @property
    def figures(self) -> dict[str, str]:
        """What is printed, by its name."""
        return {
            "files": f"{self.files:,}",
            "lines": f"{self.lines:,}",
            "syntax nodes per body line, median": f"{statistics.median(self.nodes_per_line or (0.0,)):.1f}",
            "comments per 100 lines of code": f"{100 * self.comments / max(self.code_lines, 1):.1f}",
            "packed assignments per 1000 lines": f"{1000 * self.packed / max(self.lines, 1):.1f}",
            "conditional expressions per 1000 lines": f"{1000 * self.conditional / max(self.lines, 1):.1f}",
        }


def density(folder: Path) -> Density:
    """Count in all Python files below a folder."""
    texts = [file.read_text() for file in sorted(folder.rglob("*.py"))]
    trees = [ast.parse(text) for text in texts]
    nodes = [node for tree in trees for node in ast.walk(tree)]
    per_line = [figure for text, tree in zip(texts, trees, strict=True) for figure in nodes_per_line(text, tree)]
    return Density(
        files=len(texts),
        lines=sum(text.count("\n") for text in texts),
        code_lines=sum(code_lines(text, tree) for text, tree in zip(texts, trees, strict=True)),
        nodes_per_line=tuple(per_line),
        packed=sum(is_packed(node) for node in nodes),
        conditional=sum(isinstance(node, ast.IfExp) for node in nodes),
        comments=sum(comment_count(text) for text in texts),
    )


def is_packed(node: ast.AST) -> bool:
    """Whether a node is ``a, b = x, y``."""
    if not isinstance(node, ast.Assign):
        return False
    return isinstance(node.targets[0], ast.Tuple) and isinstance(node.value, ast.Tuple)


def comment_count(text: str) -> int:
    """Comments that are for readers."""
    tokens = tokenize.generate_tokens(io.StringIO(text).readline)
    comments = [token.string for token in tokens if token.type == tokenize.COMMENT]
    return sum(not comment.startswith(TOOL_COMMENTS) for comment in comments)


def nodes_per_line(text: str, tree: ast.Module) -> Iterator[float]:
    """Syntax nodes for each line of the body, without docstring and comments, of every function."""
    lines = text.splitlines()
    for function in ast.walk(tree):
        if not isinstance(function, ast.FunctionDef):
            continue
        body = function.body
        if is_docstring(body[0]):
            body = body[1:]
        if not body:
            continue
        source = lines[body[0].lineno - 1 : function.end_lineno]
        count = sum(holds_code(line) for line in source)
        yield sum(1 for statement in body for _ in ast.walk(statement)) / max(count, 1)


def code_lines(text: str, tree: ast.Module) -> int:
    """Lines that hold code, and no docstring."""
    docstrings = [node for node in ast.walk(tree) if isinstance(node, ast.Expr) and is_docstring(node)]
    documented: set[int] = set()
    for docstring in docstrings:
        documented.update(range(docstring.lineno, (docstring.end_lineno or docstring.lineno) + 1))
    lines = enumerate(text.splitlines(), start=1)
    return sum(holds_code(line) and number not in documented for number, line in lines)


def is_docstring(statement: ast.stmt) -> bool:
    if not isinstance(statement, ast.Expr) or not isinstance(statement.value, ast.Constant):
        return False
    return isinstance(statement.value.value, str)


def holds_code(line: str) -> bool:
    stripped = line.strip()
    return bool(stripped) and not stripped.startswith("#")


def generated_figures(checkout: Path) -> dict[str, str]:
    """Size of what is generated and committed."""
    files = [file for file in (checkout / "generated").rglob("*") if file.is_file()]
    size = sum(file.stat().st_size for file in files)
    lines = sum(file.read_bytes().count(b"\n") for file in files)
    return {"generated/, MB": f"{size / 1e6:.1f}", "generated/, lines": f"{lines:,}"}


def table(headings: Sequence[str], columns: Sequence[dict[str, str]]) -> str:
    """Figures as rows of Markdown, a column for each checkout."""
    rows = [(name, *(column[name] for column in columns)) for name in columns[0]]
    lines = [tuple(headings), ("---",) * len(headings), *rows]
    return "\n".join(f"| {' | '.join(cells)} |" for cells in lines)


def main(
    checkouts: Annotated[list[Path] | None, typer.Argument(help="One checkout, or two: before and after.")] = None,
    rooms: Annotated[bool, typer.Option("--rooms", help="Each folder of the package by itself too.")] = False,
) -> None:
    """Print the figures of one checkout, or of two side by side."""
    folders = checkouts or [ROOT]
    headings = {1: ("", "here"), 2: ("", "before", "after")}.get(len(folders))
    if headings is None:
        raise typer.BadParameter("give one checkout or two")
    print(table(headings, [density(folder / PACKAGE).figures | generated_figures(folder) for folder in folders]))
    if not rooms:
        return
    for room in sorted(child for child in (folders[-1] / PACKAGE).iterdir() if child.is_dir()):
        if any(room.rglob("*.py")):
            print(f"\n{room.name}\n")
            print(table(headings, [density(folder / PACKAGE / room.name).figures for folder in folders]))


if __name__ == "__main__":
    typer.run(main)
