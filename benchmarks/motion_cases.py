"""Table of docs/hard-cases.md on motion: every case beside its independent reference, and the orders of the steps.

Takes minutes. The cases of the reference folder are left out where that is not beside this checkout.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import typer

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT))

from cosserat_casadi import Motion, build, read_scene, scene_from_dict, simulate_scene, solve  # noqa: E402
from cosserat_casadi.maths.typing import FloatArray  # noqa: E402
from cosserat_casadi.numerics.collocation import Collocation, gauss, radau  # noqa: E402
from tests.conftest import case_files  # noqa: E402
from tests.motion import transients  # noqa: E402
from tests.motion.stepping import moving_model, orders, stepped  # noqa: E402
from tests.motion.test_loops_in_motion import swayed  # noqa: E402
from tests.motion.test_reference_motions import UNDERSTATED  # noqa: E402

DOCS = ROOT / "docs" / "hard-cases.md"
BEGIN, END = "<!-- motions: written by benchmarks/motion_cases.py -->", "<!-- end of motions -->"

SLICES = "chain of rigid slices, DOP853, Richardson"
GALERKIN = "Galerkin method in the curvature, DOP853"
CHAINS = {
    "release_planar": ("soft Reissner cantilever let go", SLICES, 1e-5),
    "release_damped": ("soft Reissner cantilever, Kelvin–Voigt damping", SLICES, 1e-5),
    "space_push": ("pre-curved strip, weight at once, push in space", SLICES, 1e-4),
    "shaken": ("hanging rod, base shaken", SLICES, 1e-4),
    "planar_release": ("inextensible strip let go, m g L³/EI = 6.3", GALERKIN, 1e-5),
    "flying": ("free rod kicked at its tip", SLICES, 1e-2),
}
"""Name, reference and tolerance of the reference cases."""


@dataclass(frozen=True)
class Row:
    """A case beside its reference.

    Attributes:
        case: what moves.
        reference: where the numbers come from.
        tolerance: asked for, of the paths over the length.
        distance: of the tip from its reference, over the length.
        uncertainty: of the reference, over the length.
        estimate: error that the motion claims, over the length.
        steps: that were taken.
    """

    case: str
    reference: str
    tolerance: float
    distance: float
    uncertainty: float
    estimate: float
    steps: int

    @property
    def line(self) -> str:
        """The row of the table."""
        numbers = [self.tolerance, self.distance, self.uncertainty, self.estimate]
        cells = [self.case, self.reference, *(f"{number:.0e}" for number in numbers), str(self.steps)]
        return f"| {' | '.join(cells)} |"


def row_of(motion: Motion, case: str, reference: str, distances: FloatArray, uncertainty: float) -> Row:
    """A case at its tolerance.

    Args:
        motion: that was computed.
        case: what moves.
        reference: where the numbers come from.
        distances: of the tip from its reference, shape (T,), m.
        uncertainty: of the reference, m.
    """
    assert motion.converged, motion.message
    length = motion.model.scene.rods[0].length
    simulation = motion.model.scene.simulation
    assert simulation is not None
    assert simulation.tolerance is not None
    return Row(
        case=case,
        reference=reference,
        tolerance=simulation.tolerance,
        distance=float(distances.max()) / length,
        uncertainty=uncertainty / length,
        estimate=motion.error_estimate,
        steps=motion.statistics.steps,
    )


def chains() -> Iterator[Row]:
    """The reference cases."""
    for path in case_files("dynamics"):
        if path.stem not in CHAINS:
            continue
        case, reference, tolerance = CHAINS[path.stem]
        found = json.loads(path.with_suffix(".json").read_text())
        times = json.dumps(found["expected"]["times"])
        motion = simulate_scene(read_scene(path, (f"simulation.tolerance={tolerance}", f"simulation.times={times}")))
        distances = np.linalg.norm(motion.tip().position - np.array(found["expected"]["tip"]), axis=1)
        uncertainty = UNDERSTATED.get(path.stem, 1.0) * found["uncertainty"]
        yield row_of(motion, case, reference, distances, uncertainty)


def simulated(scene: dict[str, Any]) -> Motion:
    return simulate_scene(scene_from_dict(scene))


def in_plane(motion: Motion, rod: str | None = None) -> FloatArray:
    """The tip's x and z, shape (T, 2)."""
    return motion.tip(rod).position[:, [0, 2]]


