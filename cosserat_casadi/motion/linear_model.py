"""A scene linearised about an equilibrium, for control: ẋ = A x + B u, y = C x + D u of deviations from it.

The states are modal coordinates η of the undamped motion and their rates: with Φᵀ M Φ = I no mass matrix is inverted,
so that coordinates without mass do no harm. These follow the others at once, or relax if they have damping.

Inputs that move a base or the length of a cable move the rods with them: δx = Z z + X_c δu with any X_c that the
constraints allow. The inertia of that motion needs the rate and the acceleration of such an input, which become
further inputs.

Outputs are positions of tips, bodies and sections, and the conjugates of actuators.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TypeAlias

import casadi as ca
import numpy as np

from cosserat_casadi.equilibrium.contact.pressing_contacts import PressingContacts, marginal_contact, pressing_contacts
from cosserat_casadi.equilibrium.solution import Solution
from cosserat_casadi.errors import Problem, SceneError, SolveError, refuse
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.load_cases import column_indices
from cosserat_casadi.motion.eigenproblem import NOTHING, natural_shift, undamped_modes
from cosserat_casadi.motion.relaxing_rows import integrated
from cosserat_casadi.motion.small_motions import DEPENDENT, SmallMotions
from cosserat_casadi.motion.vibration_modes import check_mass, small_motions
from cosserat_casadi.result import Shown

AXES = ("x", "y", "z")

Place: TypeAlias = tuple[str, float]
"""A section of a rod: its name and the abscissa X."""

QUICK = 1e-10
"""Ratio of the lowest squared frequency to that of a mode, up to which the mode has no modal coordinate."""

UNHELD = 1e-7
"""Share of the displacement of a constraint by an input that may remain open, as rounding."""


@dataclass(frozen=True)
class StateSpace:
    """The output equation y = C x + D u, with states whose rates follow from A x + B u.

    Attributes:
        A: shape (n, n).
        B: shape (n, inputs).
        C: shape (outputs, n), units of the outputs.
        D: shape (outputs, inputs).
        states: names of the entries of x.
        inputs: names of the entries of u, deviations from the equilibrium in SI units; a name that ends in .rate or
            .acceleration is a derivative of another input.
        outputs: names of the entries of y, deviations from the equilibrium.
    """

    A: FloatArray
    B: FloatArray
    C: FloatArray
    D: FloatArray
    states: tuple[str, ...]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]


@dataclass(frozen=True)
class DescriptorModel(StateSpace):
    """The descriptor form E ẋ = A x + B u in the unknowns of the scene, their rates, multipliers and tensions.

    Attributes:
        E: shape (n, n), singular with constraints or coordinates without mass.
    """

    E: FloatArray


@dataclass(frozen=True, repr=False)
class LinearModel(Shown, StateSpace):
    """The state equation ẋ = A x + B u in modal coordinates, their rates, and relaxing coordinates.

    Attributes:
        modes: number of modal coordinates, the lowest frequencies first.
        descriptor: the model in the unknowns of the scene.
    """

    modes: int
    descriptor: DescriptorModel

    @property
    def eigenvalues(self) -> FloatArray:
        """Eigenvalues of A, by increasing size, shape (n,), 1/s."""
        values = np.linalg.eigvals(self.A)
        return np.asarray(values[np.argsort(np.abs(values), kind="stable")])

    def reduced(self, modes: int) -> LinearModel:
        """Return the model with the first modes alone; the static response of the other modes is kept in C, D and A.

        Eigenvalues do not change if the loads have a potential and the damping is zero or proportional to the
        stiffness; else they change the less the more modes are kept.

        Args:
            modes: number of modes that are kept, including rigid motions.

        Raises:
            ValueError: the number is not from 1 to the number of the modes.
        """
        if not 1 <= modes <= self.modes:
            raise ValueError(f"from 1 to {self.modes} modes can be kept, got {modes}")
        kept = [*range(modes), *range(self.modes, self.modes + modes)]
        left = np.setdiff1d(np.arange(len(self.A)), kept)
        # What is left out has no rate: its rows say where it is at every instant.
        inverse = np.linalg.inv(self.A[np.ix_(left, left)])
        by_states = -inverse @ self.A[np.ix_(left, kept)]
        by_inputs = -inverse @ self.B[left]
        to_rates = self.A[np.ix_(kept, left)]
        to_outputs = self.C[:, left]
        return LinearModel(
            A=self.A[np.ix_(kept, kept)] + to_rates @ by_states,
            B=self.B[kept] + to_rates @ by_inputs,
            C=self.C[:, kept] + to_outputs @ by_states,
            D=self.D + to_outputs @ by_inputs,
            states=tuple(self.states[index] for index in kept),
            inputs=self.inputs,
            outputs=self.outputs,
            modes=modes,
            descriptor=self.descriptor,
        )


def linearise(solution: Solution, outputs: Sequence[str | Place] | None = None) -> LinearModel:
    """Linearise a model about one of its equilibria, at rest.

    Args:
        solution: the equilibrium, with the model.
        outputs: positions of sections as ``("rod", 0.5)``; ``rod.tip.position``, ``body.position``, or
            the conjugate of an actuator, such as ``actuator.length``. By default the positions of all tips, and of the
            middle of rods whose tip is held.

    Raises:
        SolveError: the solution is no equilibrium, or a contact is neither pressed nor open.
        SceneError: an output is unknown, nothing that may move has mass, or constraints leave no room for an input.
    """
    if not solution.converged:
        raise SolveError(solution.message)
    marginal = marginal_contact(solution)
    if marginal:
        raise SolveError(f"No linear model: {marginal}")
    watched = outputs_of(solution, outputs)
    equations = _Equations.about(solution)
    check_mass(equations.motions)
    return _linear_model(equations, watched)


@dataclass(frozen=True)
class _Equations:
    """Equations of small motions with inputs.

    Attributes:
        model: the scene.
        motions: the equations without inputs.
        by_inputs: derivatives of the residual by inputs, by their rates and their accelerations, (size, inputs) each.
        contacts: contacts that press.
    """

    model: Model
    motions: SmallMotions
    by_inputs: tuple[FloatArray, FloatArray, FloatArray]
    contacts: PressingContacts

    @staticmethod
    def about(solution: Solution) -> _Equations:
        """The equations about an equilibrium at rest."""
        contacts = pressing_contacts(solution)
        motions = small_motions(solution.model, solution.x, solution.inputs, contacts=contacts)
        model = solution.model.in_motion
        symbols = [ca.MX.sym(name, model.inputs.size) for name in ("inputs", "rate", "acceleration")]
        rest = ca.DM.zeros(model.size, 1)
        residual = model.inverse_dynamics(solution.model.with_flows(solution.x), rest, rest, *symbols)
        derivatives = ca.Function("by_inputs", symbols, [ca.jacobian(residual, symbol) for symbol in symbols])
        held = np.zeros(model.inputs.size)
        matrices = [matrix.full() for matrix in derivatives(solution.inputs, held, held)]
        matrices[0][: solution.model.size] += contacts.stiffness_by_inputs
        by_value, by_rate, by_acceleration = integrated(motions.branches, matrices)
        return _Equations(model, motions, (by_value, by_rate, by_acceleration), contacts)

    @cached_property
    def carried(self) -> FloatArray:
        """X_c: scaled coordinates that follow the constraints which moving inputs displace, shape (n, inputs).

        Raises:
            SceneError: the constraints allow no such motion.
        """
        motions = self.motions
        gradients = motions.constraints
        opened = np.zeros((len(gradients), self.model.inputs.size))
        opened[: motions.holding.size] = self.by_inputs[0][motions.holding]
        opened[len(opened) - len(self.contacts.held) :] = self.contacts.held_by_inputs
        if not np.any(opened):
            return np.zeros((motions.moving.size, self.model.inputs.size))
        carried = -np.linalg.pinv(gradients, rcond=DEPENDENT) @ opened
        left = np.abs(gradients @ carried + opened).max(axis=0)
        stuck = left > UNHELD * np.abs(opened).max()
        if np.any(stuck):
            columns = [name for name, index in column_indices(self.model.inputs).items() if stuck[index]]
            fault = f"constraints do not let {', '.join(columns)} change to first order"
            remedy = "admit the strain that gives way, or do not make it an input"
            raise SceneError(Problem("inputs", fault, remedy))
        return np.asarray(carried)

    @cached_property
    def forces(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Forces of inputs, their rates and their accelerations on the free coordinates z, shape (k, inputs) each."""
        motions = self.motions
        moved = np.zeros((self.model.size, self.model.inputs.size))
        moved[motions.moving] = self.carried / motions.roots[:, None]
        matrices = (motions.stiffness, motions.damping, motions.mass)
        by_value, by_rate, by_acceleration = (
            -motions.projected(motions.moving_rows(direct + matrix @ moved))
            for direct, matrix in zip(self.by_inputs, matrices, strict=True)
        )
        return by_value, by_rate, by_acceleration

    @cached_property
    def used(self) -> tuple[list[int], list[int], list[int]]:
        """Indices of the inputs whose values, rates and accelerations are inputs of the model; all values are."""
        values = self.contacts.given.tolist()
        rates = np.flatnonzero(np.any(self.forces[1], axis=0) | np.any(self.by_inputs[1], axis=0))
        accelerations = np.flatnonzero(np.any(self.forces[2], axis=0) | np.any(self.by_inputs[2], axis=0))
        return values, rates.tolist(), accelerations.tolist()

    @cached_property
    def input_names(self) -> tuple[str, ...]:
        """Names of all entries of u."""
        columns = list(column_indices(self.model.inputs))
        names: list[str] = []
        for suffix, indices in zip(("", ".rate", ".acceleration"), self.used, strict=True):
            names += [columns[index] + suffix for index in indices]
        return tuple(names)

    def joined(self, matrices: Sequence[FloatArray]) -> FloatArray:
        """Join the columns of values, rates and accelerations that are inputs of the model."""
        parts = [matrix[:, indices] for matrix, indices in zip(matrices, self.used, strict=True)]
        return np.hstack(parts)


