"""The rules of assemblies: rods carried by rods, bodies held by joints.

They look at the tables of the file, like all rules between tables. What hangs on geometry, joints that over-constrain
or bodies that cannot close, is found by the model.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from cosserat_casadi.scene.faults import Fault, listing, named, shown, tables


def assembly_faults(given: Mapping[str, Any]) -> Iterator[Fault]:
    """Faults of bases on rods, of joints and of bodies against each other."""
    yield from _bases_on_nothing(given)
    yield from _unknown_bodies(given)
    yield from _bodies_that_nobody_holds(given)
    yield from _tips_held_twice(given)


def carriers(given: Mapping[str, Any]) -> dict[str, str]:
    """For each rod that starts on another rod, by name, the name of that rod."""
    found = {}
    for name, (_, rod) in named(tables(given, "rods")).items():
        base = rod.get("base")
        if isinstance(base, Mapping) and isinstance(carrier := base.get("rod"), str):
            found[name] = carrier
    return found


def _bases_on_nothing(given: Mapping[str, Any]) -> Iterator[Fault]:
    rods, on = named(tables(given, "rods")), carriers(given)
    for name, carrier in on.items():
        where = ("rods", rods[name][0], "base", "rod")
        if carrier not in rods:
            yield Fault(where, f"no rod is named {shown(carrier)}", listing((n for n in rods if n != name), "rods"))
        elif carrier == name:
            yield Fault(where, "a rod cannot start on itself", "name another rod, or give its base in the world")
        elif name in (circle := _circle(on, name)):
            problem = f"rods that carry each other in a circle: {' on '.join(map(shown, [*circle, name]))}"
            yield Fault(where, problem, "one of them must start in the world")


def _circle(on: Mapping[str, str], name: str) -> list[str]:
    """The rods met going from carrier to carrier, up to the first that is met again."""
    met = [name]
    while (carrier := on.get(met[-1])) is not None and carrier not in met:
        met.append(carrier)
    return met if on.get(met[-1]) == name and len(met) > 1 else []


def _unknown_bodies(given: Mapping[str, Any]) -> Iterator[Fault]:
    bodies = named(tables(given, "bodies"))
    for path, name in _references(given):
        if isinstance(name, str) and name not in bodies:
            yield Fault(path, f"no body is named {shown(name)}", listing(bodies, "bodies"))


def _references(given: Mapping[str, Any]) -> Iterator[tuple[tuple[str | int, ...], Any]]:
    """Every place that names a body, with the name."""
    for i, joint in tables(given, "joints"):
        yield ("joints", i, "body"), joint.get("body")
    for i, load in tables(given, "loads"):
        if load.get("kind") == "body_wrench":
            yield ("loads", i, "body"), load.get("body")
        elif load.get("kind") == "gravity" and isinstance(load.get("bodies"), list):
            yield from ((("loads", i, "bodies", j), name) for j, name in enumerate(load["bodies"]))


def _bodies_that_nobody_holds(given: Mapping[str, Any]) -> Iterator[Fault]:
    held = {joint.get("body") for _, joint in tables(given, "joints") if isinstance(joint.get("body"), str)}
    for name, (i, _) in named(tables(given, "bodies")).items():
        if name not in held:
            remedy = f'give it to a rod: [[joints]] with body = "{name}" and a rod'
            yield Fault(("bodies", i), f"nobody holds the body {shown(name)}: no joint names it", remedy)


def _tips_held_twice(given: Mapping[str, Any]) -> Iterator[Fault]:
    first: dict[str, str] = {}
    for i, support in tables(given, "supports"):
        if isinstance(name := support.get("rod"), str):
            first.setdefault(name, f"supports[{i}]")
    for i, joint in tables(given, "joints"):
        name = joint.get("rod")
        if not isinstance(name, str):
            continue
        if name in first:
            problem = f"{first[name]} holds the tip of {shown(name)} already"
            yield Fault(("joints", i, "rod"), problem, "one support or joint for each tip")
        first.setdefault(name, f"joints[{i}]")
