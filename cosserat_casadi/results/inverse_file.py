"""The file of an inverse problem: the result at the inputs found, and how far each target is missed."""

from __future__ import annotations

from typing import Any

from cosserat_casadi.control.inverse_result import Inverse
from cosserat_casadi.results.json_text import plain
from cosserat_casadi.results.solution_file import result


def inverse_result(inverse: Inverse) -> dict[str, Any]:
    """An inverse problem's end as the plain data of its file; a number that is not finite becomes null."""
    targets = []
    for target, gap in zip(inverse.targets, inverse.gaps, strict=True):
        entry = {
            "kind": target.kind,
            "what": gap.what,
            "position_gap": gap.position,
            "angle_gap": gap.angle,
            "position_error_estimate": gap.position_error,
            "angle_error_estimate": gap.angle_error,
        }
        targets.append(entry)
    data = {**result(inverse.solution), "targets_met": inverse.met, "targets": targets}
    plain_data: dict[str, Any] = plain(data)
    return plain_data
