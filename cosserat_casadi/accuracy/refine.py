"""From a tolerance to the cheapest discretisation that meets it.

A ladder of uniform discretisations is climbed, quickly, to a witness: a solution whose own error is a small part of
the tolerance. Below the witness modes per component, intervals and the order of the rotation integrator are trimmed
to what the tolerance needs. The trimmed model is solved, and its distance to the witness, with what the witness itself
may be off, is the estimate of its error.

The choice is made at the inputs of the scene, or those given: a component that they do not excite keeps one mode. Who
changes the inputs afterwards, to load the rod harder or in another direction, fixes modes and nodes or chooses at the
inputs that excite most.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from math import ceil

import numpy as np
import numpy.typing as npt

from cosserat_casadi import scene as scenes
from cosserat_casadi.accuracy.coarsen import Trim
from cosserat_casadi.accuracy.node_residual import modes_to_see
from cosserat_casadi.accuracy.preview import SAMPLES, Preview, watched
from cosserat_casadi.accuracy.resolution import Resolution
from cosserat_casadi.equilibrium.judge import correct, judge
from cosserat_casadi.equilibrium.relax import PATH_OF_ENERGY
from cosserat_casadi.equilibrium.solution import Pose, Solution
from cosserat_casadi.equilibrium.solve import NONE_STABLE, check_potential, solve, stabilised
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model, build
from cosserat_casadi.model.discretise import DEFAULT_MODES, discretise, nodes_for
from cosserat_casadi.model.unknowns import BlockKind
from cosserat_casadi.numerics.continuation import ContinuationSettings
from cosserat_casadi.numerics.outcome import Outcome
from cosserat_casadi.numerics.progress import Progress
from cosserat_casadi.rod.discretisation import Discretisation
from cosserat_casadi.rod.strain import DiscreteRod

LADDER = (3, 5, 7, 9, 12, 15, 19, 24, 30, 38, 48, 64)
"""Modes per strain component and element of a witness, rung by rung."""

FIRST = ((1e-4, 1), (0.0, 2))
"""Rung to begin with for tolerances down to a bound; lower ones cannot tell how fast they converge."""

NO_SHAPE = 0.1
"""Error relative to the length from which on a rod on modes and nodes of the user's own is not that of the scene."""

SAFETY = 2.0
"""Factor on the distance to a finer solution whose own error is not known."""

WITNESS = 0.15
"""Share of the tolerance that a witness may be off by its modes, and by its grid a third of that."""

TRIMS = (0.85, 0.35)
"""Shares of the tolerance that trimming may use up, one try after the other."""

MARGIN = 1.02
"""Factor on the distance to a witness whose own error is known."""

STRETCH, MOST_STRETCH = 1.4, 4.0
"""Factor on the intervals of a witness whose grid is too coarse, and the product at which it is given up."""

ROUNDING = 2e-14
"""Floor of every estimate."""

FLOOR = 1e-13
"""Error of a witness that is not told from rounding."""

TIGHT = 1e-6
"""Witnesses for tolerances below this take the rotation integrator of eighth order, others that of sixth."""

MOST_NODES = 400
"""Intervals of an element beyond which a rod too bent for them is given up."""

GIVE_UP = 2
"""Rungs beyond the first failure after which no equilibrium is sought any more."""

Report = Callable[[str], None]
"""Told what is being tried."""


