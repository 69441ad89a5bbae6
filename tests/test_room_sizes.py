"""Lines that each room of the package may have. Budgets fall, and grow only with physics."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

import pytest

from tests.conftest import ROOT

PACKAGE = ROOT / "cosserat_casadi"

LINES = {
    "accuracy": 3_705,
    "actuators": 458,
    "beside rooms": 625,
    "cli": 4_410,
    "codegen": 11_880,
    "compiling": 5_450,
    "constraints": 1_030,
    "control": 2_795,
    "environments": 330,
    "equilibrium": 8_325,
    "estimation": 1_730,
    "identification": 4_650,
    "loads": 2_365,
    "maths": 2_643,
    "mjcf": 1_050,
    "model": 11_989,
    "motion": 15_835,
    "numerics": 5_400,
    "obstacles": 413,
    "page": 803,
    "paths": 3_745,
    "plots": 3_920,
    "results": 2_075,
    "rod": 6_128,
    "scene": 9_820,
    "sweeps": 3_708,
    "tubes": 3_250,
    "view": 1_095,
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
