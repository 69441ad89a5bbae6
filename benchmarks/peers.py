"""Packages from PyPI on the cantilever of the race made stout, each with its own error and time.

The rod has the bending stiffness, length and tip force of B1 and a radius of a twentieth of its length instead of a
five-hundredth, with shear and extension: explicit dynamics take steps that shrink with the square of the radius. A
package that is not installed has a row that says so.
"""

from __future__ import annotations

import importlib.util
import math
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from cosserat_casadi import scene_from_dict, solve_scene
from tests.reference.shooting import solve_by_shooting

LENGTH, RADIUS, BENDING, FORCE = 0.5, 0.025, math.pi * 0.05, 1.0
SECOND, AREA = math.pi * RADIUS**4 / 4, math.pi * RADIUS**2
YOUNG, POISSON = BENDING / SECOND, 0.25
SHEAR = YOUNG / (2 * (1 + POISSON))
CORRECTION = 27 / 28
"""Shear correction that PyElastica gives a circle; everybody takes it."""
DENSITY = 1000.0
SETTLED = 6.0
"""Seconds after which the damped rod stands still to about 1e-10 of its length."""

Vector = np.ndarray


@dataclass(frozen=True)
class Peer:
    """A point of a package: its tip error relative to length, and the shortest of its times."""

    package: str
    setting: str
    error: float = math.nan
    milliseconds: float = math.nan
    note: str = ""


LIMITS = {
    "PyElastica": "dynamics alone: an equilibrium is where a damped motion ends; second order in the elements; steps "
    "shrink with the square of the radius (B1 itself needs some millions); no Jacobian, no C; circular sections",
    "SciPy solve_bvp": "general collocation: the equations, their scaling and a start are the user's; no load stepping, no "
    "statement about stability, no derivatives of the solution, no C",
}
"""What a package could not do beside its row."""


def tables() -> dict[str, Any]:
    shear = CORRECTION * SHEAR * AREA
    stiffness = {"bending_x": BENDING, "bending_y": BENDING, "torsion": 2 * SHEAR * SECOND}
    stiffness |= {"shear_x": shear, "shear_y": shear, "extension": YOUNG * AREA}
    rod = {"name": "rod", "length": LENGTH, "strain": "reissner", "stiffness": stiffness}
    tip = {"name": "tip", "kind": "tip_wrench", "rod": "rod", "frame": "world", "force": [FORCE, 0.0, 0.0]}
    tip["moment"] = [0.0, 0.0, 0.0]
    return {"schema": 1, "rods": [rod], "loads": [tip]}


def true_tip() -> Vector:
    """By shooting from the unloaded rod, DOP853 at 1e-13."""
    return np.asarray(solve_by_shooting(tables(), samples=2).tip_position)


def shortest(work: Callable[[], Vector], repeats: int) -> tuple[Vector, float]:
    """Result and shortest time of several runs, ms."""
    best = math.inf
    for _ in range(repeats):
        begin = time.perf_counter()
        found = work()
        best = min(best, time.perf_counter() - begin)
    return found, 1e3 * best


def peers() -> Iterator[Peer]:
    """One row for each package and setting."""
    truth = true_tip()
    for package, module, settings, solver, repeats in (
        ("PyElastica", "elastica", (10, 20, 40, 80), relaxed, 1),
        ("SciPy solve_bvp", "scipy", (1e-3, 1e-6, 1e-9), collocated, 3),
        ("this package, Python", "casadi", (1e-3, 1e-5, 1e-8, 1e-11), ours, 3),
    ):
        if importlib.util.find_spec(module) is None:
            yield Peer(package, "", note="not installed")
            continue
        for setting in settings:
            words = f"{setting} elements" if isinstance(setting, int) else f"tolerance {setting:.0e}"
            try:
                found, milliseconds = shortest(lambda s=setting, f=solver: f(s), repeats)  # type: ignore[misc]
            except Exception as failed:  # a peer may break in any way: that is its row
                yield Peer(package, words, note=f"{type(failed).__name__}: {failed}"[:80])
                continue
            yield Peer(package, words, float(np.linalg.norm(found - truth)) / LENGTH, milliseconds)


