"""The files of a path: JSON with everything, CSV with the load–displacement table."""

from __future__ import annotations

import csv
import io
import json
from typing import Any

from cosserat_casadi.equilibrium.solution import Pose
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.paths.follow import EquilibriumPath, PathEvent
from cosserat_casadi.results.solution_file import plain

Sections = dict[str, tuple[float, FloatArray]]
"""For rods whose tip is held: an abscissa and the positions there, shape (k, 3)."""


def path_result(path: EquilibriumPath) -> dict[str, Any]:
    """A path as the plain data of its file; a number that is not finite becomes null."""
    tips = {name: path.tip(name) for name in path.model.discrete.rods}
    held = {name: path.section(name) for name in tips if path.section(name) < 1.0}
    sections = {name: (X, path.position(X, name)) for name, X in held.items()}
    data = {
        "schema": 1,
        "title": path.model.scene.title,
        "input": path.name,
        "value": path.value.T.squeeze(),
        "outcome": path.outcome.label,
        "message": path.message,
        "error_estimate": path.error_estimate,
        "branch": path.branch,
        "discretisation": {
            name: {"modes": list(d.modes), "nodes": d.nodes, "breaks": list(d.breaks), "transport": d.transport}
            for name, d in path.model.discretisation.items()
        },
        "path": [
            {"factor": float(factor), **_judged(path, i), "rods": _rods(tips, i, sections)}
            for i, factor in enumerate(path.factor)
        ],
        "events": [
            {
                "kind": event.kind,
                "factor": event.factor,
                "multiplicity": event.multiplicity,
                "before": event.position,
                "rods": _rods(*_at_event(path, event)),
            }
            for event in path.events
        ],
    }
    found: dict[str, Any] = plain(data)
    return found


def path_text(path: EquilibriumPath) -> str:
    """The file of a path as text."""
    return json.dumps(path_result(path), indent=1, allow_nan=False, ensure_ascii=False) + "\n"


def path_table(path: EquilibriumPath) -> str:
    """The points of a path as CSV: factor, stability, tip positions (m) and quaternions of every rod."""
    tips = {name: path.tip(name) for name in path.model.discrete.rods}
    columns = [f"{name}.{axis}" for name in tips for axis in ("x", "y", "z", "qw", "qx", "qy", "qz")]
    lines = io.StringIO()
    writer = csv.writer(lines, lineterminator="\n")
    writer.writerow(["factor", "stable", "smallest_eigenvalue", *columns])
    for i, factor in enumerate(path.factor):
        judged = ["" if word is None else str(word).lower() for word in _judged(path, i).values()]
        poses = [number for tip in tips.values() for number in (*tip.position[i], *tip.quaternion[i])]
        writer.writerow([repr(float(factor)), judged[0], judged[2], *[repr(float(number)) for number in poses]])
    return lines.getvalue()


def _judged(path: EquilibriumPath, i: int) -> dict[str, bool | float | None]:
    stable, neutral, least = path.stable, path.neutral, path.smallest_eigenvalue
    if stable is None or neutral is None or least is None:
        return {"stable": None, "neutral": None, "smallest_eigenvalue": None}
    return {"stable": bool(stable[i]), "neutral": bool(neutral[i]), "smallest_eigenvalue": float(least[i])}


def _at_event(path: EquilibriumPath, event: PathEvent) -> tuple[dict[str, Pose], int, Sections]:
    tips = {name: path.event_tip(event, name) for name in path.model.discrete.rods}
    held = {name: path.section(name) for name in tips if path.section(name) < 1.0}
    return tips, 0, {name: (X, path.event_position(event, X, name)[None, :]) for name, X in held.items()}


def _rods(tips: dict[str, Pose], i: int, sections: Sections) -> dict[str, Any]:
    """Tips of all rods at point i, and of a rod whose tip is held a section that moves."""
    found: dict[str, Any] = {}
    for name, tip in tips.items():
        found[name] = {"tip": {"position": tip.position[i], "quaternion": tip.quaternion[i]}}
        if name in sections:
            X, positions = sections[name]
            found[name]["section"] = {"X": X, "position": positions[i]}
    return found
