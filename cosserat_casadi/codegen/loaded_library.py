"""The shared object of an exported folder: its functions by name, and memory for their calls."""

from __future__ import annotations

import ctypes
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from cosserat_casadi.codegen.compiled_results import CompiledStability, StabilityInfo
from cosserat_casadi.codegen.input_values import (
    ArgumentValues,
    ListedInputs,
    ListedParameters,
    listed_parameters,
    listed_values,
)
from cosserat_casadi.codegen.plain import pointer
from cosserat_casadi.errors import ExportError, Problem
from cosserat_casadi.maths.typing import FloatArray


@dataclass(frozen=True)
class LoadedLibrary(ABC):
    """An exported folder, compiled.

    Methods take inputs by name, with the scene's values for the others, or all inputs stacked. They raise a ValueError
    for inputs of the wrong size, and a SceneError for names that the scene does not have.

    Attributes:
        library: the shared object.
        manifest: contents of the folder, as data.
        scene: text of the exported scene; empty if that file is missing.
    """

    library: Path
    manifest: dict[str, Any] = field(repr=False)
    scene: str = field(default="", repr=False)

    @staticmethod
    @abstractmethod
    def is_sound(described: Any) -> bool:
        """Whether a manifest has the entries of this kind of folder, besides name, files and inputs.

        Raises:
            AttributeError, KeyError, OverflowError, TypeError, ValueError: an entry is missing or wrong.
        """

    @staticmethod
    def sizes(described: Mapping[str, Any]) -> dict[str, int]:
        """Sizes in a sound manifest, except that of the inputs, by their macros in the header."""
        parameters = described.get("parameters")
        return {"PARAMETERS": sum(len(entry["value"]) for entry in parameters)} if parameters else {}

    def __getstate__(self) -> dict[str, Any]:
        """Return the state for pickle and copy: the path of the shared object in place of the opened object."""
        return {entry.name: getattr(self, entry.name) for entry in fields(self)}

    def __setstate__(self, state: dict[str, Any]) -> None:
        """Restore the state; raise an ExportError if the shared object is not on this machine, or was removed."""
        if not state["library"].is_file():
            problem = "is not here: a pickle of a loaded folder names its shared object and does not hold it"
            raise ExportError(Problem(str(state["library"]), problem, "load the folder again"))
        self.__dict__.update(state)

    @cached_property
    def inputs(self) -> ListedInputs:
        """Names, units and default values of the inputs."""
        return ListedInputs(listed_values(self.manifest["inputs"]))

    @cached_property
    def parameters(self) -> ListedParameters:
        """Names, units and default values of the parameters; often none."""
        return listed_parameters(self.manifest.get("parameters", []), self.scene)

    @property
    def defaults(self) -> FloatArray:
        """The scene's own inputs, stacked."""
        return self.inputs.pack()

    @property
    def tolerance(self) -> float | None:
        """Wanted error of the scene; None if no tolerance has a meaning."""
        if not self.manifest["tolerance_binds"]:
            return None
        return float(self.manifest["tolerance"])

    def in_range(self, inputs: ArgumentValues = None) -> bool:
        """Whether every input is in its range, by its kind and the bounds of the scene."""
        given = self.inputs.stacked(inputs)
        return bool(np.all((given >= self.inputs.lower) & (given <= self.inputs.upper)))

    def clamp(self, inputs: ArgumentValues = None) -> FloatArray:
        """Stack all inputs, with values beyond a range moved to its end; NaN stays."""
        return np.clip(self.inputs.stacked(inputs), self.inputs.lower, self.inputs.upper)

    def _rows(self, inputs: npt.ArrayLike, parameters: ArgumentValues) -> tuple[FloatArray, list[Any]]:
        """Return the inputs of many load cases, shape (count, size of the inputs), and the further arguments of C.

        Args:
            inputs: shape (count, size of the inputs), or one row for all.
            parameters: shape (count, size of the parameters), or one set for all rows, by name or stacked.

        Raises:
            ValueError: inputs or parameters are of the wrong size, or of different numbers of rows.
        """
        given = np.atleast_2d(np.asarray(inputs, dtype=np.float64))
        if given.ndim != 2 or given.shape[1] != self.inputs.size:
            raise ValueError(f"inputs must have shape (count, {self.inputs.size}), got {given.shape}")
        p = self.parameters.rows(parameters)
        count = len(p) if len(given) == 1 else len(given)
        if len(p) not in (1, count):
            raise ValueError(f"there are {len(p)} rows of parameters for {len(given)} rows of inputs")
        given = np.ascontiguousarray(np.broadcast_to(given, (count, given.shape[1])))
        p = np.ascontiguousarray(np.broadcast_to(p, (count, p.shape[1])))
        return given, [pointer(p)] if self.parameters.size else []

    def _given(self, inputs: ArgumentValues, parameters: ArgumentValues) -> list[Any]:
        """Convert inputs and parameters to arguments of functions in C."""
        return [pointer(self.inputs.stacked(inputs)), *self.parameters.passed(parameters)]

    def _judged(self, *arguments: Any) -> CompiledStability | None:
        """Judge the stability of an equilibrium; None if the arguments are no equilibrium.

        Args:
            arguments: arguments of the function in C, before its workspaces.
        """
        info = StabilityInfo()
        memory = room(self._function("stability_workspace_size")())
        status = self._function("stability")(*arguments, self._workspace(), memory, ctypes.byref(info))
        return None if status != 0 else info.judged

    @cached_property
    def _handle(self) -> ctypes.CDLL:
        return ctypes.CDLL(str(self.library))

    def _function(self, word: str) -> Any:
        """Look up a function in C, whose symbol begins with the name of the library."""
        return getattr(self._handle, f"{self.manifest['name']}_{word}")

    def _workspace(self) -> Any:
        """Allocate memory for one call, so that several threads may call at once."""
        return room(self._function("workspace_size")())


def budget(options: type[ctypes.Structure], first: int | None, second: int | None) -> Any:
    """Make a reference to the struct of the two budgets of a turn; None for the budgets of the header.

    Args:
        options: the struct, whose members are the budgets.
        first: value of the first budget; None for the header's.
        second: value of the second budget; None for the header's.

    Raises:
        ValueError: one budget is given without the other.
    """
    if (first is None) != (second is None):
        names = " and ".join(name for name, *_ in options._fields_)
        raise ValueError(f"give both {names}, or none")
    if first is None:
        return None
    return ctypes.byref(options(first, second))


def by_tip(names: Sequence[str], columns: FloatArray) -> dict[str, FloatArray]:
    """Return d(position, quaternion)/dinputs of each tip, shape (7, m).

    Args:
        names: names of the rods, or of the tubes.
        columns: array that the library wrote, shape (tips, m, 7).
    """
    return {name: own.T for name, own in zip(names, columns, strict=True)}


def room(size: int) -> Any:
    """Allocate zeroed memory of so many bytes, aligned for numbers."""
    return (ctypes.c_double * -(-size // ctypes.sizeof(ctypes.c_double)))()
