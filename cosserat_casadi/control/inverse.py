"""The inverse problem: values of inputs for which the equilibrium meets the targets of the scene.

The unknowns of the rods and the inputs are sought together, the equilibrium being constraints ("lifted"), by an
interior-point method with exact derivatives. What the optimiser ends at is only a proposal: the equilibrium at the
inputs found is computed anew and judged like any other.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import casadi as ca
import numpy as np

from cosserat_casadi.control.goals import Gap, deviations, gaps, length_of
from cosserat_casadi.control.sought import Sought, scales, sought
from cosserat_casadi.equilibrium.solution import Solution
from cosserat_casadi.equilibrium.solve import check_potential, solve
from cosserat_casadi.errors import Problem, SceneError
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model

DAMPING = (1e-1, 1e-2, 1e-3, 1e-4, 1e-8)
"""Weights of the inputs' distance from where a round starts, the last one for all further rounds.

Strong damping at first keeps the rods on the branch that they start on.
"""

SETTLED = 1e-9
"""Change of the inputs from round to round, in their scales, below which they have settled."""

ROUNDS = 7
"""Most rounds."""

IPOPT = {
    "print_level": 0,
    "sb": "yes",
    "tol": 1e-10,
    "mu_init": 1e-4,
    "max_iter": 300,
    "bound_relax_factor": 0.0,
    "honor_original_bounds": "yes",
}
"""Options of the interior-point method; bounds are kept as they are written."""

NOT_STABLE = " No stable equilibrium was found that comes as near."


@dataclass(frozen=True)
class Inverse:
    """Inputs found for targets.

    Attributes:
        solution: equilibrium at the inputs found; its message says whether the targets are met.
        gaps: how far each target is missed, in the order of the scene.
        met: whether the equilibrium was found and every gap is within the scene's tolerance.
        rounds: runs of the optimiser.
    """

    solution: Solution
    gaps: tuple[Gap, ...]
    met: bool
    rounds: int

    @property
    def values(self) -> dict[str, FloatArray]:
        """The inputs found, by name."""
        return self.solution.model.inputs.unpack(self.solution.inputs)


def inverse(model: Model, *, start: Solution | None = None, stable: bool = False) -> Inverse:
    """Inputs for which a model's equilibrium meets the targets of its scene.

    Of several solutions it finds one near the scene's own inputs. Where targets cannot all be met, within the bounds
    or at all, the weighted squares of what is missed are least, as far as a local method can tell.

    Args:
        model: of a scene with targets, and with inputs that it lists or bounds.
        start: equilibrium of this model to start from; by default that at the scene's own inputs, brought into bounds.
        stable: whether a stable equilibrium is wanted: from an unstable one the rod is let settle and the search goes
            on from there, once. For loads that have a potential.

    Raises:
        SceneError: the scene has no targets, or names no inputs to find; or a stable equilibrium is wanted under loads
            without a potential.
    """
    if not model.scene.targets:
        raise SceneError(Problem("targets", "missing", "say with [[targets]] where a rod or body is to be"))
    wanted = sought(model)
    first = start or solve(model, model.inputs.unpack(wanted.clipped(model.pack())))
    if stable:
        check_potential(model, first.inputs)
    search = _Search(model, wanted, scales(model, wanted, first), wanted.clipped(first.inputs))
    found = search.run(first.x if np.all(np.isfinite(first.x)) else model.unloaded())
    if stable and found.solution.stable is False:
        found = _from_settled(search, found)
    return _told(found, stable)


def _from_settled(search: _Search, found: Inverse) -> Inverse:
    """The search once more, from where the rod settles to; what was found where that leads to nothing stable."""
    settled = solve(search.model, found.values, start=found.solution, stable=True)
    if not settled.stable:
        return found
    again = _Search(search.model, search.wanted, search.scale, settled.inputs).run(settled.x)
    return again if again.solution.stable else found


def _told(found: Inverse, stable: bool) -> Inverse:
    """The outcome with a sentence on the targets."""
    message = found.solution.message
    if found.solution.converged:
        missed = [gap for gap, met in zip(found.gaps, _met(found.solution, found.gaps), strict=True) if not met]
        message += " The targets are met." if not missed else _missed(missed)
        message += NOT_STABLE if stable and found.solution.stable is False else ""
    met = found.met and not (stable and found.solution.stable is False)
    return replace(found, solution=replace(found.solution, message=message), met=met)


def _missed(missed: list[Gap]) -> str:
    told = "; ".join(
        f"{gap.what} by {gap.position:.3g} m" + ("" if gap.angle is None else f" and {gap.angle:.3g} rad")
        for gap in missed
    )
    return f" The targets are not all met; the closest that was found misses {told}."


def _met(solution: Solution, missed: tuple[Gap, ...]) -> list[bool]:
    model = solution.model
    lengths = [length_of(model, target) for target in model.scene.targets]
    tolerance = model.scene.accuracy.tolerance
    return [gap.within(length, tolerance) for gap, length in zip(missed, lengths, strict=True)]


@dataclass(frozen=True)
class _Search:
    """The lifted problem of n sought inputs, in their scales from where they start.

    Attributes:
        model: the model.
        wanted: the inputs sought.
        scale: a change of each that matters, shape (n,).
        origin: stacked inputs to start from.
    """

    model: Model
    wanted: Sought
    scale: FloatArray
    origin: FloatArray

    def run(self, x: FloatArray) -> Inverse:
        """Rounds of the optimiser, each damped about where the one before ended, then our own solve.

        The damping picks one of many solutions and keeps the problem regular; moving its centre takes the error that
        it makes out of the result.
        """
        solver, size = self._solver(), self.model.size
        centre, rounds, moved = np.zeros(len(self.scale)), 0, np.inf
        while rounds < ROUNDS and moved > SETTLED:
            damping = DAMPING[min(rounds, len(DAMPING) - 1)]
            parameters = np.concatenate([centre, [damping]])
            found = solver(x0=np.concatenate([x, centre]), p=parameters, lbg=0.0, ubg=0.0, **self._bounds())
            ended = found["x"].full()[:, 0]
            rounds += 1
            if not np.all(np.isfinite(ended)):
                break
            moved = float(np.abs(ended[size:] - centre).max())
            x, centre = ended[:size], ended[size:]
        return self._judged(x, centre, rounds)

    def _judged(self, x: FloatArray, change: FloatArray, rounds: int) -> Inverse:
        inputs = self.origin.copy()
        inputs[self.wanted.places] += self.scale * change
        inputs = self.wanted.clipped(inputs)
        solution = solve(self.model, self.model.inputs.unpack(inputs), start=x)
        missed = gaps(solution)
        return Inverse(solution, missed, solution.converged and all(_met(solution, missed)), rounds)

    def _solver(self) -> ca.Function:
        count, places = len(self.scale), self.wanted.places
        x, change, parameters = (
            ca.MX.sym("x", self.model.size),
            ca.MX.sym("change", count),
            ca.MX.sym("centre_and_damping", count + 1),
        )
        into = ca.DM.triplet(places.tolist(), list(range(count)), ca.DM(self.scale), self.model.inputs.size, count)
        inputs = ca.DM(self.origin) + into @ change
        damped = parameters[-1] * ca.sumsqr(change - parameters[:-1])
        problem = {
            "x": ca.vertcat(x, change),
            "p": parameters,
            "f": (ca.sumsqr(deviations(self.model, x, inputs)) + damped) / 2,
            "g": self.model.residual(x, inputs),
        }
        options = {"print_time": False, "error_on_fail": False, "show_eval_warnings": False, "ipopt": IPOPT}
        return ca.nlpsol("inverse", "ipopt", problem, options)

    def _bounds(self) -> dict[str, FloatArray]:
        free = np.full(self.model.size, np.inf)
        start = self.origin[self.wanted.places]
        lower, upper = (self.wanted.lower - start) / self.scale, (self.wanted.upper - start) / self.scale
        return {"lbx": np.concatenate([-free, lower]), "ubx": np.concatenate([free, upper])}
