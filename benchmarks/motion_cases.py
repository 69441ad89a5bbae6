"""Table of docs/hard-cases.md on motion: every case beside its independent reference, its cost, orders of steps.

Takes minutes, up to LIMIT for a case. The cases of the reference folder are left out where that is not beside this
checkout. Their costs are of the processor: other work on the machine lengthens them less than it lengthens the clock's.
With ``--cost`` those cases alone, at COMMON, are printed, and nothing is written; with ``--only`` one of them is run,
and its rows in the table are replaced; with ``--modes`` the free rod that is kicked, on more and more modes.
"""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer
from doc_tables import put
from kicked_rod_waves import KickedRod

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT))

from cosserat_casadi import Motion, Scene, build, read_scene, scene_from_dict, simulate, solve  # noqa: E402
from cosserat_casadi.accuracy.levels import SPARE_NODES  # noqa: E402
from cosserat_casadi.maths.typing import FloatArray  # noqa: E402
from cosserat_casadi.model.discretise import discretise, nodes_for  # noqa: E402
from cosserat_casadi.motion.motion_compiler import MotionCompiler  # noqa: E402
from cosserat_casadi.motion.simulate import Simulator, started  # noqa: E402
from cosserat_casadi.motion.tip_paths import WATCHED, Paths, path_distance  # noqa: E402
from cosserat_casadi.motion.trajectory import MotionProgress  # noqa: E402
from cosserat_casadi.numerics.collocation import Collocation, gauss, radau  # noqa: E402
from tests.conftest import case_files  # noqa: E402
from tests.model import test_joint_coordinates as joint_coordinates  # noqa: E402
from tests.model import test_joint_stops as joint_stops  # noqa: E402
from tests.model import test_joints_of_bodies as joints_of_bodies  # noqa: E402
from tests.motion import disk_chain, transients  # noqa: E402
from tests.motion.stepping import moving_model, orders, stepped  # noqa: E402
from tests.motion.test_loops_in_motion import swayed  # noqa: E402
from tests.motion.test_reference_motions import reference  # noqa: E402

DOCS = ROOT / "docs" / "hard-cases.md"
BEGIN_KICKED, END_KICKED = "<!-- kicked: written by benchmarks/motion_cases.py --modes -->", "<!-- end of kicked -->"
BEGIN, END = "<!-- motions: written by benchmarks/motion_cases.py -->", "<!-- end of motions -->"

SLICES = "chain of rigid slices, DOP853, Richardson"
GALERKIN = "Galerkin method in the curvature, DOP853"
CHAINS = {
    "release_planar": ("soft Reissner cantilever let go", SLICES, 1e-5),
    "release_damped": ("soft Reissner cantilever, Kelvin–Voigt damping", SLICES, 1e-5),
    "space_push": ("pre-curved strip, weight at once, push in space", SLICES, 1e-4),
    "shaken": ("hanging rod, base shaken", SLICES, 1e-4),
    "planar_release": ("inextensible strip let go, m g L³/EI = 6.3", GALERKIN, 1e-5),
    "flying": ("free rod kicked at its tip", "finite differences, DOP853, Richardson", 1e-2),
}
"""Name, reference and tolerance of the reference cases."""

COMMON = 1e-4
"""Tolerance at which every one of them is timed, beside its own."""

OUT_OF_REACH = {"flying"}
"""Those that are not: ``--modes`` tells how many modes COMMON would take."""

KICKED_MODES = ((1, 8), (1, 14), (1, 28), (2, 4), (2, 7), (2, 14), (4, 2), (4, 4), (4, 7))
"""Elements of the free rod that is kicked, and modes of every strain in each: as many unknowns on all."""

KICKED_CELLS = (60, 40)
"""Cells of the other method that it is compared with, and of one that tells how exact that is."""

KICKED_STEPS = 3e-5
"""Tolerance of its steps, over the length: they leave less than its modes do."""

LIMIT = 600.0
"""Processor time after which a case is stopped, s."""


