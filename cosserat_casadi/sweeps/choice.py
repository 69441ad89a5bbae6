"""One discretisation for all rows of a sweep, and its verification on some of them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from cosserat_casadi.accuracy.common_modes import CommonModes, LoadCase
from cosserat_casadi.accuracy.fixing import fixed_alike, unfixed, union_of
from cosserat_casadi.codegen.rows import POSE
from cosserat_casadi.equilibrium.solution import Solution
from cosserat_casadi.equilibrium.solve import solve
from cosserat_casadi.maths.pose_change import rotation_angles
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model, build
from cosserat_casadi.numerics.progress import StageProgress
from cosserat_casadi.rod.discretisation import Discretisation
from cosserat_casadi.scene import Scene
from cosserat_casadi.scene.writing import scene_text
from cosserat_casadi.sweeps.row_model import solved_poses
from cosserat_casadi.sweeps.sampling import representative_rows
from cosserat_casadi.sweeps.scratch import Scratch
from cosserat_casadi.sweeps.table import Table
from cosserat_casadi.sweeps.variants import Variants

CHECKED = 6
"""Number of rows that are solved again at the end."""


@dataclass(frozen=True)
class Choice:
    """A discretisation for all rows.

    Attributes:
        discretisation: discretisation of all rods; None if the scene fixes it.
        rows: rows of the table on which the discretisation was chosen.
        converged: number of these rows with an equilibrium on it.
        error_estimate: largest estimated error of these rows on it; None if the scene fixes it, or no row converged.
    """

    discretisation: Discretisation | None
    rows: tuple[int, ...] = ()
    converged: int = 0
    error_estimate: float | None = None

    def scene(self, variant: Scene) -> Scene:
        """The scene of a variant on this discretisation."""
        if self.discretisation is None:
            return variant
        return fixed_alike(variant, self.discretisation)

    def plain(self) -> dict[str, Any]:
        """The choice as data of a JSON file."""
        chosen = self.discretisation
        discretisation = None
        if chosen is not None:
            discretisation = {
                "modes": list(chosen.modes),
                "nodes": chosen.nodes,
                "rotation": chosen.transport,
                "sections": chosen.sections,
                **({"fibres": chosen.fibres} if chosen.fibres else {}),
            }
        return {
            "discretisation": discretisation,
            "rows": list(self.rows),
            "converged": self.converged,
            "error_estimate": self.error_estimate,
        }

    @classmethod
    def read(cls, plain: dict[str, Any]) -> Choice:
        """The choice from the data of a JSON file."""
        entries = plain["discretisation"]
        discretisation = None
        if entries:
            modes = tuple(entries["modes"])
            sums = {key: entries.get(key, 0) for key in ("sections", "fibres")}
            discretisation = Discretisation(modes, entries["nodes"], transport=entries["rotation"], **sums)
        return cls(discretisation, tuple(plain["rows"]), plain["converged"], plain["error_estimate"])


def choose(variants: Variants, table: Table, samples: int, progress: StageProgress) -> Choice:
    """The smallest discretisation found that meets the tolerance on representative rows.

    Modes, nodes or rotation that the scene fixes are used. Rows without an equilibrium are ignored, unless no row has
    one.

    Args:
        variants: scenes and inputs of the table.
        table: the rows.
        samples: number of representative rows.
        progress: receives the work under way.
    """
    accuracy = variants.entries[0].scene.accuracy
    if accuracy.fixed:
        return Choice(None)
    rows = representative_rows(table.values, samples, table.scratch)
    scenes: dict[str, Scene] = {}
    cases = []
    for row in rows:
        variant = variants.scene_of_row(row)
        text = scene_text(variant)
        # Rows of equal scenes share the scene, and so its model.
        if text not in scenes:
            scenes[text] = unfixed(variant, accuracy.tolerance)
        cases.append(LoadCase(scenes[text], variants.inputs_of_row(row)))
    search = CommonModes(cases, lambda done, total: progress("Choosing the discretisation", done, total))
    answers = search.refined()
    _, error = search.worst(answers)
    return Choice(
        union_of(list(answers.chosen.values())),
        tuple(rows),
        len(cases) - len(search.without_equilibrium),
        error if error >= 0.0 else None,
    )


def check(
    variants: Variants,
    choice: Choice,
    outcomes: npt.NDArray[np.int64],
    poses: FloatArray,
    scratch: Scratch,
    progress: StageProgress,
) -> list[dict[str, Any]]:
    """Verify some rows by solving them again in Python with error estimates, whatever the rows report.

    Args:
        variants: scenes and inputs of the table.
        choice: the discretisation.
        outcomes: outcomes of the rows, 0 for an equilibrium, shape (rows,).
        poses: poses of tips and bodies, shape (rows, 7 tips and bodies).
        scratch: storage of arrays with an entry for each row.
        progress: receives the work under way.

    Returns:
        for each row its index from 0, the estimated error, the distance of its poses from a solution in Python,
        relative to the length, whether it is stable; None if the row has no equilibrium in Python, or stability is not
        defined.
    """
    candidates = scratch.joined(_converged(outcomes, poses, scratch), 4)
    if not candidates.size:
        return []
    # Rows with the first tip at the corners of the workspace, at which rods are bent most.
    chosen = representative_rows(candidates[:, 1:], CHECKED, scratch)
    rows = [int(row) for row in candidates[chosen, 0]]
    models: dict[str, Model] = {}
    checked = []
    for done, row in enumerate(rows):
        progress("Checking rows", done, len(rows))
        scene = choice.scene(variants.scene_of_row(row))
        text = scene_text(scene)
        if text not in models:
            models[text] = build(scene)
        solution = solve(models[text], variants.inputs_of_row(row))
        entry: dict[str, Any] = {"row": row, "error_estimate": None, "difference": None, "stable": None}
        if solution.converged:
            entry["error_estimate"] = solution.error_estimate
            entry["difference"] = pose_difference(poses[row], solution)
            entry["stable"] = solution.stable
        checked.append(entry)
    progress("Checking rows", len(rows), len(rows))
    return checked


def _converged(outcomes: npt.NDArray[np.int64], poses: FloatArray, scratch: Scratch) -> Iterator[FloatArray]:
    """Indices of the rows with an equilibrium, and the positions of their first tips, block by block."""
    for block in scratch.blocks(len(outcomes)):
        converged = np.flatnonzero(outcomes[block] == 0)
        yield np.column_stack([block.start + converged, poses[block, :3][converged]])


def pose_difference(poses: FloatArray, solution: Solution) -> float:
    """Largest pose error of a row of a sweep against a solution: distance over length, angle in rad.

    Args:
        poses: poses of tips and bodies in the row, shape (7 tips and bodies,).
        solution: solution of the row.
    """
    scene = solution.model.scene
    length = max(rod.length for rod in scene.rods)
    swept = poses.reshape(-1, len(POSE))
    solved = solved_poses(solution).reshape(swept.shape)
    distances = np.linalg.norm(swept[:, :3] - solved[:, :3], axis=1)
    angles = rotation_angles(swept[:, 3:], solved[:, 3:])
    return float(max(distances.max() / length, angles.max()))
