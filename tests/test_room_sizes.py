"""Lines that each room of the package may have. Budgets fall, and grow only with physics."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

import pytest

from tests.conftest import ROOT

PACKAGE = ROOT / "cosserat_casadi"

LINES = {
    "accuracy": 3_610,
    "actuators": 470,
    "beside rooms": 610,
    "cli": 4_390,
    "codegen": 11_600,
    "compiling": 4_530,
    "constraints": 1_040,
    "control": 2_850,
    "environments": 340,
    "equilibrium": 7_310,
    "estimation": 1_770,
    "identification": 4_730,
    "loads": 2_340,
    "maths": 2_600,
    "mjcf": 1_070,
    "model": 11_660,
    "motion": 14_190,
    "numerics": 5_530,
    "obstacles": 470,
    "page": 830,
    "paths": 2_780,
    "plots": 4_000,
    "results": 2_060,
    "rod": 6_040,
    "scene": 9_750,
    "sweeps": 3_770,
    "tubes": 3_280,
    "view": 1_130,
}
"""Budget of lines of Python for each room; modules beside the rooms count as one room."""

BESIDE_ROOMS = "beside rooms"

SLACK = 0.02
"""Share of a budget that may be unused: a room that has become smaller has its budget lowered."""


def room_of(path: Path) -> str:
    parts = path.relative_to(PACKAGE).parts
    return parts[0] if len(parts) > 1 else BESIDE_ROOMS


def lines_of_rooms() -> Counter[str]:
    lines: Counter[str] = Counter()
    for path in PACKAGE.rglob("*.py"):
        lines[room_of(path)] += path.read_text(encoding="utf-8").count("\n")
    return lines


def test_every_room_has_a_budget() -> None:
    assert set(LINES) == set(lines_of_rooms())


@pytest.mark.parametrize("room", LINES)
def test_a_room_keeps_to_its_budget(room: str) -> None:
    lines = lines_of_rooms()[room]
    assert lines <= LINES[room], f"{room} has {lines} lines: fold what is there twice, or say which physics it takes"
    assert lines >= (1 - SLACK) * LINES[room] - 20, f"{room} has {lines} lines: lower its budget"