@dataclass(frozen=True)
class Timed:
    """A motion and what it took.

    Attributes:
        motion: that was computed.
        seconds: processor time of choosing modes and steps, building and integrating.
    """

    motion: Motion
    seconds: float


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
        seconds: processor time.
        remark: why the tolerance is not met; empty where it is.
    """

    case: str
    reference: str
    tolerance: float
    distance: float
    uncertainty: float
    estimate: float
    steps: int
    seconds: float
    remark: str = ""

    @property
    def line(self) -> str:
        """The row of the table."""
        numbers = [self.tolerance, self.distance, self.uncertainty, self.estimate]
        digits = [f"{number:.0e}" for number in numbers]
        if self.remark:
            digits[0] = f"{digits[0]}, {self.remark}"
        cells = [self.case, self.reference, *digits, str(self.steps), f"{self.seconds:.1f}"]
        return f"| {' | '.join(cells)} |"


def row_of(timed: Timed, case: str, reference: str, distances: FloatArray, uncertainty: float) -> Row:
    """A case at its tolerance.

    Args:
        timed: motion that was computed.
        case: what moves.
        reference: where the numbers come from.
        distances: of the tip from its reference, shape (T,), m.
        uncertainty: of the reference, m.
    """
    motion = timed.motion
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
        seconds=timed.seconds,
        remark="" if motion.converged else motion.outcome.label.replace("_", " "),
    )


def chains(stems: Sequence[str] = tuple(CHAINS)) -> Iterator[Row]:
    """Reference cases, each at its own tolerance and at the common one."""
    for stem in stems:
        tolerance = CHAINS[stem][2]
        common = set() if stem in OUT_OF_REACH else {COMMON}
        for one in sorted({tolerance, *common}, reverse=True):
            yield from chain(stem, one)


def chains_at_common() -> Iterator[Row]:
    """The reference cases, at the common tolerance."""
    for stem in CHAINS:
        if stem not in OUT_OF_REACH:
            yield from chain(stem, COMMON)


def chain(stem: str, tolerance: float) -> Iterator[Row]:
    """A reference case at a tolerance; nothing where its file is missing, or where no motion came to its end."""
    case, source, _ = CHAINS[stem]
    for path in case_files("dynamics"):
        if path.stem != stem:
            continue
        expected = reference(path)
        times = json.dumps(expected["times"])
        scene = read_scene(path, (f"simulation.tolerance={tolerance}", f"simulation.times={times}"))
        try:
            timed = timed_motion(scene)
        except KeyboardInterrupt:
            print(f"{case}, {tolerance:.0e}: stopped after {LIMIT:.0f} s of the processor", flush=True)
            return
        tip = timed.motion.tip().position
        if len(tip) != len(expected["tip"]):
            print(f"{case}, {tolerance:.0e}: {timed.motion.message}", flush=True)
            return
        distances = np.linalg.norm(tip - np.array(expected["tip"]), axis=1)
        yield row_of(timed, case, source, distances, expected["uncertainty"])


def timed_motion(scene: Scene) -> Timed:
    """The motion of a scene and the processor time of this process that it takes.

    Raises:
        KeyboardInterrupt: it was stopped before any motion was computed to its end.
    """
    began = time.process_time()
    motion = simulate(scene, progress=partial(_stop_late, began))
    return Timed(motion, time.process_time() - began)


def _stop_late(began: float, _: MotionProgress) -> None:
    if time.process_time() - began > LIMIT:
        raise KeyboardInterrupt


def simulated(scene: dict[str, Any]) -> Timed:
    """The motion of a scene that has to reach its tolerance."""
    timed = timed_motion(scene_from_dict(scene))
    assert timed.motion.converged, timed.motion.message
    return timed


def in_plane(motion: Motion, rod: str | None = None) -> FloatArray:
    """The tip's x and z, shape (T, 2)."""
    return motion.tip(rod).position[:, [0, 2]]


