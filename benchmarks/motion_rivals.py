"""Other packages on one motion: a soft cantilever that is held straight and let go under its weight.

Each has a function that prepares a run and returns it: what it builds once is not timed with the motion. A package
that is not installed, or that fails, has a row that says so.
"""

from __future__ import annotations

import importlib.util
import math
import resource
import time
from collections.abc import Callable, Collection, Iterator
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from cosserat_casadi.maths.typing import FloatArray

LENGTH, RADIUS = 0.5, 0.02
"""m."""

YOUNG, DENSITY = 1e6, 1000.0
"""Pa, kg/m³."""

SHEAR = YOUNG / 3.0
"""Pa: the material keeps its volume."""

GRAVITY = 9.81
"""m/s²."""

AREA = math.pi * RADIUS**2
SECOND_MOMENT = math.pi * RADIUS**4 / 4.0

INTERVAL = 0.1
"""Time between the instants at which the tip is compared, s."""

DURATION = 1.0
"""s."""

TIMES: FloatArray = np.linspace(0.0, DURATION, round(DURATION / INTERVAL) + 1)

REPEATS = 3
"""Runs of which the shortest counts, after a first one; those of all contestants take turns."""

Paths = np.ndarray
"""Positions of the tip at all times, shape (T, 3), m."""

Run = Callable[[], Paths]


@dataclass
class Rival:
    """A point of a package.

    Attributes:
        package: its name.
        setting: what it was run with; why there is no point.
        tip: positions at the times; None where there are none.
        seconds: shortest processor time of a run.
        first: processor time of preparing and of the first run, s.
        run: computes the motion once more; None where there is nothing to time.
    """

    package: str
    setting: str
    tip: Paths | None = None
    seconds: float = math.nan
    first: float = math.nan
    run: Run | None = None

    def again(self) -> None:
        """Compute the motion once more; the shortest processor time counts."""
        if self.run is None:
            return
        begin = time.process_time()
        self.tip = self.run()
        took = time.process_time() - begin
        self.seconds = took if math.isnan(self.seconds) else min(self.seconds, took)


LIMITS = {
    "Exudyn": "Geometrically exact beams in the plane, generalised-α with a spectral radius of 0.9 (C++). "
    "The user chooses elements and steps, and there is no error estimate.",
    "MuJoCo": "The cable of version 3: rigid pieces on ball joints, without shear and extension. "
    "Version 4 has replaced the cable by flexible chains, which have no shear either.",
    "PyElastica": "It is explicit: steps shrink with the elements, and longer steps explode. Its sections shrink as "
    "the rod stretches, ours do not: this is the error that remains with many elements. Its clamp, like the clamp of "
    "MuJoCo's cable, holds the whole first element, so the rod is half an element longer here.",
    "soromox": "It has the same strain coordinates as ours, differentiable, on JAX, and forward dynamics with explicit "
    "steps. The first call compiles model and solver.",
}
"""What a package is, and what it could not do."""


def rivals(packages: Collection[str]) -> Iterator[Rival]:
    """One row for each setting of some packages."""
    for package, module, contestants in (
        ("Exudyn", "exudyn", exudyn_runs()),
        ("MuJoCo", "mujoco", mujoco_runs()),
        ("PyElastica", "elastica", elastica_runs()),
        ("soromox", "soromox", soromox_runs()),
    ):
        if package not in packages:
            continue
        if importlib.util.find_spec(module) is None:
            yield Rival(package, "not installed")
            continue
        for setting, prepare in contestants:
            try:
                yield prepared(package, setting, prepare)
            except Exception as failed:  # a package may break in any way: that is its row
                yield Rival(package, f"{setting}: {type(failed).__name__}, {str(failed).splitlines()[0][:60]}")


def prepared(package: str, setting: str, prepare: Callable[[], Run]) -> Rival:
    """Prepare a run, and run it a first time: processor time of all threads, and of a compiler."""
    begin = with_compiler()
    run = prepare()
    tip = run()
    first = with_compiler() - begin
    if not np.all(np.isfinite(tip)) or np.abs(tip).max() > 2.0 * LENGTH:
        return Rival(package, f"{setting}: exploded")
    return Rival(package, setting, tip, first=first, run=run)


def with_compiler() -> float:
    """Processor time of this process and of those that it started and that have ended, s."""
    children = resource.getrusage(resource.RUSAGE_CHILDREN)
    return time.process_time() + children.ru_utime + children.ru_stime


Contestants = list[tuple[str, Callable[[], Run]]]


def half_an_element_more(elements: int) -> tuple[float, float]:
    """Length of a chain whose first element is clamped, and how far before the clamp it begins, m."""
    length = LENGTH * 2 * elements / (2 * elements - 1)
    return length, length / (2 * elements)


