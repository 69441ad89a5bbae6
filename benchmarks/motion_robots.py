"""Three motions beside Exudyn, MuJoCo and PyElastica: a push in space, a tendon robot, and a crank that drives a loop.

Every package is compared with digits of this one at a tolerance of 1e-5: one without shear and extension with those of
a rod without, the others with those of a rod that has both. Their points come near those digits on finer models: that
is an independent check of these. Contestants take turns, with an empty cache of compiled code at the beginning.
`--write` puts the table into docs/accuracy.md and draws docs/figures/motion_robots.png. `--only` names a motion that is
run alone, and `--package` the peers that are run beside ours; rows of others stay as the page has them.
"""

from __future__ import annotations

import importlib.util
import math
import os
from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Annotated, Any

import numpy as np
import typer
from doc_tables import put, rows_of, table
from motion_rivals import Paths, Rival, Run, prepared
from rich.progress import Progress

from cosserat_casadi import Motion, scene_from_dict, simulate
from cosserat_casadi.compiling.cache import VARIABLE
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.motion.motion_compiler import MotionCompiler
from cosserat_casadi.motion.pose_series import section_poses
from cosserat_casadi.motion.simulate import Simulator, started
from cosserat_casadi.plots.figure import figure_class, write_figure

DOCS = Path(__file__).parents[1] / "docs"
BEGIN, END = "<!-- robots: written by benchmarks/motion_robots.py -->", "<!-- end of robots -->"
FIGURE = "figures/motion_robots.png"

TOLERANCES = (1e-2, 3e-3, 1e-3, 1e-4)
REFERENCE = 1e-5
"""Tolerance of the digits."""

REPEATS = 3
"""Runs of which the shortest counts, after a first one."""

INSTANTS = 11
"""Times at which positions are compared."""

OURS = "cosserat, from the cache"
BY_DEFAULT = "cosserat, by default"
ON_CHOSEN = "cosserat, one motion on the modes chosen"
"""As in motion_peers.py: with all that chooses and estimates, in machine code and not; the last motion once more."""


@dataclass(frozen=True)
class Rod:
    """A round rod: length and radius in m, Young's modulus in Pa, density in kg/m³, retardation time in s.

    Its shear modulus is a third of Young's modulus, as that of a material that keeps its volume.
    """

    length: float
    radius: float
    young: float
    density: float
    retardation: float = 0.0

    @property
    def shear(self) -> float:
        return self.young / 3.0

    @property
    def area(self) -> float:
        return math.pi * self.radius**2

    @property
    def second_moment(self) -> float:
        return math.pi * self.radius**4 / 4.0

    def table(self, name: str, strain: str) -> dict[str, Any]:
        """It in a scene, along x from the origin."""
        return {
            "name": name,
            "length": self.length,
            "strain": strain,
            "material": {"youngs_modulus": self.young, "poisson_ratio": 0.5, "density": self.density},
            "section": {"shape": "circle", "radius": self.radius},
            "base": {"position": [0, 0, 0], "tangent": [1, 0, 0]},
            "damping": {"retardation_time": self.retardation},
        }


SLENDER = Rod(length=0.5, radius=5e-3, young=30e6, density=1000.0)
BACKBONE = Rod(length=0.4, radius=0.7e-3, young=60e9, density=6450.0, retardation=2e-3)
COUPLER = Rod(length=0.3, radius=2e-3, young=1e9, density=1150.0)

GRAVITY = 9.81
PUSH, PUSHED = 0.1, 0.2
"""Force across the weight, N, and time within which it grows, s."""

OFFSET, TENSIONS, PULLED = 8e-3, (6.0, 8.0), 0.1
"""Of a tendon to the tip and of one to the middle, on the other side: m, N; time within which they are pulled, s."""

CRANK, SLIDER, TURN = 0.1, 0.02, 0.5
"""Length of the crank, m; mass of the slider, kg; time of a turn, s."""


def grown(time: float, within: float) -> float:
    """From 0 to 1 as a cubic that begins and ends at rest."""
    share = min(time / within, 1.0)
    return share * share * (3.0 - 2.0 * share)


