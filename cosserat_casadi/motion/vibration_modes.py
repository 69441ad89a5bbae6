"""Vibration modes of a scene about its equilibrium, with the error of each.

A vibration mode and the equilibrium need different polynomials: modes per strain are raised, level by level, until all
requested frequencies agree with the level before.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import ceil

import numpy as np
import numpy.typing as npt

from cosserat_casadi import scene as scenes
from cosserat_casadi.accuracy.levels import nodes_for_turn
from cosserat_casadi.accuracy.refine import FINER_MODES, solve_rods
from cosserat_casadi.accuracy.scene_solver import TIGHT
from cosserat_casadi.equilibrium.answer_error import FRICTION_IN_MOTION, FRICTION_OF_CONTACT, SAFETY
from cosserat_casadi.equilibrium.contact.contact_state import given_inputs, without_contacts
from cosserat_casadi.equilibrium.contact.pressing_contacts import PressingContacts, marginal_contact, pressing_contacts
from cosserat_casadi.equilibrium.judge import correct, judge
from cosserat_casadi.equilibrium.metrics import largest_turn, prolong
from cosserat_casadi.equilibrium.solution import SECTIONS_APART, Solution
from cosserat_casadi.equilibrium.solve import solve
from cosserat_casadi.errors import Problem, SceneError
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model, build
from cosserat_casadi.model.discretise import discretise, with_more_fibres
from cosserat_casadi.model.required_modes import signal_modes
from cosserat_casadi.model.tube_checks import refuse_tubes
from cosserat_casadi.motion.eigenproblem import REAL, ComplexArray, eigenpairs, slowest_told
from cosserat_casadi.motion.mode_shapes import NumberArray, RodShape, end_of_cluster, normalised, rod_shape
from cosserat_casadi.motion.relaxing_rows import branch_rows, integrated
from cosserat_casadi.motion.small_motions import SmallMotions, quaternion_growth
from cosserat_casadi.numerics.continuation import ContinuationSettings
from cosserat_casadi.numerics.outcome import LabelledOutcome
from cosserat_casadi.numerics.progress import Progress, Report, not_told
from cosserat_casadi.result import Result
from cosserat_casadi.spelling import named

DEFAULT_COUNT = 8
"""Number of modes that are sought by default."""

SPARE_MODES = 4
"""Polynomials per strain on the first level, less the number of modes that are sought."""

LEVEL_FACTOR = 1.3
"""Factor on the number of polynomials from one level to the next."""

MOST_MODES = 48
"""Polynomials per strain above which no finer level is tried."""

SPARE_NODES = 4
"""Intervals beyond the number that polynomials and the rotation of a rod need: mass is an integral of squares."""

ROUNDING = 1e-13
"""Least error estimate, relative to an eigenvalue."""


WHILE_PRESSED = (
    "The modes hold while every contact presses and nothing else touches: larger motions lift off and strike."
)
"""Sentence on small motions of rods in exact contact."""

ABOUT_REST = "They are vibrations about rest at the scene's values, without the motion of {inputs} in [[motions]]."
"""Sentence on small motions of a scene whose inputs move: a rod with a rotating base has other frequencies."""


class ModesOutcome(LabelledOutcome):
    """Every way a search for modes can end; the value is the sentence."""

    RESOLVED = "Modes found: every frequency is known to the tolerance."
    UNRESOLVED = (
        "Modes of the discrete model were found, but not every frequency is known to the tolerance: "
        "ask for fewer, or allow a larger tolerance or more modes per strain."
    )
    NOT_ESTIMATED = "Modes of the discrete model: their distance from the modes of the rods is not estimated."
    NO_EQUILIBRIUM = "No modes: there is no equilibrium to vibrate about."
    MARGINAL_CONTACT = "No modes: a contact is closed without force, so that only one side of each vibration meets it."


@dataclass(frozen=True)
class Mode:
    """A small motion δx = Re(vector exp(λ t)).

    Attributes:
        eigenvalue: λ, 1/s; for a conjugate pair the one with positive imaginary part.
        vector: δx of all unknowns, shape (size,); zero for multipliers and tensions. The largest displacement over
            length, or rotation, of any section is 1.
        error_estimate: estimated error of λ, relative to |λ|; None if it was not estimated.
    """

    eigenvalue: complex
    vector: NumberArray
    error_estimate: float | None = None

    @property
    def angular_frequency(self) -> float:
        """|λ|, 1/s."""
        return abs(self.eigenvalue)

    @property
    def frequency(self) -> float:
        """|λ| / 2π, Hz."""
        return self.angular_frequency / (2 * np.pi)

    @property
    def damping_ratio(self) -> float:
        """−Re λ / |λ|; zero for a rigid motion."""
        # A zero without a sign: neither a rigid motion nor one without damping decays.
        if self.eigenvalue.real == 0.0:
            return 0.0
        return -self.eigenvalue.real / abs(self.eigenvalue)

    @property
    def oscillates(self) -> bool:
        """Whether the motion oscillates, and does not only grow or decay."""
        return self.eigenvalue.imag > 0.0

    @property
    def grows(self) -> bool:
        """Whether the motion grows by more than rounding."""
        return self.eigenvalue.real > REAL * abs(self.eigenvalue)

    @property
    def words(self) -> str:
        """Kind of the motion in one word, for tables."""
        if self.eigenvalue == 0.0:
            return "rigid or neutral"
        if self.oscillates:
            return "flutters" if self.grows else "swings"
        return "grows" if self.grows else "decays"


@dataclass(frozen=True, repr=False)
class Modes(Result):
    """Modes about an equilibrium.

    Attributes:
        solution: the equilibrium, on the model whose modes these are.
        outcome: outcome of the search.
        stability: sentences on the growth or decay of small motions; without an equilibrium, the reason.
        modes: ordered by |λ|, multiplicities repeated, conjugate pairs once; the creep of branches is not among them.
        spectrum: all eigenvalues of the model, including creep, ordered by |λ|, 1/s; the larger ones are not those of
            the rods.
        slowest: least |λ| that can be distinguished from zero, 1/s.
    """

    solution: Solution
    outcome: ModesOutcome
    stability: str
    modes: tuple[Mode, ...]
    spectrum: ComplexArray
    slowest: float = 0.0

    @property
    def message(self) -> str:
        """Sentence on the outcome of the search and the stability of small motions, for the user."""
        return f"{self.outcome.value} {self.stability}"

    @property
    def model(self) -> Model:
        """The model whose modes these are."""
        return self.solution.model

    @property
    def converged(self) -> bool:
        """Whether there are modes, to the tolerance if one was requested."""
        return self.outcome in (ModesOutcome.RESOLVED, ModesOutcome.NOT_ESTIMATED)

    @property
    def angular_frequencies(self) -> FloatArray:
        """|λ| of all modes, shape (p,), 1/s."""
        return np.array([mode.angular_frequency for mode in self.modes])

    @property
    def eigenvalues(self) -> ComplexArray:
        """λ of all modes, shape (p,), 1/s."""
        return np.array([mode.eigenvalue for mode in self.modes], dtype=complex)

    def shape(self, X: FloatArray, rod: str | None = None) -> RodShape:
        """Displacements and rotations of a rod's sections in all modes.

        Args:
            X: abscissae, shape (k,).
            rod: name of the rod; it may be left out if there is one rod.
        """
        name = self.model.rod_name(rod)
        vectors = np.stack([mode.vector for mode in self.modes], axis=1)
        return rod_shape(self.model, name, self.solution.x, self.solution.inputs, vectors, np.asarray(X, dtype=float))


def small_motions(
    model: Model,
    x: FloatArray,
    inputs: FloatArray,
    inputs_rate: FloatArray | None = None,
    inputs_acceleration: FloatArray | None = None,
    p: FloatArray | None = None,
    contacts: PressingContacts | None = None,
) -> SmallMotions:
    """Linearise the equations of motion about constant unknowns.

    With stress that relaxes, the equations have the unknowns of ``model.in_motion``.

    Args:
        model: the scene.
        x: the unknowns, shape (model.size,).
        inputs: stacked inputs.
        inputs_rate: rate of the inputs, for example of a steadily spinning base; zero by default.
        inputs_acceleration: acceleration of the inputs; zero by default.
        p: stacked parameters; None for a model without parameters.
        contacts: pressing contacts, whose forces are among the inputs.
    """
    x = model.with_flows(x)
    model = model.in_motion
    rest = np.zeros(model.size)
    held = np.zeros(model.inputs.size)
    rate = held if inputs_rate is None else inputs_rate
    acceleration = held if inputs_acceleration is None else inputs_acceleration
    parameters = [] if p is None else [p]
    arguments = [x, rest, rest, inputs, *parameters, rate, acceleration]
    matrices = [matrix.full() for matrix in model.dynamics_jacobian(*arguments)[:3]]
    held_gradients = quaternion_growth(model, x)
    if contacts is not None:
        # Flows, which relaxing stress has in motion, are behind the unknowns of the equilibrium.
        size = contacts.stiffness.shape[0]
        matrices[0][:size, :size] += contacts.stiffness
        held = np.pad(contacts.held, ((0, 0), (0, model.size - size)))
        held_gradients = np.vstack([held_gradients, held])
    unknowns = model.discrete.unknowns
    branches = branch_rows(model.discrete, *matrices[1:])
    stiffness, damping, mass = integrated(branches, matrices)
    return SmallMotions(
        stiffness,
        damping,
        mass,
        unknowns.units,
        unknowns.differential,
        held_gradients,
        tuple(branches),
    )


def modes_at(solution: Solution, count: int | None = None, *, report: Report | None = None) -> Modes:
    """Compute the modes of a model about one of its equilibria, without error estimates.

    Args:
        solution: the equilibrium.
        count: number of modes of lowest |λ|; None for all modes of the model.
        report: callback with the stage.

    Raises:
        SceneError: nothing that may move has mass.
    """
    if not solution.converged:
        return _without_modes(solution, ModesOutcome.NO_EQUILIBRIUM, solution.message)
    model = solution.model
    marginal = marginal_contact(solution)
    if marginal:
        return _without_modes(solution, ModesOutcome.MARGINAL_CONTACT, marginal)
    tell = report or not_told
    tell(f"equations of motion of {model.size} unknowns")
    motions = small_motions(model, solution.x, solution.inputs, contacts=pressing_contacts(solution))
    check_mass(motions)
    tell(f"eigenvalues of {model.size} unknowns")
    pairs = eigenpairs(
        motions.free_stiffness,
        motions.free_damping,
        motions.free_mass,
        conservative=model.has_potential(solution.inputs),
    )
    swinging, free = pairs.values, pairs.vectors
    if motions.branches:
        vibrates = ~motions.creeps(swinging, free)
        swinging, free = swinging[vibrates], free[:, vibrates]
    # Shapes of one eigenvalue are told apart together, also where the last of them is not asked for.
    end = end_of_cluster(swinging, count)
    values = swinging[:end]
    vectors = motions.displacement(free[:, :end])[: model.size]
    shapes = normalised(model, solution.x, solution.inputs, values, vectors)
    modes = [Mode(complex(value), shape) for value, shape in zip(values, shapes.T, strict=True)]
    # The larger half of a discretisation's eigenvalues are not those of the rods, whose oscillations they judge.
    believed = np.arange(len(pairs.values)) < ceil(len(pairs.values) / 2)
    slowest = slowest_told(motions.free_mass)
    stability = stability_sentences(pairs.values, believed, solution, slowest)
    apart = solution.sections_lie_apart
    return Modes(
        solution,
        ModesOutcome.UNRESOLVED if apart else ModesOutcome.NOT_ESTIMATED,
        f"{stability} Their error is not known; {SECTIONS_APART}" if apart else stability,
        tuple(modes[:count]),
        pairs.values,
        slowest,
    )


def modes_of(
    subject: scenes.Scene | Model | Solution,
    values: Mapping[str, npt.ArrayLike] | None = None,
    *,
    count: int | None = None,
    progress: Progress | None = None,
    report: Report | None = None,
) -> Modes:
    """Compute the vibration modes about an equilibrium.

    Each mode of a scene has an estimated error; if the scene fixes modes or nodes, they are used as they are, and only
    the errors are estimated. The modes of a model about one of its equilibria have no error estimates.

    Args:
        subject: a validated scene, or a model, which is solved; or an equilibrium.
        values: inputs by name; others keep the scene's values. Not for an equilibrium.
        count: number of modes of lowest |λ|; by default eight for a scene, and all modes for a model.
        progress: callback with the share of the present stage that is done.
        report: callback with the stage.

    Raises:
        ValueError: the count is not positive, or values are given with an equilibrium.
        SceneError: a value is refused, more modes are requested than there are unknowns, or nothing that may move has
            mass.
    """
    if isinstance(subject, Solution):
        if values is not None:
            raise ValueError("an equilibrium has its inputs already: leave the values out")
        return modes_at(subject, count, report=report)
    if isinstance(subject, Model):
        return modes_at(solve(subject, values, progress=progress), count, report=report)
    refuse_tubes(subject)
    scene = subject
    count = DEFAULT_COUNT if count is None else count
    if count < 1:
        raise ValueError(f"at least one mode must be asked for, got {count}")
    if not scene.accuracy.fixed:
        _check_count(scene, count)
    equilibrium = solve_rods(scene, values, progress=progress, report=report)
    if not equilibrium.converged:
        return _without_modes(equilibrium, ModesOutcome.NO_EQUILIBRIUM, equilibrium.message)
    if scene.accuracy.fixed:
        return _on_fixed(equilibrium, count, report)
    return _to_tolerance(equilibrium, count, report)


def _check_count(scene: scenes.Scene, count: int) -> None:
    """Refuse more modes than there are unknowns on the finest level that is tried.

    Raises:
        SceneError: too many modes are requested.
    """
    rods = sum(own.elements * sum(own.modes) for own in discretise(scene, MOST_MODES).values())
    # A rod's base, and a body, may move in six ways.
    most = rods + 6 * (len(scene.rods) + len(scene.bodies))
    if count > most:
        problem = f"{count} modes are more than the {most} unknowns of {MOST_MODES} polynomials per strain"
        raise SceneError(Problem("--count", problem, "ask for far fewer: about half of these can be resolved"))


def _on_fixed(equilibrium: Solution, count: int, report: Report | None) -> Modes:
    """Compute modes on the discretisation of an equilibrium, with errors by a finer one."""
    own = modes_at(equilibrium, count, report=report)
    witness = modes_at(_finer_equilibrium(equilibrium, FINER_MODES, report), count, report=report)
    # The finer modes are not exact either.
    return _judged(own, witness, SAFETY)


def _to_tolerance(equilibrium: Solution, count: int, report: Report | None) -> Modes:
    """Compute modes on the first level that agrees with the level before; on the last level if none does."""
    scene = equilibrium.model.scene
    # Half of the modes bend a rod in one plane, as a rule: a planar rod takes a level or two more.
    enough = min(ceil(count / 2) + SPARE_MODES, MOST_MODES)
    first = max(enough, signal_modes(scene), _most_modes(equilibrium))
    coarser = modes_at(_on_level(equilibrium, first, report), count, report=report)
    while coarser.converged:
        more = ceil((LEVEL_FACTOR - 1.0) * _most_modes(coarser.solution))
        finer = modes_at(_finer_equilibrium(coarser.solution, more, report), count, report=report)
        judged = _judged(finer, coarser)
        if judged.outcome is not ModesOutcome.UNRESOLVED or _most_modes(finer.solution) >= MOST_MODES:
            return judged
        coarser = finer
    return coarser


def _finer_equilibrium(coarser: Solution, more: int, report: Report | None) -> Solution:
    return _on_level(coarser, _most_modes(coarser) + more, report)


def _on_level(coarser: Solution, polynomials: int, report: Report | None) -> Solution:
    """Solve for the equilibrium of a coarser solution, with this number of polynomials for each strain and element."""
    scene = without_contacts(coarser.model.scene)
    nodes = nodes_for_turn(polynomials, largest_turn(coarser)) + SPARE_NODES
    transport = "magnus8" if scene.accuracy.tolerance < TIGHT else "magnus6"
    chosen = discretise(scene, polynomials, nodes, transport)
    # Finer sums of laws than the coarser solution's show the error of these.
    finer = {name: replace(own, fibres=coarser.model.discretisation[name].fibres) for name, own in chosen.items()}
    model = build(scene, with_more_fibres(finer))
    if report is not None:
        report(f"equilibrium of {model.size} unknowns, {nodes} intervals")
    inputs = given_inputs(coarser.model, coarser.inputs)
    values = model.inputs.unpack(inputs)
    newton = ContinuationSettings().newton
    if scene.touches_exactly:
        solution = solve(model, values, start=coarser, estimate_error=False)
    else:
        corrected = correct(model, inputs, prolong(coarser, model), newton)
        if corrected is None:
            return solve(model, values, estimate_error=False)
        x, ended = corrected.x, corrected.outcome
        solution = judge(model, inputs, x, ended, corrected.iterations, 1.0, newton.tolerance)
    # What is known of the coarser solution holds for the finer one all the more.
    return replace(
        solution,
        error_estimate=coarser.error_estimate,
        shape_error_estimate=coarser.shape_error_estimate,
    )


def _most_modes(solution: Solution) -> int:
    """Largest number of polynomials of a strain of any rod."""
    return max(max(d.modes, default=0) for d in solution.model.discretisation.values())


def _judged(modes: Modes, witness: Modes, safety: float = 1.0) -> Modes:
    """Estimate the errors of modes by those of another discretisation, times a safety factor."""
    if not witness.converged:
        return witness
    if not modes.converged:
        return modes
    errors = safety * _distances(modes.eigenvalues, witness.eigenvalues)
    estimated = tuple(
        replace(mode, error_estimate=float(error)) for mode, error in zip(modes.modes, errors, strict=True)
    )
    tolerance = modes.model.scene.accuracy.tolerance
    outcome = ModesOutcome.UNRESOLVED
    # Written so that an estimate which is not a number counts as too large.
    if np.all(errors <= tolerance):
        outcome = ModesOutcome.RESOLVED
    believed = _confirmed(modes.spectrum, witness.spectrum)
    stability = stability_sentences(modes.spectrum, believed, modes.solution, modes.slowest)
    return replace(modes, outcome=outcome, stability=stability, modes=estimated)


def _confirmed(values: ComplexArray, others: ComplexArray) -> npt.NDArray[np.bool_]:
    """Mask of eigenvalues that another discretisation also has, to within half of their growth."""
    gaps = np.abs(values[:, None] - others).min(axis=1, initial=np.inf)
    return np.asarray(gaps <= np.abs(values.real) / 2)


def _distances(values: ComplexArray, others: ComplexArray) -> FloatArray:
    """Distance of each eigenvalue from its counterpart among others, relative to its size; inf without one."""
    distances = np.full(len(values), np.inf)
    left = list(others)
    for index, value in enumerate(values):
        if not left:
            break
        # Of eigenvalues that are close to each other the nearest counterparts belong together.
        gaps = np.abs(np.array(left) - value)
        nearest = int(np.argmin(gaps))
        size = max(abs(value), abs(left[nearest]))
        distances[index] = 0.0 if size == 0.0 else gaps[nearest] / size
        del left[nearest]
    return np.asarray(distances + ROUNDING)


def check_mass(motions: SmallMotions) -> None:
    """Refuse a scene without modes.

    Raises:
        SceneError: nothing may move, or nothing that may move has mass.
    """
    if not motions.free_mass.size:
        fault = "nothing can move: supports, joints or contacts hold everything"
        raise SceneError(Problem("rods", fault, "leave something free, or take more modes"))
    if not np.any(motions.free_mass):
        fault = "nothing that can move has mass"
        remedy = "give materials a density, rods a linear_density, or bodies a mass"
        raise SceneError(Problem("rods", fault, remedy))


def _without_modes(solution: Solution, outcome: ModesOutcome, why: str) -> Modes:
    return Modes(solution, outcome, why, (), np.zeros(0, dtype=complex))


def stability_sentences(
    values: ComplexArray, believed: npt.NDArray[np.bool_], solution: Solution, slowest: float
) -> str:
    """Write sentences on the growth, oscillation or decay of small motions about an equilibrium.

    Args:
        values: all eigenvalues of the model.
        believed: whether each oscillating eigenvalue counts as a motion of the rods, not of the discretisation.
        solution: the equilibrium.
        slowest: least |λ| that can be distinguished from zero, 1/s.
    """
    growing = values.real > REAL * np.abs(values)
    swinging = values.imag > 0.0
    sentences = []
    unsettled = values[growing & ~swinging]
    if unsettled.size:
        count = _motions(unsettled.size, "grows", "grow")
        sentences.append(f"Statically unstable: {count} without swinging, at up to {unsettled.real.max():.6g} 1/s.")
    elif solution.stable is False and not np.any(values == 0.0):
        sentences.append("Statically unstable: massless parts leave the equilibrium at once.")
    fluttering = values[growing & swinging & believed]
    if fluttering.size:
        fastest = fluttering[np.argmax(fluttering.real)]
        count = _motions(fluttering.size, "grows", "grow")
        frequency = abs(fastest) / (2 * np.pi)
        sentences.append(
            f"Dynamically unstable (flutter): {count} while swinging, at {frequency:.6g} Hz by {fastest.real:.6g} 1/s."
        )
    neutral = int(np.sum(values == 0.0))
    if neutral:
        count = _motions(neutral, "meets", "meet")
        told = f"{count} no resistance: rigid, neutral, or slower than {slowest:.2g} 1/s, which counts as zero."
        sentences.append(told.capitalize())
    if not sentences:
        sentences.append(_settled(values))
    if solution.contacts and solution.model.scene.touches_exactly:
        sentences.append(WHILE_PRESSED)
    if solution.contacts and solution.model.scene.rubs_exactly:
        on_paths = solution.model.scene.rubs_along_exact_paths
        sentences.append((FRICTION_OF_CONTACT if on_paths else FRICTION_IN_MOTION).strip())
    moved = list(dict.fromkeys(motion.input for motion in solution.model.scene.motions))
    if moved:
        sentences.append(ABOUT_REST.format(inputs=named(moved)))
    return " ".join(sentences)


def _settled(values: ComplexArray) -> str:
    if np.all(values.real < 0.0):
        return "Stable: small motions die away."
    return "Stable: small motions stay small."


def _motions(count: int, singular: str, plural: str) -> str:
    if count == 1:
        return f"one motion {singular}"
    return f"{count} motions {plural}"
