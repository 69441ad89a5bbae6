"""Writes examples/notebook.ipynb from docs/notebook.md: blocks of Python become cells of code, all else text.

`make api` runs it. The notebook lies beside the scenes, so that its paths do without the folder ``examples``.
"""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
PAGE = ROOT / "docs" / "notebook.md"
NOTEBOOK = ROOT / "examples" / "notebook.ipynb"

BLOCK = re.compile(r"^```python\n(.*?)^```$", flags=re.DOTALL | re.MULTILINE)


def notebook() -> str:
    """The text of the notebook: format 4.5, without outputs."""
    # The pattern has one group: texts and blocks take turns.
    parts = BLOCK.split(PAGE.read_text(encoding="utf-8"))
    cells = [_cell(index, part.strip(), is_code=index % 2 == 1) for index, part in enumerate(parts) if part.strip()]
    data = {
        "cells": cells,
        "metadata": {
            "kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"},
            "language_info": {"name": "python"},
        },
        "nbformat": 4,
        "nbformat_minor": 5,
    }
    return json.dumps(data, indent=1, ensure_ascii=False) + "\n"


def _cell(index: int, text: str, *, is_code: bool) -> dict[str, Any]:
    cell: dict[str, Any] = {"id": f"cell-{index}", "metadata": {}}
    if is_code:
        source = text.replace('"examples/', '"')
        cell |= {"cell_type": "code", "execution_count": None, "outputs": []}
    else:
        # Pages beside this one are not beside the notebook.
        source = re.sub(r"\[([^\]]+)\]\([^)]+\)", r"\1", text)
        cell |= {"cell_type": "markdown"}
    return {**cell, "source": source.splitlines(keepends=True)}


if __name__ == "__main__":
    NOTEBOOK.write_text(notebook(), encoding="utf-8")
