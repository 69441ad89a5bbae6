"""An overhand knot, which is an open trefoil, pulled tight without friction: beside PyElastica in one run.

EI = L = 1. Both begin with one shape, that of benchmarks/reference/knot.csv: unknowns of our rod on 8 modes, to six
digits. Ours is an equilibrium, and tells the error of its modes and that of the width of its contact. PyElastica's rod
moves, damped, until it hardly does any more; it shears and stretches, which ours does not, and the table says by how
much. A small push across keeps the knot from turning about the axis.

    python benchmarks/tight_knot.py [--page]      # writes the table of docs/smooth-contact.md anew
"""

from __future__ import annotations

import argparse
import math
import time
from pathlib import Path
from typing import Any

import elastica
import numpy as np
from doc_tables import put, table

from cosserat_casadi import build, discretise, scene_from_dict, solve
from cosserat_casadi.maths.typing import FloatArray

FOLDER = Path(__file__).parent
SHAPE = FOLDER / "reference" / "knot.csv"
PAGE = FOLDER.parent / "docs" / "smooth-contact.md"
MARKS = ("<!-- tight knot -->", "<!-- end of tight knot -->")
HEADINGS = ("", "tip, of the length", "curvature of the loop", "least gap, radii", "processor time, s")

RADIUS, TENSION = 8e-3, 100.0
YOUNG = 4 / math.pi / RADIUS**4
PUSH = 0.02 * TENSION * np.array([0.0, 0.91, 0.41])
"""At the middle of the rod, N."""

MODES = 8
ELEMENTS = 160
SPRING = 3e5
"""Stiffness of PyElastica's contact, N/m: sections sink into each other by a hundredth of the radius."""

DAMPING, DURATION = 10.0, 0.6
"""Of PyElastica: rate, 1/s, and time that it moves, s."""

TABLES: dict[str, Any] = {
    "schema": 1,
    "rods": [
        {
            "name": "rod",
            "length": 1.0,
            "strain": "kirchhoff",
            "material": {"youngs_modulus": YOUNG, "poisson_ratio": 0.5},
            "section": {"shape": "circle", "radius": RADIUS},
            "base": {"position": [0, 0, 0], "tangent": [1, 0, 0]},
        }
    ],
    "joints": [
        {"kind": "prismatic", "rod": "rod", "position": [1, 0, 0], "tangent": [1, 0, 0], "axis": [1, 0, 0]},
        {"kind": "revolute", "rod": "rod", "at": 0, "axis": [1, 0, 0]},
    ],
    "loads": [
        {"name": "pull", "kind": "tip_wrench", "rod": "rod", "force": [TENSION, 0, 0]},
        {"name": "push", "kind": "point_wrench", "rod": "rod", "at": 0.5, "force": PUSH.tolist()},
    ],
    "rod_contacts": [{"rods": ["rod"]}],
}
"""The rod slides along the axis at its tip, and turns about it at its base."""