def turned(time: float) -> tuple[FloatArray, FloatArray]:
    """Pin of the crank and its velocity, in the plane, m and m/s."""
    share = min(time / TURN, 1.0)
    angle = 2.0 * math.pi * grown(time, TURN)
    rate = 2.0 * math.pi * 6.0 * share * (1.0 - share) / TURN
    along = np.array([math.cos(angle), math.sin(angle)])
    across = np.array([-along[1], along[0]])
    return CRANK * along, CRANK * rate * across


def ramp(name: str, within: float, value: Any) -> dict[str, Any]:
    """A motion of an input that begins at zero."""
    start = [0.0] * len(value) if isinstance(value, list) else 0.0
    return {"input": name, "times": [0.0, within], "values": [start, value], "interpolation": "cubic"}


def pushed(strain: str) -> dict[str, Any]:
    weight = {"name": "weight", "kind": "gravity", "acceleration": [0, 0, -GRAVITY]}
    push = {"name": "push", "kind": "tip_wrench", "rod": "rod", "force": [0, 0, 0]}
    motions = [ramp("push.force", PUSHED, [0.0, PUSH, 0.0])]
    return {"rods": [SLENDER.table("rod", strain)], "loads": [weight, push], "motions": motions}


def pulled(strain: str) -> dict[str, Any]:
    tendon = {"kind": "tendon", "rod": "rod", "tension": 0.0}
    tendons = [
        {"name": "upper", **tendon, "offset": [OFFSET, 0.0]},
        {"name": "lower", **tendon, "offset": [-OFFSET, 0.0], "span": [0.0, 0.5]},
    ]
    motions = [ramp(f"{one['name']}.tension", PULLED, force) for one, force in zip(tendons, TENSIONS, strict=True)]
    return {"rods": [BACKBONE.table("rod", strain)], "actuators": tendons, "motions": motions}


def driven(strain: str) -> dict[str, Any]:
    def hinge(carrier: dict[str, Any], carried: dict[str, Any], **more: Any) -> dict[str, Any]:
        return {"kind": "revolute", "axis": [0, 1, 0], "between": [carrier, carried], **more}

    rod = COUPLER.table("rod", strain)
    rod["base"] = {"tangent": [1, 0, 0]}
    solid = {"mass": SLIDER, "inertia": [1e-6, 1e-6, 1e-6]}
    guide = {"world": True, "position": [CRANK + COUPLER.length, 0, 0]}
    joints = [
        hinge({"world": True, "position": [0, 0, 0]}, {"body": "arm"}, name="crank", angle=0.0),
        hinge({"body": "arm", "position": [CRANK, 0, 0]}, {"rod": "rod", "at": 0.0}),
        hinge({"rod": "rod"}, {"body": "slider"}),
        {"kind": "prismatic", "axis": [1, 0, 0], "between": [guide, {"body": "slider"}]},
    ]
    bodies = [{"name": name, **solid} for name in ("arm", "slider")]
    # About y a turn from x towards z is a negative one.
    motions = [ramp("crank.angle", TURN, -2.0 * math.pi)]
    return {"rods": [rod], "bodies": bodies, "joints": joints, "motions": motions, "inputs": ["crank.angle"]}


@dataclass(frozen=True)
class Case:
    """A motion.

    Attributes:
        title: what moves.
        rod: its rod.
        tables: its scene with a strain model, without accuracy and time.
        plain: strain model without shear and extension.
        sheared: with both.
        at: share of the length at which positions are compared.
        duration: s.
        start: where the scene begins.
    """

    title: str
    rod: Rod
    tables: Callable[[str], dict[str, Any]]
    plain: str
    sheared: str
    at: float
    duration: float
    start: str = "equilibrium"

    @property
    def times(self) -> FloatArray:
        """When positions are compared, s."""
        return np.linspace(0.0, self.duration, INSTANTS)

    def moved(self, strain: str, tolerance: float, compiled: bool | None = None) -> Motion:
        """The motion by this package."""
        simulation = {
            "duration": self.duration,
            "times": self.times.tolist(),
            "tolerance": tolerance,
            "start": self.start,
        }
        scene = scene_from_dict({"schema": 1, **self.tables(strain), "simulation": simulation})
        return simulate(scene, compiled=compiled)

    def watched(self, motion: Motion) -> Paths:
        """Positions of the section at the times, shape (T, 3), m."""
        return np.asarray(motion.section("rod", self.at).position)


