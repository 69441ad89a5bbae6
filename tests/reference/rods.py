"""From the tables of a scene to one rod as functions of X ∈ [0, 1], base to tip.

Local z is the tangent, strains are [K; Γ] per metre of undeformed length, the section wrench is [M; N].
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]
Profile = Callable[[float], Array]
Table = dict[str, Any]

STRAINS = ("bending_x", "bending_y", "torsion", "shear_x", "shear_y", "extension")
THEORIES = {"planar": STRAINS[1:2], "kirchhoff": STRAINS[:3], "reissner": STRAINS}


@dataclass(frozen=True)
class PointLoad:
    """Force and moment on the section at X; body axes follow the section."""

    at: float
    force: Array
    moment: Array
    follows: bool


@dataclass(frozen=True)
class RodData:
    """What a scene says of its only rod.

    Attributes:
        length: undeformed, m.
        admitted: True for each strain that may change, in the order K_x, K_y, K_z, Γ_x, Γ_y, Γ_z.
        compliance: 6 strains per unit of wrench; zero where a strain is not admitted.
        intrinsic: 6 strains of the unloaded rod.
        dead_load: force and moment per metre in world axes, stacked.
        follower_load: force and moment per metre in section axes, stacked.
        points: loads on single sections, the tip included.
        base_position: 3 coordinates, m.
        base_rotation: columns are the section's axes in the world.
        beyond: changes of strain (k, 6) and abscissae (k,) ↦ stress beside that of the compliance (k, 6); None of none.
    """

    length: float
    admitted: NDArray[np.bool_]
    compliance: Profile
    intrinsic: Profile
    dead_load: Profile
    follower_load: Profile
    points: tuple[PointLoad, ...]
    base_position: Array
    base_rotation: Array
    beyond: Callable[[Array, Array], Array] | None = None


def rod_of(scene: Table) -> RodData:
    """The only rod of a scene."""
    (rod,) = scene["rods"]
    base = rod.get("base", {})
    return RodData(
        length=float(rod["length"]),
        admitted=_admitted(rod["strain"]),
        compliance=_compliance(rod),
        intrinsic=_intrinsic(rod.get("intrinsic", {})),
        dead_load=_dead_load(scene, rod),
        follower_load=_wrench_sum(_distributed(scene, "body")),
        points=tuple(_points(scene)),
        base_position=np.array(base.get("position", [0, 0, 0]), dtype=float),
        base_rotation=_base_rotation(base),
    )


# Rotations


def rotation_from_quaternion(quaternion: ArrayLike) -> Array:
    """Rotation matrix of a quaternion w, x, y, z, normalised first."""
    q = np.asarray(quaternion, dtype=float)
    w, x, y, z = q / np.linalg.norm(q)
    return np.array(
        [
            [w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z],
        ]
    )


def hat(v: Array) -> Array:
    """The matrix of the cross product with a vector."""
    return np.array([[0.0, -v[2], v[1]], [v[2], 0.0, -v[0]], [-v[1], v[0], 0.0]])


def rotation_from_tangent(tangent: ArrayLike) -> Array:
    """The shortest rotation of z to a direction; for −z, where there is none, the half turn about x."""
    direction = np.asarray(tangent, dtype=float)
    x, y, z = direction / np.linalg.norm(direction)
    if z < 0 and x == y == 0:
        return np.diag([1.0, -1.0, -1.0])
    return rotation_from_quaternion([1 + z, -y, x, 0])


def _base_rotation(base: Table) -> Array:
    if "tangent" in base:
        return rotation_from_tangent(base["tangent"])
    return rotation_from_quaternion(base.get("quaternion", [1, 0, 0, 0]))


# Functions of X


def _legendre_profile(rows: Sequence[Any]) -> Profile:
    """Rows of Legendre coefficients in 2X − 1, a number standing for a constant."""
    lists = [np.atleast_1d(np.asarray(row, dtype=float)) for row in rows]
    coefficients = np.zeros((max(map(len, lists)), len(lists)))
    for column, entries in enumerate(lists):
        coefficients[: len(entries), column] = entries
    if len(coefficients) == 1:
        return lambda X: coefficients[0]
    return lambda X: np.asarray(legendre.legval(2 * X - 1, coefficients))


def _linear(size: Any) -> Callable[[float], float]:
    """A number, or two that are met at base and tip."""
    if not isinstance(size, list):
        return lambda X: size
    start, end = size
    return lambda X: start + (end - start) * X


def _is_tapered(table: Table) -> bool:
    return any(isinstance(value, list) for value in table.values())


# Elasticity


def _admitted(strain: str | Sequence[str]) -> NDArray[np.bool_]:
    names = THEORIES[strain] if isinstance(strain, str) else strain
    return np.array([name in names for name in STRAINS])


def _compliance(rod: Table) -> Profile:
    admitted = _admitted(rod["strain"])
    hooke = _direct_hooke(rod["stiffness"]) if "stiffness" in rod else _material_hooke(rod)

    def compliance(X: float) -> Array:
        return np.divide(1.0, hooke(X), out=np.zeros(6), where=admitted)

    if _is_tapered(rod["stiffness"] if "stiffness" in rod else rod["section"]):
        return compliance
    constant = compliance(0.0)
    return lambda X: constant


def _direct_hooke(stiffness: Table) -> Profile:
    sizes = [_linear(stiffness.get(name, np.inf)) for name in STRAINS]
    return lambda X: np.array([size(X) for size in sizes])


def _material_hooke(rod: Table) -> Profile:
    material, section = rod["material"], rod["section"]
    young = material["youngs_modulus"]
    shear = material.get("shear_modulus")
    if shear is None:
        shear = young / (2 * (1 + material["poisson_ratio"]))
    correction = section.get("shear_correction", 1.0)

    def hooke(X: float) -> Array:
        area, about_x, about_y, torsion = _section_constants(section, X)
        sideways = correction * shear * area
        return np.array([young * about_x, young * about_y, shear * torsion, sideways, sideways, young * area])

    return hooke


def _section_constants(section: Table, X: float) -> tuple[float, float, float, float]:
    """Area, ∫y² dA, ∫x² dA and the torsion constant of a section."""
    if section["shape"] == "rectangle":
        width, height = _linear(section["width"])(X), _linear(section["height"])(X)
        torsion = torsion_constant(width, height)
        return width * height, width * height**3 / 12, height * width**3 / 12, torsion
    outer = _linear(section.get("outer_radius", section.get("radius")))(X)
    inner = _linear(section.get("inner_radius", 0.0))(X)
    second = np.pi / 4 * (outer**4 - inner**4)
    return np.pi * (outer**2 - inner**2), second, second, 2 * second


def torsion_constant(width: float, height: float) -> float:
    """Saint-Venant's torsion constant of a rectangle.

    With a ≥ b the sides, J = a b³/3 (1 − 192 b/(π⁵ a) Σ_{k odd} tanh(kπa/2b)/k⁵). As tanh tends to one, the sum is
    split into Σ_{k odd} 1/k⁵ = 31 ζ(5)/32 and a rest that falls off exponentially.
    """
    long, short = max(width, height), min(width, height)
    odd = np.arange(1, 27, 2)
    rest = 2 / (np.exp(np.minimum(np.pi * odd * long / short, 700.0)) + 1)
    zeta_5 = 1.0369277551433699263
    total = 31 / 32 * zeta_5 - np.sum(rest / odd.astype(float) ** 5)
    return float(long * short**3 / 3 * (1 - 192 * short / (np.pi**5 * long) * total))


def _intrinsic(table: Table) -> Profile:
    return _legendre_profile([*table.get("curvature", [0, 0, 0]), *table.get("tangent", [0, 0, 1])])


# Loads


def _linear_density(rod: Table) -> Callable[[float], float]:
    if "stiffness" in rod:
        return _linear(rod.get("linear_density", 0.0))
    section, density = rod["section"], rod["material"]["density"]
    return lambda X: density * _section_constants(section, X)[0]


def _dead_load(scene: Table, rod: Table) -> Profile:
    weights = [
        np.array([*load["acceleration"], 0, 0, 0], dtype=float)
        for load in scene.get("loads", [])
        if load["kind"] == "gravity" and rod["name"] in load.get("rods", [rod["name"]])
    ]
    wrenches = _wrench_sum(_distributed(scene, "world"))
    if not weights:
        return wrenches
    acceleration, density = sum(weights), _linear_density(rod)
    return lambda X: wrenches(X) + density(X) * acceleration


def _distributed(scene: Table, frame: str) -> list[Table]:
    loads = scene.get("loads", [])
    return [load for load in loads if load["kind"] == "distributed_wrench" and load.get("frame", "world") == frame]


def _wrench_sum(loads: Sequence[Table]) -> Profile:
    rest = [0, 0, 0]
    profiles = [_legendre_profile([*load.get("force", rest), *load.get("moment", rest)]) for load in loads]
    return lambda X: sum((profile(X) for profile in profiles), np.zeros(6))


def _points(scene: Table) -> list[PointLoad]:
    return [
        PointLoad(
            at=float(load.get("at", 1.0)),
            force=np.array(load.get("force", [0, 0, 0]), dtype=float),
            moment=np.array(load.get("moment", [0, 0, 0]), dtype=float),
            follows=load.get("frame", "world") == "body",
        )
        for load in scene.get("loads", [])
        if load["kind"] in ("tip_wrench", "point_wrench")
    ]