@dataclass
class _Climb:
    """The way up the ladder for one scene and one set of inputs, and down from its top.

    Attributes:
        scene: the scene.
        values: inputs by name.
        progress: told the share of the load path that is done.
        report: told what is being tried.
        stable: whether a stable equilibrium is wanted.
        settled: whether the equilibrium was reached by settling to less energy.
        unsettled: whether settling was tried in vain.
        floor: intervals below which a grid was found too coarse for so bent a rod.
        failures: rungs on which no equilibrium was found.
    """

    scene: scenes.Scene
    values: Mapping[str, npt.ArrayLike] | None
    progress: Progress | None = None
    report: Report | None = None
    stable: bool = False
    settled: bool = False
    unsettled: bool = False
    floor: int = 0
    failures: list[Solution] = field(default_factory=list)

    @property
    def tolerance(self) -> float:
        """Wanted error of the tip poses."""
        return self.scene.accuracy.tolerance

    @property
    def transport(self) -> str:
        """Rotation integrator of the witness that suits the tolerance."""
        return "magnus8" if self.tolerance < TIGHT else "magnus6"

    def solve(
        self, modes: int | tuple[int, ...], nodes: int, below: Solution | None, transport: str | None = None
    ) -> Solution:
        """Solution on a rung, from one with fewer modes where that is near, else from the unloaded scene."""
        model = self._build(discretise(self.scene, modes, nodes, transport or self.transport))
        if below is not None:
            near = _polish(model, prolong(below, model), below.inputs)
            if near is not None:
                return near
        found, self.settled = solve(model, self.values, progress=self.progress), False
        return self._stabilised(found) if found.outcome is Outcome.LOAD_STALLED else found

    def _stabilised(self, solution: Solution) -> Solution:
        """A stable solution where one is wanted and can be found.

        A held rod is always wanted stable: what leads to its supports are springs of our own, not loads of the scene.
        """
        wanted = (self.stable or bool(self.scene.supports)) and not self.unsettled
        if not wanted or solution.stable or not solution.model.has_potential(solution.inputs):
            return solution
        found = stabilised(solution, ContinuationSettings(), self.progress)
        self.settled, self.unsettled = bool(found.stable), not found.stable
        return found

    def ladder(self) -> Solution:
        """The cheapest solution found whose estimated error is below the tolerance."""
        rung, stretch = self._first_rung(), 1.0
        below: Solution | None = None
        while rung < len(LADDER):
            turn = 0.0 if below is None else largest_turn(below)
            nodes = max(ceil(stretch * self._nodes(LADDER[rung], turn)), self.floor)
            fine = self.solve(LADDER[rung], nodes, below)
            if fine.outcome is Outcome.UNRESOLVED and nodes < MOST_NODES:
                below, self.floor = fine, finer_grid(fine, nodes)
                continue
            if not fine.converged:
                self.failures.append(fine)
                if len(self.failures) > GIVE_UP:
                    return self.failures[-1]
                rung += 1
                continue
            below, resolution = fine, Resolution(Preview(fine))
            lacking = resolution.modes_lacking(max(WITNESS * self.tolerance, FLOOR))
            seeing = modes_to_see(fine, largest_turn(fine), self.tolerance)
            if seeing > LADDER[rung]:
                rung = next((r for r, modes in enumerate(LADDER) if modes >= seeing), len(LADDER))
            elif lacking > 0:
                rung = _next_rung(rung, lacking)
            elif resolution.grid_error <= max(WITNESS / 3 * self.tolerance, FLOOR):
                # Only now: with few modes a rod may seem unstable that is not.
                below = self._stabilised(fine)
                if below is fine or not below.stable:
                    return self._trimmed(resolution)
            elif stretch < MOST_STRETCH:
                stretch *= STRETCH
            else:
                break
        return self.failures[-1] if below is None else _unresolved(below)

    def _trimmed(self, resolution: Resolution) -> Solution:
        """The cheapest solution below a witness; the witness itself where none is near enough to it."""
        witness = resolution.preview.witness
        own = resolution.modes_error + resolution.grid_error
        for share in TRIMS:
            trimmed = Trim(resolution.preview, share * self.tolerance - own).run()
            found = _polish(self._build(trimmed.discretisation), trimmed.start, witness.inputs)
            # Few modes meet the tip and may still be too stiff to buckle: the witness decides what is stable.
            if found is None or not found.converged or found.stable is not witness.stable:
                continue
            judged = replace(
                with_estimate(found, witness, MARGIN, own),
                smallest_eigenvalue=witness.smallest_eigenvalue,
                message=witness.message,
            )
            if judged.error_estimate is not None and judged.error_estimate <= self.tolerance:
                return judged
        return replace(witness, error_estimate=own + ROUNDING)

    def _build(self, discretisation: dict[str, Discretisation]) -> Model:
        model = build(self.scene, discretisation)
        if self.report is not None:
            self.report(f"{model.size} unknowns, {max(d.nodes for d in discretisation.values())} intervals")
        return model

    def _first_rung(self) -> int:
        return min(next(rung for bound, rung in FIRST if self.tolerance >= bound), len(LADDER) - 1)

    def fixed(self) -> Solution:
        """The discretisation that the scene asks for, with its error estimated by a finer one."""
        modes = DEFAULT_MODES if self.scene.accuracy.modes is None else self.scene.accuracy.modes
        most = modes if isinstance(modes, int) else max(modes)
        nodes = nodes_for(most) if self.scene.accuracy.nodes is None else self.scene.accuracy.nodes
        coarse = self._stabilised(self.solve(modes, nodes, None, self.scene.accuracy.rotation))
        if not coarse.converged:
            return coarse
        turn = largest_turn(coarse)
        seeing = modes_to_see(coarse, turn, self.scene.accuracy.tolerance)
        finer = max(modes + 4, seeing) if isinstance(modes, int) else tuple(max(m + 4, seeing) for m in modes)
        witness = self.solve(finer, max(nodes + 10, self._nodes(max(most + 4, seeing), turn)), coarse)
        if not witness.converged:
            return _unresolved(coarse)
        found = with_estimate(coarse, witness)
        wrong = found.shape_error_estimate is None or not found.shape_error_estimate <= NO_SHAPE
        return _unresolved(found) if wrong else found

    def _nodes(self, modes: int, turn: float) -> int:
        unloaded = max(_unloaded_turn(scene_rod) for scene_rod in self._bases())
        return nodes_for(modes) + ceil(max(turn, unloaded) / 2)

    def _bases(self) -> list[DiscreteRod]:
        return list(build(self.scene, discretise(self.scene, 1, 2)).discrete.rods.values())


