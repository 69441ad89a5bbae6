"""Named values stacked into one vector: common base of the inputs and the parameters of a model."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, fields
from functools import cached_property
from typing import Any, ClassVar, Generic, Protocol, TypeVar

import numpy as np
import numpy.typing as npt

from cosserat_casadi.errors import Problem, SceneError, refuse
from cosserat_casadi.maths.typing import FloatArray


class StackedEntry(Protocol):
    """A named value.

    Attributes:
        default: the scene's value, shape (components, k).
    """

    @property
    def name(self) -> str:
        """Name of the value, as the scene and the command line spell it."""

    @property
    def default(self) -> FloatArray:
        """The scene's value, shape (components, k)."""


EntryType = TypeVar("EntryType", bound=StackedEntry)


@dataclass(frozen=True)
class StackedLayout(Generic[EntryType]):
    """Named values, stacked into one vector.

    Attributes:
        entries: the values in the order of the vector.
    """

    entries: tuple[EntryType, ...]

    what: ClassVar[str]
    """Word for such a value, with its article; ``several`` is its plural."""

    several: ClassVar[str]

    def __getstate__(self) -> dict[str, Any]:
        """The state for pickle and copy: the values, without the symbol that is built from them."""
        return {field.name: getattr(self, field.name) for field in fields(self)}

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Names in the order of the vector."""
        return tuple(entry.name for entry in self.entries)

    @cached_property
    def defaults(self) -> tuple[FloatArray, ...]:
        """The scene's value of each by name, shape (components, k)."""
        return tuple(entry.default for entry in self.entries)

    @cached_property
    def size(self) -> int:
        """Entries of the stacked vector."""
        return sum(entry.default.size for entry in self.entries)

    @cached_property
    def slices(self) -> dict[str, slice]:
        """Slice of each value in the stacked vector, column after column."""
        slices = {}
        start = 0
        for entry in self.entries:
            stop = start + entry.default.size
            slices[entry.name] = slice(start, stop)
            start = stop
        return slices

    def __iter__(self) -> Iterator[tuple[EntryType, slice]]:
        """Pairs of a value and its slice of the stacked vector."""
        return zip(self.entries, self.slices.values(), strict=True)

    def pack(self, values: Mapping[str, npt.ArrayLike] | None = None) -> FloatArray:
        """The stacked vector: values by name, and default values for other names.

        Args:
            values: new values by name; a number, (3,) for a vector, (3, k) for Legendre coefficients.

        Returns:
            shape (size,), SI units.

        Raises:
            SceneError: a name is unknown, or a value has another shape, or is no finite number.
        """
        given = dict(values or {})
        problems = list(self._unknown_names(given))
        # The empty part makes the vector of a model without inputs an array of numbers too.
        parts = [np.zeros(0)]
        for entry in self.entries:
            try:
                value = np.asarray(given.get(entry.name, entry.default), dtype=float)
            except (TypeError, ValueError):
                problems.append(Problem(entry.name, f"must be numbers, got {given[entry.name]!r}"))
                continue
            problems.extend(self._faults(entry, value))
            # Legendre coefficients are stacked degree after degree: column-major order.
            parts.append(value.ravel(order="F"))
        refuse(problems)
        return np.concatenate(parts)

    def _faults(self, entry: EntryType, value: FloatArray) -> Iterator[Problem]:
        """Problems of a value, its range excepted."""
        if value.size != entry.default.size:
            yield Problem(entry.name, f"must have {entry.default.size} numbers, got {value.size}")
        elif not np.all(np.isfinite(value)):
            yield Problem(entry.name, f"must be finite, got {value.tolist()}")

    def _unknown_names(self, given: Mapping[str, npt.ArrayLike]) -> Iterator[Problem]:
        """A problem for every unknown name."""
        known = ", ".join(self.names) or "none"
        for name in given:
            if name not in self.names:
                yield Problem(str(name), f"is not {self.what} of this model", f"its {self.several} are {known}")

    def split(self, stacked: npt.ArrayLike) -> dict[str, FloatArray]:
        """Values by name from the stacked values, shape (size,).

        Raises:
            SceneError: the number of stacked values is not ``size``.
        """
        vector = np.asarray(stacked, dtype=float).ravel()
        if vector.size != self.size:
            names = ", ".join(self.names) or "none"
            problem = f"must be {self.size} numbers, got {vector.size}"
            raise SceneError(Problem(self.several, problem, f"they are {names}"))
        return self.unpack(vector)

    @property
    def quaternions(self) -> list[int]:
        """Indices of the first entries of quaternions that may have either sign."""
        return []

    def nearer(self, first: FloatArray, last: FloatArray) -> FloatArray:
        """Values with the signs of quaternions that are nearer to other values: Q and −Q are one rotation.

        Args:
            first: the other values, shape (size,).
            last: the values, shape (size,).
        """
        signed = np.array(last, dtype=float)
        for start in self.quaternions:
            if first[start : start + 4] @ signed[start : start + 4] < 0.0:
                signed[start : start + 4] *= -1.0
        return signed

    def unpack(self, stacked: FloatArray) -> dict[str, FloatArray]:
        """Values by name from the stacked vector, each in the shape of its default."""
        return {entry.name: stacked[span].reshape(entry.default.shape, order="F") for entry, span in self}