# Exudyn


def exudyn_runs() -> Contestants:
    settings = ((8, 5e-3), (16, 5e-3), (32, 2e-3), (64, 1e-3), (128, 5e-4), (256, 2e-4))
    return [(f"{n} elements, {1e3 * step:g} ms", partial(exudyn_run, n, step)) for n, step in settings]


def exudyn_run(elements: int, step: float) -> Run:
    """Beams in the plane, whose y is up."""
    import exudyn
    import exudyn.itemInterface

    items = exudyn.itemInterface

    def run() -> Paths:
        container = exudyn.SystemContainer()
        system = container.AddSystem()
        size = LENGTH / elements
        nodes = [
            system.AddNode(items.NodeRigidBody2D(referenceCoordinates=[number * size, 0.0, 0.0]))
            for number in range(elements + 1)
        ]
        for number in range(elements):
            beam = items.ObjectBeamGeometricallyExact2D(
                nodeNumbers=nodes[number : number + 2],
                length=size,
                massPerLength=DENSITY * AREA,
                crossSectionInertia=DENSITY * SECOND_MOMENT,
                bendingStiffness=YOUNG * SECOND_MOMENT,
                axialStiffness=YOUNG * AREA,
                shearStiffness=SHEAR * AREA,
                includeReferenceRotations=False,
            )
            mass = system.AddMarker(items.MarkerBodyMass(bodyNumber=system.AddObject(beam)))
            system.AddLoad(items.LoadMassProportional(markerNumber=mass, loadVector=[0.0, -GRAVITY, 0.0]))
        ground = system.AddNode(items.NodePointGround())
        held = system.AddMarker(items.MarkerNodeCoordinate(nodeNumber=ground, coordinate=0))
        for coordinate in range(3):
            base = system.AddMarker(items.MarkerNodeCoordinate(nodeNumber=nodes[0], coordinate=coordinate))
            system.AddObject(items.CoordinateConstraint(markerNumbers=[held, base]))
        position = exudyn.OutputVariableType.Position
        watch = items.SensorNode(nodeNumber=nodes[-1], storeInternal=True, outputVariableType=position)
        sensor = system.AddSensor(watch)
        system.Assemble()
        settings = exudyn.SimulationSettings()
        settings.timeIntegration.endTime = DURATION
        settings.timeIntegration.numberOfSteps = round(DURATION / step)
        settings.timeIntegration.generalizedAlpha.spectralRadius = 0.9
        settings.timeIntegration.newton.useModifiedNewton = True
        settings.solution.file.write = False
        settings.solution.sensors.writePeriod = INTERVAL
        settings.linearSolver.solverType = exudyn.LinearSolverType.EigenSparse
        settings.parallel.numberOfThreads = 1
        system.SolveDynamic(settings)
        found = system.GetSensorStoredData(sensor)
        across = np.interp(TIMES, found[:, 0], found[:, 1])
        up = np.interp(TIMES, found[:, 0], found[:, 2])
        return np.column_stack([across, np.zeros(TIMES.size), up])

    return run


# MuJoCo


def mujoco_runs() -> Contestants:
    settings = ((5, 2e-3), (10, 2e-3), (20, 1e-3), (40, 2e-4), (80, 1e-4))
    return [(f"cable of {n} pieces, {1e3 * step:g} ms", partial(mujoco_run, n, step)) for n, step in settings]


def mujoco_run(elements: int, step: float) -> Run:
    """The composite cable, without contact."""
    import mujoco

    length, before = half_an_element_more(elements)
    model = mujoco.MjModel.from_xml_string(f"""
<mujoco>
  <extension> <plugin plugin="mujoco.elasticity.cable"/> </extension>
  <option timestep="{step}" gravity="0 0 {-GRAVITY}" integrator="implicitfast"> <flag contact="disable"/> </option>
  <worldbody>
    <composite type="cable" prefix="c" curve="s" count="{elements + 1} 1 1" size="{length}" offset="{-before} 0 0"
               initial="none">
      <plugin plugin="mujoco.elasticity.cable">
        <config key="twist" value="{SHEAR}"/> <config key="bend" value="{YOUNG}"/> <config key="flat" value="true"/>
      </plugin>
      <joint kind="main" damping="0"/>
      <geom type="cylinder" size="{RADIUS}" density="{DENSITY}"/>
    </composite>
  </worldbody>
</mujoco>""")
    data = mujoco.MjData(model)
    (tip,) = (number for number in range(model.nsite) if model.site(number).name.endswith("last"))

    def run() -> Paths:
        mujoco.mj_resetData(model, data)
        mujoco.mj_forward(model, data)
        found = [data.site_xpos[tip].copy()]
        for _ in TIMES[1:]:
            for _ in range(round(INTERVAL / step)):
                mujoco.mj_step(model, data)
            mujoco.mj_kinematics(model, data)
            found.append(data.site_xpos[tip].copy())
            # An unstable model begins anew by itself.
            if data.warning.number.sum():
                return np.full((TIMES.size, 3), math.nan)
        return np.array(found)

    return run


