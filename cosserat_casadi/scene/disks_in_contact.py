"""Disks that touch planes exactly: written as bodies without mass, which are disks, each fixed to its section."""

from __future__ import annotations

import re
from typing import Any

from cosserat_casadi.scene.disk_record import Disks, tables_of
from cosserat_casadi.scene.faults import Table
from cosserat_casadi.scene.joint_ends import add_unlisted_body
from cosserat_casadi.scene.obstacle_records import OBSTACLES
from cosserat_casadi.scene.records import sound

SEATED = {"name", "listed", "radius", "thickness"}
"""Keys of a body that stands for a disk."""

SEAT = {"kind", "body", "rod", "at"}
"""Keys of the joint that holds it."""


def seat_disks(tables: dict[str, Any]) -> None:
    """Write disks that touch obstacles without a width as bodies without mass, each fixed to its section.

    Rows whose sizes or places are parameters are left for the obstacle to refuse.
    """
    if not all(isinstance(tables.get(key, []), list) for key in ("bodies", "joints")):
        return
    for row in tables_of(tables, "disks"):
        _unseat(tables, str(row.get("name")))
    seated: dict[str, list[str]] = {}
    free = [name for entry in _listed(tables, "parameters") for name in (entry if isinstance(entry, list) else [entry])]
    for obstacle in tables_of(tables, "obstacles"):
        for name in list(_listed(obstacle, "disks")) if touches_disks(obstacle) else []:
            rows = [row for row in tables_of(tables, "disks") if row.get("name") == name]
            record = sound(Disks, rows[0]) if rows else None
            named = [str(entry) for entry in free if str(entry).startswith(f"{name}.")]
            is_parametric = any(entry != f"{name}.mass" for entry in named)
            if record is None or is_parametric or not isinstance(obstacle.get("bodies", []), list):
                continue
            if name not in seated:
                seated[name] = _seated(tables, record)
            obstacle["disks"].remove(name)
            obstacle.setdefault("bodies", []).extend(seated[name])
        if obstacle.get("disks") == [] and "bodies" in obstacle:
            del obstacle["disks"]


def _seated(tables: dict[str, Any], row: Disks) -> list[str]:
    """Put bodies in the sections of a row of disks; their names."""
    names = []
    for number, at in enumerate(row.places):
        size = {"radius": row.radius, "thickness": row.thickness}
        body = add_unlisted_body(tables, f"{row.name}[{number}]", **size)
        names.append(body)
        tables.setdefault("joints", []).append({"kind": "fixed", "body": body, "rod": row.rod, "at": at})
    return names


def _unseat(tables: dict[str, Any], row: str) -> None:
    """Write bodies that an earlier reading wrote for a row as the row again, whose sizes and places may have changed.

    The row is written at the obstacles that name all of these bodies; at others their names stay.
    """
    bodies = [
        body
        for body in tables_of(tables, "bodies")
        if re.fullmatch(re.escape(row) + r"\[\d+\]", str(body.get("name"))) and set(body) == SEATED
    ]
    names = [body["name"] for body in bodies]
    planes = [obstacle for obstacle in tables_of(tables, "obstacles") if touches_disks(obstacle)]
    touching = [obstacle for obstacle in planes if names and {*names} <= {*_listed(obstacle, "bodies")}]
    if not touching:
        return
    for obstacle in touching:
        others = [name for name in obstacle["bodies"] if name not in names]
        obstacle["bodies"] = others
        if not others:
            del obstacle["bodies"]
        obstacle["disks"] = [*_listed(obstacle, "disks"), row]
    tables["bodies"] = [body for body in tables["bodies"] if body not in bodies]
    tables["joints"] = [joint for joint in tables["joints"] if joint.get("body") not in names or set(joint) != SEAT]


def _listed(table: dict[str, Any], key: str) -> list[Any]:
    """The list of a key, which may be faulty or missing."""
    listed = table.get(key)
    return listed if isinstance(listed, list) else []


def touches_disks(obstacle: Table) -> bool:
    """Whether an obstacle touches disks exactly: one without a width that is a plane."""
    record = OBSTACLES.record_of(obstacle)
    return "width" not in obstacle and record is not None and record.is_flat
