"""How finely a page paints what moves follows from how long its pictures take."""

from __future__ import annotations

import json
from pathlib import Path

from tests.page.pages_made import run_node

LATE = 50.0
"""Milliseconds of a picture that is late."""

QUICK = 17.0


def qualities(tmp_path: Path, times: list[float]) -> list[int]:
    """The quality after each picture, 0 for the finest."""
    file = tmp_path / "times.json"
    file.write_text(json.dumps(times))
    found: list[int] = run_node("pace.js", file)
    return found


def test_late_pictures_make_the_next_ones_coarser_and_quick_ones_finer(tmp_path: Path) -> None:
    # Three late ones for a step; not beyond the coarsest of four.
    assert qualities(tmp_path, [LATE] * 12) == [0, 0, 1, 1, 1, 2, 2, 2, 3, 3, 3, 3]
    # One that is late now and then, as while something else is loaded, changes nothing.
    assert set(qualities(tmp_path, [LATE, LATE, QUICK, QUICK] * 10)) == {0}
    found = qualities(tmp_path, [LATE] * 6 + [QUICK] * 120)
    assert found[5:65] == [2] * 60
    assert found[65:125] == [1] * 60
    assert found[125] == 0


def test_a_finer_quality_that_failed_is_tried_again_later_and_later(tmp_path: Path) -> None:
    found = qualities(tmp_path, [LATE] * 3 + [QUICK] * 60 + [LATE] * 3 + [QUICK] * 120 + [LATE] * 3 + [QUICK] * 239)
    steps = [i for i in range(1, len(found)) if found[i] != found[i - 1]]
    assert steps == [2, 62, 65, 185, 188]
    assert found[-1] == 1
