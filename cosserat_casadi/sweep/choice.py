"""One discretisation for all rows of a sweep, and how well it turns out to serve them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from cosserat_casadi.accuracy.refine import solve_scene
from cosserat_casadi.accuracy.tune import common_discretisation, fixed, unfixed
from cosserat_casadi.codegen.rows import JUDGED, POSE
from cosserat_casadi.equilibrium.solution import Solution
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.rod.discretisation import Discretisation
from cosserat_casadi.scene import Scene
from cosserat_casadi.sweep.row_model import result_row
from cosserat_casadi.sweep.sampling import representative_rows
from cosserat_casadi.sweep.variants import Variants

CHECKED = 6
"""Rows that are solved again at the end."""

Told = Callable[[str, int, int], None]
"""Told what is being done, how much of it is done, and of how much."""


@dataclass(frozen=True)
class Choice:
    """A discretisation for all rows.

    Attributes:
        discretisation: of all rods; None where the scene fixes it itself.
        rows: rows of the table that it was chosen on.
        converged: how many of them have an equilibrium on it.
        error_estimate: the largest of them on this discretisation; None where the scene chose, or none converged.
    """

    discretisation: Discretisation | None
    rows: tuple[int, ...] = ()
    converged: int = 0
    error_estimate: float | None = None

    def scene(self, given: Scene) -> Scene:
        """A scene on this discretisation."""
        return given if self.discretisation is None else fixed(given, self.discretisation)

    def plain(self) -> dict[str, Any]:
        """The choice as data of a JSON file."""
        chosen = self.discretisation
        fixes = chosen and {"modes": list(chosen.modes), "nodes": chosen.nodes, "rotation": chosen.transport}
        words = {"rows": list(self.rows), "converged": self.converged, "error_estimate": self.error_estimate}
        return {"discretisation": fixes, **words}

    @classmethod
    def read(cls, plain: dict[str, Any]) -> Choice:
        """The choice that data of a JSON file hold."""
        given = plain["discretisation"]
        chosen = given and Discretisation(tuple(given["modes"]), given["nodes"], transport=given["rotation"])
        return cls(chosen, tuple(plain["rows"]), plain["converged"], plain["error_estimate"])


def choose(found: Variants, values: FloatArray, samples: int, told: Told) -> Choice:
    """The smallest discretisation found that meets the tolerance on rows that stand for all.

    A scene that fixes modes, nodes or rotation is taken at its word. Rows without an equilibrium do not take part,
    unless no row has one.

    Args:
        found: scenes and inputs of the table.
        values: of the table, shape (rows, columns).
        samples: rows to look at.
        told: told what is being done.
    """
    accuracy = found.entries[0].scene.accuracy
    if accuracy.fixed:
        return Choice(None)
    rows = representative_rows(values, samples)
    cases = [(unfixed(found.of_row(row).scene, accuracy.tolerance), _values(found, row)) for row in rows]
    done, total = 0, 2 * len(cases)

    def solved(scene: Scene, given: dict[str, FloatArray]) -> Solution:
        nonlocal done
        told("Choosing the discretisation", done, max(total, done + 1))
        done += 1
        return solve_scene(scene, given)

    alone = [solved(*case) for case in cases]
    kept = [i for i, solution in enumerate(alone) if solution.converged]
    used = kept or list(range(len(cases)))
    chosen, together = common_discretisation([cases[i] for i in used], [alone[i] for i in used], solved)  # type: ignore[arg-type]
    reached = [solution for solution in together if solution.converged]
    estimates = [s.error_estimate for s in reached if s.error_estimate is not None]
    return Choice(chosen, tuple(rows), len(reached), max(estimates, default=None))


def check(found: Variants, choice: Choice, results: FloatArray, told: Told) -> list[dict[str, Any]]:
    """Some rows solved again in Python, beside a finer discretisation that tells their error.

    Args:
        found: scenes and inputs of the table.
        choice: the discretisation.
        results: of all rows, shape (rows, results).
        told: told what is being done.

    Returns:
        for each row its number from 0, the estimated error, how far its poses lie from those found in Python, relative
        to the length, whether it is stable; None where the row has no equilibrium in Python, or that has no meaning.
    """
    converged = np.flatnonzero(results[:, 0] == 0)
    if not converged.size:
        return []
    spread = representative_rows(results[converged][:, len(JUDGED) : len(JUDGED) + 3], CHECKED)
    judged = []
    for done, row in enumerate(converged[spread].tolist()):
        told("Checking rows", done, len(spread))
        solution = solve_scene(choice.scene(found.of_row(row).scene), _values(found, row))
        words = {"row": row, "error_estimate": None, "difference": None, "stable": None}
        if solution.converged:
            difference = pose_difference(results[row], solution)
            words |= {"error_estimate": solution.error_estimate, "difference": difference, "stable": solution.stable}
        judged.append(words)
    told("Checking rows", len(spread), len(spread))
    return judged


def pose_difference(row: FloatArray, solution: Solution) -> float:
    """Largest difference of poses between a row of results and a solution: position over length, quaternion."""
    scene = solution.model.scene
    length = max(rod.length for rod in scene.rods)
    count = len(scene.rods) + len(scene.bodies)
    one, other = (
        poses[len(JUDGED) : len(JUDGED) + count * len(POSE)].reshape(count, len(POSE))
        for poses in (row, result_row(solution, len(row)))
    )
    position = np.abs(one[:, :3] - other[:, :3]).max() / length
    # Both signs of a quaternion are the same rotation.
    turns = [np.abs(one[:, 3:] - sign * other[:, 3:]).max(axis=1) for sign in (1.0, -1.0)]
    return float(max(position, np.minimum(*turns).max()))


def _values(found: Variants, row: int) -> dict[str, FloatArray]:
    return found.layout.unpack(found.inputs[row])