def pulled_by_elastica(nodes: FloatArray, across: FloatArray) -> tuple[FloatArray, float]:
    """Nodes of PyElastica's rod at its end, and its largest velocity there, m/s.

    Args:
        nodes: at the start, shape (elements + 1, 3).
        across: first axes of the sections amid the elements, shape (elements, 3).
    """

    parts = (elastica.BaseSystemCollection, elastica.Constraints, elastica.Forcing, elastica.Contact, elastica.Damping)

    class OnAxis(elastica.ConstraintBase):  # type: ignore[misc]
        """Two nodes of either end stay on the axis, and the first one where it is."""

        def constrain_values(self, system: Any, time: float) -> None:
            system.position_collection[0, 0] = 0.0
            system.position_collection[1:, [0, 1, -2, -1]] = 0.0

        def constrain_rates(self, system: Any, time: float) -> None:
            system.velocity_collection[0, 0] = 0.0
            system.velocity_collection[1:, [0, 1, -2, -1]] = 0.0

    class Pulled(elastica.NoForces):  # type: ignore[misc]
        """Tension and push."""

        def apply_forces(self, system: Any, time: float = 0.0) -> None:
            system.external_forces[0, -1] += TENSION
            system.external_forces[:, ELEMENTS // 2] += PUSH

    axes = np.eye(3)
    sizes = (1.0, RADIUS, 1.0 / (math.pi * RADIUS**2))
    moduli = {"youngs_modulus": YOUNG, "shear_modulus": YOUNG / 3.0}
    tangents = np.diff(nodes, axis=0)
    tangents /= np.linalg.norm(tangents, axis=1)[:, None]
    # Elements are chords: the axes of sections are turned by a hair to be across them.
    across = across - np.sum(across * tangents, axis=1)[:, None] * tangents
    across /= np.linalg.norm(across, axis=1)[:, None]
    directors = np.stack([across, np.cross(tangents, across), tangents])
    shape = {"position": nodes.T.copy(), "directors": directors.transpose(0, 2, 1).copy()}
    rod = elastica.CosseratRod.straight_rod(ELEMENTS, nodes[0], axes[0], axes[2], *sizes, **moduli, **shape)
    rod.rest_kappa[...] = 0.0
    simulation = type("Simulation", parts, {})()
    simulation.append(rod)
    simulation.constrain(rod).using(OnAxis)
    simulation.add_forcing_to(rod).using(Pulled)
    simulation.detect_contact_between(rod, rod).using(elastica.RodSelfContact, k=SPRING, nu=0.0)
    step = 0.25 / ELEMENTS / math.sqrt(YOUNG * math.pi * RADIUS**2)
    damping = {"translational_damping_constant": DAMPING, "rotational_damping_constant": 0.0}
    simulation.dampen(rod).using(elastica.AnalyticalLinearDamper, **damping, time_step=step)
    simulation.finalize()
    stepper = elastica.PositionVerlet()
    now = 0.0
    while now < DURATION:
        now = stepper.step(simulation, now, step)
    return np.asarray(rod.position_collection.T.copy()), float(np.abs(rod.velocity_collection).max())


def cells(what: str, nodes: FloatArray, seconds: float) -> list[str]:
    """A row of the table: the loop is in the middle of the rod, and the gap is that of the nearest nodes."""
    count = len(nodes) - 1
    middle = nodes[count // 2 - 1 : count // 2 + 2]
    bend = float(np.linalg.norm(middle[0] - 2 * middle[1] + middle[2])) * count**2
    apart = np.linalg.norm(nodes[:, None] - nodes, axis=2)
    number = np.arange(count + 1)
    gap = float(apart[np.abs(number[:, None] - number) > 5 * RADIUS * count].min()) / RADIUS - 2.0
    return [what, f"{nodes[-1, 0]:.4f}", f"{bend:.2f}", f"{gap:.3f}", f"{seconds:.0f}"]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--page", action="store_true", help="write the table into docs/smooth-contact.md")
    arguments = parser.parse_args()
    scene = scene_from_dict(TABLES)
    begun = time.process_time()
    solution = solve(build(scene, discretise(scene, MODES)), start=np.loadtxt(SHAPE))
    layer = solution.layer_error_estimate
    seconds = time.process_time() - begun
    if not solution.converged or layer is None:
        raise SystemExit(solution.message)
    poses = solution.pose(np.linspace(0.0, 1.0, ELEMENTS + 1))
    estimates = f"error estimate {solution.error_estimate:.1e}, layer error estimate {layer:.1e}"
    rows = [cells(f"cosserat_casadi, {MODES} modes an element, {estimates}", poses.position, seconds)]
    print(rows[0], "stable" if solution.stable else "not stable", flush=True)
    begun = time.process_time()
    middles = solution.pose((np.arange(ELEMENTS) + 0.5) / ELEMENTS)
    nodes, velocity = pulled_by_elastica(poses.position, middles.rotation[:, :, 0])
    stretch = float(np.linalg.norm(np.diff(nodes, axis=0), axis=1).sum()) - 1.0
    what = f"PyElastica, {ELEMENTS} elements, {stretch:.1e} longer, moves by {velocity:.0e} m/s"
    rows.append(cells(what, nodes, time.process_time() - begun))
    text = table(HEADINGS, rows)
    print(text)
    if arguments.page:
        put(PAGE, *MARKS, text)


if __name__ == "__main__":
    main()