def solve_scene(
    scene: scenes.Scene,
    values: Mapping[str, npt.ArrayLike] | None = None,
    *,
    stable: bool = False,
    progress: Progress | None = None,
    report: Report | None = None,
) -> Solution:
    """Equilibrium of a scene to its tolerance, on the cheapest discretisation found that meets it.

    The discretisation suits these inputs: a strain that they do not excite has one mode. Where
    the scene fixes modes or nodes they are used as they are, and only the error is estimated.

    A held rod whose load path ends at an unstable equilibrium, or at none, is let settle to a stable one.

    Args:
        scene: a validated scene.
        values: inputs by name; those not named keep the scene's values.
        stable: whether a free rod is let settle too; under loads that have a potential.
        progress: told the share of the load path that is done.
        report: told the discretisation being solved.

    Raises:
        SceneError: a value is refused, or a stable equilibrium is wanted under loads without a potential.
    """
    if stable:
        coarsest = build(scene, discretise(scene, 1, 2))
        check_potential(coarsest, coarsest.pack(values))
    climb = _Climb(scene, values, progress, report, stable)
    found = climb.fixed() if scene.accuracy.fixed else climb.ladder()
    if climb.settled and found.stable and PATH_OF_ENERGY not in found.message:
        found = replace(found, message=found.message + PATH_OF_ENERGY)
    if stable and found.converged and not found.stable and NONE_STABLE not in found.message:
        found = replace(found, message=found.message + NONE_STABLE)
    return found


def with_estimate(coarse: Solution, fine: Solution, factor: float = SAFETY, own: float = 0.0) -> Solution:
    """A solution with the error that a finer one of the same scene and inputs gives it.

    Args:
        coarse: the solution.
        fine: the finer one.
        factor: on the distance of their poses.
        own: error of the finer one, added.
    """
    tip = pose_distance(coarse, fine)
    whole = pose_distance(coarse, fine, SAMPLES)
    return replace(
        coarse,
        error_estimate=factor * tip + own + ROUNDING,
        shape_error_estimate=factor * max(tip, whole) + own + ROUNDING,
    )


