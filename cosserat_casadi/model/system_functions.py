"""Protocol of every system, rods and concentric tubes: the functions that solvers and paths call."""

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
        """Reference length of the pose error of each rod, or tube, m."""

    @property
    def resolution(self) -> dict[str, Any]:
        """Resolution of the system as data: modes and nodes of every rod, or steps of a piece of tubes."""

    @property
    def resolution_words(self) -> list[str]:
        """Resolution of the system in words."""

    @property
    def step_weights(self) -> FloatArray:
        """How much each unknown counts in the length of a step, shape (size,)."""

    @property
    def is_assembly(self) -> bool:
        """Whether solvers factorise the Jacobian as a sparse matrix."""

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
        """Whether the system has a potential at these inputs, which tells stable equilibria from unstable ones."""

    @property
    def residual(self) -> ca.Function:
        """(x, inputs) ↦ residual, zero in equilibrium."""

    @property
    def jacobian(self) -> ca.Function:
        """(x, inputs) ↦ derivative of the residual by x, and the residual."""

    @property
    def input_jacobian(self) -> ca.Function:
        """(x, inputs) ↦ derivative of the residual by the inputs."""

    @property
    def parameter_jacobian(self) -> ca.Function:
        """(x, inputs, p) ↦ derivative of the residual by the parameters; None without parameters."""

    @property
    def path_residual(self) -> ca.Function:
        """(x, inputs, load_factor) ↦ residual at a load factor."""

    @property
    def path_jacobian(self) -> ca.Function:
        """(x, inputs, load_factor) ↦ derivative by x of the residual at a load factor."""

    @property
    def path_rate(self) -> ca.Function:
        """(x, inputs, load_factor, inputs_rate, load_factor_rate) ↦ rate of the residual at fixed x."""

    @property
    def tip(self) -> Mapping[str, ca.Function]:
        """(x, inputs) ↦ position, quaternion and rotation of the tip, by rod or tube."""
