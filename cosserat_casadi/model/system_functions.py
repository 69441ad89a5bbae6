"""The table of functions that every system fills, rods and concentric tubes alike: what solvers and paths ask for."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Protocol, Self

import casadi as ca

from cosserat_casadi import scene as scenes
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.inputs import InputLayout


class OfScene(Protocol):
    """A model of rods or of concentric tubes."""

    @property
    def scene(self) -> scenes.Scene:
        """The scene of the model."""


class SystemFunctions(OfScene, Protocol):
    """A system as functions of its unknowns ``x`` and its stacked ``inputs``."""

    @property
    def inputs(self) -> InputLayout:
        """Names, order and default values of the inputs."""

    @property
    def size(self) -> int:
        """Number of unknowns."""

    @property
    def lengths(self) -> dict[str, float]:
        """Length that the pose error of each rod, or tube, is relative to, m."""

    @property
    def resolution(self) -> dict[str, Any]:
        """How finely the system is resolved, as data: modes and nodes of every rod, or steps of a piece of tubes."""

    @property
    def resolution_words(self) -> list[str]:
        """How finely the system is resolved, in words."""

    @property
    def step_weights(self) -> FloatArray:
        """How much each unknown counts in the length of a step, shape (size,)."""

    @property
    def is_assembly(self) -> bool:
        """Whether the Jacobian is solved with as a sparse matrix."""

    @property
    def hessian_is_cheap(self) -> bool:
        """Whether an optimiser is faster with exact second derivatives than with estimated ones."""

    def at(self, values: Any = None) -> Self:
        """The system with its parameters fixed."""

    def pack(self, values: Any = None) -> FloatArray:
        """The stacked inputs from the scene's values and new ones by name."""

    def unloaded(self) -> FloatArray:
        """Unknowns from which loads, or curvatures, grow, shape (size,)."""

    def has_potential(self, inputs: FloatArray) -> bool:
        """Whether an energy tells which equilibria are stable."""

    @property
    def residual(self) -> ca.Function:
        """(x, inputs) ↦ residual, zero in equilibrium."""

    @property
    def jacobian(self) -> ca.Function:
        """(x, inputs) ↦ its derivative with x, and the residual."""

    @property
    def input_jacobian(self) -> ca.Function:
        """(x, inputs) ↦ its derivative with the inputs."""

    @property
    def parameter_jacobian(self) -> ca.Function:
        """(x, inputs, p) ↦ its derivative with the parameters, of a system that has some."""

    @property
    def path_residual(self) -> ca.Function:
        """(x, inputs, load_factor) ↦ residual."""

    @property
    def path_jacobian(self) -> ca.Function:
        """(x, inputs, load_factor) ↦ its derivative with x."""

    @property
    def path_rate(self) -> ca.Function:
        """(x, inputs, load_factor, inputs_rate, load_factor_rate) ↦ its rate at fixed x."""

    @property
    def tip(self) -> Mapping[str, ca.Function]:
        """(x, inputs) ↦ position, quaternion and rotation of the tip, by rod or tube."""
