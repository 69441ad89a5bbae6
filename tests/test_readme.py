"""The first page: short, its scene the example, its figures those of docs/accuracy.md; test_pages runs its blocks."""

from __future__ import annotations

import re

from cosserat_casadi import parse_scene, read_scene
from tests.conftest import ROOT
from tests.pages import DOCS, blocks, commands, run_python

README = ROOT / "README.md"


def test_the_first_page_is_short() -> None:
    assert len(README.read_text().splitlines()) <= 120


def test_scene_of_the_readme_is_the_example() -> None:
    (text,) = blocks(README, "toml")
    assert parse_scene(text) == read_scene(ROOT / "examples" / "nitinol_wire.toml")


def test_python_of_the_readme_finds_an_equilibrium() -> None:
    (code,) = blocks(README, "python")
    assert "Equilibrium found" in run_python(code)


def test_there_are_five_commands() -> None:
    assert [line.split()[1] for line in commands(README)] == ["examples", "check", "solve", "simulate", "export"]


def cells(line: str) -> list[str]:
    return [cell.strip() for cell in line.strip("| ").split("|")]


def test_rows_of_the_race_are_those_of_the_page_on_accuracy() -> None:
    table = re.compile(r"<!-- race: written by benchmarks/race.py -->\n(.*?)\n<!-- end of race -->", flags=re.DOTALL)
    first_page, page = (table.findall(text.read_text()) for text in (README, DOCS / "accuracy.md"))
    rows = [cells(line) for line in first_page[0].splitlines()[2:]]
    known = [cells(line) for line in page[0].splitlines() if line.startswith("| B2 |")]
    assert len(rows) == 3
    assert rows == [[row[1], row[2], row[9], row[10], row[11]] for row in known]
