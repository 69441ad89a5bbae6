"""Seeded robots of one rod: a base on a hinge or a slide with spring, motor and stops or a drive, disks, a tendon.

Rods of materials that are not linear, chambers and muscles are among them.

In equilibrium each is a clamped rod under point loads: the base is where the joint has come to, disks are their
weights, and a tendon is a force at each hole; laws, and what is active, are stresses in its sections. So what holds for
rods of a scene holds for them.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np

from cosserat_casadi import Solution
from tests.reference.material_scenes import make_of_matter, with_materials
from tests.reference.random_scenes import directed, random_scene
from tests.reference.rods import Array, RodData, Table, rod_of, rotation_from_quaternion


def robot_scene(seed: int) -> Table:
    """A legal scene; the same seed gives the same one."""
    rng = np.random.default_rng([seed, 11])
    tables = {**random_scene(seed), "accuracy": {"modes": int(rng.integers(2, 5)), "nodes": int(rng.integers(5, 10))}}
    (rod,) = tables["rods"]
    length = rod["length"]
    compliance = rod_of(tables).compliance(0.0)[:3]
    bending = 1 / float(compliance.max()) if compliance.any() else 1.0
    places = sorted(rng.uniform(0.1, 1.0, int(rng.integers(2, 5))).tolist())
    if rng.random() < 0.7:
        if not any(load["kind"] == "gravity" for load in tables["loads"]):
            tables["loads"].append({"name": "weight", "kind": "gravity", "acceleration": directed(rng, 9.81)})
        weight = bending / length**2 * 10 ** rng.uniform(-3, 0.5)
        sizes = {"mass": float(weight / np.linalg.norm(_gravity(tables))), "radius": 0.1 * length, "thickness": 0.0}
        tables["disks"] = [{"rod": "rod", "at": places, **sizes}]
    if rng.random() < 0.7:
        tension = float(bending / length**2 * 10 ** rng.uniform(-2, 1))
        offset = directed(rng, 0.05 * length)[:2]
        tendon = {"name": "cable", "kind": "tendon", "rod": "rod", "offset": offset, "holes": places}
        tables["actuators"] = [{**tendon, "tension": tension}]
    if rng.random() < 0.8:
        tables["joints"] = [_joint(rng, length, bending)]
        if np.random.default_rng([seed, 23]).random() < 0.3:
            tables["joints"] = [_driven(tables["joints"][0])]
    make_of_matter(np.random.default_rng([seed, 13]), tables, bending)
    return tables


def _gravity(tables: Table) -> Array:
    (gravity,) = (load for load in tables["loads"] if load["kind"] == "gravity")
    return np.array(gravity["acceleration"])


def _joint(rng: np.random.Generator, length: float, bending: float) -> Table:
    turns = bool(rng.random() < 0.7)
    unit = 1.0 if turns else length
    joint: Table = {
        "name": "joint",
        "rod": "rod",
        "at": 0.0,
        "kind": "revolute" if turns else "prismatic",
        "axis": directed(rng, 1.0),
        "stiffness": float(bending / length / unit**2 * 10 ** rng.uniform(-1, 1)),
        "rest": float(unit * rng.uniform(-0.3, 0.3)),
        "moment" if turns else "force": float(bending / length / unit * rng.normal()),
    }
    if rng.random() < 0.5:
        joint["lower_stop"] = float(-unit * rng.uniform(0.0, 0.5))
        joint["upper_stop"] = float(unit * rng.uniform(0.0, 0.5))
    return joint


def _driven(joint: Table) -> Table:
    """The joint with a drive that prescribes where its spring would rest."""
    held = {key: joint[key] for key in ("name", "rod", "at", "kind", "axis")}
    return {**held, "angle" if joint["kind"] == "revolute" else "displacement": joint["rest"]}


def on_a_hub(tables: Table) -> Table:
    """The robot whose joint stands between the world and a body without mass, to which the base is fixed."""
    (joint,) = tables["joints"]
    (rod,) = tables["rods"]
    base = {"position": [0.0, 0.0, 0.0], **rod.get("base", {})}
    place = base.pop("position")
    free = {key: entry for key, entry in joint.items() if key not in ("rod", "at")}
    hinge = {**free, "between": [{"world": True, "position": place}, {"body": "hub"}]}
    fixed = {"kind": "fixed", "rod": "rod", "at": 0.0, "body": "hub", **base}
    return {**tables, "joints": [hinge, fixed], "bodies": [{"name": "hub"}]}


def as_clamped(tables: Table, solution: Solution) -> tuple[RodData, Array, Array]:
    """The clamped rod under point loads that a robot in equilibrium is, and the wrench on its base, N and N m."""
    points = list(tables["loads"])
    for disks in tables.get("disks", []):
        points += [_point(at, disks["mass"] * _gravity(tables), np.zeros(3)) for at in disks["at"]]
    wrench = solution.base_wrench()
    force, moment = wrench.force.copy(), wrench.moment.copy()
    for tendon in (entry for entry in tables.get("actuators", []) if entry["kind"] == "tendon"):
        # It starts at the base and is anchored at the tip.
        places = [*tendon["holes"], 1.0]
        pose = solution.pose([0.0, *places], "rod")
        arms = np.array([rotation_from_quaternion(q)[:, :2] @ tendon["offset"] for q in pose.quaternion])
        spans = np.diff(pose.position + arms, axis=0)
        pulls = [tendon["tension"] * span / np.linalg.norm(span) for span in spans]
        # The clamp holds the tendon too.
        force, moment = force + pulls[0], moment + np.cross(arms[0], pulls[0])
        for at, arm, (before, after) in zip(places, arms[1:], pairwise([*pulls, np.zeros(3)]), strict=True):
            points.append(_point(at, after - before, np.cross(arm, after - before)))
    rod = with_materials(rod_of({**tables, "loads": points}), tables)
    for joint in tables.get("joints", []):
        rod = _moved(rod, joint, solution)
    return rod, force, moment


def _point(at: float, force: Array, moment: Array) -> Table:
    wrench = {"force": force.tolist(), "moment": moment.tolist()}
    return {"name": "point", "kind": "point_wrench", "rod": "rod", "at": at, "frame": "world", **wrench}


def _moved(rod: RodData, joint: Table, solution: Solution) -> RodData:
    """The rod with its base where its joint has come to."""
    axis = np.array(joint["axis"])
    state = solution.joint("joint")
    if joint["kind"] == "prismatic":
        return replace(rod, base_position=rod.base_position + state["displacement"] * axis)
    half = state["angle"] / 2
    turn = rotation_from_quaternion([np.cos(half), *(np.sin(half) * axis)])
    return replace(rod, base_rotation=turn @ rod.base_rotation)


def joint_faults(tables: Table, solution: Solution, tolerance: float) -> list[str]:
    """Why the joint of a robot is out of balance, or its stops pull or are passed; tolerance over its efforts."""
    faults = []
    wrench = solution.base_wrench()
    for joint in tables.get("joints", []):
        turns = joint["kind"] == "revolute"
        state = solution.joint("joint")
        way = "angle" if turns else "displacement"
        value, unit = state[way], 1.0 if turns else tables["rods"][0]["length"]
        if way in joint:
            if not abs(value - joint[way]) <= 1e-9 * unit:
                faults.append(f"the drive is at {value:.6g} in place of {joint[way]:.6g}")
            continue
        bears = np.array(joint["axis"]) @ (wrench.moment if turns else wrench.force)
        spring = joint["stiffness"] * (value - joint["rest"])
        motor = joint["moment" if turns else "force"]
        push = bears + spring - motor
        allowed = tolerance * (abs(spring) + abs(motor) + np.linalg.norm(wrench.moment if turns else wrench.force))
        lower, upper = (joint.get(key, end) for key, end in (("lower_stop", -np.inf), ("upper_stop", np.inf)))
        if not lower - 1e-8 * unit <= value <= upper + 1e-8 * unit:
            faults.append(f"a stop is passed: {value:.6g} of {lower:.6g} to {upper:.6g}")
        if (push > allowed and value > lower + 1e-6 * unit) or (push < -allowed and value < upper - 1e-6 * unit):
            faults.append(f"the joint is out of balance: {push:.2g} > {allowed:.2g}")
    return faults