def literature() -> Iterator[Row]:
    """Motions of the literature and of independent programs."""
    for tolerance in (1e-3, 1e-5, 1e-7):
        timed = simulated(transients.line_load(tolerance=tolerance))
        distances = np.linalg.norm(in_plane(timed.motion) - transients.LINE_LOAD_TIP, axis=1)
        yield row_of(timed, "cantilever, line load 10 sin⁴(πt/2)", GALERKIN, distances, 1e-8)

    timed = simulated(transients.sudden_weight(tolerance=1e-4))
    distances = np.linalg.norm(in_plane(timed.motion) - transients.SUDDEN_WEIGHT_TIP, axis=1)
    yield row_of(timed, "the same, weight of 10 at once", GALERKIN, distances, 3e-5)

    scene = transients.spin_up(0.025, tolerance=1e-5)
    scene["accuracy"] = {"modes": 6, "nodes": 16}
    timed = simulated(scene)
    angle = transients.spin_angle(timed.motion.times)
    along = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    across = np.stack([-np.sin(angle), np.cos(angle)], axis=1)
    in_base = transients.SPIN_TIP + np.array([transients.SPIN_LENGTH, 0.0])
    wanted = in_base[:, :1] * along + in_base[:, 1:] * across
    distances = np.linalg.norm(in_plane(timed.motion) - wanted, axis=1)
    yield row_of(timed, "spin-up (Kane, Ryan, Banerjee)", GALERKIN, distances, 2e-5)

    timed = simulated(joint_coordinates.two_links(tolerance=1e-4))
    first, _ = joint_coordinates.angles_of_two_links(timed.motion.times)
    distances = np.linalg.norm(timed.motion.tip("a").position - joint_coordinates.tip_of_first_link(first), axis=1)
    yield row_of(timed, "two stiff links, motor, spring and damper", "Lagrange's equations, RK45", distances, 1e-9)

    timed = simulated(joints_of_bodies.let_go(1e-4))
    distances = np.linalg.norm(timed.motion.body("lower").position - joints_of_bodies.elbow(timed.motion.times), axis=1)
    yield row_of(timed, "two rigid links, spring and damper", "Lagrange's equations, RK45", distances, 1e-9)

    timed = simulated(joint_stops.lever(tolerance=1e-4, **joint_stops.ELASTIC))
    turned = joint_stops.angles(timed.motion) - joint_stops.elastic_reference(timed.motion.times)
    in_rad = np.abs(turned) * timed.motion.model.scene.rods[0].length
    yield row_of(timed, "lever on an elastic stop, angle", "Lagrange's equations, RK45", in_rad, 1e-7)

    timed = simulated(disk_chain.robot(tolerance=1e-4))
    coarse, fine = (disk_chain.tip_of_chain(links, timed.motion.times) for links in (20, 40))
    distances = np.linalg.norm(in_plane(timed.motion) - (fine + (fine - coarse) / 3), axis=1)
    yield row_of(timed, "five disks, a tendon straight between them", "rigid links, LSODA, Richardson", distances, 1e-5)

    timed = simulated(transients.flying_in_plane(tolerance=1e-3))
    distances = np.linalg.norm(in_plane(timed.motion) - transients.FLYING_LOWER, axis=1)
    yield row_of(timed, "flying rod in a plane (Simo, Vu-Quoc)", "independent Reissner rod", distances, 0.02)

    timed = simulated(transients.right_angle(tolerance=1e-3))
    height = timed.motion.tip("second").position[:, 2]
    found = [height[np.abs(timed.motion.times - time) < 1.0] for time, _ in transients.RIGHT_ANGLE_TIP]
    values = np.array([value for _, value in transients.RIGHT_ANGLE_TIP])
    extremes = np.array([part[np.argmax(np.abs(part))] for part in found])
    yield row_of(timed, "right-angle cantilever, extremes", "published curves", np.abs(extremes - values), 0.1)


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