@dataclass(frozen=True)
class _Coordinates:
    """Modal coordinates η, coordinates ψ without mass but with damping, and static coordinates.

    Attributes:
        modal: Φ on the free coordinates, shape (k, r).
        damped: Ψ on the free coordinates, shape (k, d).
        static: basis of the static coordinates, shape (k, s).
    """

    modal: FloatArray
    damped: FloatArray
    static: FloatArray


def _coordinates(motions: SmallMotions) -> _Coordinates:
    symmetric = (motions.free_stiffness + motions.free_stiffness.T) / 2
    squares, modal = undamped_modes(symmetric, motions.free_mass)
    # What is so quick is known to few digits, and follows as what has no mass.
    modal = modal[:, np.abs(squares) * QUICK < natural_shift(motions.free_mass)]
    # What has no mass is orthogonal to M Φ.
    left, _, _ = np.linalg.svd(motions.free_mass @ modal)
    massless = left[:, modal.shape[1] :]
    damping = massless.T @ motions.free_damping @ massless
    sizes, directions = np.linalg.eigh((damping + damping.T) / 2)
    damped = sizes > NOTHING * np.abs(motions.free_damping).max(initial=0.0)
    return _Coordinates(modal, massless @ directions[:, damped], massless @ directions[:, ~damped])


