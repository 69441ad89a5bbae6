"""Seeded scenes to be exported: robots and what else acts on rods, with drawn inputs and parameters."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from cosserat_casadi import SceneError, scene_from_dict
from tests.reference.random_scenes import between, directed, vector
from tests.reference.robot_scenes import robot_scene
from tests.reference.rods import Table, rod_of

FAMILIES = ("rods", "loads", "actuators", "bodies", "joints", "obstacles")
"""Lists of a scene whose numbers may be parameters."""

TRANSPORTS = ("magnus4", "magnus6", "magnus8", "permuted")

BASES = ("rod.base.position", "rod.base.quaternion", "rod.length")
"""Inputs of a scene beside those of its loads and actuators."""


def exported_scene(seed: int, *, moving: bool = False) -> Table:
    """A legal scene with a small discretisation; the same seed gives the same one.

    Args:
        seed: of the numbers.
        moving: whether its equations of motion are exported, which none has with the literal linear system, nor with
            stops that are rigid.
    """
    rng = np.random.default_rng([seed, 29])
    tables = robot_scene(seed)
    tables["accuracy"] = {"modes": int(rng.integers(1, 3)), "nodes": int(rng.integers(3, 6))}
    rotation = str(rng.choice(TRANSPORTS[:3] if moving else TRANSPORTS))
    tables = _if_legal(tables, {"accuracy": {**tables["accuracy"], "rotation": rotation}}, chance=0.6, rng=rng)
    (rod,) = tables["rods"]
    length = rod["length"]
    compliance = rod_of(tables).compliance(0.0)[:3]
    force = (1 / float(compliance.max()) if compliance.any() else 1.0) / length**2
    for load in (_foundation(rng, force, length), _flow(rng, force, length), _field(rng, force * length)):
        tables = _if_legal(tables, {"loads": [*tables["loads"], load]}, chance=0.2, rng=rng)
    tables = _if_legal(tables, {"obstacles": [_ball(rng, rod)]}, chance=0.2, rng=rng)
    tables = _if_legal(tables, _carrying(rng, tables), chance=0.3, rng=rng)
    if moving:
        tables = {**tables, "joints": [_with_elastic_stops(joint) for joint in tables.get("joints", [])]}
    for name in BASES:
        inputs = [*scene_from_dict(tables).input_names(), name]
        tables = _if_legal(tables, {"inputs": inputs}, chance=0.2, rng=rng)
    names = list(_names_of_numbers(tables))
    for i in rng.permutation(len(names))[: int(rng.integers(0, 6))]:
        tables = _if_legal(tables, {"parameters": [*tables.get("parameters", []), names[i]]}, chance=1.0, rng=rng)
    return tables


def _if_legal(tables: Table, more: Table, *, chance: float, rng: np.random.Generator) -> Table:
    """The scene with further tables, with some luck and where it is not refused; else as it is."""
    if rng.random() >= chance:
        return tables
    try:
        scene_from_dict({**tables, **more})
    except SceneError:
        return tables
    return {**tables, **more}


def _foundation(rng: np.random.Generator, force: float, length: float) -> Table:
    stiffness = [force / length**2 * between(rng, 0.1, 5.0) for _ in range(3)]
    frame = str(rng.choice(["world", "body"]))
    return {"name": "bed", "kind": "foundation", "rod": "rod", "stiffness": stiffness, "frame": frame}


def _flow(rng: np.random.Generator, force: float, length: float) -> Table:
    density = force / length / (0.02 * length * 0.25)
    velocity = directed(rng, 0.5)
    return {"name": "stream", "kind": "flow", "density": density, "velocity": velocity, "diameter": 0.02 * length}


def _field(rng: np.random.Generator, moment: float) -> Table:
    dipole = {"moment": directed(rng, 50 * moment), "at": float(rng.choice([1.0, 0.6]))}
    return {"name": "coil", "kind": "magnet", "rod": "rod", "field": directed(rng, 0.02), **dipole}


def _ball(rng: np.random.Generator, rod: Table) -> Table:
    base = np.array(rod.get("base", {}).get("position", [0.0, 0.0, 0.0]))
    centre = base + directed(rng, 0.7 * rod["length"])
    sizes = {"radius": 0.15 * rod["length"], "width": 0.02 * rod["length"]}
    return {"name": "ball", "kind": "sphere", "centre": centre.tolist(), "rods": ["rod"], **sizes}


def _carrying(rng: np.random.Generator, tables: Table) -> Table:
    """Lists with a second rod on the first, and a load on its tip."""
    (rod,) = tables["rods"]
    place = {"rod": "rod", "at": float(rng.choice([1.0, 0.5])), "position": vector(rng, 0.05 * rod["length"])}
    turn = rng.normal(size=4)
    base = {**place, "quaternion": (turn / np.linalg.norm(turn)).tolist()}
    arm = {**rod, "name": "arm", "length": 0.6 * rod["length"], "base": base}
    tip = next(load for load in tables["loads"] if load["kind"] == "tip_wrench")
    push = {**tip, "name": "push", "rod": "arm", "force": (0.3 * np.array(tip["force"])).tolist()}
    return {"rods": [rod, arm], "loads": [*tables["loads"], push]}


def _with_elastic_stops(joint: Table) -> Table:
    """The joint with stops that steps of given length resolve, if it has some."""
    if "lower_stop" not in joint:
        return joint
    return {**joint, "stop_stiffness": 10 * joint["stiffness"]}


def _names_of_numbers(tables: Table) -> Iterator[str]:
    """Paths of the numbers of a scene that may be parameters, or not."""
    for family in FAMILIES:
        for entry in tables.get(family, []):
            yield from _paths(entry, entry["name"])


def _paths(table: Table, prefix: str) -> Iterator[str]:
    for key, value in table.items():
        if isinstance(value, dict):
            yield from _paths(value, f"{prefix}.{key}")
        elif isinstance(value, int | float | list) and not isinstance(value, bool):
            yield f"{prefix}.{key}"
