"""The Pareto front: points that no other point beats in both error and time."""

from __future__ import annotations

from collections.abc import Sequence

from cosserat_casadi.bench.measurement import Measurement


def front(rows: Sequence[Measurement]) -> list[Measurement]:
    """Rows that none beats in pose error and compiled cold solve, the cheapest first.

    Rows without a place in that plane, and those of other strain models, which solve another problem, do not count.
    Of equals the first stays.
    """
    unbeaten: list[Measurement] = []
    comparable = [row for row in rows if row.in_plane and not row.strain]
    comparable.sort(key=lambda row: (row.cold_us, row.pose_error))
    for row in comparable:
        # Dearer than all before: it must be more exact than the most exact of them, which is the last.
        if not unbeaten or row.pose_error < unbeaten[-1].pose_error:
            unbeaten.append(row)
    return unbeaten