def _linear_model(equations: _Equations, watched: Outputs) -> LinearModel:
    """The model in modal coordinates."""
    motions = equations.motions
    coordinates = _coordinates(motions)
    modal = coordinates.modal.shape[1]
    moved = np.hstack([coordinates.modal, coordinates.damped])
    stiffness = motions.free_stiffness
    forces = equations.joined(equations.forces)

    # What has neither mass nor damping follows the moved coordinates and the inputs: s = S_a a + S_u u.
    static = coordinates.static
    flexibility = np.linalg.pinv(static.T @ stiffness @ static, rcond=NOTHING)
    static_by_moved = -flexibility @ static.T @ stiffness @ moved
    static_by_inputs = flexibility @ static.T @ forces
    free_by_moved = moved + static @ static_by_moved
    free_by_inputs = static @ static_by_inputs
    reduced_stiffness = moved.T @ stiffness @ free_by_moved
    reduced_forces = moved.T @ (forces - stiffness @ free_by_inputs)
    reduced_damping = moved.T @ motions.free_damping @ moved

    A, B = _first_order(reduced_stiffness, reduced_damping, reduced_forces, modal)
    # δx = (Z z + X_c δu) / √units.
    to_unknowns = motions.displacement(free_by_moved)
    carried = np.zeros((equations.model.size, equations.model.inputs.size))
    carried[motions.moving] = equations.carried / motions.roots[:, None]
    nothing = np.zeros_like(watched.by_inputs)
    direct = equations.joined([watched.by_inputs + watched.by_x @ carried, nothing, nothing])
    by_positions = watched.by_x @ to_unknowns
    # Outputs see where coordinates are, not how fast: the rates stand between modal coordinates and what relaxes.
    C = np.hstack([by_positions[:, :modal], np.zeros((len(watched.names), modal)), by_positions[:, modal:]])
    D = direct + watched.by_x @ motions.displacement(free_by_inputs)
    numbers = range(1, modal + 1)
    states = [f"mode {number}" for number in numbers]
    states += [f"mode {number}.rate" for number in numbers]
    states += [f"relaxation {number + 1}" for number in range(coordinates.damped.shape[1])]
    return LinearModel(
        A=A,
        B=B,
        C=np.asarray(C),
        D=np.asarray(D),
        states=tuple(states),
        inputs=equations.input_names,
        outputs=watched.names,
        modes=modal,
        descriptor=_descriptor(equations, watched),
    )


