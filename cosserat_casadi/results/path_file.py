"""The files of a path: complete JSON, and CSV with the load–displacement table."""

from __future__ import annotations

from typing import Any

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.paths.equilibrium_path import EquilibriumPath, PathContact, PathEvent
from cosserat_casadi.results.contact_entry import contact_entry, place_entry, point_forces, rubbing_entries

POSE_COLUMNS = ("x", "y", "z", "qw", "qx", "qy", "qz")
"""Columns of a tip: position in m, quaternion."""


def _rod_entry(position: FloatArray, quaternion: FloatArray, X: float, section: FloatArray) -> dict[str, Any]:
    """The plain data of a rod: its tip, and a moving section if the tip is held."""
    tip = {"position": position, "quaternion": quaternion}
    # A moving tip needs no further section.
    if X == 1.0:
        return {"tip": tip}
    return {"tip": tip, "section": {"X": X, "position": section}}


def path_result(path: EquilibriumPath) -> dict[str, Any]:
    """A path as the data of its file."""
    data = {
        "title": path.model.scene.title,
        "input": path.name,
        "start": path.value_at(0.0).T.squeeze(),
        "value": path.value.T.squeeze(),
        "outcome": path.outcome.label,
        "message": path.message,
        "error_estimate": path.error_estimate,
        "branch": path.branch,
        "discretisation": path.model.resolution,
        "path": _point_entries(path),
        "events": [_event_entry(path, event) for event in path.events],
    }
    scene = path.model.scene
    if scene.has_contact and not scene.touches_exactly:
        entry = contact_entry(path.model, path.x, path.all_inputs)
        data["contact"] = entry | rubbing_entries(path, len(path.factor))
    return data


def path_table(path: EquilibriumPath) -> tuple[list[str], list[list[Any]]]:
    """Header and rows of the points of a path: factor, stability, tip positions (m) and quaternions of every rod."""
    tips = {name: path.tip(name) for name in path.model.discrete.rods}
    pose_columns = [f"{name}.{axis}" for name in tips for axis in POSE_COLUMNS]
    rows = []
    for index, factor in enumerate(path.factor):
        stability = _stability_entry(path, index)
        row = [factor, stability["stable"], stability["smallest_eigenvalue"]]
        for tip in tips.values():
            row += [*tip.position[index], *tip.quaternion[index]]
        rows.append(row)
    return ["factor", "stable", "smallest_eigenvalue", *pose_columns], rows


def _point_entries(path: EquilibriumPath) -> list[dict[str, Any]]:
    # Rods with a held tip have also a moving section.
    rods = {}
    for name in path.model.discrete.rods:
        X = path.section(name)
        tip = path.tip(name)
        along = zip(tip.position, tip.quaternion, path.position(X, name), strict=True)
        rods[name] = [_rod_entry(position, quaternion, X, section) for position, quaternion, section in along]
    entries = []
    for index, factor in enumerate(path.factor):
        entry: dict[str, Any] = {
            "factor": float(factor),
            **_stability_entry(path, index),
            "rods": {name: points[index] for name, points in rods.items()},
        }
        # Depths inside smooth obstacles are computed for the whole path at once.
        if path.model.scene.touches_exactly:
            entry["contacts"] = [
                {**place_entry(contact), "kind": contact.kind, **point_forces(contact), **_friction_entry(contact)}
                for contact in path.contacts(index)
            ]
        entries.append(entry)
    return entries


def _friction_entry(contact: PathContact) -> dict[str, Any]:
    """Friction of a contact, N, and whether it slips; empty without friction."""
    return {} if contact.friction is None else {"friction": contact.friction, "slips": contact.slips}


def _event_entry(path: EquilibriumPath, event: PathEvent) -> dict[str, Any]:
    rods = {}
    for name in path.model.discrete.rods:
        X = path.section(name)
        # Events lie between points of the path.
        tip = path.event_tip(event, name)
        rods[name] = _rod_entry(tip.position, tip.quaternion, X, path.event_position(event, X, name))
    entry = {
        "kind": event.kind,
        "factor": event.factor,
        "multiplicity": event.multiplicity,
        "before": event.position,
        "rods": rods,
    }
    if event.contact is not None:
        entry["contact"] = {**place_entry(event.contact), "kind": event.contact.kind}
    return entry


def _stability_entry(path: EquilibriumPath, index: int) -> dict[str, bool | float | None]:
    if path.stable is None or path.neutral is None or path.smallest_eigenvalue is None:
        return {"stable": None, "neutral": None, "smallest_eigenvalue": None}
    return {
        "stable": bool(path.stable[index]),
        "neutral": bool(path.neutral[index]),
        "smallest_eigenvalue": float(path.smallest_eigenvalue[index]),
    }
