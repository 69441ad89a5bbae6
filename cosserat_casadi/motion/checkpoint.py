"""How far a motion has come, as plain data: a later run goes on from it with the very digits of one motion.

Beside the motion itself the motions go on that tell its error: one with coarser steps, one on other modes. Each motion
has its state, what touches or is taut, and what the next step takes over from the last.
"""

from __future__ import annotations

import json
import zipfile
from collections.abc import Mapping
from dataclasses import MISSING, Field, dataclass, fields, is_dataclass, replace
from pathlib import Path
from types import NoneType, UnionType
from typing import Any, Union, get_args, get_origin, get_type_hints

import numpy as np

from cosserat_casadi.errors import Problem, SceneError
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.motion.contact_guards import ContactPhase
from cosserat_casadi.motion.one_sided import Closed
from cosserat_casadi.numerics.integration import StepSettings
from cosserat_casadi.numerics.motion_equations import Instant
from cosserat_casadi.numerics.step import CarriedStep
from cosserat_casadi.rod.discretisation import Discretisation

WHERE = "--from"

KEY = "checkpoint"
"""Name of the data in files of motions."""


@dataclass(frozen=True)
class CarriedContacts:
    """Data that a step with friction of exact contact takes over from the steps before it, beside the state.

    Attributes:
        memory: numbers of the memory in C, shape (c,).
        touches: pair, whether it slides, place and gap of each contact that presses, shape (m, 4).
        stuck: indices of the pairs with a contact, but no contact that slips.
    """

    memory: FloatArray
    touches: FloatArray
    stuck: frozenset[int]


@dataclass(frozen=True)
class Resume:
    """Where a motion goes on.

    Attributes:
        at: the state in the coordinates of the steps, with forces of contacts behind them.
        phases: which cables are taut and which joints at their stops, or what touches.
        places: abscissae to which the contacts were last followed.
        guard: number of the guard that came to zero there; None where none did.
        first: size of the next step, s.
        memory: of the steps so far; None where the next one takes over nothing.
        contacts: of the steps so far; None without friction of exact contact.
    """

    at: Instant
    phases: ContactPhase | Closed
    places: tuple[float, ...]
    guard: int | None
    first: float
    memory: CarriedStep | None
    contacts: CarriedContacts | None = None


@dataclass(frozen=True)
class Strand:
    """One motion of a simulation, as far as it has come.

    Attributes:
        discretisation: discretisation of every rod.
        settings: how it steps.
        gauss: whether by Gauss's method, and not by Radau IIA.
        factor: error of the paths over their distance from this strand's paths; 0 of the motion itself.
        impacts: energy that its impacts took more than impacts of the motion, J.
        by_modes: whether it tells the error of the modes; else that of the steps.
        resume: where it goes on.
    """

    discretisation: dict[str, Discretisation]
    settings: StepSettings
    gauss: bool
    factor: float
    impacts: float
    by_modes: bool
    resume: Resume

    def halved(self) -> Strand:
        """The motion from where it has come to, with equal steps half as long."""
        assert self.settings.size is not None, "its steps are equal"
        return replace(self, settings=replace(self.settings, size=self.settings.size / 2.0))


@dataclass(frozen=True)
class EnergyAccount:
    """Energies up to a time, J.

    Attributes:
        stored: where the motion began.
        dissipated: since then.
        work: since then.
        impacts: lost since then.
    """

    stored: float
    dissipated: float = 0.0
    work: float = 0.0
    impacts: float = 0.0


@dataclass(frozen=True)
class Checkpoint:
    """How far a simulation has come.

    Attributes:
        time: s.
        strands: the motion, then the motions that tell its error.
        error: estimated error of the paths so far, over the length; nan where none was made.
        energy: up to the time.
        tips: positions of the tips then, by rod, m: another scene has others.
    """

    time: float
    strands: tuple[Strand, ...]
    error: float
    energy: EnergyAccount
    tips: dict[str, list[float]]

    def to_data(self) -> dict[str, Any]:
        """The checkpoint as dictionaries, lists, arrays and numbers, field by field."""
        data: dict[str, Any] = _data(self)
        return data

    @staticmethod
    def from_data(data: Mapping[str, Any]) -> Checkpoint:
        """The checkpoint of such data.

        Raises:
            KeyError: an entry is missing.
            TypeError, ValueError: an entry is of another type, or steps have no size.
        """
        checkpoint: Checkpoint = _value(Checkpoint, data)
        for strand in checkpoint.strands:
            size, has_equal_steps = strand.settings.size, strand.resume.contacts is not None
            if has_equal_steps if size is None else not size > 0.0:
                raise ValueError("steps have no size")
        return checkpoint


def read_checkpoint(path: str | Path) -> Checkpoint | None:
    """The checkpoint of a file of a motion, JSON or NPZ; None where the file is of something else.

    Raises:
        SceneError: the file is of a motion, and cannot be gone on from.
    """
    file = Path(path)
    try:
        if file.suffix.lower() == ".npz":
            with np.load(file, allow_pickle=False) as arrays:
                data = json.loads(str(arrays[KEY]))
        else:
            data = json.loads(file.read_text(encoding="utf-8"))[KEY]
    except (OSError, ValueError, KeyError, TypeError, RecursionError, zipfile.BadZipFile):
        return None
    try:
        return Checkpoint.from_data(data)
    except (KeyError, TypeError, ValueError, IndexError) as error:
        problem = f"{path} is of a motion that nothing goes on from: it has no state, or not all of one"
        raise SceneError(Problem(WHERE, problem, "write it with cosserat simulate SCENE --output")) from error


def of_another_scene() -> SceneError:
    """The error of a motion that would go on where a motion of another scene ended."""
    problem = "the motion that it would go on from is of another scene"
    return SceneError(Problem(WHERE, problem, "give the scene of that motion"))


def _data(value: Any) -> Any:
    """A value as plain data: records as dictionaries, by the names of their fields."""
    if is_dataclass(value):
        return {entry.name: _data(getattr(value, entry.name)) for entry in _written(type(value))}
    if isinstance(value, dict):
        return {key: _data(entry) for key, entry in value.items()}
    if isinstance(value, tuple | list | frozenset):
        return [_data(entry) for entry in value]
    # Files have no number that is not finite.
    return str(value) if isinstance(value, float) and not np.isfinite(value) else value


def _value(kind: Any, data: Any) -> Any:
    """The value of a type with such data."""
    origin, arguments = get_origin(kind), get_args(kind)
    if origin in (Union, UnionType):
        if data is None:
            return None
        (member,) = (one for one in arguments if one is not NoneType and is_dataclass(one) == isinstance(data, dict))
        return _value(member, data)
    if origin is np.ndarray:
        return _array(data)
    if origin is dict:
        return {key: _value(arguments[1], entry) for key, entry in data.items()}
    if origin is not None:
        return origin(_value(arguments[0], entry) for entry in data)
    types = get_type_hints(kind)
    if hasattr(kind, "__dataclass_fields__"):
        return kind(**{entry.name: _value(types[entry.name], data[entry.name]) for entry in _written(kind)})
    if issubclass(kind, tuple):
        return kind(*map(_value, types.values(), data))
    return kind(data)


def _written(record: Any) -> list[Field[Any]]:
    """Fields of a record that are written: a field with a factory is made of the written ones."""
    return [entry for entry in fields(record) if entry.default_factory is MISSING]


def _array(value: Any) -> FloatArray:
    array = np.asarray(value, dtype=float)
    if not np.all(np.isfinite(array)):
        raise ValueError("numbers are missing or not finite")
    return array
