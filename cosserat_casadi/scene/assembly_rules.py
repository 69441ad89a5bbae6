"""The rules of assemblies: rods carried by rods, bodies held by joints."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping

from cosserat_casadi.scene.constraint_records import JOINTS, SUPPORTS
from cosserat_casadi.scene.faults import Fault, SceneTables, Table, listing, numbers_of, shown, table_of

TIP = 1.0
"""Abscissa of a tip, the default place of a joint."""


def bases_on_nothing(scene: SceneTables) -> Iterator[Fault]:
    """A rod starts on an unknown rod, on itself, or on a rod that it carries."""
    rods = scene.named("rods")
    carriers = _carriers(scene)
    for name, carrier in carriers.items():
        index, _ = rods[name]
        path = ("rods", index, "base", "rod")
        circle = _circle(carriers, name)
        # The poses of rods follow one another from carrier to carried: they must begin in the world.
        if carrier not in rods:
            candidates = [known for known in rods if known != name]
            yield Fault(path, f"no rod is named {shown(carrier)}", listing(candidates, "rods"))
        elif carrier == name:
            yield Fault(path, "a rod cannot start on itself", "name another rod, or give its base in the world")
        elif circle:
            names = " on ".join(shown(rod) for rod in [*circle, name])
            yield Fault(path, f"rods that carry each other in a circle: {names}", "one of them must start in the world")


def _carriers(scene: SceneTables) -> dict[str, str]:
    """Name of the rod that carries each rod which starts on another rod, by the name of the carried one."""
    carriers = {}
    for name, (_, rod) in scene.named("rods").items():
        carrier = table_of(rod.get("base")).get("rod")
        if isinstance(carrier, str):
            carriers[name] = carrier
    return carriers


def _circle(carriers: Mapping[str, str], name: str) -> list[str]:
    """The rods from carrier to carrier until the first one is reached again; empty if it is not."""
    # A dictionary keeps the order, and finds a rod at once among thousands.
    passed = {name: None}
    carrier = carriers.get(name)
    while carrier is not None and carrier not in passed:
        passed[carrier] = None
        carrier = carriers.get(carrier)
    if carrier != name or len(passed) == 1:
        return []
    return list(passed)


def rods_that_spin(scene: SceneTables) -> Iterator[Fault]:
    """A straight rod that may turn about its tangent needs inertia about it, or its motion is not determined."""
    if scene.get("simulation") is None:
        return
    carriers = _carriers(scene).values()
    for name, (index, rod) in scene.named("rods").items():
        inertia = numbers_of(rod.get("rotary_inertia"))
        resists = len(inertia) == 3 and inertia[2] != 0.0
        is_straight = "linear_density" in rod and "intrinsic" not in rod
        if is_straight and not resists and name not in carriers and _turns_about_its_axis(scene, name, rod):
            problem = "missing about the tangent: nothing resists a spin of the rod"
            remedy = "three numbers > 0, kg m; material and section give them too"
            yield Fault(("rods", index, "rotary_inertia"), problem, remedy)


def _turns_about_its_axis(scene: SceneTables, name: str, rod: Table) -> bool:
    """Whether only spherical joints and pins, which are on its axis, hold a rod."""
    floats = table_of(rod.get("base")).get("free") is True
    for key, kinds in (("supports", SUPPORTS), ("joints", JOINTS)):
        for _, holder in scene.tables(key):
            if holder.get("rod") != name:
                continue
            record = kinds.record_of(holder)
            if record is None or not record.turns_freely:
                return False
            floats = floats or holder.get("at") == 0
    return floats


def bodies_that_nobody_holds(scene: SceneTables) -> Iterator[Fault]:
    """A body has no joint, or bodies are joined to each other alone: nothing would hold them."""
    held: set[str] = set()
    links = [links_of(joint) for _, joint in scene.tables("joints")]
    more = True
    while more:
        before = len(held)
        # A rod or the world holds a body.
        held |= {name for link in links if any(end is None or end in held for end in link) for name in link if name}
        more = len(held) > before
    for name, (i, _) in scene.named("bodies").items():
        if name not in held:
            named = any(name in link for link in links)
            reason = "its joints lead to no rod and not to the world" if named else "no joint names it"
            # Written as JSON, which TOML reads too: a faulty name may contain anything.
            remedy = f"give it to a rod: [[joints]] with body = {json.dumps(name)} and a rod"
            yield Fault(("bodies", i), f"nobody holds the body {shown(name)}: {reason}", remedy)


def links_of(joint: Table) -> tuple[str | None, str | None]:
    """The bodies at the two ends of a joint; None for a rod or the world."""
    bodies = (joint.get("body"), table_of(joint.get("carries")).get("body"))
    # A faulty name may be unhashable.
    first, second = (body if isinstance(body, str) else None for body in bodies)
    return first, second


def sections_held_twice(scene: SceneTables) -> Iterator[Fault]:
    """A tip has a support and a joint, or a section has two joints; joints of riding bodies do not count."""
    holders: dict[tuple[str, float], str] = {}
    # As in the model, a body with an obstacle, or with a velocity, floats.
    floating = [table.get("body") for key in ("obstacles", "velocities") for _, table in scene.tables(key)]
    of_bodies = [name for _, joint in scene.tables("joints") for name in links_of(joint)]
    for i, support in scene.tables("supports"):
        name = support.get("rod")
        # Another rule refuses two supports of one tip; the first of them counts here.
        if isinstance(name, str):
            holders.setdefault((name, TIP), f"supports[{i}]")
    for i, joint in scene.tables("joints"):
        name = joint.get("rod")
        at = joint.get("at", TIP)
        if not isinstance(name, str) or not isinstance(at, int | float):
            continue
        body, _ = links_of(joint)
        if joint.get("kind") == "fixed" and at != 0 and body not in floating and of_bodies.count(body) == 1:
            continue
        section = (name, float(at))
        if section in holders:
            where = "the tip" if at == TIP else f"X = {at:g}" if at else "the base"
            problem = f"{holders[section]} holds {where} of {shown(name)} already"
            yield Fault(("joints", i, "rod"), problem, "one support or joint for each section: at = …")
        holders.setdefault(section, f"joints[{i}]")
