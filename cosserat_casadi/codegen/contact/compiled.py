"""A compiled exported folder of a scene in exact contact: the solver in C, called from Python."""

from __future__ import annotations

import ctypes
import itertools
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, NamedTuple

import casadi as ca
import numpy as np
import numpy.typing as npt

from cosserat_casadi.codegen.compiled_results import (
    SOLVED,
    AnswerInfo,
    CompiledAnswer,
    CompiledStability,
    judged_words,
)
from cosserat_casadi.codegen.input_values import ArgumentValues
from cosserat_casadi.codegen.loaded_library import LoadedLibrary, budget, by_tip, room
from cosserat_casadi.codegen.manifest import ARRANGEMENTS
from cosserat_casadi.codegen.names import Names
from cosserat_casadi.codegen.plain import pointer
from cosserat_casadi.codegen.status import CONTACT_OUTCOMES
from cosserat_casadi.equilibrium.solution import Contact
from cosserat_casadi.maths.pose import POSE_SIZE
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.numerics.outcome import Outcome

RATES = 4
"""Number of rows of the derivatives of a contact: its two abscissae, and the forces there.

Where rods touch rods, a further row has the derivatives of the abscissa on the other rod.
"""


class Margins(NamedTuple):
    """Margins of a solution from a change of contacts, where its derivatives by inputs cease to hold.

    Attributes:
        force: least force of a contact, over the largest force; infinite without contacts.
        gap: least distance of sections from an obstacle, away from contacts with it, over the length.
    """

    force: float
    gap: float


class ContactInfo(AnswerInfo):
    """The struct in C with the outcome of a call: the members of every solve, then the members for contact."""

    _fields_ = (
        ("arrangement", ctypes.c_int),
        ("tries", ctypes.c_int),
        ("parts", ctypes.c_int),
    )


class ContactOptions(ctypes.Structure):
    """The struct in C with the budget of a call."""

    _fields_ = (("max_iterations", ctypes.c_int), ("max_parts", ctypes.c_int))


class ContactInC(ctypes.Structure):
    """The struct in C of a contact."""

    _fields_ = (
        ("rod", ctypes.c_int),
        ("obstacle", ctypes.c_int),
        ("is_line", ctypes.c_int),
        ("start", ctypes.c_double),
        ("end", ctypes.c_double),
        ("force", ctypes.c_double * 3),
        ("point_forces", ctypes.c_double * 2),
    )


class ContactOfRodsInC(ctypes.Structure):
    """The struct in C of a contact where rods touch rods: an obstacle may be another rod."""

    _fields_ = (*ContactInC._fields_, ("other_place", ctypes.c_double))


@dataclass(frozen=True, kw_only=True)
class CompiledContactSolution(CompiledAnswer):
    """A solution of the solver in C in exact contact.

    Attributes:
        arrangement: index of the arrangement of contacts, in the order of the manifest.
        tips: position and quaternion of the tip of each rod, shape (7,); none without a solution.
        bodies: position and quaternion of each body, shape (7,).
        contacts: who touches what, as in :class:`cosserat_casadi.Solution`.
        actuators: effort and conjugate of each actuator, by name, such as tension (N) and length (m).
        tries: number of arrangements that were solved.
        parts: number of parts of the path of the inputs.
        derivatives: derivatives of the tip of each rod by the inputs, shape (7, m), if requested.
        body_derivatives: derivatives of each body by the inputs, shape (7, m), if requested.
        z: dimensionless unknowns, forces and places of contact of the arrangement; empty without a solution.
        state: data with which the next call begins.
    """

    arrangement: int
    tips: Mapping[str, FloatArray]
    bodies: Mapping[str, FloatArray]
    contacts: tuple[Contact, ...]
    actuators: Mapping[str, Mapping[str, float]]
    tries: int
    parts: int
    derivatives: Mapping[str, FloatArray] | None
    body_derivatives: Mapping[str, FloatArray] | None
    z: FloatArray = field(repr=False)
    state: bytes = field(repr=False)


