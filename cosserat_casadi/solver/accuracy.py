"""From a tolerance to a discretisation: refine until the estimated pose error is below it.

A ladder of discretisations is climbed, two modes or more a rung. The error of a rung is the distance of its poses to
those of the next one, which is far closer to the truth: spectral errors fall by orders of magnitude a rung. The rung
that meets the tolerance is the answer, the one above it is the witness.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from math import ceil

import numpy as np
import numpy.typing as npt

from cosserat_casadi import scene as scenes
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model, build
from cosserat_casadi.model.mesh import DEFAULT_MODES, discretise, nodes_for
from cosserat_casadi.rod.strain import StrainBasis
from cosserat_casadi.solver.continuation import ContinuationSettings, Progress
from cosserat_casadi.solver.outcome import Outcome
from cosserat_casadi.solver.solution import Pose, Solution
from cosserat_casadi.solver.solve import correct, judge, solve

LADDER = (3, 5, 7, 9, 12, 15, 19, 24, 30, 38, 48, 64)
"""Modes per strain component and element, rung by rung."""

SAFETY = 2.0
"""Factor on the distance between two rungs: the witness has an error of its own."""

ROUNDING = 2e-14
"""Floor of every estimate."""

TIGHT = 1e-6
"""Tolerances below this take the rotation integrator of eighth order, others that of sixth."""

GIVE_UP = 2
"""Rungs beyond the first failure after which no equilibrium is sought any more."""

SAMPLES = (1 - np.cos(np.pi * np.arange(33) / 32)) / 2
"""Abscissae at which whole shapes are compared."""

Report = Callable[[str], None]
"""Told what is being tried."""


@dataclass(frozen=True)
class Rung:
    """One discretisation of the ladder: modes per component and Chebyshev intervals, per element."""

    modes: int | tuple[int, ...]
    nodes: int


@dataclass
class _Climb:
    """The way up the ladder for one scene and one set of inputs.

    Attributes:
        scene: the scene.
        values: inputs by name.
        progress: told the share of the load path that is done.
        report: told what is being tried.
        failures: rungs on which no equilibrium was found.
    """

    scene: scenes.Scene
    values: Mapping[str, npt.ArrayLike] | None
    progress: Progress | None = None
    report: Report | None = None
    failures: list[Solution] = field(default_factory=list)

    @property
    def transport(self) -> str:
        """Rotation integrator that suits the tolerance."""
        return "magnus8" if self.scene.accuracy.tolerance < TIGHT else "magnus6"

    def solve(self, rung: Rung, below: Solution | None) -> Solution:
        """Solution on a rung, from the one below where that is near, else from the unloaded scene."""
        model = build(self.scene, discretise(self.scene, rung.modes, rung.nodes, self.transport))
        if self.report is not None:
            self.report(f"{model.size} unknowns, {rung.nodes} intervals")
        if below is not None:
            near = _polish(model, below)
            if near is not None:
                return near
        return solve(model, self.values, progress=self.progress)

    def ladder(self) -> Solution:
        """The coarsest rung whose estimated error is below the tolerance."""
        tolerance = self.scene.accuracy.tolerance
        coarse: Solution | None = None
        for modes in LADDER[0 if tolerance >= 1e-4 else 1 :]:
            turn = 0.0 if coarse is None else largest_turn(coarse)
            fine = self.solve(Rung(modes, self._nodes(modes, turn)), coarse)
            if not fine.converged:
                self.failures.append(fine)
                if len(self.failures) > GIVE_UP:
                    return self.failures[-1]
                continue
            if coarse is not None:
                coarse = with_estimate(coarse, fine)
                if coarse.error_estimate is not None and coarse.error_estimate <= tolerance:
                    return coarse
            coarse = fine
        return self.failures[-1] if coarse is None else _unresolved(coarse)

    def fixed(self) -> Solution:
        """The discretisation that the scene asks for, with its error estimated by a finer one."""
        modes = DEFAULT_MODES if self.scene.accuracy.modes is None else self.scene.accuracy.modes
        most = modes if isinstance(modes, int) else max(modes)
        nodes = nodes_for(most) if self.scene.accuracy.nodes is None else self.scene.accuracy.nodes
        coarse = self.solve(Rung(modes, nodes), None)
        if not coarse.converged:
            return coarse
        finer = modes + 4 if isinstance(modes, int) else tuple(m + 4 for m in modes)
        witness = self.solve(Rung(finer, max(nodes + 10, self._nodes(most + 4, largest_turn(coarse)))), coarse)
        return with_estimate(coarse, witness) if witness.converged else _unresolved(coarse)

    def _nodes(self, modes: int, turn: float) -> int:
        unloaded = max(_unloaded_turn(scene_rod) for scene_rod in self._bases())
        return nodes_for(modes) + ceil(max(turn, unloaded) / 2)

    def _bases(self) -> list[StrainBasis]:
        return list(build(self.scene, discretise(self.scene, 1, 2)).frame.bases.values())


def solve_scene(
    scene: scenes.Scene,
    values: Mapping[str, npt.ArrayLike] | None = None,
    *,
    progress: Progress | None = None,
    report: Report | None = None,
) -> Solution:
    """Equilibrium of a scene to its tolerance, at the coarsest rung that meets it.

    Where the scene fixes modes or nodes they are used as they are, and only the error is estimated.

    Args:
        scene: a validated scene.
        values: inputs by name; those not named keep the scene's values.
        progress: told the share of the load path that is done.
        report: told the discretisation being solved.

    Raises:
        SceneError: a value is refused.
    """
    climb = _Climb(scene, values, progress, report)
    chosen = scene.accuracy.modes is not None or scene.accuracy.nodes is not None
    return climb.fixed() if chosen else climb.ladder()


def with_estimate(coarse: Solution, fine: Solution) -> Solution:
    """A solution with the error that a finer one of the same scene and inputs gives it."""
    tip = pose_distance(coarse, fine, np.array([1.0]))
    whole = pose_distance(coarse, fine, SAMPLES)
    return replace(
        coarse,
        error_estimate=SAFETY * tip + ROUNDING,
        shape_error_estimate=SAFETY * max(tip, whole) + ROUNDING,
    )


def pose_distance(one: Solution, other: Solution, X: FloatArray) -> float:
    """Largest difference of the poses at X over all rods: position over length, rotation entries."""
    distances = [0.0]
    for name, basis in one.model.frame.bases.items():
        a, b = one.pose(X, name), other.pose(X, name)
        distances.append(_distance(a, b, basis.rod.length))
    return max(distances)


def largest_turn(solution: Solution) -> float:
    """Largest angle through which an element of a rod turns from end to end, summed along it, rad."""
    return max(_element_turn(basis, solution) for basis in solution.model.frame.bases.values())


def _distance(a: Pose, b: Pose, length: float) -> float:
    position = float(np.abs(a.position - b.position).max()) / length
    return max(position, float(np.abs(a.rotation - b.rotation).max()))


def _element_turn(basis: StrainBasis, solution: Solution) -> float:
    curvature = solution.strain(basis.grid.nodes, basis.rod.name)[:, :3]
    turn = basis.grid.weights * np.linalg.norm(curvature, axis=1) * basis.rod.length
    return float(turn.reshape(basis.grid.elements, -1).sum(axis=1).max())


def _unloaded_turn(basis: StrainBasis) -> float:
    curvature = basis.rod.intrinsic_strain(SAMPLES)[:, :3]
    return float(np.linalg.norm(curvature, axis=1).max()) * basis.rod.length


def _polish(model: Model, below: Solution) -> Solution | None:
    """Newton from the rung below; None where it does not stay near, so that it may be another branch."""
    settings = ContinuationSettings().newton
    found = correct(model, below.inputs, prolong(below, model), settings)
    if found is None:
        return None
    return judge(model, below.inputs, found.x, found.outcome, found.iterations, 1.0, settings.tolerance)


def prolong(solution: Solution, model: Model) -> FloatArray:
    """Unknowns of a finer model of the same scene: the coefficients that exist, zeros for the rest."""
    parts = []
    for name, basis in solution.model.frame.bases.items():
        q = solution.x[solution.model.frame.rod_slices[name]]
        fine = model.frame.bases[name]
        for c, columns in basis.columns.items():
            coarse = q[columns].reshape(basis.grid.elements, -1)
            width = fine.at_nodes[c].shape[1] // fine.grid.elements
            padded = np.zeros((fine.grid.elements, width))
            padded[:, : coarse.shape[1]] = coarse
            parts.append(padded.ravel())
    multipliers = solution.x[solution.model.frame.strain_size :]
    return np.concatenate([*parts, multipliers])


def _unresolved(solution: Solution) -> Solution:
    return replace(solution, outcome=Outcome.UNRESOLVED, message=Outcome.UNRESOLVED.value, stable=None)