# Our own


def ours(tolerance: float) -> Vector:
    """Everything from the scene on: choice of the discretisation, construction, solution."""
    solution = solve_scene(scene_from_dict({**tables(), "accuracy": {"tolerance": tolerance}}))
    if not solution.converged:
        raise RuntimeError(solution.message)
    return solution.tip().position[0]


# SciPy


def collocated(tolerance: float) -> Vector:
    """Position, rotation matrix and wrench along the rod as a boundary value problem."""
    from scipy.integrate import solve_bvp

    compliance = 1 / np.array([BENDING, BENDING, 2 * SHEAR * SECOND])
    shear = CORRECTION * SHEAR * AREA
    stretch = 1 / np.array([shear, shear, YOUNG * AREA])
    forces, size = np.array([FORCE, 0.0, 0.0]), BENDING / LENGTH

    def rates(_: Vector, y: Vector) -> Vector:
        R, moment = y[3:12].reshape(3, 3, -1), y[12:15] * size
        curvature = compliance[:, None] * np.einsum("ijk,ik->jk", R, moment)
        strain = stretch[:, None] * np.einsum("ijk,i->jk", R, forces)
        strain[2] += 1
        tangent = np.einsum("ijk,jk->ik", R, strain)
        turned = np.cross(R, curvature[None], axisa=1, axisb=1, axisc=1)
        moments = -np.cross(tangent, forces[:, None], axis=0) / size
        return np.vstack([tangent, turned.reshape(9, -1), moments])

    def ends(base: Vector, tip: Vector) -> Vector:
        return np.concatenate([base[:3], base[3:12] - np.eye(3).ravel(), tip[12:]])

    s = np.linspace(0, LENGTH, 11)
    start = np.zeros((15, s.size))
    start[2], start[3:12] = s, np.eye(3).ravel()[:, None]
    solved = solve_bvp(rates, ends, s, start, tol=tolerance, max_nodes=20_000)
    if not solved.success:
        raise RuntimeError(solved.message)
    return np.asarray(solved.y[:3, -1])


# PyElastica


def relaxed(elements: int) -> Vector:
    """The tip where a damped motion has come to rest; building the simulation included, compiling it not."""
    simulate(elements, 1e-3)  # compiles
    return simulate(elements, SETTLED)


def simulate(elements: int, seconds: float) -> Vector:
    import elastica

    class Simulation(elastica.BaseSystemCollection, elastica.Constraints, elastica.Forcing, elastica.Damping):  # type: ignore[misc]
        """One rod, clamped, pushed, damped."""

    step = 0.4 * LENGTH / elements / math.sqrt(YOUNG / DENSITY)
    slowest = 3.516 * math.sqrt(BENDING / (DENSITY * AREA)) / LENGTH**2
    simulation = Simulation()
    rod = elastica.CosseratRod.straight_rod(
        elements, np.zeros(3), np.array([0.0, 0.0, 1.0]), np.array([1.0, 0.0, 0.0]), LENGTH, RADIUS, DENSITY,
        youngs_modulus=YOUNG, shear_modulus=SHEAR,
    )  # fmt: skip
    simulation.append(rod)
    clamp = {"constrained_position_idx": (0,), "constrained_director_idx": (0,)}
    simulation.constrain(rod).using(elastica.OneEndFixedBC, **clamp)
    push = (np.zeros(3), np.array([FORCE, 0.0, 0.0]))
    simulation.add_forcing_to(rod).using(elastica.EndpointForces, *push, ramp_up_time=step)
    damping = {"uniform_damping_constant": 2 * slowest, "time_step": step}
    simulation.dampen(rod).using(elastica.AnalyticalLinearDamper, **damping)
    simulation.finalize()
    stepper = elastica.PositionVerlet()
    now = 0.0
    for _ in range(math.ceil(seconds / step)):
        now = stepper.step(simulation, now, step)
    return np.array(rod.position_collection[:, -1])
