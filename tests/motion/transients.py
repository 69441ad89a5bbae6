"""Motions of the literature as tables of a scene file, with numbers that do not come from the package.

Units are those of the sources: without names, or SI. Rods that move in a plane move in x–z.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from cosserat_casadi.maths.typing import FloatArray

Table = dict[str, Any]


def table(rod: Table, *loads: Table, **changes: Any) -> Table:
    """A scene of one rod called "rod" along x under these loads."""
    plain = {
        "name": "rod",
        "length": 1.0,
        "strain": "planar",
        "stiffness": {"bending_y": 1.0},
        "linear_density": 1.0,
        "base": {"tangent": [1, 0, 0]},
    }
    return {"schema": 1, "rods": [{**plain, **rod}], "loads": list(loads), **changes}


def gravity(acceleration: float) -> Table:
    """Weight along −z."""
    return {"name": "weight", "kind": "gravity", "acceleration": [0.0, 0.0, -acceleration]}


def at_tip(rod: str = "rod", **changes: Any) -> Table:
    """A wrench at the tip, called "push"; it is zero unless it moves."""
    return {"name": "push", "kind": "tip_wrench", "rod": rod, "force": [0, 0, 0], "moment": [0, 0, 0], **changes}


# Cantilever under a smooth line load: Kirchhoff, without rotary inertia


def line_load(**simulation: Any) -> Table:
    """A line load of −10 sin⁴(πt/2) along z, from rest; the sine's power is made of two waves that begin at rest."""
    load = {"name": "load", "kind": "distributed_wrench", "rod": "rod", "force": [0, 0, 0]}
    slow = {"input": "load.force", "amplitude": [0, 0, -5.0], "frequency": 0.5, "wave": "one_minus_cosine"}
    fast = {"input": "load.force", "amplitude": [0, 0, 1.25], "frequency": 1.0, "wave": "one_minus_cosine"}
    asked = {"duration": 2.0, "times": LINE_LOAD_TIMES.tolist(), **simulation}
    return table({}, load, motions=[slow, fast], simulation=asked)


LINE_LOAD_TIMES = np.array([0.5, 0.75, 1.0, 1.25, 1.5, 2.0])
LINE_LOAD_TIP = np.array(
    [
        [0.999399508378, -0.033581343548],
        [0.95560467868, -0.27999882487],
        [0.58069889, -0.75599326],
        [0.14705470, -0.85883342],
        [0.58715052, -0.74810653],
        [0.47360012, 0.79314145],
    ]
)
"""Tip (x, z) at these times, by an independent Galerkin method; a unit of the last digit is uncertain."""

LINE_LOAD_ANGLE = np.array([-0.0334153699, -0.3508328302, -1.16026547, -1.84591766, -1.16008208, 1.38249679])
"""Inclination of the tip, rad."""

LINE_LOAD_ENERGY = 2.3978097
"""Kinetic and elastic energy at t = 2."""


# Cantilever under its weight at once


def sudden_weight(**simulation: Any) -> Table:
    """The same cantilever, straight, let go under a weight of 10."""
    asked = {"duration": 1.0, "times": [0.2, 0.5, 1.0], "start": "unloaded", **simulation}
    return table({}, gravity(10.0), simulation=asked)


SUDDEN_WEIGHT_TIP = np.array([[0.95818, -0.27436], [0.20352, -0.87181], [0.81593, -0.54553]])
"""Tip (x, z) at t = 0.2, 0.5, 1; the digits of 10 and 12 modes agree to 3e-5."""


# Spin-up: T. R. Kane, R. R. Ryan, A. K. Banerjee, J. Guid. Control Dyn. 10 (1987) 139

SPIN_LENGTH = 10.0
SPIN_TIMES = np.array([3.0, 6.0, 9.0, 12.0])
SPIN_TIP = np.array(
    [[-0.002729231, -0.21725746], [-0.01701684, -0.54354901], [-0.0119880, -0.460147], [-0.00126976, -0.15083]]
)
"""Tip in the turning frame at these times, less the length: inextensible with rotary inertia, by a Galerkin method."""

SPIN_LAG = (6.7617, -0.573762)
"""Time and size of the largest lag."""


def spin_angle(time: FloatArray) -> FloatArray:
    """Turn of the base up to t = 15: from rest to 6 rad/s."""
    ramp = time**2 / 2 + (15 / (2 * np.pi)) ** 2 * (np.cos(2 * np.pi * time / 15) - 1)
    return np.asarray(6 / 15 * ramp)


