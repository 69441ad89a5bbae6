"""Packages from PyPI on the cantilever of the race made stout, each with its own error and time.

The rod has the bending stiffness, length and tip force of B1 and a radius of a fiftieth of its length instead of a
five-hundredth, with shear and extension: explicit dynamics take steps that shrink with the square of the radius. A
package that is not installed, or that fails, has a row that says so.
"""

from __future__ import annotations

import importlib.util
import math
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from shooting_reference import Case

from tests.reference.shooting import solve_by_shooting

RADIUS, DENSITY = 0.01, 1000.0
"""m, kg/m³; neither moves the equilibrium, given the stiffnesses."""

SETTLED = 24.0
"""Time in units of the slowest critically damped motion, e⁻²⁴ of which is left then."""

CORRECTION = 27 / 28
"""Shear correction that PyElastica gives a circle; everybody takes it."""

Vector = np.ndarray


def stout() -> Case:
    """The case, with its true tip by shooting from the unloaded rod, DOP853 at 1e-13."""
    bending, area, second = math.pi * 0.05, math.pi * RADIUS**2, math.pi * RADIUS**4 / 4
    young = bending / second
    shear = young / 2.5
    case = Case(
        "reissner", 0.5, bending, 2 * shear * second, CORRECTION * shear * area, young * area, (1.0, 0.0, 0.0)
    )  # fmt: skip
    tip = solve_by_shooting(case.scene(1e-3), samples=2).tip_position
    return replace(case, tip=(float(tip[0]), float(tip[1]), float(tip[2])))


@dataclass(frozen=True)
class Peer:
    """A point of a package: its tip error relative to length, and the shortest of its times, µs."""

    package: str
    setting: str
    error: float = math.nan
    microseconds: float = math.nan


LIMITS = {
    "PyElastica": "It solves only dynamics: an equilibrium is the rest of a damped motion. Steps shrink with the "
    "square of the radius, so B1 itself would take millions of steps. Its sections shrink as the rod stretches, ours "
    "do not: this is the error that remains with many elements. Its clamp holds the whole first element, so its rod is "
    "half an element longer here. It has no derivatives and no C.",
    "SciPy solve_bvp": "General collocation: the user gives equations, scaling and start. It does not say which "
    "equilibrium was found or whether it is stable. It has no derivatives of the solution and no C.",
}
"""What a package could not do."""


def shortest(work: Callable[[], Any], repeats: int) -> tuple[Any, float]:
    """Result and shortest processor time of several runs, µs: what else runs on the machine does not count."""
    best = math.inf
    for _ in range(repeats):
        begin = time.process_time()
        found = work()
        best = min(best, time.process_time() - begin)
    return found, 1e6 * best


def peers(case: Case) -> Iterator[Peer]:
    """One row for each package and setting."""
    solvers: tuple[tuple[str, str, tuple[float, ...], Callable[[Case, Any], Vector], int], ...] = (
        ("PyElastica", "elastica", (10, 20, 40), relaxed, 2),
        ("SciPy solve_bvp", "scipy", (1e-3, 1e-6, 1e-9), collocated, 5),
    )
    for package, module, settings, solver, repeats in solvers:
        if importlib.util.find_spec(module) is None:
            yield Peer(package, "not installed")
            continue
        for setting in settings:
            words = f"{setting} elements" if isinstance(setting, int) else f"tolerance {setting:.0e}"
            try:
                found, took = shortest(partial(solver, case, setting), repeats)
            except Exception as failed:  # a peer may break in any way: that is its row
                yield Peer(package, f"{words}: {type(failed).__name__}")
                continue
            yield Peer(package, words, case.tip_error((found[0], found[1], found[2])), took)


# SciPy


def collocated(case: Case, tolerance: float) -> Vector:
    """Position, rotation matrix and moment along the rod as a boundary value problem."""
    from scipy.integrate import solve_bvp

    compliance = 1 / np.array([case.bending, case.bending, case.torsion])
    stretch = 1 / np.array([case.shear, case.shear, case.extension])
    force, size = np.array(case.force), case.bending / case.length

    def rates(_: Vector, y: Vector) -> Vector:
        R, moment = y[3:12].reshape(3, 3, -1), y[12:15] * size
        curvature = compliance[:, None] * np.einsum("ijk,ik->jk", R, moment)
        strain = stretch[:, None] * np.einsum("ijk,i->jk", R, force)
        strain[2] += 1
        tangent = np.einsum("ijk,jk->ik", R, strain)
        turned = np.cross(R, curvature[None], axisa=1, axisb=1, axisc=1)
        moments = -np.cross(tangent, force[:, None], axis=0) / size
        return np.vstack([tangent, turned.reshape(9, -1), moments])

    def ends(base: Vector, tip: Vector) -> Vector:
        return np.concatenate([base[:3], base[3:12] - np.eye(3).ravel(), tip[12:]])

    s = np.linspace(0, case.length, 11)
    start = np.zeros((15, s.size))
    start[2], start[3:12] = s, np.eye(3).ravel()[:, None]
    solved = solve_bvp(rates, ends, s, start, tol=tolerance, max_nodes=20_000)
    if not solved.success:
        raise RuntimeError(solved.message)
    return np.asarray(solved.y[:3, -1])


# PyElastica


def relaxed(case: Case, elements: int) -> Vector:
    """The tip where a damped motion comes to rest, from the rod's construction on."""
    import elastica

    class Simulation(elastica.BaseSystemCollection, elastica.Constraints, elastica.Forcing, elastica.Damping):  # type: ignore[misc]
        """One rod, clamped, pushed, damped."""

    area, second = math.pi * RADIUS**2, math.pi * RADIUS**4 / 4
    young, shear = case.extension / area, case.torsion / (2 * second)
    length = case.length / (1 - 1 / (2 * elements))  # the clamp holds the first element as a whole
    step = 0.4 * min(length / elements, 2 * RADIUS) / math.sqrt(young / DENSITY)  # waves along, and of shear
    slowest = 3.516 * math.sqrt(case.bending / (DENSITY * area)) / case.length**2
    simulation = Simulation()
    along, across = np.array([0.0, 0.0, 1.0]), np.array([1.0, 0.0, 0.0])
    rod = elastica.CosseratRod.straight_rod(
        elements, np.zeros(3), along, across, length, RADIUS, DENSITY, youngs_modulus=young, shear_modulus=shear
    )
    simulation.append(rod)
    clamp = {"constrained_position_idx": (0,), "constrained_director_idx": (0,)}
    simulation.constrain(rod).using(elastica.OneEndFixedBC, **clamp)
    simulation.add_forcing_to(rod).using(
        elastica.EndpointForces, np.zeros(3), np.array(case.force), ramp_up_time=step
    )  # fmt: skip
    damping = {"uniform_damping_constant": 2 * slowest, "time_step": step}
    simulation.dampen(rod).using(elastica.AnalyticalLinearDamper, **damping)
    simulation.finalize()
    stepper, now = elastica.PositionVerlet(), 0.0
    for _ in range(math.ceil(SETTLED / slowest / step)):
        now = stepper.step(simulation, now, step)
    return np.array(rod.position_collection[:, -1]) - (length - case.length) * along
