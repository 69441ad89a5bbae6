"""State of a simulation at its end, as plain data: a later run continues from it, digit for digit as one motion.

Beside the motion itself, the motions that tell its error go on: one with coarser steps, one on other modes. Each has
its state, its contacts or taut cables, and the data that the next step takes over from the last.
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
from cosserat_casadi.numerics.integration import StepSettings
from cosserat_casadi.numerics.motion_equations import Instant
from cosserat_casadi.numerics.step import CarriedStep
from cosserat_casadi.rod.discretisation import Discretisation

WHERE = "--from"

KEY = "checkpoint"
"""Name of the data in files of motions."""


@dataclass(frozen=True)
class CarriedContacts:
    """Data, beside the state, that a step with friction of exact contact takes over from the steps before it.

    Attributes:
        memory: numbers of the memory in C, shape (c,).
        touches: index of the pair, whether it slides, place, and gap of each contact that presses, shape (m, 4).
        stuck: indices of the pairs that have contacts of which none slips.
    """

    memory: FloatArray
    touches: FloatArray
    stuck: frozenset[int]


@dataclass(frozen=True)
class Resume:
    """Where a motion goes on.

    Attributes:
        at: state in the coordinates of the steps, with the contact forces appended.
        phases: the contacts, the cables that are taut and the joints at their stops.
        places: abscissae to which the contacts were last followed.
        guard: number of the guard that came to zero there; None if no guard did.
        first: size of the next step, s.
        memory: data of the last step for the next one; None if the next one takes over nothing.
        contacts: data of the contacts for the next step; None without friction of exact contact.
    """

    at: Instant
    phases: ContactPhase
    places: tuple[float, ...]
    guard: int | None
    first: float
    memory: CarriedStep | None
    contacts: CarriedContacts | None = None


@dataclass(frozen=True)
class Strand:
    """A motion of a simulation: the motion itself, or another one that tells its error.

    Attributes:
        discretisation: discretisation of every rod.
        settings: settings of the time steps.
        gauss: whether the steps are of Gauss's method; else of Radau IIA.
        factor: error of the motion's paths over their distance from the paths of this strand; 0 of the motion itself.
        impacts: energy lost in impacts of this strand, less the energy lost in impacts of the motion, J.
        by_modes: whether the strand tells the error of the modes; else it tells the error of the steps.
        resume: state from which the strand goes on.
    """

    discretisation: dict[str, Discretisation]
    settings: StepSettings
    gauss: bool
    factor: float
    impacts: float
    by_modes: bool
    resume: Resume

    def halved(self) -> Strand:
        """The motion from where it has come to, with equal steps half as long; steps of a tolerance stay the same."""
        size = self.settings.size
        return self if size is None else replace(self, settings=replace(self.settings, size=size / 2.0))


@dataclass(frozen=True)
class EnergyAccount:
    """Energies up to a time, J.

    Attributes:
        stored: energy stored at the start of the motion.
        dissipated: energy dissipated since then.
        work: work put in since then.
        impacts: energy lost in impacts since then.
    """

    stored: float
    dissipated: float = 0.0
    work: float = 0.0
    impacts: float = 0.0


@dataclass(frozen=True)
class Checkpoint:
    """State of a simulation at the time that it has reached.

    Attributes:
        time: time reached, s.
        strands: the motion, then the motions that tell its error.
        error: estimated error of the paths so far, over the length; nan if it was not estimated.
        energy: energies up to that time.
        tips: positions of the tips at that time, by rod, m; they show whether a scene is the one of the checkpoint.
    """

    time: float
    strands: tuple[Strand, ...]
    error: float
    energy: EnergyAccount
    tips: dict[str, list[float]]

    def to_data(self) -> dict[str, Any]:
        """Return the checkpoint as dictionaries, lists, arrays and numbers, field by field."""
        data: dict[str, Any] = _data(self)
        return data

    @staticmethod
    def from_data(data: Mapping[str, Any]) -> Checkpoint:
        """Return the checkpoint with the data of :meth:`to_data`.

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
    """Read the checkpoint in the file of a motion, JSON or NPZ; None if the file does not hold a motion.

    Raises:
        SceneError: the file holds a motion that cannot be continued.
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
        problem = f"no motion can go on from {path}: its state is missing or incomplete"
        raise SceneError(Problem(WHERE, problem, "write it with cosserat simulate SCENE --output")) from error


def of_another_scene() -> SceneError:
    """The error of continuing a motion from the checkpoint of another scene."""
    problem = "the motion to go on from has another scene"
    return SceneError(Problem(WHERE, problem, "give the scene of that motion"))


def _data(value: Any) -> Any:
    """Return a value as plain data: records become dictionaries by the names of their fields."""
    if is_dataclass(value):
        return {entry.name: _data(getattr(value, entry.name)) for entry in _written(type(value))}
    if isinstance(value, dict):
        return {key: _data(entry) for key, entry in value.items()}
    if isinstance(value, tuple | list | frozenset):
        return [_data(entry) for entry in value]
    # Files have no number that is not finite.
    return str(value) if isinstance(value, float) and not np.isfinite(value) else value


def _value(kind: Any, data: Any) -> Any:
    """Return the value of a type from its plain data, the inverse of :func:`_data`."""
    origin, arguments = get_origin(kind), get_args(kind)
    if origin in (Union, UnionType):
        if data is None:
            return None
        (member,) = (one for one in arguments if one is not NoneType)
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
    """Fields of a record that are written; a field with a default factory is not, as the others determine it."""
    return [entry for entry in fields(record) if entry.default_factory is MISSING]


def _array(value: Any) -> FloatArray:
    array = np.asarray(value, dtype=float)
    if not np.all(np.isfinite(array)):
        raise ValueError("numbers are missing or not finite")
    return array
