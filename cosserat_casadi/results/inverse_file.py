"""The file of an inverse problem: the result at the inputs found, and how far each target is missed."""

from __future__ import annotations

import json
from typing import Any

from cosserat_casadi.control.inverse import Inverse
from cosserat_casadi.results.solution_file import plain, result


def inverse_result(found: Inverse) -> dict[str, Any]:
    """What was found as the plain data of its file; a number that is not finite becomes null."""
    targets = [
        {"kind": target.kind, "what": gap.what, "position_gap": gap.position, "angle_gap": gap.angle}
        for target, gap in zip(found.solution.model.scene.targets, found.gaps, strict=True)
    ]
    data: dict[str, Any] = plain({**result(found.solution), "targets_met": found.met, "targets": targets})
    return data


def inverse_text(found: Inverse) -> str:
    """The file as text."""
    return json.dumps(inverse_result(found), indent=1, allow_nan=False, ensure_ascii=False) + "\n"
