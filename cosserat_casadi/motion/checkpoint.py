"""How far a motion has come, as plain data: a later run goes on from it with the very digits of one motion.

Beside the motion itself the motions go on that tell its error: one with coarser steps, one on other modes. Each of them
has its state, what touches or is taut, and what the next step takes over from the last.
"""

from __future__ import annotations

import json
import zipfile
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from cosserat_casadi.errors import Problem, SceneError
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.motion.contact_forces import MovingContact
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
class Resume:
    """Where a motion goes on.

    Attributes:
        at: the state in the coordinates of the steps, with forces of contacts behind them.
        phases: which cables are taut and which joints at their stops, or what touches.
        places: abscissae to which the contacts were last followed.
        guard: number of the guard that came to zero there; None where none did.
        first: size of the next step, s.
        memory: of the steps so far; None where the next one takes over nothing.
    """

    at: Instant
    phases: ContactPhase | Closed
    places: tuple[float, ...]
    guard: int | None
    first: float
    memory: CarriedStep | None


@dataclass(frozen=True)
class Strand:
    """One motion of a simulation, as far as it has come.

    Attributes:
        discretisation: of every rod.
        settings: how it steps.
        gauss: whether by Gauss's method, and not by Radau IIA.
        factor: error of the paths over their distance from those of this strand; 0 of the motion itself.
        resume: where it goes on.
    """

    discretisation: dict[str, Discretisation]
    settings: StepSettings
    gauss: bool
    factor: float
    resume: Resume


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
        """The checkpoint as dictionaries, lists, arrays and numbers."""
        return {
            "time": self.time,
            "error": self.error,
            "energy": asdict(self.energy),
            "tips": self.tips,
            "strands": [_strand_data(strand) for strand in self.strands],
        }

    @staticmethod
    def from_data(data: Mapping[str, Any]) -> Checkpoint:
        """The checkpoint of such data.

        Raises:
            KeyError: an entry is missing.
            TypeError: one is of another type; likewise ValueError.
        """
        return Checkpoint(
            time=float(data["time"]),
            strands=tuple(_strand(strand) for strand in data["strands"]),
            error=_number(data["error"]),
            energy=EnergyAccount(**data["energy"]),
            tips=dict(data["tips"]),
        )


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


def _strand_data(strand: Strand) -> dict[str, Any]:
    resume = strand.resume
    memory = resume.memory
    return {
        "discretisation": {name: asdict(one) for name, one in strand.discretisation.items()},
        "tolerance": strand.settings.tolerance,
        "newton": strand.settings.newton,
        "size": strand.settings.size,
        "gauss": strand.gauss,
        "factor": strand.factor,
        "at": _instant_data(resume.at),
        "phases": _phases_data(resume.phases, resume.places),
        "guard": resume.guard,
        "first": resume.first,
        "memory": None if memory is None else {**vars(memory), "linearised_at": _instant_data(memory.linearised_at)},
    }


def _strand(data: Mapping[str, Any]) -> Strand:
    memory = data["memory"]
    phases, places = _phases(data["phases"])
    resume = Resume(
        at=_instant(data["at"]),
        phases=phases,
        places=places,
        guard=data["guard"],
        first=float(data["first"]),
        memory=None if memory is None else _memory(memory),
    )
    settings = StepSettings(_array(data["tolerance"]), data["size"], newton=float(data["newton"]))
    discretisation = {
        name: Discretisation(tuple(one["modes"]), one["nodes"], tuple(one["breaks"]), one["transport"])
        for name, one in data["discretisation"].items()
    }
    return Strand(discretisation, settings, bool(data["gauss"]), float(data["factor"]), resume)


def _memory(data: Mapping[str, Any]) -> CarriedStep:
    at = data["linearised_at"]
    return CarriedStep(
        begun=float(data["begun"]),
        size=float(data["size"]),
        unknowns=_array(data["unknowns"]),
        wanted=float(data["wanted"]),
        error=_number(data["error"]),
        longest=float(data["longest"]),
        linearised_at=None if at is None else _instant(at),
    )


def _instant_data(instant: Instant | None) -> dict[str, Any] | None:
    return None if instant is None else {"t": instant.time, "x": instant.x, "v": instant.v, "a": instant.a}


def _instant(data: Mapping[str, Any]) -> Instant:
    return Instant(float(data["t"]), _array(data["x"]), _array(data["v"]), _array(data["a"]))


def _phases_data(phases: ContactPhase | Closed, places: tuple[float, ...]) -> dict[str, Any]:
    if not isinstance(phases, ContactPhase):
        return {"taut": list(phases)}
    return {
        "touches": [list(touch) for touch in phases.touches],
        "laid": sorted(phases.laid),
        "places": list(places),
        "floors": list(phases.floors),
        "forces_from": phases.forces_from,
        "moment": phases.moment,
        "changes": phases.changes,
    }


def _phases(data: Mapping[str, Any]) -> tuple[ContactPhase | Closed, tuple[float, ...]]:
    if "taut" in data:
        return tuple(bool(taut) for taut in data["taut"]), ()
    phase = ContactPhase(
        touches=tuple(MovingContact(*touch) for touch in data["touches"]),
        laid=frozenset(data["laid"]),
        floors=tuple(_array(floors) for floors in data["floors"]),
        forces_from=_number(data["forces_from"], -np.inf),
        moment=_number(data["moment"], -np.inf),
        changes=int(data["changes"]),
    )
    return phase, tuple(float(place) for place in data["places"])


def _number(value: Any, missing: float = float("nan")) -> float:
    """A number; files have no word for one that is not finite."""
    return missing if value is None else float(value)


def _array(value: Any) -> FloatArray:
    array = np.asarray(value, dtype=float)
    if not np.all(np.isfinite(array)):
        raise ValueError("numbers are missing or not finite")
    return array