CASES = {
    "push": Case("a push in space", SLENDER, pushed, "kirchhoff", "reissner", 1.0, 1.0, "unloaded"),
    "tendons": Case("a tendon robot in its plane", BACKBONE, pulled, "planar", "planar", 1.0, 0.5),
    "crank": Case("a crank that drives a loop", COUPLER, driven, "planar", "planar", 0.5, TURN),
}


def motions_of(case: Case) -> Iterator[Rival]:
    """Ours at each tolerance: from the cache, as it comes by default, and the last motion once more by itself."""
    for tolerance in TOLERANCES:
        motions = list[Motion]()
        both = [
            prepared(package, "", partial(chosen, case, tolerance, compiled, motions))
            for package, compiled in ((BY_DEFAULT, None), (OURS, True))
        ]
        motion = motions[-1]
        words = f"tolerance {tolerance:.0e}, estimate {motion.error_estimate:.0e}"
        if not motion.converged:
            yield Rival(OURS, f"{words}: {motion.outcome.name.lower()}")
            continue
        for rival in both:
            rival.setting = words
            yield rival
        yield prepared(ON_CHOSEN, f"{words}, {motion.model.size} unknowns", partial(again, case, motion, tolerance))


def chosen(case: Case, tolerance: float, compiled: bool | None, motions: list[Motion]) -> Run:
    """The motion with all that chooses and estimates; it is appended to the motions."""
    folder = Path(os.environ[VARIABLE]).with_name("compiled" if compiled else "default")

    def run() -> Paths:
        # What one of both has compiled is nothing to the other.
        os.environ[VARIABLE] = str(folder)
        motions.append(case.moved(case.plain, tolerance, compiled))
        return case.watched(motions[-1])

    return run


def again(case: Case, motion: Motion, tolerance: float) -> Run:
    """The motion on the same modes, once, with steps of a tolerance: nothing is chosen, and no error estimated."""
    simulation = motion.model.scene.simulation
    assert simulation is not None
    start = started(motion.model, simulation, None)
    simulator = Simulator(motion.model, simulation, start, source=MotionCompiler(always=True))

    def run() -> Paths:
        history = simulator.controlled(tolerance)
        x, inputs = history.rough_positions(case.times)
        return np.asarray(section_poses(motion.model, "rod", case.at, x, inputs).position)

    return run


# Exudyn


def exudyn_solved(container: Any, system: Any, node: int, case: Case, step: float) -> Paths:
    """Paths of a node of an Exudyn system."""
    import exudyn
    from exudyn import itemInterface as items  # noqa: N813

    position = exudyn.OutputVariableType.Position
    watch = items.SensorNode(nodeNumber=node, storeInternal=True, outputVariableType=position)
    sensor = system.AddSensor(watch)
    system.Assemble()
    settings = exudyn.SimulationSettings()
    settings.timeIntegration.endTime = case.duration
    settings.timeIntegration.numberOfSteps = round(case.duration / step)
    settings.timeIntegration.generalizedAlpha.spectralRadius = 0.9
    settings.timeIntegration.newton.useModifiedNewton = True
    # Rods of metal do not reach the tolerances that it has by default, 1e-8 and 1e-10, and halve their steps in vain.
    settings.timeIntegration.newton.relativeTolerance = 1e-5
    settings.timeIntegration.newton.absoluteTolerance = 1e-6
    settings.solution.file.write = False
    settings.solution.sensors.writePeriod = case.duration / (INSTANTS - 1)
    settings.linearSolver.solverType = exudyn.LinearSolverType.EigenSparse
    settings.parallel.numberOfThreads = 1
    system.SolveDynamic(settings)
    found = system.GetSensorStoredData(sensor)
    return np.column_stack([np.interp(case.times, found[:, 0], found[:, axis]) for axis in (1, 2, 3)])


