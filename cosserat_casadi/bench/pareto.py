"""The Pareto front: points that no other point beats in both error and time."""

from __future__ import annotations

from collections.abc import Sequence

from cosserat_casadi.bench.measurement import Measurement


def front(rows: Sequence[Measurement]) -> list[Measurement]:
    """Rows that none beats in pose error and compiled cold solve, the cheapest first.

    Rows without a place in that plane, and those of other strain models, which solve another problem, do not count.
    Of equals the first stays.
    """
    found: list[Measurement] = []
    placed = [row for row in rows if row.placed and not row.strain]
    for row in sorted(placed, key=lambda row: (row.cold_us, row.pose_error)):
        if not found or row.pose_error < found[-1].pose_error:
            found.append(row)
    return found
