"""Disks in exact contact with planes: reading writes each as a disk-shaped body without mass, fixed to its section."""

from __future__ import annotations

import re
from typing import Any

from cosserat_casadi.scene.disk_record import Disks, tables_of
from cosserat_casadi.scene.faults import Table, list_of
from cosserat_casadi.scene.joint_ends import add_unlisted_body
from cosserat_casadi.scene.obstacle_records import OBSTACLES
from cosserat_casadi.scene.records import sound

SEATED = {"name", "listed", "radius", "thickness"}
"""Keys of a body that stands for a disk."""

SEAT = {"kind", "body", "rod", "at"}
"""Keys of the joint that holds a body which stands for a disk."""


def seat_disks(tables: dict[str, Any]) -> None:
    """Write disks that touch obstacles without a width as bodies without mass, each fixed to its section.

    Rows with sizes or places that are parameters are left as they are: the obstacle refuses them.
    """
    if not all(isinstance(tables.get(key, []), list) for key in ("bodies", "joints")):
        return
    listed = list_of(tables.get("parameters"))
    free = [name for entry in listed for name in (entry if isinstance(entry, list) else [entry])]
    rows: dict[str, Disks] = {}
    seated: dict[str, list[str]] = {}
    for row in tables_of(tables, "disks"):
        record = sound(Disks, row)
        if record is None:
            continue
        name = str(record.name)
        stood_alone = _unseat(tables, name)
        named = [str(entry) for entry in free if str(entry).startswith(f"{name}.")]
        if any(entry != f"{name}.mass" for entry in named):
            continue
        rows.setdefault(name, record)
        if stood_alone:
            seated[name] = _seated(tables, record)
    for obstacle in tables_of(tables, "obstacles"):
        for name in list(list_of(obstacle.get("disks"))) if touches_disks(obstacle) else []:
            is_row = isinstance(name, str) and name in rows
            if not is_row or not isinstance(obstacle.get("bodies", []), list):
                continue
            if name not in seated:
                seated[name] = _seated(tables, rows[name])
            obstacle["disks"].remove(name)
            obstacle.setdefault("bodies", []).extend(seated[name])
        if obstacle.get("disks") == [] and "bodies" in obstacle:
            del obstacle["disks"]


def _seated(tables: dict[str, Any], row: Disks) -> list[str]:
    """Put bodies in the sections of a row of disks and return their names."""
    names = []
    for number, at in enumerate(row.places):
        size = {"radius": row.radius, "thickness": row.thickness}
        body = add_unlisted_body(tables, f"{row.name}[{number}]", **size)
        names.append(body)
        tables.setdefault("joints", []).append({"kind": "fixed", "body": body, "rod": row.rod, "at": at})
    return names


def _unseat(tables: dict[str, Any], row: str) -> bool:
    """Replace bodies that an earlier reading wrote for a row by the row, with its present sizes and places.

    Obstacles that name all of these bodies name the row again; other obstacles keep the names of the bodies.

    Returns:
        whether there were such bodies, but no obstacle that names the row.
    """
    bodies = [
        body
        for body in tables_of(tables, "bodies")
        if re.fullmatch(re.escape(row) + r"\[\d+\]", str(body.get("name"))) and set(body) == SEATED
    ]
    names = [body["name"] for body in bodies]
    if not names:
        return False
    planes = [obstacle for obstacle in tables_of(tables, "obstacles") if touches_disks(obstacle)]
    touching = [obstacle for obstacle in planes if {*names} <= {*list_of(obstacle.get("bodies"))}]
    for obstacle in touching:
        others = [name for name in obstacle["bodies"] if name not in names]
        obstacle["bodies"] = others
        if not others:
            del obstacle["bodies"]
        obstacle["disks"] = [*list_of(obstacle.get("disks")), row]
    tables["bodies"] = [body for body in tables["bodies"] if body not in bodies]
    tables["joints"] = [joint for joint in tables["joints"] if joint.get("body") not in names or set(joint) != SEAT]
    return not touching


def touches_disks(obstacle: Table) -> bool:
    """Whether an obstacle touches disks exactly: one without a width that is a plane."""
    record = OBSTACLES.record_of(obstacle)
    return "width" not in obstacle and record is not None and record.is_flat
