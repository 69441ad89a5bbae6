"""Joints that are written by their two ends, ``between``: converted to joints at a body, in the world or at a base."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from cosserat_casadi.scene.faults import Fault, SceneTables, Table
from cosserat_casadi.scene.orientations import ORIENTATION_KEYS

PLACE = ("position", *ORIENTATION_KEYS)
"""Keys of an end in a body or in the world that give the place of the joint."""

ORIGIN = {"position": [0.0, 0.0, 0.0]}
"""Default place of an end in a body or in the world."""

KEYS = {"rod", "at", "body", "world", *PLACE}
"""Keys of an end; its record refuses an end with another key."""

Tables = dict[str, Any]


def place_joints_by_their_ends(tables: Tables) -> None:
    """Convert joints with two ends to joints of one section, or to joints that carry a body.

    A base of a rod at a section of another rod, or in the world, is placed there. Two sections that are not bases get a
    body without mass between them, fixed to the first. The records refuse joints that cannot be converted.
    """
    given = SceneTables(tables)
    joints: list[tuple[int, Any]] = list(given.tables("joints"))
    for index, joint in joints:
        ends = joint.get("between")
        if not _are_two_tables(ends) or list(end_faults(ends)) or any(set(end) - KEYS for end in ends):
            continue
        rods = [end for end in ends if "rod" in end]
        if not rods:
            written = _between_bodies(joint, ends)
        elif len(rods) == 1:
            (other,) = [end for end in ends if "rod" not in end]
            written = _at_place(tables, joint, rods[0], other)
        else:
            written = _between_rods(tables, joint, rods, index)
        if written:
            del joint["between"]


def end_faults(ends: Any) -> Iterator[Fault]:
    """Faults, without path, of two ends that do not make a joint; none if they are not two tables, another fault."""
    if not _are_two_tables(ends):
        return
    rods = [end for end in ends if "rod" in end]
    if all("world" in end for end in ends):
        yield Fault((), "joins the world with itself", "name a rod or a body in one of the ends")
    elif "body" in ends[0] and ends[0]["body"] == ends[1].get("body"):
        yield Fault((), "joins a body with itself", "name another body, a rod or the world in one of the ends")
    elif len(rods) == 2 and all(_at(end) == 0 for end in rods):
        yield Fault((), "joins two bases", "start one of the rods from its other end")
    for number, end in enumerate(ends):
        if sum(key in end for key in ("rod", "body", "world")) != 1:
            yield Fault((), "has an end that is not of one thing", "each end has one of rod, body and world = true")
        elif "rod" in end:
            for key in (key for key in PLACE if key in end):
                yield Fault((number, key), "stands in the end of a rod", "at says which section is jointed")


def _are_two_tables(ends: Any) -> bool:
    return isinstance(ends, list) and len(ends) == 2 and all(isinstance(end, Mapping) for end in ends)


def _at(end: Table) -> Any:
    return end.get("at", 1.0)


def _at_place(tables: Tables, joint: Tables, section: Table, other: Table) -> bool:
    """Convert a joint of a rod's section at a body or in the world."""
    joint["rod"] = section["rod"]
    joint["at"] = _at(section)
    place = {key: other[key] for key in PLACE if key in other}
    if "body" in other:
        joint["body"] = other["body"]
    elif _at(section) == 0:
        return _put_base(tables, section["rod"], place)
    joint.update({**ORIGIN, **place})
    return True


def _between_bodies(joint: Tables, ends: list[Table]) -> bool:
    """Convert a joint of a body at another body, or in the world, which carries it."""
    first, second = ends if "world" not in ends[1] else ends[::-1]
    if "body" in first:
        joint["body"] = first["body"]
    joint.update({**ORIGIN, **{key: first[key] for key in PLACE if key in first}})
    joint["carries"] = {key: value for key, value in second.items() if key in ("body", *PLACE)}
    return True


def _between_rods(tables: Tables, joint: Tables, sections: list[Table], index: int) -> bool:
    """Convert a joint of two rods: put the base of one at the section of the other, or let a body hold both."""
    first, second = sections if _at(sections[0]) != 0 else sections[::-1]
    joint["rod"] = second["rod"]
    joint["at"] = _at(second)
    if _at(second) == 0:
        place = {key: joint.pop(key) for key in PLACE if key in joint}
        return _put_base(tables, second["rod"], {"rod": first["rod"], "at": _at(first), **place})
    joint["body"] = add_unlisted_body(tables, joint.get("name", f"joints[{index}]"))
    tables["joints"].append({"kind": "fixed", "body": joint["body"], "rod": first["rod"], "at": _at(first)})
    return True


def add_unlisted_body(tables: Tables, name: Any, **contents: Any) -> Any:
    """Add a body without mass under a name that no other body has, such as ``spacers[0]``; the name."""
    taken = [body.get("name") for _, body in SceneTables(tables).tables("bodies")]
    while name in taken:
        name = f"at_{name}"
    tables.setdefault("bodies", []).append({"name": name, "listed": False, **contents})
    return name


def _put_base(tables: Tables, name: Any, place: Tables) -> bool:
    """Put the base of a rod at a place; return whether there is such a rod."""
    if not isinstance(name, str) or name not in SceneTables(tables).named("rods"):
        return False
    rod: Any = SceneTables(tables).named("rods")[name][1]
    base = rod.setdefault("base", {})
    if not isinstance(base, dict):
        return False
    base.update(place)
    return True