def exudyn_in_plane(system: Any, rod: Rod, elements: int, start: float = 0.0) -> list[int]:
    """Nodes of a rod of geometrically exact beams along x, in the plane."""
    from exudyn import itemInterface as items  # noqa: N813

    size = rod.length / elements
    nodes = [
        system.AddNode(items.NodeRigidBody2D(referenceCoordinates=[start + number * size, 0.0, 0.0]))
        for number in range(elements + 1)
    ]
    bending, axial, shear = rod.young * rod.second_moment, rod.young * rod.area, rod.shear * rod.area
    for number in range(elements):
        beam = items.ObjectBeamGeometricallyExact2D(
            nodeNumbers=nodes[number : number + 2],
            length=size,
            massPerLength=rod.density * rod.area,
            crossSectionInertia=rod.density * rod.second_moment,
            bendingStiffness=bending,
            axialStiffness=axial,
            shearStiffness=shear,
            bendingDamping=rod.retardation * bending,
            axialDamping=rod.retardation * axial,
            shearDamping=rod.retardation * shear,
            includeReferenceRotations=False,
        )
        system.AddObject(beam)
    return nodes


def exudyn_held(system: Any, node: int, coordinates: Sequence[int], moved: Sequence[Any] = ()) -> None:
    """Hold coordinates of a node, or move them as functions of time."""
    from exudyn import itemInterface as items  # noqa: N813

    ground = system.AddMarker(
        items.MarkerNodeCoordinate(nodeNumber=system.AddNode(items.NodePointGround()), coordinate=0)
    )
    for place, coordinate in enumerate(coordinates):
        marker = system.AddMarker(items.MarkerNodeCoordinate(nodeNumber=node, coordinate=coordinate))
        more = {"offsetUserFunction": moved[place]} if moved else {}
        system.AddObject(items.CoordinateConstraint(markerNumbers=[ground, marker], **more))


def exudyn_push(case: Case, elements: int, step: float) -> Run:
    """Geometrically exact beams in space, interpolated on SE(3)."""
    import exudyn
    from exudyn import itemInterface as items  # noqa: N813

    rod = case.rod
    section = exudyn.BeamSection()
    shear, bending = rod.shear * rod.area, rod.young * rod.second_moment
    inertia = rod.density * rod.second_moment
    section.stiffnessMatrix = np.diag(
        [rod.young * rod.area, shear, shear, 2 * rod.shear * rod.second_moment, bending, bending]
    )
    section.inertia = np.diag([2.0 * inertia, inertia, inertia])
    section.massPerLength = rod.density * rod.area

    def force(_: Any, time: float, vector: Any) -> list[float]:
        return [0.0, PUSH * grown(time, PUSHED), 0.0]

    def run() -> Paths:
        container = exudyn.SystemContainer()
        system = container.AddSystem()
        size = rod.length / elements
        upright = [1.0, 0.0, 0.0, 0.0]
        nodes = [
            system.AddNode(items.NodeRigidBodyEP(referenceCoordinates=[number * size, 0.0, 0.0, *upright]))
            for number in range(elements + 1)
        ]
        for number in range(elements):
            beam = items.ObjectBeamGeometricallyExact(
                nodeNumbers=nodes[number : number + 2], length=size, sectionData=section
            )
            mass = system.AddMarker(items.MarkerBodyMass(bodyNumber=system.AddObject(beam)))
            system.AddLoad(items.LoadMassProportional(markerNumber=mass, loadVector=[0.0, 0.0, -GRAVITY]))
        ground = system.AddMarker(items.MarkerBodyRigid(bodyNumber=system.AddObject(items.ObjectGround())))
        base = system.AddMarker(items.MarkerNodeRigid(nodeNumber=nodes[0]))
        system.AddObject(items.GenericJoint(markerNumbers=[ground, base]))
        tip = system.AddMarker(items.MarkerNodeRigid(nodeNumber=nodes[-1]))
        system.AddLoad(items.LoadForceVector(markerNumber=tip, loadVectorUserFunction=force))
        return exudyn_solved(container, system, nodes[-1], case, step)

    return run