def pose_distance(one: Solution, other: Solution, X: FloatArray | None = None) -> float:
    """Largest difference of the poses over all rods: position over length, rotation entries.

    Args:
        one: a solution.
        other: another of the same scene.
        X: abscissae to compare, shape (k,); by default those that the tolerance binds.
    """
    distances = [0.0]
    for name, discrete_rod in one.model.discrete.rods.items():
        sections = watched(one.model, name) if X is None else X
        distances.append(
            _distance(one.pose(sections, name), other.pose(sections, name), discrete_rod.properties.length)
        )
    return max(distances)


def largest_turn(solution: Solution) -> float:
    """Largest angle through which an element of a rod turns from end to end, summed along it, rad."""
    return max(_element_turn(discrete_rod, solution) for discrete_rod in solution.model.discrete.rods.values())


def _distance(a: Pose, b: Pose, length: float) -> float:
    position = float(np.abs(a.position - b.position).max()) / length
    return max(position, float(np.abs(a.rotation - b.rotation).max()))


def _element_turn(discrete_rod: DiscreteRod, solution: Solution) -> float:
    curvature = solution.strain(discrete_rod.grid.nodes, discrete_rod.properties.name)[:, :3]
    turn = discrete_rod.grid.weights * np.linalg.norm(curvature, axis=1) * discrete_rod.properties.length
    return float(turn.reshape(discrete_rod.grid.elements, -1).sum(axis=1).max())


def _unloaded_turn(discrete_rod: DiscreteRod) -> float:
    curvature = discrete_rod.properties.intrinsic_strain(SAMPLES)[:, :3]
    return float(np.linalg.norm(curvature, axis=1).max()) * discrete_rod.properties.length


def _polish(model: Model, start: FloatArray, inputs: FloatArray) -> Solution | None:
    """Newton from a near start; None where it does not stay near, so that it may be another branch."""
    settings = ContinuationSettings().newton
    found = correct(model, inputs, start, settings)
    if found is None:
        return None
    return judge(model, inputs, found.x, found.outcome, found.iterations, 1.0, settings.tolerance)


def finer_grid(solution: Solution, nodes: int) -> int:
    """Intervals that should resolve a rod too bent for its grid; at most twice as many, for it may be another rod."""
    return ceil(nodes * min(2.0, 1.2 * float(solution.model.coarseness(solution.x, solution.inputs))))


def _next_rung(rung: int, lacking: int) -> int:
    """The lowest rung above that has the modes that lack; no more than three up, convergence may turn out faster."""
    wanted = LADDER[rung] + lacking
    above = next((r for r, modes in enumerate(LADDER) if modes >= wanted), len(LADDER))
    return min(max(above, rung + 1), rung + 3)


def prolong(solution: Solution, model: Model) -> FloatArray:
    """Unknowns of a finer model of the same scene: the coefficients that exist, zeros for the rest."""
    parts = []
    for name, discrete_rod in solution.model.discrete.rods.items():
        q = solution.x[solution.model.discrete.unknowns.strain(name)]
        fine = model.discrete.rods[name]
        for c, columns in discrete_rod.columns.items():
            coarse = q[columns].reshape(discrete_rod.grid.elements, -1)
            width = fine.at_nodes[c].shape[1] // fine.grid.elements
            padded = np.zeros((fine.grid.elements, width))
            padded[:, : coarse.shape[1]] = coarse
            parts.append(padded.ravel())
    multipliers = solution.x[solution.model.discrete.unknowns.count(BlockKind.STRAIN) :]
    return np.concatenate([*parts, multipliers])


def _unresolved(solution: Solution) -> Solution:
    return replace(solution, outcome=Outcome.UNRESOLVED, message=Outcome.UNRESOLVED.value, stable=None)