@dataclass(frozen=True)
class CompiledContact(LoadedLibrary):
    """An exported folder of a scene in exact contact.

    Attributes:
        library: the shared object.
        manifest: contents of the folder, as data.
    """

    @staticmethod
    def is_sound(described: Any) -> bool:
        """Whether a manifest of exact contact has all entries that are read."""
        names = [*described["rods"], *described["obstacles"]]
        contacts = all(isinstance(entry["contacts"], list) for entry in described[ARRANGEMENTS])
        return contacts and all(isinstance(name, str) for name in names)

    @staticmethod
    def sizes(described: Mapping[str, Any]) -> dict[str, int]:
        """Numbers of arrangements and of parameters, by their macros."""
        return {"ARRANGEMENTS": len(described[ARRANGEMENTS]), **LoadedLibrary.sizes(described)}

    @property
    def rods(self) -> list[str]:
        """Names of the rods, in order."""
        return list(self.manifest["rods"])

    @property
    def bodies(self) -> list[str]:
        """Names of the bodies, in order."""
        return list(self.manifest.get("bodies", []))

    @property
    def _rods_touch_rods(self) -> bool:
        """Whether rods may touch rods."""
        return bool(self.manifest.get("rods_touch_rods", False))

    @property
    def _posed(self) -> int:
        """Number of poses: tips of rods, then bodies."""
        return len(self.rods) + len(self.bodies)

    @cached_property
    def residual(self) -> list[ca.Function]:
        """Functions (z, inputs) ↦ residual of each arrangement, with exact first and second derivatives.

        The argument z is that of a solution: unknowns, forces and places of contact; parameters are appended to the
        inputs. The derivatives of a solution follow from these, and hold as long as its contacts: see :meth:`margins`.

        Raises:
            AttributeError: the folder was exported without derivatives.
        """
        return self._externals("residual")

    @cached_property
    def poses(self) -> list[ca.Function]:
        """Functions (z, inputs) ↦ position and quaternion of the tip of each rod, then of each body, stacked.

        Raises:
            AttributeError: the folder was exported without derivatives.
        """
        return self._externals("poses")

    def _externals(self, word: str) -> list[ca.Function]:
        """Load a function of each arrangement for CasADi."""
        names = Names(self.manifest["name"], tuple(self.rods))
        if f"{names.name}_derivatives.c" not in self.manifest["files"]:
            raise AttributeError("export the folder with derivatives: export(..., derivatives=True)")
        symbols = [f"{names.differentiable(str(number))}_{word}" for number in range(len(self.arrangements))]
        return [ca.external(symbol, str(self.library)) for symbol in symbols]

    @property
    def arrangements(self) -> list[list[dict[str, Any]]]:
        """The contacts of each arrangement that the library knows."""
        return [entry["contacts"] for entry in self.manifest[ARRANGEMENTS]]

    def start(self) -> CompiledContactSolution:
        """Return the solution at the inputs of the scene."""
        state = self._room()
        self._function("start")(state)
        info = ContactInfo(load_factor=1.0, error_estimate=-1.0)
        return self._answer(state, info, solved=True)

    def solve(
        self,
        inputs: ArgumentValues = None,
        start: CompiledContactSolution | None = None,
        *,
        parameters: ArgumentValues = None,
    ) -> CompiledContactSolution:
        """Solve for an equilibrium in C.

        Args:
            inputs: inputs by name or stacked; by default those of the scene.
            start: a solution from which the inputs move; by default, and if no path leads from it to the inputs, the
                solution at the inputs of the scene.
            parameters: parameters by name or stacked; by default those of the scene.
        """
        given = self._given(inputs, parameters)
        state = self._room() if start is None else self._state(start)
        info = ContactInfo()
        status = self._function("solve")(*given, state, self._workspace(), ctypes.byref(info))
        outcome = CONTACT_OUTCOMES[status]
        return self._answer(state, info, solved=outcome in SOLVED)

    def solve_batch(self, inputs: npt.ArrayLike, *, parameters: ArgumentValues = None) -> list[CompiledContactSolution]:
        """Solve for equilibria of many load cases, each separately from the solution at the inputs of the scene.

        Args:
            inputs: shape (count, size of the inputs), or one row for all.
            parameters: shape (count, size of the parameters), or one set for all rows, by name or stacked.

        Raises:
            AttributeError: the folder was exported without batches.
            ValueError: inputs or parameters are of the wrong size, or of different numbers of rows.
            SceneError: the scene has no parameters of these names.
        """
        given, passed = self._rows(inputs, parameters)
        size = self._function("state_size")()
        states = room(len(given) * size)
        infos = (ContactInfo * len(given))()
        self._function("solve_batch")(len(given), pointer(given), *passed, states, self._workspace(), 1, infos)
        whole = bytes(states)
        answers = []
        for row, info in enumerate(infos):
            state = room(size)
            ctypes.memmove(state, whole[row * size : (row + 1) * size], size)
            answers.append(self._answer(state, info, solved=CONTACT_OUTCOMES[info.status] in SOLVED))
        return answers

    def track(
        self,
        inputs: ArgumentValues,
        start: CompiledContactSolution,
        *,
        parameters: ArgumentValues = None,
        max_iterations: int | None = None,
        max_parts: int | None = None,
    ) -> CompiledContactSolution:
        """Compute one turn of a control loop: the solution and its derivatives, in bounded work.

        Args:
            inputs: inputs of the turn.
            start: the solution of the turn before.
            parameters: parameters by name or stacked; by default those of the scene.
            max_iterations: most Newton steps; by default as in the header.
            max_parts: most parts of the path of the inputs; by default as in the header.

        Raises:
            ValueError: one budget is given without the other.
        """
        given = self._given(inputs, parameters)
        options = budget(ContactOptions, max_iterations, max_parts)
        state = self._state(start)
        info = ContactInfo()
        columns = np.zeros((self._posed, self.inputs.size, POSE_SIZE))
        further = [None] if self.parameters.size else []
        room_of_call = (options, pointer(columns), *further, self._workspace(), ctypes.byref(info))
        status = self._function("track")(*given, state, None, *room_of_call)
        outcome = CONTACT_OUTCOMES[status]
        # After any other end the state is that of the turn before, for its inputs.
        solved = outcome is Outcome.CONVERGED
        return self._answer(state, info, columns if solved else None, solved=solved)

    def sensitivity(self, solution: CompiledContactSolution) -> dict[str, FloatArray] | None:
        """Return d(position, quaternion)/d(inputs, parameters) of each tip, shape (7, m); None without derivatives."""
        columns = self._by_all("solve_sensitivity", solution, self._posed, POSE_SIZE)
        return None if columns is None else by_tip(self.rods, columns[: len(self.rods)])

    def contact_sensitivity(self, solution: CompiledContactSolution) -> list[FloatArray] | None:
        """Return d(start, end, both forces)/d(inputs, parameters) of each contact, shape (4, m); or None.

        Where rods touch rods a fifth row has the derivatives of the abscissa on the other rod.
        """
        rows = RATES + self._rods_touch_rods
        columns = self._by_all("contact_sensitivity", solution, len(solution.contacts), rows)
        return None if columns is None else [own.T for own in columns]

    def _by_all(self, word: str, solution: CompiledContactSolution, count: int, rows: int) -> FloatArray | None:
        """Return derivatives by inputs, then by parameters, shape (count, m, rows); None if a C function has none."""
        by_inputs, by_parameters = (np.zeros((count, of.size, rows)) for of in (self.inputs, self.parameters))
        columns = [pointer(own) for own in (by_inputs, *([by_parameters] if self.parameters.size else []))]
        status = self._function(word)(self._state(solution), *columns, self._workspace())
        return None if status != 0 else np.concatenate([by_inputs, by_parameters], axis=1)

    def margins(self, solution: CompiledContactSolution) -> Margins | None:
        """Return how near a solution is to a change of contacts; None without a solution."""
        force, gap = ctypes.c_double(), ctypes.c_double()
        state = self._state(solution)
        status = self._function("margins")(state, ctypes.byref(force), ctypes.byref(gap), self._workspace())
        return None if status != 0 else Margins(force.value, gap.value)

    def stability(self, solution: CompiledContactSolution) -> CompiledStability | None:
        """Judge the stability of a solution, for loads with a potential; None without a solution.

        Raises:
            AttributeError: the folder was exported without stability.
        """
        return self._judged(self._state(solution))

    def error_estimate(self, solution: CompiledContactSolution) -> float | None:
        """Estimate the error of a solution, such as one of a turn; None without a solution.

        Raises:
            AttributeError: the folder was exported without the estimate.
        """
        estimate = ctypes.c_double()
        status = self._function("error_estimate")(self._state(solution), ctypes.byref(estimate), self._workspace())
        return estimate.value if CONTACT_OUTCOMES[status] is Outcome.CONVERGED else None

    def _answer(
        self,
        state: Any,
        info: ContactInfo,
        derivatives: FloatArray | None = None,
        *,
        solved: bool,
    ) -> CompiledContactSolution:
        poses = self._poses(state) if solved else np.zeros((0, POSE_SIZE))
        return CompiledContactSolution(
            **judged_words(info, CONTACT_OUTCOMES),
            tolerance=self.tolerance,
            arrangement=self._arrangement_of(state),
            tips=dict(zip(self.rods, poses, strict=False)),
            bodies=dict(zip(self.bodies, poses[len(self.rods) :], strict=False)),
            contacts=self._contacts(state) if solved else (),
            actuators=self._actuators(state) if solved else {},
            tries=info.tries,
            parts=info.parts,
            derivatives=None if derivatives is None else by_tip(self.rods, derivatives[: len(self.rods)]),
            body_derivatives=None if derivatives is None else by_tip(self.bodies, derivatives[len(self.rods) :]),
            z=self._z(state) if solved else np.zeros(0),
            state=bytes(state),
        )

    def _z(self, state: Any) -> FloatArray:
        """Third member z of the state, with the length that the arrangement has."""
        own = self.manifest[ARRANGEMENTS][self._arrangement_of(state)]
        size = own["unknowns"] + own["forces"] + own["places"]
        # Two whole numbers come before it.
        return np.frombuffer(bytes(state), dtype=float, count=size, offset=2 * ctypes.sizeof(ctypes.c_int)).copy()

    def _arrangement_of(self, state: Any) -> int:
        """Second member of the state, the index of the arrangement."""
        return int(ctypes.cast(state, ctypes.POINTER(ctypes.c_int))[1])

    def _poses(self, state: Any) -> FloatArray:
        poses = np.zeros((self._posed, POSE_SIZE))
        self._function("poses")(state, pointer(poses), self._workspace())
        return poses

    def _actuators(self, state: Any) -> dict[str, dict[str, float]]:
        entries = self.manifest.get("actuators", [])
        if not entries:
            return {}
        efforts, conjugates = np.zeros((2, len(entries)))
        self._function("actuators")(state, pointer(efforts), pointer(conjugates), self._workspace())
        exerted = zip(entries, efforts.tolist(), conjugates.tolist(), strict=True)
        return {entry["name"]: {entry["effort"]: f, entry["conjugate"]: c} for entry, f, c in exerted}

    def _contacts(self, state: Any) -> tuple[Contact, ...]:
        most = max([1, *map(len, self.arrangements)])
        found = ((ContactOfRodsInC if self._rods_touch_rods else ContactInC) * most)()
        count = self._function("contacts")(state, found, self._workspace())
        contacts = []
        obstacles = self.manifest["obstacles"]
        for own in itertools.islice(found, count):
            of_rods = own.obstacle >= len(obstacles)
            ends = 2 if own.is_line else 1
            contact = Contact(
                obstacle=[*obstacles, *self.rods][own.obstacle],
                owner=[*self.rods, *self.bodies][own.rod],
                of_body=own.rod >= len(self.rods),
                start=own.start,
                end=own.end,
                force=np.array(own.force),
                ends=tuple(own.point_forces[:ends]),
                kind="line" if own.is_line else "point",
                on_rods=(own.start, own.other_place) if of_rods else None,
            )
            contacts.append(contact)
        return tuple(contacts)

    def _room(self) -> Any:
        """Allocate a state, without a solution."""
        return room(self._function("state_size")())

    def _state(self, solution: CompiledContactSolution) -> Any:
        state = self._room()
        if len(solution.state) != ctypes.sizeof(state):
            raise ValueError("the start is a solution of another library")
        ctypes.memmove(state, solution.state, len(solution.state))
        return state
