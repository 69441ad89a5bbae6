"""The page "notebook.md" as a notebook: written from the page, copied by ``cosserat examples``, run cell by cell."""

from __future__ import annotations

import ast
import importlib.util
from pathlib import Path
from typing import Any

import nbformat
import pytest

from tests.commands import cosserat_line
from tests.conftest import ROOT
from tests.pages import DOCS, blocks, commands

NOTEBOOK = ROOT / "examples" / "notebook.ipynb"


def test_the_notebook_is_that_of_the_page() -> None:
    spec = importlib.util.spec_from_file_location("notebook_file", DOCS / "notebook_file.py")
    assert spec is not None
    assert spec.loader is not None
    writer = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(writer)
    assert NOTEBOOK.read_text(encoding="utf-8") == writer.notebook(), "run make api"
    cells = nbformat.read(NOTEBOOK, as_version=4).cells
    assert [cell.cell_type for cell in cells].count("code") == len(blocks(DOCS / "notebook.md", "python"))
    # No command stands on the page that this file would have to run.
    assert commands(DOCS / "notebook.md") == []


def run_cell(source: str, names: dict[str, Any]) -> Any:
    """Run a cell as a notebook does; the value of its last line where that is an expression."""
    body = ast.parse(source).body
    last = body.pop() if body and isinstance(body[-1], ast.Expr) else None
    exec(compile(ast.Module(body, []), "cell", "exec"), names)
    if last is None:
        return None
    assert isinstance(last, ast.Expr)
    return eval(compile(ast.Expression(last.value), "cell", "eval"), names)


@pytest.mark.slow
def test_the_copied_notebook_runs_cell_by_cell(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    done = cosserat_line("cosserat examples notebook --output .", tmp_path)
    assert done.returncode == 0, done.stderr
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    notebook = nbformat.read("notebook.ipynb", as_version=4)
    nbformat.validate(notebook)
    names: dict[str, Any] = {"__name__": "__main__"}
    shown = [run_cell(cell.source, names) for cell in notebook.cells if cell.cell_type == "code"]
    results = [value for value in shown if value is not None]
    assert [type(value).__name__ for value in results] == ["Solution", "ShownFigure"]
    assert results[1]._repr_png_().startswith(b"\x89PNG")
    assert "data:image/png" in results[0]._repr_html_()