def _first_order(
    stiffness: FloatArray, damping: FloatArray, forces: FloatArray, modal: int
) -> tuple[FloatArray, FloatArray]:
    """A and B of the states η, η̇, ψ, for ``modal`` coordinates with unit mass and others without mass."""
    count = len(stiffness)
    relaxing = count - modal
    # Rows of ψ: C_ψψ ψ̇ = f − C_ψη η̇ − K_ψ a.
    inverse = np.linalg.inv(damping[modal:, modal:])
    rate_by_rates = -inverse @ damping[modal:, :modal]
    rate_by_positions = -inverse @ stiffness[modal:]
    rate_by_inputs = inverse @ forces[modal:]
    coupling = damping[:modal, modal:]
    by_rates = -damping[:modal, :modal] - coupling @ rate_by_rates
    by_positions = -stiffness[:modal] - coupling @ rate_by_positions
    by_inputs = forces[:modal] - coupling @ rate_by_inputs

    A = np.zeros((modal + count, modal + count))
    A[:modal, modal : 2 * modal] = np.eye(modal)
    positions = [*range(modal), *range(2 * modal, 2 * modal + relaxing)]
    A[modal : 2 * modal, positions] = by_positions
    A[modal : 2 * modal, modal : 2 * modal] = by_rates
    A[2 * modal :, positions] = rate_by_positions
    A[2 * modal :, modal : 2 * modal] = rate_by_rates
    B = np.vstack([np.zeros((modal, forces.shape[1])), by_inputs, rate_by_inputs])
    return A, B


def _descriptor(equations: _Equations, watched: Outputs) -> DescriptorModel:
    """The model in the unknowns: coordinates, their rates, multipliers and tensions, then contact forces."""
    motions = equations.motions
    contacts = equations.contacts
    moving = motions.moving
    algebraic = motions.algebraic
    count = moving.size
    size = 2 * count + algebraic.size + len(contacts.held)
    positions = slice(0, count)
    rates = slice(count, 2 * count)
    held = slice(2 * count, 2 * count + algebraic.size)
    pressed = slice(held.stop, size)

    E = np.zeros((size, size))
    E[positions, positions] = np.eye(count)
    E[rates, rates] = motions.mass[np.ix_(moving, moving)]
    A = np.zeros((size, size))
    A[positions, rates] = np.eye(count)
    A[rates, positions] = -motions.stiffness[np.ix_(moving, moving)]
    A[rates, rates] = -motions.damping[np.ix_(moving, moving)]
    A[rates, held] = -motions.stiffness[np.ix_(moving, algebraic)]
    A[held, positions] = -motions.stiffness[np.ix_(algebraic, moving)]
    A[held, held] = -motions.stiffness[np.ix_(algebraic, algebraic)]
    gradients = motions.held[len(motions.held) - len(contacts.held) :, moving]
    A[rates, pressed] = (gradients / motions.roots**2).T
    A[pressed, positions] = gradients
    by_inputs = -equations.joined(equations.by_inputs)
    nothing = np.zeros_like(contacts.held_by_inputs)
    opened = equations.joined([contacts.held_by_inputs, nothing, nothing])
    B = np.vstack([np.zeros((count, by_inputs.shape[1])), by_inputs[moving], by_inputs[algebraic], opened])
    C = np.zeros((len(watched.names), size))
    C[:, positions] = watched.by_x[:, moving]
    C[:, held] = watched.by_x[:, algebraic]
    nothing = np.zeros_like(watched.by_inputs)
    D = equations.joined([watched.by_inputs, nothing, nothing])
    names = np.array(_unknown_names(equations.model))
    states = [*names[moving], *(f"{name}.rate" for name in names[moving]), *names[algebraic]]
    states += [f"contact {number}" for number in range(1, len(contacts.held) + 1)]
    return DescriptorModel(A, B, C, D, tuple(states), equations.input_names, watched.names, E)