def literature() -> Iterator[Row]:
    """Motions of the literature and of independent programs."""
    for tolerance in (1e-3, 1e-5, 1e-7):
        motion = simulated(transients.line_load(tolerance=tolerance))
        distances = np.linalg.norm(in_plane(motion) - transients.LINE_LOAD_TIP, axis=1)
        yield row_of(motion, "cantilever, line load 10 sin⁴(πt/2)", GALERKIN, distances, 1e-8)

    motion = simulated(transients.sudden_weight(tolerance=1e-4))
    distances = np.linalg.norm(in_plane(motion) - transients.SUDDEN_WEIGHT_TIP, axis=1)
    yield row_of(motion, "the same, weight of 10 at once", GALERKIN, distances, 3e-5)

    scene = transients.spin_up(0.025, tolerance=1e-5)
    scene["accuracy"] = {"modes": 6, "nodes": 16}
    motion = simulated(scene)
    angle = transients.spin_angle(motion.times)
    along = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    across = np.stack([-np.sin(angle), np.cos(angle)], axis=1)
    in_base = transients.SPIN_TIP + np.array([transients.SPIN_LENGTH, 0.0])
    wanted = in_base[:, :1] * along + in_base[:, 1:] * across
    distances = np.linalg.norm(in_plane(motion) - wanted, axis=1)
    yield row_of(motion, "spin-up (Kane, Ryan, Banerjee)", GALERKIN, distances, 2e-5)

    motion = simulated(transients.flying_in_plane(tolerance=1e-3))
    distances = np.linalg.norm(in_plane(motion) - transients.FLYING_LOWER, axis=1)
    yield row_of(motion, "flying rod in a plane (Simo, Vu-Quoc)", "independent Reissner rod", distances, 0.02)

    motion = simulated(transients.right_angle(tolerance=1e-3))
    height = motion.tip("second").position[:, 2]
    found = [height[np.abs(motion.times - time) < 1.0] for time, _ in transients.RIGHT_ANGLE_TIP]
    values = np.array([value for _, value in transients.RIGHT_ANGLE_TIP])
    extremes = np.array([part[np.argmax(np.abs(part))] for part in found])
    yield row_of(motion, "right-angle cantilever, extremes", "published curves", np.abs(extremes - values), 0.1)


def order_rows() -> Iterator[str]:
    """Orders of the steps on rods, free and in a loop."""
    model = moving_model(transients.line_load(), 6)
    loop_scene = swayed("pinned tip")
    loop_scene["accuracy"] = {"modes": 2, "nodes": 6}
    loop = moving_model(loop_scene)
    start = solve(build(loop.scene.held(), loop.discretisation)).x
    moves = np.asarray(loop.discrete.unknowns.differential)

    def of_rod(method: Collocation, size: float) -> list[FloatArray]:
        end = stepped(model, method, size, 1.5, model.unloaded()).at(1.5)
        return [end.x, end.v]

    def of_loop(method: Collocation, size: float) -> list[FloatArray]:
        end = stepped(loop, method, size, 0.3, start).at(0.3)
        return [end.x[moves], end.v[moves], end.x[~moves]]

    exact = of_rod(gauss(3), 0.0025)
    exact_loop = of_loop(radau(3), 0.3 / 480)
    for method in (radau(2), radau(3), gauss(2), gauss(3)):
        found = [of_rod(method, size) for size in (0.03, 0.015)]
        cells = [f"{rate:.1f}" for rate in _rates(found, exact)]
        loop_cells = ["–", "–", "–"]
        if method.stiffly_accurate:
            found = [of_loop(method, size) for size in (0.3 / 40, 0.3 / 80)]
            loop_cells = [f"{rate:.1f}" for rate in _rates(found, exact_loop)]
        yield f"| {' | '.join([method.name, *cells, *loop_cells])} |"


def _rates(found: list[list[FloatArray]], exact: list[FloatArray]) -> FloatArray:
    """Order of each part of a state, from two sizes of steps."""
    errors = [[np.abs(part - true).max() for part, true in zip(state, exact, strict=True)] for state in found]
    return np.asarray(orders(errors)[-1])


def main() -> None:
    """Run all cases, write the tables."""
    lines = ["| motion | reference | tolerance | distance | of the reference | estimate | steps |"]
    lines.append("|---|---|---|---|---|---|---|")
    for rows in (literature(), chains()):
        for row in rows:
            lines.append(row.line)
            print(row.line, flush=True)
    lines += ["", "| method | x | v | x, held | v, held | multipliers |", "|---|---|---|---|---|---|"]
    for line in order_rows():
        lines.append(line)
        print(line, flush=True)
    before, rest = DOCS.read_text().split(BEGIN)
    text = "\n".join(lines)
    DOCS.write_text(f"{before}{BEGIN}\n{text}\n{END}{rest.split(END)[1]}")


if __name__ == "__main__":
    typer.run(main)