# PyElastica


def elastica_runs() -> Contestants:
    settings = ((10, 0.8), (10, 0.4), (20, 0.4), (40, 0.4), (80, 0.4))
    return [(f"{n} elements, {share:g} of a wave's time", partial(elastica_run, n, share)) for n, share in settings]


def elastica_run(elements: int, share: float) -> Run:
    """One rod, clamped, without damping; steps are a share of the time in which a wave crosses an element."""
    import elastica

    class Simulation(elastica.BaseSystemCollection, elastica.Constraints, elastica.Forcing):  # type: ignore[misc]
        """One rod, clamped, with weight."""

    length, before = half_an_element_more(elements)
    wave = min(length / elements, 2.0 * RADIUS) / math.sqrt(YOUNG / DENSITY)
    count = math.ceil(INTERVAL / (share * wave))
    start = np.array([-before, 0.0, 0.0])
    along, across = np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0])

    def run() -> Paths:
        simulation = Simulation()
        rod = elastica.CosseratRod.straight_rod(
            elements, start, along, across, length, RADIUS, DENSITY, youngs_modulus=YOUNG, shear_modulus=SHEAR
        )
        # It corrects the shear of a circle by 27/28; nobody else does here.
        rod.shear_matrix[:2, :2] *= 28.0 / 27.0
        simulation.append(rod)
        clamp = {"constrained_position_idx": (0,), "constrained_director_idx": (0,)}
        simulation.constrain(rod).using(elastica.OneEndFixedBC, **clamp)
        weight = np.array([0.0, 0.0, -GRAVITY])
        simulation.add_forcing_to(rod).using(elastica.GravityForces, acc_gravity=weight)
        simulation.finalize()
        stepper = elastica.PositionVerlet()
        now = 0.0
        found = [rod.position_collection[:, -1].copy()]
        for _ in TIMES[1:]:
            for _ in range(count):
                now = stepper.step(simulation, now, INTERVAL / count)
            found.append(rod.position_collection[:, -1].copy())
        return np.array(found)

    return run


# soromox


def soromox_runs() -> Contestants:
    settings = (
        (2, "semi-implicit Euler", 2e-4),
        (3, "semi-implicit Euler", 2e-4),
        (4, "semi-implicit Euler", 1e-4),
        (4, "Tsit5", 3e-4),
        (5, "Tsit5", 2e-4),
    )
    return [
        (f"order {order}, {solver}, {1e3 * step:g} ms", partial(soromox_run, order, solver, step))
        for order, solver, step in settings
    ]


def soromox_run(order: int, solver: str, step: float) -> Run:
    """Geometric variable strain: all six strains as Legendre polynomials up to an order."""
    import diffrax
    import jax
    import jax.numpy as jnp
    from soromox.simulation.integrators import SemiImplicitEuler
    from soromox.systems.components import JointSpec, LinkSpec
    from soromox.systems.gvs import GVS, GVSSegment, StrainBasisSpec
    from soromox.systems.system_state import SystemState

    jax.config.update("jax_enable_x64", True)
    link = LinkSpec.circular(
        length=LENGTH,
        radius=RADIUS,
        density=DENSITY,
        reference_strain=[0.0, 0.0, 0.0, 1.0, 0.0, 0.0],
        young_modulus=YOUNG,
        shear_modulus=SHEAR,
    )
    strains = ("kappa_x", "kappa_y", "kappa_z", "sigma_x", "sigma_y", "sigma_z")
    basis = StrainBasisSpec("legendre", strains, order)
    segment = GVSSegment(link, JointSpec.fixed(), basis, order + 4)
    pose = jnp.array([0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0])
    robot: Any = GVS.from_segments([segment], gravity=jnp.array([0.0, 0.0, -GRAVITY]), base_pose=pose)
    size = robot.num_coordinates
    method = diffrax.Tsit5() if solver == "Tsit5" else SemiImplicitEuler(robot)

    def moved(state: Any) -> Any:
        begin = SystemState(t=jnp.array(0.0), y=state)
        motion = robot.rollout_to(begin, t1=DURATION, solver_dt=step, save_ts=jnp.asarray(TIMES), solver=method)
        return jax.vmap(lambda q: robot.forward_kinematics(q, jnp.array(LENGTH)))(motion.y[:, :size])

    simulated = jax.jit(moved)

    def run() -> Paths:
        poses = np.asarray(simulated(jnp.zeros(2 * size)))
        return np.asarray(poses[:, :3, 3])

    return run