def spin_up(spacing: float = 0.05, **simulation: Any) -> Table:
    """A rod on a base that turns x towards z; its quaternion goes through knots of a spline."""
    # The spline ends at rest, which the base does not: it goes on beyond the duration.
    knots = np.arange(0.0, 13.0, spacing)
    half = (np.pi / 2 - spin_angle(knots)) / 2
    none = np.zeros_like(half)
    values = np.stack([np.cos(half), none, np.sin(half), none], axis=1)
    turning = {"input": "rod.base.quaternion", "times": knots.tolist(), "values": values.tolist()}
    rod = {
        "length": SPIN_LENGTH,
        "stiffness": {"bending_y": 1.4e4},
        "linear_density": 1.2,
        "rotary_inertia": [6e-4, 6e-4, 1.2e-3],
    }
    asked = {"duration": 12.0, "times": SPIN_TIMES.tolist(), "start": "unloaded", **simulation}
    return table(rod, motions=[{**turning, "interpolation": "cubic"}], simulation=asked)


# Free rods: J. C. Simo, L. Vu-Quoc, J. Appl. Mech. 53 (1986) 849 and Comput. Methods Appl. Mech. Engng 66 (1988) 125

LEAN = np.array([0.6, 0.0, -0.8])
"""Direction of the rod from its upper end at (0, 0, 8) to its lower at (6, 0, 0)."""

FLYING_BASE = {"position": [0, 0, 8], "tangent": LEAN.tolist(), "free": True}
SOFT = {"shear_x": 1e4, "shear_y": 1e4, "extension": 1e4}


def flying_in_plane(**simulation: Any) -> Table:
    """Force 8 along x and moment 80 at the lower end, both until t = 2.5."""
    rod = {
        "length": 10.0,
        "strain": ["bending_y", "shear_x", "extension"],
        "stiffness": {"bending_y": 100.0, "shear_x": 1e4, "extension": 1e4},
        "rotary_inertia": [10.0, 10.0, 20.0],
        "base": FLYING_BASE,
    }
    force = {"input": "push.force", "times": [0.0, 2.5], "values": [[8, 0, 0], [0, 0, 0]], "interpolation": "step"}
    moment = {"input": "push.moment", "times": [0.0, 2.5], "values": [[0, 80, 0], [0, 0, 0]], "interpolation": "step"}
    asked = {"duration": 7.5, "times": [2.5, 5.0, 7.5], "start": "unloaded", **simulation}
    return table(rod, at_tip(), motions=[force, moment], simulation=asked)


FLYING_LOWER = np.array([[4.97, 4.48], [9.78, 8.20], [16.28, -0.28]])
"""Lower end (x, z) at t = 2.5, 5, 7.5, ± 0.02."""

FLYING_UPPER = np.array([[3.58, 6.11], [8.08, 1.75], [17.23, 8.25]])
"""Upper end (x, z)."""

FLYING_TURN = 229.51
"""Angular momentum about the origin after t = 2.5."""


def flying_in_space(**simulation: Any) -> Table:
    """Moments and a force that rise to t = 2.5 and fall to zero at t = 5."""
    rod = {
        "length": 10.0,
        "strain": "reissner",
        "stiffness": {"bending_x": 500.0, "bending_y": 500.0, "torsion": 500.0, **SOFT},
        "rotary_inertia": [10.0, 10.0, 20.0],
        "base": FLYING_BASE,
    }
    times = [0.0, 2.5, 5.0]
    force = {"input": "push.force", "times": times, "values": [[0, 0, 0], [20, 0, 0], [0, 0, 0]]}
    # The sources have the plane x–y, and moments about −z and y.
    moment = {"input": "push.moment", "times": times, "values": [[0, 0, 0], [0, 200, 100], [0, 0, 0]]}
    asked = {"duration": 6.0, "frames": 13, "start": "unloaded", **simulation}
    return table(rod, at_tip(), motions=[force, moment], simulation=asked)


# Right-angle cantilever: J. C. Simo, L. Vu-Quoc, Comput. Methods Appl. Mech. Engng 66 (1988) 125


