"""Small scenes in motion: one for each family of coupling, with mass, rotary inertia and damping."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, partial
from typing import Any

import casadi as ca
import numpy as np
import numpy.typing as npt

from cosserat_casadi import Model, build, scene_from_dict
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.motion.contact_gap import Facing
from tests.scenes import STIFFNESS

Tables = dict[str, Any]

FEW = {"modes": 2, "nodes": 5}
ROTARY = [2e-3, 3e-3, 4.5e-3]
DAMPING = {"bending_x": 0.02, "bending_y": 0.03, "torsion": 0.01, "shear_x": 0.3, "shear_y": 0.2, "extension": 0.5}
BRANCHES = [{"share": 0.2, "time": 0.03}, {"share": 0.15, "time": 0.4}]
NAMES = {"planar": ["bending_y"], "kirchhoff": ["bending_x", "bending_y", "torsion"], "reissner": list(STIFFNESS)}

WEIGHT = {"name": "weight", "kind": "gravity", "acceleration": [0.3, -0.2, -2.0]}
PUSH = {"name": "push", "kind": "tip_wrench", "rod": "a", "force": [0.4, 0.3, -0.4]}
TWIST = {"name": "twist", "kind": "tip_wrench", "rod": "a", "moment": [0.1, 0.05, 0.2]}
FOLLOW = {
    "name": "follow",
    "kind": "tip_wrench",
    "rod": "a",
    "force": [0.2, -0.3, 0.1],
    "moment": [0.05, 0.1, 0.1],
    "frame": "body",
}
HOOK = {"name": "hook", "kind": "point_wrench", "rod": "a", "at": 0.4, "force": [0.3, -0.6, 0.2]}
WIND = {"name": "wind", "kind": "distributed_wrench", "rod": "a", "force": [[0.4, 0.3], 0.2, 0.0], "frame": "body"}
BREEZE = {"name": "breeze", "kind": "distributed_wrench", "rod": "a", "force": [[0.4, 0.3], 0.2, 0.1]}
PULL = {
    "name": "pull",
    "kind": "body_wrench",
    "body": "plate",
    "position": [0.02, 0.0, 0.07],
    "force": [0.3, 0.1, 0.5],
    "moment": [0.1, 0.05, 0.2],
}
JET = {**PULL, "name": "jet", "frame": "body"}
PIN = {"rod": "a", "kind": "pinned", "position": [0.2, 0.0, 0.7]}
IN_PLANE = {"name": "push", "kind": "tip_wrench", "rod": "a", "force": [0.4, 0.0, -0.4]}

# Products of inertia, and a centre of mass off the origin.
INERTIA = [[3e-2, 4e-3, -2e-3], [4e-3, 5e-2, 6e-3], [-2e-3, 6e-3, 4e-2]]
DISKS = {"rod": "a", "at": [0.5, 1.0], "mass": 0.2, "radius": 0.3, "thickness": 0.2}
PLATE = {"name": "plate", "mass": 0.3, "centre_of_mass": [0.1, 0.02, 0.03], "inertia": INERTIA}


def rod(name: str = "a", strain: str | list[str] = "kirchhoff", **changes: Any) -> Tables:
    admitted = NAMES[strain] if isinstance(strain, str) else strain
    plain = {
        "name": name,
        "length": 0.8,
        "strain": strain,
        "stiffness": STIFFNESS,
        "linear_density": [0.9, 0.7],
        "rotary_inertia": ROTARY,
        "damping": {key: DAMPING[key] for key in admitted},
    }
    return {**plain, **changes}


def scene(*rods: Tables, loads: list[Tables], **more: Any) -> Tables:
    return {"schema": 1, "accuracy": FEW, "rods": list(rods), "loads": loads, **more}


def joint(name: str, kind: str = "fixed", **changes: Any) -> Tables:
    return {"body": "plate", "rod": name, "kind": kind, "position": [0.02, -0.03, 0.01], **changes}


def _jointed(kind: str) -> Tables:
    """A plate on a fixed joint and on one of this kind."""
    axis = {"axis": [0.3, -0.5, 0.8]} if kind in ("revolute", "prismatic") else {}
    second = rod("b", base={"position": [0.4, 0.1, 0.05]}, length=0.7)
    joints = [joint("a", position=[-0.2, 0, 0]), joint("b", kind, **axis)]
    return scene(rod(strain="reissner"), second, loads=[WEIGHT, FOLLOW, PULL, JET], bodies=[PLATE], joints=joints)


def _carried() -> Tables:
    place = {"rod": "a", "at": 0.5, "position": [0.02, 0.01, 0.0], "quaternion": [0.6, 0, 0.8, 0]}
    return scene(rod(), rod("b", "reissner", base=place, length=0.5), loads=[WEIGHT, FOLLOW])


def _free() -> Tables:
    start = {"position": [0.1, 0.2, 0.3], "quaternion": [0.6, 0, 0.8, 0], "free": True}
    return scene(rod(strain="reissner", base=start), loads=[WEIGHT, PUSH, FOLLOW, WIND])


def _free_with_body() -> Tables:
    start = {"position": [0.1, 0.2, 0.3], "free": True}
    return scene(rod(base=start), loads=[WEIGHT, PUSH], bodies=[PLATE], joints=[joint("a", "spherical")])


def _body_on_a_body() -> Tables:
    """A plate on a rod that carries another one by a hinge, which a spring and a ball hold in the world."""
    arm = {"body": "plate", "position": [0.1, 0.02, 0.03], "rotation_vector": [0.1, 0.2, 0.3]}
    hinge = {"kind": "revolute", "axis": [0.3, -0.5, 0.8]}
    held = {"kind": "prismatic", "axis": [0.2, 0.9, 0.1], "stiffness": 30.0}
    joints = [
        joint("a"),
        {**hinge, "between": [arm, {"body": "second", "position": [0, 0.04, 0.0]}]},
        {**held, "between": [{"world": True, "position": [0.1, 0.0, 0.9]}, {"body": "third"}]},
        {"kind": "spherical", "between": [{"body": "second", "position": [0.1, 0, 0]}, {"body": "third"}]},
    ]
    bodies = [PLATE, *({**PLATE, "name": name} for name in ("second", "third"))]
    return scene(rod(strain="reissner"), loads=[WEIGHT, PULL], bodies=bodies, joints=joints)


def _supported(kind: str) -> Tables:
    place = {"rod": "a", "kind": kind, "position": [0.2, 0.1, 0.7]}
    if kind == "clamped":
        place["quaternion"] = [0.96, 0.0, 0.28, 0.0]
    return scene(rod(strain="reissner"), loads=[WEIGHT, HOOK], supports=[place])


def _tendons(**cable: Any) -> Tables:
    tendon = {"name": "cable", "kind": "tendon", "rod": "a", "offset": [[0.06, -0.03], 0.01], **cable}
    cell = {
        "name": "cell",
        "kind": "chamber",
        "rod": "a",
        "pressure": 2e4,
        "area": 2e-5,
        "offset": [0.01, [0.03, 0.01]],
    }
    return scene(rod(strain="reissner"), loads=[WEIGHT], actuators=[tendon, cell])


def _driven(*fields: str, course: Tables | None = None, **more: Any) -> Tables:
    """A rod whose base, or length, is an input; chambers and tendons on it."""
    cable = {"name": "cable", "kind": "tendon", "rod": "a", "tension": 0.5, "offset": [[0.06, -0.03], 0.01]}
    cable |= course or {}
    inputs = [f"a.{field}" for field in fields]
    place = {"position": [0.1, -0.2, 0.05], "quaternion": [0.6, 0, 0.8, 0]}
    bent = {"curvature": [0.3, [-0.4, 0.2], 0.2]}
    driven = rod(strain="reissner", base=place, intrinsic=bent)
    loads = [WEIGHT, PUSH, FOLLOW, WIND, BREEZE]
    return scene(driven, loads=loads, inputs=inputs, actuators=[cable], **more)


def _relaxing() -> Tables:
    """A rod with branches whose length is an input beside one with other branches, both on a plate."""
    first = rod(strain="reissner", damping={**rod()["damping"], "prony": BRANCHES})
    base = {"position": [0.4, 0.1, 0.05]}
    second = rod("b", base=base, length=0.7, damping={"prony": BRANCHES[:1]})
    joints = [joint("a", position=[-0.2, 0, 0]), joint("b", "revolute", axis=[0.3, -0.5, 0.8])]
    loads = [WEIGHT, FOLLOW, PULL]
    return scene(first, second, loads=loads, bodies=[PLATE], joints=joints, inputs=["a.length"])


def _with_disks() -> Tables:
    """A free rod with disks on it."""
    start = {"position": [0.1, 0.2, 0.3], "quaternion": [0.6, 0, 0.8, 0], "free": True}
    return scene(rod(strain="reissner", base=start), loads=[WEIGHT, PUSH], disks=[dict(DISKS)])


FAMILIES: dict[str, Callable[[], Tables]] = {
    "planar": lambda: scene(rod(strain="planar"), loads=[IN_PLANE]),
    "kirchhoff": lambda: scene(rod(), loads=[WEIGHT, PUSH, TWIST]),
    "reissner": lambda: scene(rod(strain="reissner"), loads=[WEIGHT, FOLLOW, WIND]),
    "two elements": lambda: scene(rod(), loads=[WEIGHT, HOOK]),
    "one strain": lambda: scene(rod(strain=["extension"]), loads=[WEIGHT]),
    "clamped tip": partial(_supported, "clamped"),
    "pinned tip": partial(_supported, "pinned"),
    **{f"{kind} joint": partial(_jointed, kind) for kind in ("fixed", "spherical", "revolute", "prismatic")},
    "carried": _carried,
    "free": _free,
    "free with body": _free_with_body,
    "body inside": lambda: scene(rod(), loads=[WEIGHT, PULL], bodies=[PLATE], joints=[joint("a", at=0.4)]),
    "body on a body": _body_on_a_body,
    "disks": _with_disks,
    "disks drawn out": lambda: _driven("length", disks=[dict(DISKS)]),
    "through holes": lambda: _driven("length", course={"holes": [0.4, 1.0], "friction": 0.2}),
    "tendons": partial(_tendons, tension=1.5),
    "given length": partial(_tendons, length=0.78),
    "slack": partial(_tendons, length=0.83, slack=True),
    "moving base": partial(_driven, "base.position", "base.quaternion"),
    "drawn out": partial(_driven, "length"),
    "all driven": partial(_driven, "base.position", "base.quaternion", "length"),
    "driven and held": lambda: _driven(
        "base.position",
        "base.quaternion",
        "length",
        # Made anew for each scene: a test may change what it gets.
        supports=[{"rod": "a", "kind": "pinned", "position": [0.9, -0.2, 0.3]}],
    ),
}


RELAXING: dict[str, Callable[[], Tables]] = {
    "relaxing": lambda: scene(rod(strain="planar", damping={"prony": BRANCHES}), loads=[IN_PLANE]),
    "relaxing joints": _relaxing,
}
"""Rods whose stress relaxes: what their branches move by has no kinetic energy."""

ALL = {
    **FAMILIES,
    **RELAXING,
    "planar held": lambda: scene(rod(strain=["bending_y", "extension"]), loads=[IN_PLANE], supports=[PIN]),
}


@cache
def model_of(family: str) -> Model:
    return build(scene_from_dict(ALL[family]()), moving=True)


@dataclass(frozen=True)
class State:
    """Arguments of the functions of a scene in motion."""

    x: FloatArray
    v: FloatArray
    a: FloatArray
    inputs: FloatArray
    inputs_rate: FloatArray
    inputs_acceleration: FloatArray

    @property
    def all(self) -> tuple[FloatArray, ...]:
        return self.x, self.v, self.a, self.inputs, self.inputs_rate, self.inputs_acceleration

    @property
    def velocities(self) -> tuple[FloatArray, ...]:
        return self.x, self.v, self.inputs, self.inputs_rate


def symbols_of(model: Model) -> list[ca.MX]:
    """Symbols of x, v, a, inputs and their two rates."""
    size, inputs = model.size, model.discrete.layout.size
    shapes = {"x": size, "v": size, "a": size, "inputs": inputs, "inputs_rate": inputs, "inputs_acceleration": inputs}
    return [ca.MX.sym(name, count) for name, count in shapes.items()]


def drawn_state(model: Model, seed: int = 0) -> State:
    """Any state: constraints are open, quaternions of frames have any norm."""
    draw = np.random.default_rng(seed).standard_normal
    inputs = model.pack()
    x = 0.3 * draw(model.size)
    v, a = draw((2, model.size))
    rate, acceleration = 0.3 * draw((2, len(inputs)))
    return State(x, v, a, inputs, rate, acceleration)


def constrained_rows(model: Model) -> npt.NDArray[np.bool_]:
    """Equations of joints, supports and the bases of carried rods: not those of cables."""
    rows = np.zeros(model.size, dtype=bool)
    for placed in model.discrete.constraints:
        rows[model.discrete.multipliers(placed)] = True
    return rows


def consistent_state(model: Model, seed: int = 0) -> State:
    """A state in which constraints are closed, with rates that keep them closed, and quaternions have norm 1.

    It is no equilibrium. Cables are taut.
    """
    state = drawn_state(model, seed)
    x, v = state.x.copy(), state.v.copy()
    differential = np.asarray(model.discrete.unknowns.differential)
    held = constrained_rows(model)
    for _ in range(12 if held.any() else 0):
        rows = model.jacobian(x, state.inputs)[0].full()[held][:, differential]
        gap = model.residual(x, state.inputs).full().ravel()[held]
        x[differential] -= np.linalg.pinv(rows) @ gap
    for cable in model.discrete.cables:
        tension = model.discrete.tension(cable)
        x[tension] = np.abs(x[tension])
    for name, frame in model.discrete.frames.items():
        deviation = x[model.discrete.deviation(name)]
        quaternion = frame.start.quaternion + deviation[3:]
        quaternion /= np.linalg.norm(quaternion)
        deviation[3:] = quaternion - frame.start.quaternion
        rate = v[model.discrete.deviation(name)][3:]
        rate -= quaternion * (quaternion @ rate)
    if held.any():
        rows = model.jacobian(x, state.inputs)[0].full()[held][:, differential]
        by_inputs = model.input_jacobian(x, state.inputs).full()[held]
        # The least change of the rates that keeps the constraints closed.
        left = rows @ v[differential] + by_inputs @ state.inputs_rate
        v[differential] -= np.linalg.pinv(rows) @ left
        assert np.abs(model.residual(x, state.inputs).full().ravel()[held]).max() < 1e-13
    return State(x, v, state.a, state.inputs, state.inputs_rate, state.inputs_acceleration)


def gaps_along(facing: Facing, nodes: FloatArray, count: int = 200) -> FloatArray:
    """Gaps of a rod and an obstacle at sections evenly spread over it, over the length, shape (count + 1,)."""
    return np.array([facing.at(nodes, X).value for X in np.linspace(0.0, 1.0, count + 1).tolist()])
