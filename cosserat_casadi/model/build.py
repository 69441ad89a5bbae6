"""The model of a scene: named CasADi functions, ready to solve, export or embed."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Self

import casadi as ca
import numpy as np
import numpy.typing as npt

from cosserat_casadi import scene as scenes
from cosserat_casadi.errors import Problem, SceneError, refuse
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model import operations
from cosserat_casadi.model.constraint_rank import check_constraints
from cosserat_casadi.model.discrete_scene import DiscreteScene, discrete_scene, with_numbers, with_parameters
from cosserat_casadi.model.discretise import discretise
from cosserat_casadi.model.element_ends import check_discretisation
from cosserat_casadi.model.inputs import InputLayout, input_layout
from cosserat_casadi.model.load_assembly import check_loads
from cosserat_casadi.model.load_potential import loads_have_potential
from cosserat_casadi.model.model_functions import ModelFunctions
from cosserat_casadi.model.motion_functions import MotionFunctions
from cosserat_casadi.model.obstacle_checks import check_obstacles
from cosserat_casadi.model.parameters import ParameterLayout, WithParameters
from cosserat_casadi.model.scene_actuators import actuators_have_potential
from cosserat_casadi.model.scene_constraints import check_directions, decisive_axes
from cosserat_casadi.model.system import Arguments, ratio_of
from cosserat_casadi.model.tube_checks import refuse_tubes
from cosserat_casadi.result import Shown
from cosserat_casadi.rod.discretisation import Discretisation


@dataclass(frozen=True, repr=False)
class Model(ModelFunctions, MotionFunctions, WithParameters, Shown):
    """A scene as functions of its unknowns ``x`` and its stacked ``inputs``.

    ``x`` holds the strain coordinates of every rod, in the order of the scene, then the multipliers of supports and
    joints, then the displacements of bodies and of the bases of carried rods; all are dimensionless.
    Every function is exact for the discrete model and can be differentiated again.

    Attributes:
        discrete: the scene with its constant matrices.
    """

    discrete: DiscreteScene

    def __reduce__(self) -> tuple[type[Self], tuple[DiscreteScene]]:
        """Pickle and copy rebuild the model from its scene; each function is written again when it is first used."""
        return type(self), (self.discrete,)

    @property
    def scene(self) -> scenes.Scene:
        """The scene of this model; its parameters have the values of its file, or the values set by :meth:`at`."""
        return self.discrete.nominal.scene if self.parameters.size else self.discrete.scene

    @property
    def parameters(self) -> ParameterLayout:
        """Names, order and default values of the parameters."""
        return self.discrete.parameters

    def unjudged(self, values: Mapping[str, npt.ArrayLike] | None) -> Model:
        """The model with constants for its parameters; its loads, obstacles and pairs of rods are not checked.

        Between two sets of parameters the unloaded rods may penetrate each other.
        """
        nominal = self.discrete.nominal
        return Model(with_numbers(nominal, self.parameters.set_in(nominal.scene, values)))

    def _bound(self, values: Mapping[str, npt.ArrayLike] | None) -> Model:
        bound = self.unjudged(values)
        nominal, discrete = self.discrete.nominal, bound.discrete
        check_loads(discrete)
        check_directions(nominal.constraints, discrete.own_unloaded)
        if discrete.scene.obstacles:
            check_obstacles(discrete)
        if discrete.pairs:
            check_pairs(self, values)
        return bound

    def changed(self, change: Callable[[scenes.Scene], scenes.Scene]) -> Model:
        """The model, without parameters, of a scene with other constraints, on the same modes and nodes.

        Args:
            change: the scene ↦ the other scene, of the same rods.
        """
        bound = self.at()
        nominal = build(change(bound.discrete.nominal.scene).baked(), self.discretisation)
        if bound.discrete.scaling is None:
            return nominal
        return Model(with_numbers(nominal.discrete, change(bound.scene)))

    @cached_property
    def in_motion(self) -> Model:
        """The model with flows of relaxing stress behind its unknowns and margins of contact, else itself."""
        relaxes = any(rod.properties.branches for rod in self.discrete.rods.values())
        if self.discrete.moving or not (relaxes or self.discrete.may_lie_apart):
            return self
        return Model(self.discrete.in_motion)

    @cached_property
    def with_memory(self) -> Model:
        """The model with inputs ``history``, by which friction remembers the last point of a path."""
        return self if self.inputs.memory is not None else Model(self.discrete.with_memory)

    @property
    def rubs_on_paths(self) -> bool:
        """Whether friction acts along a path: between rods and obstacles or rods and rods, not on bodies or disks."""
        if self.scene.touches_exactly:
            return self.scene.rubs_along_exact_paths
        return self.scene.rubs and self.with_memory.inputs.memory is not None

    def with_flows(self, x: FloatArray) -> FloatArray:
        """Unknowns of :attr:`in_motion` at rest: unknowns of this model, then flows, shape (in_motion.size,)."""
        return np.concatenate([x, np.zeros(self.in_motion.size - self.size)])

    @cached_property
    def richer(self) -> Model:
        """The model with modes and intervals added, on which the error of an answer shows (docs/theory.md, 10)."""
        return Model(self.discrete.richer.discrete)

    @property
    def inputs(self) -> InputLayout:
        """Names, order and default values of the inputs."""
        return self.discrete.layout

    @property
    def size(self) -> int:
        """Number of unknowns."""
        return self.discrete.size

    @property
    def lengths(self) -> dict[str, float]:
        """Length of each rod in the scene, m."""
        return {rod.name: rod.length for rod in self.scene.rods}

    @property
    def parametric_scene(self) -> scenes.Scene:
        """The scene with entries of the symbol p for its parameters."""
        return self.discrete.scene

    @property
    def shape_unknowns(self) -> npt.NDArray[np.bool_]:
        """Which unknowns belong to a shape, shape (size,): strains and poses, no forces."""
        return self.discrete.unknowns.differential

    @property
    def typical_sizes(self) -> tuple[float, float]:
        """Length of the longest rod, m, and energy of the stiffest rod bent by about a radian, N m."""
        rods = self.discrete.nominal.rods.values()
        return max(rod.properties.length for rod in rods), max(rod.energy_unit for rod in rods)

    @property
    def hessian_is_cheap(self) -> bool:
        """True: an optimiser is faster with exact second derivatives of this model."""
        return True

    @property
    def step_weights(self) -> FloatArray:
        """How much each unknown counts in the length of a step, shape (size,): strains and poses by 1, forces less."""
        return self.discrete.unknowns.step_weights

    @property
    def is_assembly(self) -> bool:
        """Whether joints or frames tie rods together, so that the Jacobian is sparse."""
        return self.discrete.is_assembly

    @property
    def discretisation(self) -> dict[str, Discretisation]:
        """Modes, nodes and element ends of every rod."""
        return {name: discrete_rod.discretisation for name, discrete_rod in self.discrete.rods.items()}

    @property
    def resolution(self) -> dict[str, Any]:
        """Modes, nodes, element ends and integrator of every rod, as data."""
        return {name: d.plain() for name, d in self.discretisation.items()}

    @property
    def resolution_words(self) -> list[str]:
        """Modes, intervals and elements of every rod in words; rods with equal numbers share a sentence."""
        names: dict[str, list[str]] = {}
        for name, d in self.discretisation.items():
            elements = f" in {d.elements} elements" if d.elements > 1 else ""
            sums = f", layers summed at {d.sections} sections an element" if d.sections else ""
            names.setdefault(f"modes {list(d.modes)}, {d.nodes} intervals{elements}{sums}", []).append(name)
        return [f"{', '.join(alike)}: {words}" for words, alike in names.items()]

    def element_ends(self, rod: str) -> tuple[float, ...]:
        """Abscissae X at which the elements of a rod end, base to tip, for the parameters of this model."""
        return self.at().discrete.rods[rod].grid.known_places

    def operations(self, function: ca.Function) -> int:
        """Scalar operations of one of the model's functions, after expansion and sharing of common terms."""
        return operations.operations(function)

    def rod_name(self, rod: str | None) -> str:
        """A rod's name; None stands for the only one.

        Raises:
            KeyError: there is no such rod, or there are several to choose from.
        """
        names = list(self.discrete.rods)
        if rod is None and len(names) == 1:
            return names[0]
        if rod not in names:
            raise KeyError(f"{rod!r} is not a rod of this scene; its rods are {', '.join(names)}")
        return rod

    def length(self, rod: str, inputs: FloatArray) -> float:
        """Length of a rod for these inputs, m."""
        return self.discrete.rods[rod].length * self.length_ratio(rod, inputs)

    def body_length(self, body: str, inputs: FloatArray) -> float:
        """Length of the longest rod that holds a body, for these inputs, m."""
        return max(self.length(rod, inputs) for rod in self.discrete.unloaded.rods_of(body))

    def length_ratio(self, rod: str, inputs: FloatArray) -> float:
        """Length of a rod for these inputs, relative to its length in the scene."""
        discrete = self.at().discrete
        ratio = ratio_of(discrete, rod, Arguments(ca.DM(0, 1), ca.DM(inputs)))
        return 1.0 if ratio is None else float(ca.evalf(ca.MX(ratio)))

    def has_potential(self, inputs: FloatArray) -> bool:
        """Whether all loads and actuators derive from a potential at these inputs, so that stability is defined.

        The answer depends on which inputs are zero, and on nothing else: it is kept for each pattern of zeros.
        """
        bound = self.at()
        known: dict[bytes, bool] = bound.__dict__.setdefault("_potential", {})
        pattern = (np.asarray(inputs) != 0.0).tobytes()
        if pattern not in known:
            by_loads = loads_have_potential(bound.discrete, inputs)
            known[pattern] = by_loads and actuators_have_potential(bound.discrete, inputs)
        return known[pattern]

    def pack(self, values: Mapping[str, npt.ArrayLike] | None = None) -> FloatArray:
        """The stacked inputs from the scene's values and new ones by name."""
        return self.inputs.pack(values)

    def unloaded(self) -> FloatArray:
        """Unknowns of the unloaded scene, shape (size,)."""
        return np.zeros(self.size)


