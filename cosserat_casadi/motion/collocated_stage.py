"""One stage of an optimal-control problem in motion: the equations of a collocation step, which the optimiser solves.

The optimiser holds the equations of motion at the instants at which the step collocates. Its variables are, of each
stage, the state, and for each of these instants the accelerations and the algebraic entries. With them the next state
is linear, by the same tables as in :mod:`cosserat_casadi.numerics.step`: a solution of the optimiser is, to the
tolerance of its equations, a motion of the simulator with steps of that size.

Time is measured in stages: with h the duration of a stage, velocities are h dx/dt and accelerations h² d²x/dt². All
variables then are changes of x within a stage, and the tables have entries of order one.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import casadi as ca
import numpy as np
import numpy.typing as npt

from cosserat_casadi.errors import Problem, refuse
from cosserat_casadi.maths.typing import FloatArray, Matrix
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.function_table import PARAMETERS
from cosserat_casadi.model.unknowns import BlockKind
from cosserat_casadi.motion.constraint_projection import Closing
from cosserat_casadi.motion.contact_checks import unfit_rods
from cosserat_casadi.motion.motion_checks import immovable
from cosserat_casadi.motion.section_pairs import SECTIONS, TouchingPairs
from cosserat_casadi.motion.small_motions import quaternion_growth
from cosserat_casadi.numerics.collocation import STAGES, Collocation, radau
from cosserat_casadi.numerics.neutral import kept_by

MECHANICAL = (BlockKind.STRAIN, BlockKind.POSE, BlockKind.COORDINATE)
"""Unknowns whose rates are velocities of rods, bodies and joints."""

DEPENDENT = 1e-9
"""Singular value of the constraints, over the largest one, below which a constraint counts as redundant."""


@dataclass(frozen=True)
class Instants:
    """Coordinates of a model at the instants of a stage, each of shape (size,) for each instant, in SI units."""

    x: list[Matrix]
    v: list[Matrix]
    a: list[Matrix]


@dataclass(frozen=True)
class StageEquations:
    """The equations of motion at all instants of a stage.

    Arguments beyond the third are passed by name: rates and parameters of one size could otherwise be exchanged
    unnoticed.

    Attributes:
        function: (state, unknowns, inputs, inputs_rate) ↦ dimensionless residual; with parameters
            (state, unknowns, inputs, p, inputs_rate) ↦ dimensionless residual.
    """

    function: ca.Function

    def __call__(
        self, state: Matrix, unknowns: Matrix, inputs: Matrix, *, inputs_rate: Matrix, p: Matrix | None = None
    ) -> Matrix:
        """Evaluate the dimensionless residual at all instants, shape (unknowns_size,); it is zero along a motion.

        Args:
            state: at the beginning of the stage, shape (state_size,).
            unknowns: unknowns of the stage, shape (unknowns_size,).
            inputs: stacked inputs at the beginning of the stage.
            inputs_rate: rates of the inputs within the stage, units per second.
            p: stacked parameters, if the stage takes them.

        Raises:
            ValueError: parameters are given to a stage that takes none, or are missing.
        """
        parameters = _asked_for(PARAMETERS in self.function.name_in(), p)
        residual: Matrix = self.function(state, unknowns, inputs, *parameters, inputs_rate)
        return residual


def _asked_for(takes_parameters: bool, p: Matrix | FloatArray | None) -> list[Matrix | FloatArray]:
    """Return the parameters as a list of arguments; the list is empty for a stage that takes none.

    Raises:
        ValueError: they are given to a stage that takes none, or are missing.
    """
    if takes_parameters and p is None:
        raise ValueError("this stage takes parameters: give them as p")
    if not takes_parameters and p is not None:
        raise ValueError("this stage takes no parameters: leave p out, or make it with parameters=True")
    return [] if p is None else [p]


@dataclass(frozen=True)
class MotionStage:
    """A model over one stage.

    Its *state* consists of the differential unknowns and their changes per stage, (x, h v), dimensionless. Its
    *unknowns* are, for each instant in turn, a vector in the order of x: h² a for differential entries, the value
    for algebraic ones; in exact contact the forces of :attr:`pairs` follow. Inputs change linearly within the
    stage. If the model has parameters, they are an argument p after the inputs; in exact contact the smoothing is
    the last entry of p.

    Attributes:
        model: the model.
        duration: h, s.
        method: the collocation method.
        pairs: forces and gaps of sections and bodies that may touch exactly; None without exact contact.
    """

    model: Model
    duration: float
    method: Collocation
    pairs: TouchingPairs | None = None

    @property
    def differential(self) -> npt.NDArray[np.bool_]:
        """Mask of the differential entries of x, which have accelerations, shape (model.size,)."""
        return self.model.discrete.unknowns.differential

    @property
    def state_size(self) -> int:
        """Number of entries of a state."""
        return 2 * int(np.count_nonzero(self.differential))

    @property
    def unknowns_size(self) -> int:
        """Number of unknowns of a stage, and of its equations."""
        return self.method.stages * len(self.accelerated)

    @property
    def dynamics(self) -> Model | TouchingPairs:
        """Provider of the equations of motion at an instant and their derivatives: :attr:`pairs`, or else the model."""
        return self.model if self.pairs is None else self.pairs

    @property
    def _forces(self) -> int:
        return 0 if self.pairs is None else self.pairs.count

    @property
    def accelerated(self) -> npt.NDArray[np.bool_]:
        """Mask of the unknowns of an instant that are accelerations, shape (unknowns_size / instants,)."""
        return np.pad(self.differential, (0, self._forces))

    def state(self, x: FloatArray, v: FloatArray | None = None) -> FloatArray:
        """State of a motion at one time, shape (state_size,).

        Args:
            x: unknowns of the model, shape (model.size,).
            v: their rates, 1/s; at rest by default.
        """
        rates = np.zeros(self.model.size) if v is None else v
        return np.concatenate([x[self.differential], self.duration * rates[self.differential]])

    def still(self, x: FloatArray) -> FloatArray:
        """Unknowns of a stage without accelerations, as an initial guess, shape (unknowns_size,).

        Args:
            x: unknowns of the model, from which the algebraic values are taken, shape (model.size,).
        """
        still = np.where(self.differential, 0.0, x)
        return np.tile(np.pad(still, (0, self._forces)), self.method.stages)

    def x(self, state: Matrix) -> Matrix:
        """Unknowns of the model in a state, shape (model.size,); zero for the algebraic ones, which no pose reads."""
        return differential_places(self.model) @ state[: self.state_size // 2]

    def v(self, state: Matrix) -> Matrix:
        """Rates of the unknowns of the model in a state, 1/s, shape (model.size,); zero for the algebraic ones."""
        return differential_places(self.model) @ state[self.state_size // 2 :] / self.duration

    def independent_rates(
        self, state: Matrix, x: FloatArray, inputs: FloatArray, p: FloatArray | None = None
    ) -> Matrix:
        """Rates in the directions that constraints leave free, 1/s; they are zero if and only if the rods stand still.

        To ask that all rates are zero would repeat the rates of constraints that the equations of a stage hold already,
        and optimisers fail on redundant equations. Flows of stress that relaxes are not included.

        Args:
            state: shape (state_size,).
            x: unknowns near the state's, at which constraints are linearised, shape (model.size,).
            inputs: stacked inputs there.
            p: stacked parameters there, if the stage takes them.

        Raises:
            ValueError: parameters are given to a stage that takes none, or are missing.
        """
        mechanical = self.model.discrete.unknowns.of_kind(*MECHANICAL)
        moving = np.concatenate([np.arange(len(x))[span] for _, span in mechanical])
        jacobian, _ = self.model.jacobian(x, inputs, *_asked_for(self.model.parameters.size > 0, p))
        held_rows = np.vstack([jacobian.full()[Closing(self.model).rows], quaternion_growth(self.model, x)])
        return ca.DM(kept_by(held_rows[:, moving], DEPENDENT)).T @ self.v(state)[moving.tolist()]

    @cached_property
    def transition(self) -> ca.DM:
        """Derivative of the next state with respect to the state, sparse, shape (state_size, state_size)."""
        one = ca.DM.eye(self.state_size // 2)
        return ca.blockcat([[one, one], [ca.DM(*one.shape), one]])

    @cached_property
    def drive(self) -> ca.DM:
        """Derivative of the next state with respect to the stage's unknowns, sparse, (state_size, unknowns_size)."""
        positions = [weight * self.places.T for weight in self.method.position_weights.tolist()]
        velocities = [weight * self.places.T for weight in self.method.weights.tolist()]
        matrix: ca.DM = ca.vertcat(ca.horzcat(*positions), ca.horzcat(*velocities))
        return matrix

    @cached_property
    def next_state(self) -> ca.Function:
        """The linear function (state, unknowns) ↦ next state."""
        state = ca.MX.sym("state", self.state_size)
        unknowns = ca.MX.sym("unknowns", self.unknowns_size)
        following = self.transition @ state + self.drive @ unknowns
        return ca.Function("next_state", [state, unknowns], [following], ["state", "unknowns"], ["next_state"])

    @cached_property
    def equations(self) -> StageEquations:
        """The equations of motion at all instants: (state, unknowns, inputs, inputs_rate=…, p=…) ↦ residual."""
        return StageEquations(self.equations_by(self.dynamics.inverse_dynamics, "equations"))

    def equations_by(self, inverse_dynamics: ca.Function, name: str) -> ca.Function:
        """The function of :attr:`equations`, composed of the equations of motion at each instant.

        Args:
            inverse_dynamics: equations of motion at an instant, with the signature of those of :attr:`dynamics`.
            name: name of the function.
        """
        arguments = self.symbols
        state, unknowns, inputs, *p, rate = arguments
        moving = self.instants(state, unknowns)
        rows = []
        for i in range(self.method.stages):
            now = self.inputs_at(i, inputs, rate)
            still = ca.DM(self.model.inputs.size, 1)
            rows.append(inverse_dynamics(moving.x[i], moving.v[i], moving.a[i], now, *p, rate, still))
        return ca.Function(name, arguments, [ca.vertcat(*rows)], list(self.sizes), ["residual"])

    @property
    def sizes(self) -> dict[str, int]:
        """Number of entries of each argument of the equations, by name."""
        parameters = self.model.parameters.size + (self.pairs is not None)
        return {
            "state": self.state_size,
            "unknowns": self.unknowns_size,
            "inputs": self.model.inputs.size,
            **({PARAMETERS: parameters} if parameters else {}),
            "inputs_rate": self.model.inputs.size,
        }

    @property
    def symbols(self) -> list[ca.MX]:
        """New symbols for the arguments of the equations."""
        return [ca.MX.sym(word, size) for word, size in self.sizes.items()]

    def inputs_at(self, i: int, inputs: Matrix, rate: Matrix) -> Matrix:
        """Inputs at the i-th instant."""
        return inputs + float(self.method.nodes[i]) * self.duration * rate

    def instants(self, state: Matrix, unknowns: Matrix) -> Instants:
        """Unknowns of :attr:`dynamics`, their rates and accelerations at all instants.

        Args:
            state: shape (state_size,).
            unknowns: unknowns of the stage, shape (unknowns_size,).
        """
        half = self.state_size // 2
        start = self.places @ state[:half]
        travel = self.places @ state[half:]
        size = len(self.accelerated)
        accelerated = ca.DM(self.accelerated.astype(float))
        own = [unknowns[j * size : (j + 1) * size] for j in range(self.method.stages)]
        accelerations = [accelerated * each for each in own]
        positions = []
        velocities = []
        for i in range(self.method.stages):
            x = start + float(self.method.nodes[i]) * travel + (1.0 - accelerated) * own[i]
            v = travel
            for j in range(self.method.stages):
                x += float(self.method.matrix_squared[i, j]) * accelerations[j]
                v += float(self.method.matrix[i, j]) * accelerations[j]
            positions.append(x)
            velocities.append(v / self.duration)
        return Instants(positions, velocities, [each / self.duration**2 for each in accelerations])

    @cached_property
    def places(self) -> ca.DM:
        """Matrix that scatters differential entries into x of :attr:`dynamics`, sparse, state_size / 2 columns."""
        return ca.vertcat(differential_places(self.model), ca.DM(self._forces, self.state_size // 2))


def differential_places(model: Model) -> ca.DM:
    """Matrix that scatters the differential entries into x, sparse, shape (model.size, number of such entries)."""
    return _places(model.discrete.unknowns.differential)


def algebraic_places(model: Model) -> ca.DM:
    """Matrix that scatters the algebraic entries into x, sparse, shape (model.size, number of such entries)."""
    return _places(~model.discrete.unknowns.differential)


def _places(chosen: npt.NDArray[np.bool_]) -> ca.DM:
    rows = np.flatnonzero(chosen).tolist()
    pattern = ca.Sparsity.triplet(len(chosen), len(rows), rows, list(range(len(rows))))
    return ca.DM(pattern, 1.0)


def motion_stage(
    model: Model,
    duration: float,
    method: Collocation | None = None,
    *,
    parameters: bool = False,
    sections: int = SECTIONS,
) -> MotionStage:
    """One stage of an optimal-control problem in which a model moves.

    Args:
        model: of a scene whose rods have mass; build it with ``moving=True`` where bodies may turn freely. Parameters
            have the values of the scene, or of ``model.at(…)``, unless they are asked for.
        duration: duration of the stage, s.
        method: by default the simulator's, Radau IIA with three stages, ``radau(3)``; in exact contact
            ``radau(1)``, Euler's implicit method.
        parameters: whether the parameters of the scene, if it names some, are an argument of the equations.
        sections: stretches of a rod, at whose ends it may touch an obstacle without a width.

    Raises:
        SceneError: a rod has no mass, the duration is not positive, the method does not suit the constraints, or
            exact contact, or rods that touch rods exactly are too thin or hang together.
    """
    exact = model.scene.touches_exactly
    chosen = method or radau(1 if exact else STAGES)
    problems = immovable(model)
    if not 0.0 < duration < np.inf:
        problems.append(Problem("duration", f"{duration} s is no positive time", "give the length of a stage"))
    if not chosen.stiffly_accurate and not np.all(model.discrete.unknowns.differential):
        what = f"{chosen.name} does not converge for supports, joints, carried rods and cables of given length"
        problems.append(Problem("method", what, "take Radau IIA, radau(2)"))
    if exact and not (chosen.stages == 1 and chosen.stiffly_accurate):
        what = f"{chosen.name} throws rods and bodies back that meet an obstacle without restitution"
        problems.append(Problem("method", what, "take radau(1), or give each obstacle a width, m"))
    problems += unfit_rods(model)
    if sections < 1:
        problems.append(Problem("sections", f"must be 1 or more, got {sections}", f"take {SECTIONS}"))
    refuse(problems)
    own = model if parameters else model.at()
    return MotionStage(own, duration, chosen, TouchingPairs(own, sections, duration) if exact else None)
