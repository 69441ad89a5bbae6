"""The tubes and loads of a scene as numbers, and the vector of their inputs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Generic, TypeVar

import casadi as ca
import numpy as np
import numpy.typing as npt

from cosserat_casadi import scene as scenes
from cosserat_casadi.errors import Problem, SceneError, refuse
from cosserat_casadi.maths.numbers import Numbers, Scalar, as_vector, known
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.inputs import InputLayout, input_layout
from cosserat_casadi.model.load_cases import column_indices
from cosserat_casadi.model.parameters import NO_PARAMETERS, ParameterLayout, parameter_layout
from cosserat_casadi.model.scene_rods import shear_modulus
from cosserat_casadi.rod.section import annulus, hooke
from cosserat_casadi.spelling import closest
from cosserat_casadi.tubes.tube_loads import COMPONENTS, TubeLoad, loads_of

Inputs = TypeVar("Inputs", FloatArray, ca.MX)
Entries = TypeVar("Entries", FloatArray, Numbers)

Values = Mapping[str, npt.ArrayLike] | npt.ArrayLike | None
"""Inputs by name, or all inputs in order, or None for the inputs of the scene."""

SLACK = 1e-12
"""Distance, over a length, by which a translation may leave its range, as rounding."""


@dataclass(frozen=True)
class TubeNumbers(Generic[Entries]):
    """Numbers of tubes, with an entry for each tube in the order of the scene: values, or expressions of parameters.

    Attributes:
        bending: bending stiffness EI, shape (n,), N m².
        torsion: torsional stiffness GJ, shape (n,), N m².
        curvature: curvature of the curved part of the unloaded tube, shape (n,), 1/m.
        straight: length of the straight part, shape (n,), m.
        curved: length of the curved part beyond it, shape (n,), m.
        loads: loads on the tubes, m inputs of three numbers.
    """

    bending: Entries
    torsion: Entries
    curvature: Entries
    straight: Entries
    curved: Entries
    loads: tuple[TubeLoad, ...]

    @property
    def length(self) -> Entries:
        """Lengths of the tubes, shape (n,), m."""
        return self.straight + self.curved


@dataclass(frozen=True)
class Robot(TubeNumbers[FloatArray]):
    """Tubes as arrays with an entry for each tube, in the order of the scene; parameters have the scene's values.

    Attributes:
        scene: scene of the tubes.
        names: names of the tubes.
        layout: the inputs: rotation and translation of each tube, then the loads, 2 n + 3 m numbers.
        parameters: numbers that are arguments of the model's functions; often none.
    """

    scene: scenes.Scene
    names: tuple[str, ...]
    layout: InputLayout
    parameters: ParameterLayout = NO_PARAMETERS

    @cached_property
    def numbers(self) -> TubeNumbers[Numbers]:
        """The numbers of the tubes, as expressions if they depend on parameters."""
        return tube_numbers(self.parameters.written(self.scene, self.parameters.symbol))

    @cached_property
    def inputs(self) -> FloatArray:
        """The inputs of the scene, shape (2 n + 3 m,), rad, m and the units of the loads."""
        return self.layout.pack()

    @cached_property
    def columns(self) -> dict[str, int]:
        """Index of each number in the inputs: ``tube.rotation``, ``tube.translation``, then ``load.field.x``."""
        return column_indices(self.layout)

    @property
    def tolerance(self) -> float:
        """Wanted pose error of the tips, with distances relative to the protruding length."""
        return self.scene.accuracy.tolerance

    @property
    def size(self) -> int:
        """Number of tubes."""
        return len(self.names)

    @property
    def has_energy(self) -> bool:
        """Whether all loads have an energy, so that stability has a meaning; true without loads."""
        return all(load.has_energy for load in self.loads)

    def rotations(self, inputs: Inputs) -> Inputs:
        """Rotations of the drives among the inputs, n entries, rad."""
        return inputs[: 2 * self.size : 2]

    def translations(self, inputs: Inputs) -> Inputs:
        """Translations of the tubes among the inputs, n entries, m."""
        return inputs[1 : 2 * self.size : 2]

    def load_start(self, index: int) -> int:
        """Index of the first number of a load in the inputs."""
        return int(self.layout.slices[self.loads[index].name].start)

    def without_loads(self, inputs: FloatArray) -> FloatArray:
        """The inputs with all loads zero."""
        unloaded = inputs.copy()
        unloaded[2 * self.size :] = 0.0
        return unloaded

    def input_index(self, name: str) -> int:
        """Index of an input in the inputs.

        Raises:
            SceneError: there is no such input.
        """
        if name not in self.columns:
            raise SceneError(Problem(name, "is no input of the tubes", closest(name, self.columns)))
        return self.columns[name]

    def packed(self, values: Values = None) -> FloatArray:
        """Stack the inputs, shape (2 n + 3 m,).

        Args:
            values: inputs by name, with the scene's values for the others, where a load may be named as a whole, such
                as "push.force"; or all inputs in order; None for the inputs of the scene.

        Raises:
            SceneError: inputs are unknown, not finite, or out of their ranges; the error lists all of them.
        """
        if values is None:
            return self.inputs.copy()
        if isinstance(values, Mapping):
            inputs = self._named(values)
        else:
            inputs = np.array(values, dtype=float).ravel()
            # Refused where it has too few or too many numbers.
            self.layout.split(inputs)
        refuse(self._out_of_range(inputs))
        return inputs

    def _named(self, values: Mapping[str, npt.ArrayLike]) -> FloatArray:
        inputs = self.inputs.copy()
        problems = []
        spans = {name: slice(index, index + 1) for name, index in self.columns.items()} | self.layout.slices
        for name, value in values.items():
            numbers = np.asarray(value, dtype=float)
            if name not in spans:
                problems.append(Problem(name, "is no input of the tubes", closest(name, self.columns)))
            elif numbers.size != inputs[spans[name]].size:
                wanted = {1: "a number", COMPONENTS: "three numbers"}[inputs[spans[name]].size]
                problems.append(Problem(name, f"must be {wanted}, got the shape {numbers.shape}"))
            else:
                inputs[spans[name]] = numbers.ravel()
        refuse(problems)
        return inputs

    def _out_of_range(self, inputs: FloatArray) -> list[Problem]:
        problems = []
        for name, value in zip(self.columns, inputs, strict=True):
            if not np.isfinite(value):
                problems.append(Problem(name, f"must be finite, got {value}"))
        for name, translation, length in zip(self.names, self.translations(inputs), self.length, strict=True):
            if translation < -SLACK * length or translation > (1 + SLACK) * length:
                problem = f"must be from 0 to the length of the tube, {length:g} m, got {translation:g}"
                remedy = "it is how far the tip stands out of the plate"
                problems.append(Problem(f"{name}.translation", problem, remedy))
        if not problems and not np.any(self.translations(inputs) > 0.0):
            problems.append(Problem("tubes", "no tube stands out of the plate", "push one out: translation > 0"))
        return problems


def robot_of(scene: scenes.Scene) -> Robot:
    """Make the tubes of a scene with constant numbers.

    Raises:
        SceneError: the scene has no tubes.
    """
    if not scene.tubes:
        raise SceneError(Problem("tubes", "the scene has none", "a scene of rods is solved by solve"))
    numbers = tube_numbers(scene)
    return Robot(
        scene=scene.baked(),
        names=tuple(tube.name for tube in scene.tubes),
        bending=known(numbers.bending),
        torsion=known(numbers.torsion),
        curvature=known(numbers.curvature),
        straight=known(numbers.straight),
        curved=known(numbers.curved),
        loads=numbers.loads,
        layout=input_layout(scene),
    )


def parametric_robot(scene: scenes.Scene) -> Robot:
    """Make the tubes of a scene whose parameters are arguments of the model's functions.

    Raises:
        SceneError: the scene has no tubes.
    """
    if not scene.parameters:
        return robot_of(scene)
    return replace(robot_of(scene), scene=scene, parameters=parameter_layout(scene))


def tube_numbers(scene: scenes.Scene) -> TubeNumbers[Numbers]:
    """Collect the numbers of the tubes of a scene, some of which may be expressions of parameters."""
    stiffness = [_stiffness(tube) for tube in scene.tubes]
    return TubeNumbers(
        bending=as_vector([bending for bending, _ in stiffness]),
        torsion=as_vector([torsion for _, torsion in stiffness]),
        curvature=as_vector([tube.curvature for tube in scene.tubes]),
        straight=as_vector([tube.straight for tube in scene.tubes]),
        curved=as_vector([tube.curved for tube in scene.tubes]),
        loads=loads_of(scene),
    )


def _stiffness(tube: scenes.Tube) -> tuple[Scalar, Scalar]:
    """EI and GJ of a tube, N m²."""
    if tube.stiffness is not None:
        return tube.stiffness.bending, tube.stiffness.torsion
    material = tube.material
    section = tube.section
    # The rules of the scene have seen to it that one of the two is given whole.
    assert material is not None
    assert section is not None
    shape = annulus(as_vector([section.outer_radius]), as_vector([section.inner_radius]))
    diagonal = hooke(shape, material.youngs_modulus, shear_modulus(material), shear_correction=1.0)
    bending: Scalar = diagonal[0, 0]
    torsion: Scalar = diagonal[0, 2]
    return bending, torsion