def exudyn_tendons(case: Case, elements: int, step: float) -> Run:
    """Each tendon as the couple at its end: what it is to a rod that keeps its length."""
    import exudyn
    from exudyn import itemInterface as items  # noqa: N813

    def couple(value: float) -> Callable[[Any, float, Any], list[float]]:
        return lambda _, time, vector: [0.0, 0.0, value * grown(time, PULLED)]

    def run() -> Paths:
        container = exudyn.SystemContainer()
        system = container.AddSystem()
        nodes = exudyn_in_plane(system, case.rod, elements)
        exudyn_held(system, nodes[0], range(3))
        for node, value in ((nodes[-1], -TENSIONS[0] * OFFSET), (nodes[elements // 2], TENSIONS[1] * OFFSET)):
            marker = system.AddMarker(items.MarkerNodeRigid(nodeNumber=node))
            system.AddLoad(items.LoadTorqueVector(markerNumber=marker, loadVectorUserFunction=couple(value)))
        found = exudyn_solved(container, system, nodes[-1], case, step)
        return found[:, [0, 2, 1]]

    return run


def exudyn_crank(case: Case, elements: int, step: float) -> Run:
    """Constraints move the pin; the slider is a body on the last node."""
    import exudyn
    from exudyn import itemInterface as items  # noqa: N813

    pin = [
        lambda _, time, item, offset: float(turned(time)[0][0]) - CRANK,
        lambda _, time, item, offset: float(turned(time)[0][1]),
    ]

    def run() -> Paths:
        container = exudyn.SystemContainer()
        system = container.AddSystem()
        nodes = exudyn_in_plane(system, case.rod, elements, CRANK)
        exudyn_held(system, nodes[0], (0, 1), pin)
        exudyn_held(system, nodes[-1], (1,))
        slider = system.AddNode(items.NodePoint2D(referenceCoordinates=[CRANK + case.rod.length, 0.0]))
        system.AddObject(items.ObjectMassPoint2D(mass=SLIDER, nodeNumber=slider))
        for coordinate in (0, 1):
            both = [
                system.AddMarker(items.MarkerNodeCoordinate(nodeNumber=node, coordinate=coordinate))
                for node in (slider, nodes[-1])
            ]
            system.AddObject(items.CoordinateConstraint(markerNumbers=both))
        found = exudyn_solved(container, system, nodes[elements // 2], case, step)
        return found[:, [0, 2, 1]]

    return run


# MuJoCo


def half_more(rod: Rod, elements: int) -> float:
    """Length of an element of a chain whose first one is clamped as a whole, and begins half of it before the clamp."""
    return rod.length * 2.0 / (2 * elements - 1)


def mujoco_cable(rod: Rod, elements: int, size: float, before: float, first: str, twist: float) -> str:
    """A chain of pieces, the first held or on a ball joint."""
    damping = rod.retardation * rod.young * rod.second_moment / size
    return f"""
    <composite type="cable" prefix="c" curve="s" count="{elements + 1} 1 1" size="{size * elements}"
               offset="{before} 0 0" initial="{first}">
      <plugin plugin="mujoco.elasticity.cable">
        <config key="twist" value="{twist}"/> <config key="bend" value="{rod.young}"/> <config key="flat" value="true"/>
      </plugin>
      <joint kind="main" damping="{damping}"/>
      <geom type="cylinder" size="{rod.radius}" density="{rod.density}"/>
    </composite>"""


def mujoco_run(case: Case, step: float, world: str, act: Callable[[Any, Any], None], site: tuple[str, float]) -> Run:
    """A scene with forces of time; the place that is watched is in the axes of a body."""
    import mujoco

    weight = GRAVITY if case.tables is pushed else 0.0
    model = mujoco.MjModel.from_xml_string(f"""
<mujoco>
  <extension> <plugin plugin="mujoco.elasticity.cable"/> </extension>
  <option timestep="{step}" gravity="0 0 {-weight}" integrator="implicitfast"> <flag contact="disable"/> </option>
  {world}
</mujoco>""")
    data = mujoco.MjData(model)
    body = model.body(site[0]).id

    def place() -> FloatArray:
        return np.asarray(data.xpos[body] + site[1] * data.xmat[body].reshape(3, 3)[:, 0])

    def run() -> Paths:
        mujoco.mj_resetData(model, data)
        mujoco.mj_forward(model, data)
        found = [place()]
        for _ in case.times[1:]:
            for _ in range(round(case.times[1] / step)):
                act(model, data)
                mujoco.mj_step(model, data)
            mujoco.mj_kinematics(model, data)
            found.append(place())
            # An unstable model begins anew by itself.
            if data.warning.number.sum():
                return np.full((INSTANTS, 3), math.nan)
        return np.array(found)

    return run


def mujoco_push(case: Case, elements: int, step: float) -> Run:
    """The composite cable, whose last piece is pushed at its end."""
    size = half_more(case.rod, elements)
    cable = mujoco_cable(case.rod, elements, size, -size / 2, "none", case.rod.shear)

    def act(model: Any, data: Any) -> None:
        last = model.nbody - 1
        force = np.array([0.0, PUSH * grown(data.time, PUSHED), 0.0])
        arm = size / 2 * data.xmat[last].reshape(3, 3)[:, 0]
        data.xfrc_applied[last] = [*force, *np.cross(arm, force)]

    return mujoco_run(case, step, f"<worldbody>{cable}</worldbody>", act, ("cB_last", size))


def mujoco_tendons(case: Case, elements: int, step: float) -> Run:
    """Tendons as couples; without stiffness against twist, which nothing excites and which would need shorter steps."""
    size = half_more(case.rod, elements)
    cable = mujoco_cable(case.rod, elements, size, -size / 2, "none", 0.0)
    # A couple on a piece bends the chain up to that piece's middle: two pieces share the couple at the rod's middle.
    pieces, over = divmod(case.rod.length / 2 / size, 1.0)
    middle, weights = 1 + int(pieces), np.array([1.0 - over, over])

    def act(model: Any, data: Any) -> None:
        share = OFFSET * grown(data.time, PULLED)
        # About y a turn towards z is a negative one.
        data.xfrc_applied[model.nbody - 1, 4] = TENSIONS[0] * share
        data.xfrc_applied[middle : middle + 2, 4] = -TENSIONS[1] * share * weights

    return mujoco_run(case, step, f"<worldbody>{cable}</worldbody>", act, ("cB_last", size))


def mujoco_crank(case: Case, elements: int, step: float) -> Run:
    """A crank of large inertia turns the cable's first pin; an equality holds its end at the slider."""
    size, inertia = case.rod.length / elements, 1e3
    cable = mujoco_cable(case.rod, elements, size, CRANK, "ball", 0.0)
    world = f"""
  <worldbody>
    <body name="crank"> <joint type="hinge" axis="0 -1 0"/>
      <inertial pos="0 0 0" mass="1" diaginertia="{inertia} {inertia} {inertia}"/> {cable} </body>
    <body name="slider" pos="{CRANK + case.rod.length} 0 0"> <joint type="slide" axis="1 0 0"/>
      <inertial pos="0 0 0" mass="{SLIDER}" diaginertia="1e-6 1e-6 1e-6"/> </body>
  </worldbody>
  <equality> <connect body1="cB_last" body2="slider" anchor="{size} 0 0" solref="{4 * step} 1"/> </equality>"""

    def act(model: Any, data: Any) -> None:
        share = data.time / TURN
        data.qfrc_applied[0] = inertia * 2.0 * math.pi * 6.0 * (1.0 - 2.0 * share) / TURN**2

    return mujoco_run(case, step, world, act, (f"cB_{elements // 2}", 0.0))


# PyElastica


def elastica_run(case: Case, elements: int, share: float) -> Run:
    """One rod without damping; steps are a share of the time in which a wave crosses an element."""
    import elastica

    class Simulation(elastica.BaseSystemCollection, elastica.Constraints, elastica.Forcing):  # type: ignore[misc]
        """One rod with forces and constraints."""

    class Pushed(elastica.NoForces):  # type: ignore[misc]
        """The push at the tip."""

        def apply_forces(self, system: Any, time: float = 0.0) -> None:
            system.external_forces[1, -1] += PUSH * grown(time, PUSHED)

    class Driven(elastica.ConstraintBase):  # type: ignore[misc]
        """The pin on its circle, the slider on its line."""

        def constrain_values(self, system: Any, time: float) -> None:
            pin, _ = turned(time)
            system.position_collection[:, 0] = pin[0], 0.0, pin[1]
            system.position_collection[1:, -1] = 0.0

        def constrain_rates(self, system: Any, time: float) -> None:
            _, rate = turned(time)
            system.velocity_collection[:, 0] = rate[0], 0.0, rate[1]
            system.velocity_collection[1:, -1] = 0.0

    rod, loop = case.rod, case.tables is driven
    size = rod.length / elements if loop else half_more(rod, elements)
    start = np.array([CRANK if loop else -size / 2, 0.0, 0.0])
    count = math.ceil(case.times[1] / (share * min(size, 2.0 * rod.radius) / math.sqrt(rod.young / rod.density)))
    node = elements // 2 if loop else elements

    def run() -> Paths:
        simulation = Simulation()
        along, across = np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0])
        moduli = {"youngs_modulus": rod.young, "shear_modulus": rod.shear}
        straight = elastica.CosseratRod.straight_rod
        body = straight(elements, start, along, across, size * elements, rod.radius, rod.density, **moduli)
        # It corrects the shear of a circle by 27/28; nobody else does here.
        body.shear_matrix[:2, :2] *= 28.0 / 27.0
        simulation.append(body)
        if loop:
            body.mass[-1] += SLIDER
            simulation.constrain(body).using(Driven)
        else:
            clamp = {"constrained_position_idx": (0,), "constrained_director_idx": (0,)}
            simulation.constrain(body).using(elastica.OneEndFixedBC, **clamp)
            weight = np.array([0.0, 0.0, -GRAVITY])
            simulation.add_forcing_to(body).using(elastica.GravityForces, acc_gravity=weight)
            simulation.add_forcing_to(body).using(Pushed)
        simulation.finalize()
        stepper = elastica.PositionVerlet()
        now = 0.0
        found = [body.position_collection[:, node].copy()]
        for _ in case.times[1:]:
            for _ in range(count):
                now = stepper.step(simulation, now, case.times[1] / count)
            found.append(body.position_collection[:, node].copy())
        return np.array(found)

    return run


MODULES = {"Exudyn": "exudyn", "MuJoCo": "mujoco", "PyElastica": "elastica"}
MODELS: dict[str, dict[str, Callable[[Case, int, float], Run]]] = {
    "Exudyn": {"push": exudyn_push, "tendons": exudyn_tendons, "crank": exudyn_crank},
    "MuJoCo": {"push": mujoco_push, "tendons": mujoco_tendons, "crank": mujoco_crank},
    "PyElastica": {"push": elastica_run, "crank": elastica_run},
}
SETTINGS = {
    "Exudyn": ((4, 1e-2), (8, 5e-3), (16, 2e-3), (32, 1e-3), (64, 5e-4)),
    "MuJoCo": ((5, 5e-4), (10, 2e-4), (20, 5e-5)),
    "PyElastica": ((20, 0.4),),
}
"""Elements, and the step in s, of PyElastica as a share of the time in which a wave crosses an element."""

LIMITS = (
    "In the other packages a tendon is a couple at its end, which is equivalent for a rod that keeps its length.",
    "PyElastica does not have the backbone: it has no damping in the material, and its steps would be 0.2 µs. In the "
    "loop its nodes are put on circle and line, and the mass of the slider is added to its last node.",
    "MuJoCo's crank has a large inertia and is turned by a moment; a soft constraint holds the slider at the cable.",
    "soromox has only chains, and explicit steps, so it is only in the table above. cardillo is not in the package "
    "index of this run.",
)


def rivals(name: str, case: Case, packages: Collection[str]) -> Iterator[Rival]:
    """One row for each setting of the peers."""
    for package in packages:
        if name not in MODELS[package]:
            continue
        if importlib.util.find_spec(MODULES[package]) is None:
            yield Rival(package, "not installed")
            continue
        for elements, step in SETTINGS[package]:
            words = f"{elements} elements, " + (
                f"{step:g} of a wave's time" if package == "PyElastica" else f"{1e3 * step:g} ms"
            )
            try:
                yield prepared(package, words, partial(MODELS[package][name], case, elements, step))
            except Exception as failed:  # a package may break in any way: that is its row
                yield Rival(package, f"{words}: {type(failed).__name__}")


HEADINGS = ("motion", "package", "", "error / L", "processor, s", "with first call, s")


def cells(name: str, row: Rival, digits: dict[str, Paths]) -> list[str]:
    """A row of the table."""
    if row.tip is None:
        return [CASES[name].title, row.package, row.setting, "–", "–", "–"]
    case = CASES[name]
    # MuJoCo's chain neither shears nor stretches, as ours here.
    strain = case.sheared if row.package in ("Exudyn", "PyElastica") else case.plain
    error = np.linalg.norm(row.tip - digits[strain], axis=1).max() / case.rod.length
    return [case.title, row.package, row.setting, f"{error:.1e}", f"{row.seconds:.2g}", f"{row.first:.2g}"]


STYLES = {
    OURS: ("#bb5566", "v"),
    BY_DEFAULT: ("#ee8866", "P"),
    ON_CHOSEN: ("#cc3311", "*"),
    "Exudyn": ("#4477aa", "o"),
    "MuJoCo": ("#228833", "s"),
    "PyElastica": ("#777777", "D"),
}
"""Colour and marker of every contestant."""


def drawn(lines: Sequence[Sequence[str]]) -> Any:
    """Error against processor time, a panel for each motion."""
    figure = figure_class()(figsize=(10.0, 4.2), layout="constrained")
    for axes, case in zip(figure.subplots(1, len(CASES), sharey=True, squeeze=False)[0], CASES.values(), strict=True):
        for package, (colour, marker) in STYLES.items():
            of_package = [line for line in lines if line[:2] == [case.title, package] and line[3] != "–"]
            points = sorted((float(line[4]), float(line[3])) for line in of_package)
            if not points:
                continue
            times, errors = zip(*points, strict=True)
            axes.loglog(times, errors, marker=marker, markersize=6, color=colour, linewidth=1.2, label=package)
        axes.set_title(case.title, fontsize=10)
        axes.set_xlabel("processor time, s")
        axes.grid(alpha=0.3)
    figure.axes[0].set_ylabel("error / length")
    handles, labels = figure.axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=6, fontsize=7.5)
    return figure


def on_page(name: str) -> list[list[str]]:
    """Rows of a motion that the page has."""
    return [row for row in rows_of(DOCS / "accuracy.md", BEGIN, END) if row[0] == CASES[name].title]


def main(
    write: Annotated[bool, typer.Option("--write", help="Put table and figure into docs.")] = False,
    only: Annotated[
        str, typer.Option(help="The motion that is run: push, tendons or crank; rows of others are kept.")
    ] = "",
    package: Annotated[
        list[str] | None, typer.Option(help="A peer that is run beside ours; may be repeated. Rows of others are kept.")
    ] = None,
) -> None:
    """Print the table."""
    packages = package or list(MODULES)
    lines = []
    with TemporaryDirectory() as cache, Progress(transient=True) as bar:
        for name in bar.track(CASES, description="moving"):
            if only not in ("", name):
                lines += on_page(name)
                continue
            case = CASES[name]
            os.environ[VARIABLE] = f"{cache}/{name}/default"
            rows = [*motions_of(case), *rivals(name, case, packages)]
            for _ in range(REPEATS):
                for row in rows:
                    row.again()
            digits = {strain: case.watched(case.moved(strain, REFERENCE)) for strain in (case.plain, case.sheared)}
            kept = [row for row in on_page(name) if row[1] in MODULES and row[1] not in packages]
            lines += [*(cells(name, row, digits) for row in rows), *kept]
    text = "\n".join([table(HEADINGS, lines), "", *(f"* {words}" for words in LIMITS)])
    print(text)
    if write:
        picture = f"![Error against processor time, three motions]({FIGURE})"
        put(DOCS / "accuracy.md", BEGIN, END, f"{text}\n\n{picture}")
        write_figure(drawn(lines), DOCS / FIGURE, dpi=110)


if __name__ == "__main__":
    typer.run(main)