def _unknown_names(model: Model) -> list[str]:
    """Names of the entries of x, such as ``rod.strain[2]``."""
    names = []
    for block in model.discrete.unknowns.blocks:
        names += [f"{block.owner}.{block.kind.value}[{index}]" for index in range(block.size)]
    return names


@dataclass(frozen=True)
class Outputs:
    """Outputs as linear functions of unknowns and inputs.

    Attributes:
        names: names of the outputs.
        by_x: derivatives with respect to the unknowns of the motion, shape (outputs, size).
        by_inputs: derivatives with respect to the inputs, shape (outputs, inputs).
    """

    names: tuple[str, ...]
    by_x: FloatArray
    by_inputs: FloatArray


def outputs_of(solution: Solution, wanted: Sequence[str | Place] | None) -> Outputs:
    """Linearise the wanted outputs.

    Raises:
        SceneError: names that are no outputs, all of them.
    """
    model = solution.model
    x = ca.MX.sym("x", model.size)
    inputs = ca.MX.sym("inputs", model.inputs.size)
    known = _known_outputs(model, x, inputs)
    chosen = _default_outputs(model) if wanted is None else list(wanted)
    problems: list[Problem] = []
    values = []
    names: list[str] = []
    for output in chosen:
        if isinstance(output, str) and output in known:
            name = output
            value = known[name]
        elif not isinstance(output, str) and output[0] in model.shape and 0.0 <= output[1] <= 1.0:
            rod, X = output
            name = f"{rod}.position({X:g})"
            value = model.shape[rod](x, inputs, X)[0]
        else:
            remedy = f"its outputs are sections (rod, X) with X in [0, 1], and {', '.join(known)}"
            problems.append(Problem("outputs", f"{output!r} is not an output of this scene", remedy))
            continue
        values.append(value)
        names += [name] if value.shape[0] == 1 else [f"{name}.{axis}" for axis in AXES]
    refuse(problems)
    stacked = ca.vertcat(*values)
    derivatives = ca.Function("outputs", [x, inputs], [ca.jacobian(stacked, x), ca.jacobian(stacked, inputs)])
    by_x, by_inputs = derivatives(solution.x, solution.inputs)
    # Flows are behind the unknowns that sections see.
    unseen = np.zeros((len(names), model.in_motion.size - model.size))
    return Outputs(tuple(names), np.hstack([by_x.full(), unseen]), by_inputs.full())


def _default_outputs(model: Model) -> list[str | Place]:
    """Tips, and middles of rods whose tip a support holds."""
    held = {support.rod for support in model.scene.supports}
    chosen: list[str | Place] = []
    for rod in model.discrete.rods:
        if rod in held:
            chosen.append((rod, 0.5))
        else:
            chosen.append(f"{rod}.tip.position")
    return chosen


def _known_outputs(model: Model, x: ca.MX, inputs: ca.MX) -> dict[str, ca.MX]:
    """All quantities that may be outputs, by name."""
    known = {}
    for rod in model.discrete.rods:
        known[f"{rod}.tip.position"] = model.tip[rod](x, inputs)[0]
    for body in model.body:
        known[f"{body}.position"] = model.body[body](x, inputs)[0]
    for actuator, function in model.actuator.items():
        known[f"{actuator}.{function.name_out(1)}"] = function(x, inputs)[1]
    return known