def kicked_rows() -> Iterator[str]:
    """The free rod that is kicked, on more and more modes: errors of its tip, steps, time; and the laws of the errors.

    On one polynomial for each strain, and on elements with as many unknowns.
    """
    (path,) = (path for path in case_files("dynamics") if path.stem == "flying")
    scene = read_scene(path).with_motion_inputs()
    simulation = scene.simulation
    assert simulation is not None
    exact, coarser = (KickedRod(cells, 4).paths(WATCHED) for cells in KICKED_CELLS)
    places: dict[int, dict[int, float]] = {}
    turns: dict[int, dict[int, float]] = {}
    for elements, modes in KICKED_MODES:
        whole = discretise(scene, modes, nodes_for(modes) + SPARE_NODES)
        ends = tuple(float(end) for end in np.linspace(0.0, 1.0, elements + 1))
        cut = {name: replace(discretisation, breaks=ends) for name, discretisation in whole.items()}
        model = build(scene, cut, moving=True)
        source = MotionCompiler(always=True)
        simulator = Simulator(model, simulation, started(model, simulation, None), source=source)
        # Compiled beforehand: the time is that of the steps.
        source.kernels(model)
        began = time.process_time()
        history = simulator.controlled(KICKED_STEPS)
        seconds = time.process_time() - began
        place, turn, usual = errors_of(simulator.paths(history), exact)
        places.setdefault(elements, {})[elements * modes] = place
        turns.setdefault(elements, {})[elements * modes] = turn
        steps = history.statistics.steps
        yield f"| {elements} | {modes} | {place:.1e} | {turn:.1e} | {usual:.1e} | {steps} | {seconds:.1f} |"
    place, turn, _ = errors_of(coarser, exact)
    fine, coarse = KICKED_CELLS
    changes = f"{place:.0e} and {turn:.0e}"
    yield f"\nOn {coarse} cells instead of {fine}, place and turn of the other method change by {changes}."
    yield "\n| elements | place falls as | modes of a strain for 1e-04 | turn falls as | modes of a strain for 1e-04 |"
    yield "|---|---|---|---|---|"
    for elements in places:
        laws = [law(errors[elements]) for errors in (places, turns)]
        cells = [f"modes^−{slope:.1f} | {needed:.0f}" for slope, needed in laws]
        yield f"| {elements} | {' | '.join(cells)} |"


def errors_of(found: Paths, exact: Paths) -> tuple[float, float, float]:
    """Largest distance of places and of the tip's turn about its tangent, as a tolerance has them, and the median turn.

    Over the length, without unit; the turn is on the arm that a tolerance has.
    """
    turned = []
    for row in range(len(exact.points)):
        at = exact.points[[row]]
        turned.append(path_distance(Paths(at, found.section_axes[[row]]), Paths(at, exact.section_axes[[row]])))
    place = path_distance(replace(found, section_axes=exact.section_axes), exact)
    return place, max(turned), float(np.median(turned))


def law(errors: dict[int, float]) -> tuple[float, float]:
    """Power with which errors fall with modes, and the modes that reach COMMON by it."""
    slope = -float(np.polyfit(np.log(list(errors)), np.log(list(errors.values())), 1)[0])
    most = max(errors)
    return slope, most * (errors[most] / COMMON) ** (1.0 / slope)


def replaced(text: str, rows: list[Row]) -> str:
    """The tables of the page with new rows in the place of those of the same case, reference and tolerance."""
    for row in rows:
        lines = [line for line in text.splitlines() if line.startswith(f"| {row.case} |")]
        kept = [line for line in lines if float(line.split(" | ")[2].split(",")[0]) != row.tolerance]
        ordered = sorted([*kept, row.line], key=lambda line: -float(line.split(" | ")[2].split(",")[0]))
        text = text.replace("\n".join(lines), "\n".join(ordered))
    return text


def main(
    cost: Annotated[bool, typer.Option("--cost", help="reference cases at COMMON alone; nothing is written")] = False,
    only: Annotated[str, typer.Option(help="a reference case whose rows in the table are replaced")] = "",
    modes: Annotated[bool, typer.Option("--modes", help="the kicked rod on more and more modes alone")] = False,
) -> None:
    """Run all cases, write the tables."""
    if modes:
        found = [
            "| elements | modes in each | place | turn | turn, median | steps | processor, s |",
            "|---|---|---|---|---|---|---|",
        ]
        for line in kicked_rows():
            found.append(line)
            print(line, flush=True)
        put(ROOT / "docs" / "motion.md", BEGIN_KICKED, END_KICKED, "\n".join(found))
        return
    lines = ["| motion | reference | tolerance | distance | of the reference | estimate | steps | processor, s |"]
    lines.append("|---|---|---|---|---|---|---|---|")
    print("\n".join(lines), flush=True)
    if cost:
        for row in chains_at_common():
            print(row.line, flush=True)
        return
    if only:
        rows = list(chains([only]))
        print("\n".join(row.line for row in rows))
        DOCS.write_text(replaced(DOCS.read_text(), rows))
        return
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