def right_angle(**simulation: Any) -> Table:
    """Two legs of 10 in the plane x–y, pushed out of it at the elbow: 0 to 50 at t = 1, to 0 at t = 2."""
    leg = {
        "length": 10.0,
        "strain": "reissner",
        "stiffness": {
            "bending_x": 1e3, "bending_y": 1e3, "torsion": 1e3, "shear_x": 1e6, "shear_y": 1e6, "extension": 1e6
        },
        "linear_density": 1.0,
        "rotary_inertia": [10.0, 10.0, 20.0],
    }  # fmt: skip
    first = {**leg, "name": "first", "base": {"tangent": [1, 0, 0]}}
    # Along y of the world, which is y of the first leg's sections too.
    second = {**leg, "name": "second", "base": {"rod": "first", "tangent": [0, 1, 0]}}
    force = {"input": "push.force", "times": [0.0, 1.0, 2.0], "values": [[0, 0, 0], [0, 0, 50], [0, 0, 0]]}
    asked = {"duration": 16.5, "frames": 331, "start": "unloaded", **simulation}
    loads = [at_tip("first")]
    return {"schema": 1, "rods": [first, second], "loads": loads, "motions": [force], "simulation": asked}


RIGHT_ANGLE_TIP = [(7.67, 8.29), (15.99, -9.67)]
"""Times and heights of the tip's extremes, read off curves, ± 0.1."""

RIGHT_ANGLE_ELBOW = [(3.05, 5.50), (10.8, -3.87)]
"""Likewise of the elbow."""


# Two free rods, hinged


def scissors(**simulation: Any) -> Table:
    """Two free rods whose tips meet in a hinge about y; the hinge is pushed, and one rod is turned, until t = 0.5."""
    stiff = {"bending_x": 1e4, "bending_y": 1e4, "torsion": 1e4, "shear_x": 1e6, "shear_y": 1e6, "extension": 1e6}
    rod = {"length": 5.0, "strain": "reissner", "stiffness": stiff, "linear_density": 1.0}
    left = {**rod, "name": "left", "rotary_inertia": [10.0, 10.0, 20.0]}
    right = {**rod, "name": "right", "rotary_inertia": [1.0, 1.0, 2.0]}
    left["base"] = {"position": [-5, 0, 0], "tangent": [1, 0, 0], "free": True}
    right["base"] = {"position": [5, 0, 0], "tangent": [-1, 0, 0], "free": True}
    hinge = {"name": "hinge", "mass": 1.0, "inertia": [1.0, 1.0, 1.0]}
    # Along x and back: the tips lie in the hinge as their bases do.
    along = {"quaternion": [np.sqrt(0.5), 0.0, np.sqrt(0.5), 0.0]}
    joints = [
        {"rod": "left", "body": "hinge", "kind": "fixed", **along},
        {"rod": "right", "body": "hinge", "kind": "revolute", "axis": [0, 1, 0], **along},
    ]
    joints[1]["quaternion"] = [np.sqrt(0.5), 0.0, -np.sqrt(0.5), 0.0]
    push = {"name": "push", "kind": "body_wrench", "body": "hinge", "force": [0, 0, 0]}
    turn = {"name": "turn", "kind": "tip_wrench", "rod": "left", "moment": [0, 0, 0]}
    times = [0.0, 0.25, 0.5]
    force = {"input": "push.force", "times": times, "values": [[0, 0, 0], [0, 0, 40], [0, 0, 0]]}
    moment = {"input": "turn.moment", "times": times, "values": [[0, 0, 0], [0, 160, 0], [0, 0, 0]]}
    asked = {"duration": 1.5, "frames": 16, "start": "unloaded", **simulation}
    return {
        "schema": 1,
        "rods": [left, right],
        "bodies": [hinge],
        "joints": joints,
        "loads": [push, turn],
        "motions": [force, moment],
        "simulation": asked,
    }


# Heavy top: O. Brüls, A. Cardona, M. Arnold, Mech. Mach. Theory 48 (2012) 121


def heavy_top() -> Table:
    """A body on a ball joint at the tip of a rod that only twists, so that the joint stays at (0, 0, 1)."""
    rod = {"strain": ["torsion"], "stiffness": {"torsion": 1.0}, "base": {}}
    inertia = [0.234375, 0.46875, 0.234375]
    body = {"name": "top", "mass": 15.0, "centre_of_mass": [0, 1, 0], "inertia": inertia}
    joint = {"rod": "rod", "body": "top", "kind": "spherical"}
    return table(rod, {**gravity(9.81), "bodies": ["top"]}, bodies=[body], joints=[joint])


TOP_SPIN = np.array([0.0, 150.0, -4.61538])
"""Angular velocity at the start, in the axes of the body, which are those of the world then, rad/s."""

TOP_CENTRE = np.array([-0.15041682, -0.72416559, -0.67302227])
"""Centre of mass from the joint at t = 2, after some 48 turns."""

TOP_QUATERNION = np.array([0.12294714, -0.49107989, 0.35043003, -0.78798689])
"""Of the body at t = 2, w first."""