def check_pairs(model: Model, parameters: Mapping[str, npt.ArrayLike] | None = None) -> None:
    """Refuse rods that penetrate each other unloaded: the side on which they belong is unknown.

    Rods that constraints have to draw together are not checked: their unloaded poses are not where they will be.

    Args:
        model: the model.
        parameters: by name; the scene's values by default.

    Raises:
        SceneError: two rods penetrate each other by more than the width of their contact.
    """
    if model.discrete.constraints and not model.discrete.closed_unloaded:
        return
    given = [model.parameters.pack(parameters)] if model.parameters.size else []
    if model.contact_depth is not None and float(model.contact_depth(model.unloaded(), model.pack(), *given)) > 1.0:
        problem = "two rods, or two stretches of one, are inside each other where nothing acts"
        raise SceneError(
            Problem("rod_contacts", problem, "move them apart, or name the pairs that touch: rods = [...]")
        )


def check_axes(nominal: DiscreteScene, parameters: ParameterLayout) -> None:
    """Refuse parameters that turn an axis on which the held directions of other joints depend.

    Raises:
        SceneError: there are such axes; it names all of them.
    """
    problems = []
    decisive = decisive_axes(nominal.unloaded)
    for name, joint in parameters.turning_axes:
        if joint in decisive:
            problem = "is an axis that keeps planar rods in their plane, which decides what other joints hold"
            problems.append(Problem(name, problem, "build a scene for each value"))
    refuse(problems)


def build(
    scene: scenes.Scene,
    discretisation: Mapping[str, Discretisation] | None = None,
    *,
    moving: bool = False,
) -> Model:
    """The model of a scene.

    Args:
        scene: a validated scene.
        discretisation: one for every rod; by default the scene's, or else a moderate one. :func:`cosserat_casadi.solve`
            chooses it for a tolerance.
        moving: whether the model is for a motion, in which bodies may turn freely and stress may relax.

    Raises:
        SceneError: joints over-constrain; or, at rest, leave a body free to turn; a load or an obstacle cannot be
            where it is; or the discretisation is not one of the scene's rods.
    """
    refuse_tubes(scene)
    check_constraints(scene, moving=moving)
    chosen = discretise(scene) if discretisation is None else discretisation
    if discretisation is not None:
        check_discretisation(scene, discretisation)
    nominal = discrete_scene(scene, input_layout(scene), chosen, moving)
    check_loads(nominal)
    if scene.obstacles:
        check_obstacles(nominal)
    if nominal.pairs:
        check_pairs(Model(nominal))
    if not scene.parameters:
        return Model(nominal)
    parametric = with_parameters(nominal)
    check_axes(nominal, parametric.parameters)
    return Model(parametric)
