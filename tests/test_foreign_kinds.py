"""The families are open: a member of each that does not ship, known to this file alone, runs through everything.

Each is one record, one class and one registration. Nothing else of the package, its documents or its tests has heard
of them.
"""

from __future__ import annotations

import csv
import json
import shutil
import tomllib
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, ClassVar, Literal

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose
from pydantic import Field

from cosserat_casadi import (
    Model,
    Outcome,
    Scene,
    SceneError,
    Solution,
    build,
    export,
    follow,
    identify,
    inverse,
    load,
    modes_of,
    parse_scene,
    scene_from_dict,
    simulate,
    solve,
)
from cosserat_casadi.actuators.actuator import Actuator
from cosserat_casadi.cli.exit_codes import REFUSED
from cosserat_casadi.constraints.held_directions import NONE, across
from cosserat_casadi.constraints.section_constraint import HeldDirections
from cosserat_casadi.constraints.tip_holder import Joint, Support
from cosserat_casadi.control.targets import Target, TargetMiss, length_of
from cosserat_casadi.identification.measured_quantities import MeasurementSite, StateQuantity
from cosserat_casadi.loads.load import Load, Section
from cosserat_casadi.maths.grid import Grid
from cosserat_casadi.maths.typing import FloatArray, Matrix
from cosserat_casadi.model.scene_rods import rod_properties
from cosserat_casadi.model.sections import CrossSection, Sizes
from cosserat_casadi.motion.trajectory import MotionOutcome
from cosserat_casadi.obstacles.obstacle import Obstacle
from cosserat_casadi.obstacles.obstacle import across as normal_to
from cosserat_casadi.page.page_facts import page_facts
from cosserat_casadi.plots.scene_plot import plot_solution
from cosserat_casadi.rod.actuation import StrainSum
from cosserat_casadi.rod.section import SectionShape
from cosserat_casadi.scene.actuator_records import ActuatorRecord
from cosserat_casadi.scene.constraint_records import JointRecord, SupportRecord
from cosserat_casadi.scene.faults import Fault, SceneTables, Table
from cosserat_casadi.scene.input_fields import InputField
from cosserat_casadi.scene.load_records import LoadRecord
from cosserat_casadi.scene.measurement_record import MovingMeasurement
from cosserat_casadi.scene.obstacle_records import ObstacleRecord
from cosserat_casadi.scene.rod_records import SectionRecord
from cosserat_casadi.scene.target_records import TargetRecord
from cosserat_casadi.scene.values import Direction, Positive, Size, Vector
from tests.commands import cosserat
from tests.derivatives import central_differences
from tests.families import mostly_slow
from tests.registration import registered
from tests.shooting_near import integrate

STIFFNESS = 3.0
ANCHOR = np.array([0.15, 0.05, 0.25])
MOMENT = 0.02


class SpringRecord(LoadRecord):
    """A spring from a section to a point of the world."""

    inputs: ClassVar[Mapping[str, InputField]] = {
        "anchor": InputField("m", 3, axes="world"),
        "stiffness": InputField("N/m", 1, positive=True),
    }
    references: ClassVar[Mapping[str, str]] = {"rod": "rods"}

    kind: Literal["spring_to_point"] = Field(description="spring from a section to a point of the world")
    rod: str = Field(description="name of the rod that it is tied to")
    at: float = Field(1.0, gt=0.0, le=1.0, description="abscissa X of the section, without unit")
    anchor: tuple[float, float, float] = Field(description="the point of the world, m")
    stiffness: float = Field(gt=0.0, description="force per length, N/m")


class Spring(Load[SpringRecord]):
    """k (a − r) on the section."""

    record = SpringRecord

    def abscissa(self, load: SpringRecord) -> float:
        return load.at

    def energy(self, load: SpringRecord, section: Section, values: Mapping[str, Matrix]) -> Matrix:
        return values["stiffness"] / 2 * ca.sumsqr(section.position - values["anchor"])


class MuscleRecord(ActuatorRecord):
    """A muscle along the rod that bends it."""

    inputs: ClassVar[Mapping[str, InputField]] = {"contraction": InputField("N m", 1, lower=0.0)}
    references: ClassVar[Mapping[str, str]] = {"rod": "rods"}

    kind: Literal["fibre"] = Field(description="muscle along the rod")
    rod: str = Field(description="name of the rod that it bends")
    span: tuple[float, float] = Field((0.0, 1.0), description="where it begins and ends, X, without unit")
    contraction: float = Field(ge=0.0, description="bending moment, N m")


class Muscle(Actuator[MuscleRecord]):
    """A moment that works on the total turn about the y axis of the sections."""

    record = MuscleRecord
    effort = "contraction"
    conjugate = "turn"
    conjugate_unit = "rad"
    energy_sign = -1.0

    def quantity(self, actuator: MuscleRecord, grid: Grid) -> StrainSum:
        inside = (grid.nodes >= actuator.span[0]) & (grid.nodes <= actuator.span[1])
        return StrainSum((1,), inside[None, :].astype(float))


class TeeRecord(SectionRecord):
    """A T: a flange along x on top of a web along y."""

    shape: Literal["tee"] = Field(description="flange on a web")
    flange: Size = Field(description="width of the flange along x, m")
    web: Size = Field(description="height of the web along y, m")
    wall: Size = Field(description="thickness of both, m")


class Tee(CrossSection[TeeRecord]):
    """Two rectangles about their common centroid; torsion as of thin walls."""

    record = TeeRecord

    def shape(self, sizes: Sizes) -> SectionShape:
        flange, web, wall = (sizes[key] for key in ("flange", "web", "wall"))
        flange_area, web_area = flange * wall, web * wall
        area = flange_area + web_area
        # Between the centroids of the two.
        distance = (web + wall) / 2
        return SectionShape(
            area=area,
            second_moment_x=(flange * wall**3 + wall * web**3) / 12 + flange_area * web_area / area * distance**2,
            second_moment_y=(wall * flange**3 + web * wall**3) / 12,
            torsion_constant=(flange + web) * wall**3 / 3,
        )

    def half_widths(self, sizes: Sizes) -> tuple[Any, Any]:
        return sizes["flange"] / 2, (sizes["web"] + sizes["wall"]) / 2


class CylindricalRecord(JointRecord):
    """The tip of a rod slides along one axis of a body and turns about it."""

    kind: Literal["cylindrical"] = Field(description="the tip slides along one axis of the body and turns about it")
    axis: Direction = Field(description="axis through the joint's position, in the axes of the body, without unit")


class Cylindrical(Joint[CylindricalRecord]):
    """Held across the axis."""

    record = CylindricalRecord

    def held(self, record: CylindricalRecord, rotation: FloatArray) -> HeldDirections:
        across_axis = across(record.axis, rotation)
        return HeldDirections(across_axis, across_axis, turn_with_pose=True)


class RollerRecord(SupportRecord):
    """The tip of a rod stays in a plane."""

    kind: Literal["roller"] = Field(description="the tip rolls on a plane")
    axis: Direction = Field(description="normal of the plane through the position, world axes, without unit")

    @classmethod
    def scene_conflicts(cls, given: Table, scene: SceneTables) -> Iterator[Fault]:
        yield from ()


class Roller(Support[RollerRecord]):
    """Held along the normal of the plane alone."""

    record = RollerRecord

    def held(self, record: RollerRecord, rotation: FloatArray) -> HeldDirections:
        normal = rotation.T @ np.asarray(record.axis) / np.linalg.norm(record.axis)
        return HeldDirections(normal[:, None], NONE, turn_with_pose=True)


class EndlessBarRecord(ObstacleRecord):
    """A round bar without ends."""

    kind: Literal["endless_bar"] = Field(description="round bar without ends")
    point: Vector = Field(description="a point of its axis, world axes, m")
    axis: Direction = Field(description="direction of its axis, world axes, without unit")
    radius: Positive = Field(description="its radius, m")

    @property
    def thickness(self) -> float:
        return 2 * self.radius


class EndlessBar(Obstacle[EndlessBarRecord]):
    """All that is nearer to a line than a radius."""

    record = EndlessBarRecord

    def distance(self, obstacle: EndlessBarRecord, point: Matrix) -> Matrix:
        axis = ca.DM(obstacle.axis) / ca.norm_2(ca.DM(obstacle.axis))
        return ca.norm_2(ca.cross(axis, point - ca.DM(obstacle.point))) - obstacle.radius

    def mesh(self, obstacle: EndlessBarRecord, near: FloatArray, size: float) -> FloatArray:
        axis = np.asarray(obstacle.axis) / np.linalg.norm(obstacle.axis)
        first, second = normal_to(axis)
        angles = np.linspace(0.0, 2 * np.pi, 13)[:, None]
        ring = obstacle.radius * (np.cos(angles) * first + np.sin(angles) * second)
        ends = size * np.array([-0.5, 0.5])[:, None, None] * axis
        return np.asarray(np.asarray(obstacle.point) + ends + ring)


class HeightRecord(TargetRecord):
    """A height at which the tip of a rod is to be."""

    references: ClassVar[Mapping[str, str]] = {"rod": "rods"}

    kind: Literal["height"] = Field(description="height of a tip")
    rod: str = Field(description="name of the rod")
    height: float = Field(description="wanted z of the tip, world axes, m")


class Height(Target[HeightRecord]):
    """z − h over the length."""

    record = HeightRecord

    def error(self, target: HeightRecord, model: Model, wanted: Matrix, x: Matrix, inputs: Matrix) -> Matrix:
        position: Matrix = model.tip[target.rod](x, inputs)[0]
        return (position[2] - target.height) / length_of(model, target)

    def gap(self, target: HeightRecord, solution: Solution) -> TargetMiss:
        height = solution.tip(target.rod).position[2]
        return TargetMiss(f"height of {target.rod}", abs(float(height - target.height)), None)


class AltitudeRecord(MovingMeasurement):
    """Height of a tip above the floor."""

    references: ClassVar[Mapping[str, str]] = {"rod": "rods"}
    entries: ClassVar[tuple[str, ...]] = ("z",)
    differences: ClassVar[tuple[str, ...]] = ("m",)

    quantity: Literal["altitude"] = Field(description="height of a tip, m")
    rod: str = Field(description="name of the rod")
    at: float = 1.0
    body: str | None = None
    offset: Vector = (0.0, 0.0, 0.0)


class Altitude(StateQuantity[AltitudeRecord]):
    """z of the tip."""

    record = AltitudeRecord

    def difference(self, site: MeasurementSite) -> Matrix:
        heights = [position[2] for position, _ in site.frames()]
        return ca.horzcat(*heights) - site.measured


MEMBERS = (Spring, Muscle, Tee, Cylindrical, Roller, EndlessBar, Height, Altitude)


FINGER = f"""
schema = 1
title = "A finger on a spring"
inputs = ["spring.anchor", "muscle.contraction", "push.force"]
accuracy = {{ modes = 3, nodes = 6, tolerance = 0.05 }}
[[rods]]
name = "finger"
length = 0.3
strain = "kirchhoff"
material = {{ youngs_modulus = 5e8, poisson_ratio = 0.4, density = 700.0 }}
section = {{ shape = "tee", flange = 8e-3, web = 6e-3, wall = 2e-3 }}
[[loads]]
name = "weight"
kind = "gravity"
acceleration = [0, 0, -9.81]
[[loads]]
name = "push"
kind = "tip_wrench"
rod = "finger"
force = [0.02, -0.03, 0]
[[loads]]
name = "spring"
kind = "spring_to_point"
rod = "finger"
anchor = {ANCHOR.tolist()}
stiffness = {STIFFNESS}
[[actuators]]
name = "muscle"
kind = "fibre"
rod = "finger"
contraction = {MOMENT}
[simulation]
duration = 0.01
frames = 3
start = "unloaded"
tolerance = 1e-2
"""

HALF = 0.2
"""Length of either rod that holds the plate, m."""

PLATE = f"""
schema = 1
title = "A plate that slides on one of its rods, beside a rod on a roller"
inputs = ["pull.force", "wind.force"]
accuracy = {{ modes = 2, nodes = 4, tolerance = 0.05 }}
[[rods]]
name = "left"
length = {HALF}
strain = ["bending_x", "bending_y", "torsion", "extension"]
stiffness = {{ bending_x = 0.05, bending_y = 0.05, torsion = 0.04, extension = 2000 }}
linear_density = 0.02
base = {{ tangent = [1, 0, 0] }}
[[rods]]
name = "right"
length = {HALF}
strain = "kirchhoff"
stiffness = {{ bending_x = 0.05, bending_y = 0.05, torsion = 0.04 }}
linear_density = 0.02
base = {{ position = [{2 * HALF}, 0, 0], tangent = [-1, 0, 0] }}
[[rods]]
name = "beam"
length = 0.3
strain = "planar"
stiffness = {{ bending_y = 0.05 }}
linear_density = 0.02
base = {{ position = [0, 0.1, 0], tangent = [1, 0, 0] }}
[[supports]]
kind = "roller"
rod = "beam"
position = [0.3, 0, 0]
axis = [0, 0, 2]
[[bodies]]
name = "plate"
mass = 0.01
inertia = [1e-6, 1e-6, 1e-6]
[[joints]]
kind = "fixed"
rod = "left"
body = "plate"
[[joints]]
kind = "cylindrical"
rod = "right"
body = "plate"
axis = [0, 0, -3]
quaternion = [0, 0, 1, 0]
[[obstacles]]
name = "bar"
kind = "endless_bar"
point = [0.15, 0, -0.007]
axis = [0, 1, 0]
radius = 0.005
rods = ["beam"]
width = 1e-3
[[loads]]
name = "pull"
kind = "body_wrench"
body = "plate"
force = [5, 0, -0.5]
[[loads]]
name = "wind"
kind = "distributed_wrench"
rod = "beam"
force = [0, 0, -0.1]
[simulation]
duration = 0.002
frames = 3
tolerance = 1e-2
[[motions]]
input = "pull.force"
amplitude = [0, 0, 0.1]
frequency = 20.0
"""

INPUTS = '["spring.anchor", "muscle.contraction", "push.force"]'
TEXTS = {"finger": FINGER, "plate": PLATE}
CAUSES = {"finger": "push.force", "plate": "pull.force"}


@pytest.fixture(autouse=True, scope="module")
def foreign() -> Iterator[None]:
    with registered(*MEMBERS):
        yield


@pytest.fixture(scope="module", params=TEXTS)
def name(request: pytest.FixtureRequest) -> str:
    return str(request.param)


@pytest.fixture(scope="module")
def scene(name: str) -> Scene:
    return parse_scene(TEXTS[name])


@pytest.fixture(scope="module")
def solution(scene: Scene) -> Solution:
    return solve(build(scene))


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for name, text in TEXTS.items():
        (tmp_path / f"{name}.toml").write_text(text)
    return tmp_path


# Every verb


def test_check_solve_report_and_plot(name: str, folder: Path) -> None:
    checked = cosserat("check", f"{name}.toml", cwd=folder)
    assert checked.returncode == 0
    words = {"finger": ("spring_to_point", "muscle"), "plate": ("roller tip of beam", "endless_bar")}
    assert all(word in checked.stdout for word in words[name]), checked.stdout
    found = cosserat("solve", f"{name}.toml", "--output", "found.json", "--plot", "found.png", cwd=folder)
    assert found.returncode == 0, found.stdout
    assert (folder / "found.png").stat().st_size > 10_000
    result = json.loads((folder / "found.json").read_text())
    assert result["converged"]
    assert result["stable"] is True


def test_jacobian_vs_differences(solution: Solution) -> None:
    assert solution.converged, solution.message
    model, x, inputs = solution.model, solution.x, solution.inputs
    jacobian = model.jacobian(x, inputs)[0].full()
    differences = central_differences(lambda x: model.residual(x, inputs), x, 1e-6)
    assert_allclose(jacobian, differences, rtol=0, atol=1e-8 * np.abs(jacobian).max())


def test_path(name: str, solution: Solution) -> None:
    value = 1.2 * solution.model.inputs.unpack(solution.inputs)[CAUSES[name]]
    path = follow(solution.model, CAUSES[name], value)
    assert path.outcome.name == "CONVERGED", path.message


def test_modes(solution: Solution) -> None:
    found = modes_of(solution, count=2)
    assert len(found.modes) == 2
    assert all(mode.eigenvalue.imag > 0.0 for mode in found.modes)


def test_motion(scene: Scene) -> None:
    moving = scene.with_motion_inputs()
    motion = simulate(build(moving, moving=True))
    assert motion.outcome is MotionOutcome.COMPLETED, motion.message


def test_facts_of_the_page_and_the_view(name: str, solution: Solution) -> None:
    facts = page_facts(solution)
    if name == "finger":
        tee = facts["rods"]["finger"]
        assert tee["shape"] == "rectangle"
        assert_allclose([tee["x"][0], tee["y"][0]], [4e-3, 4e-3], rtol=1e-6, atol=0)
        assert facts["actuators"]["muscle"]["drawn_as"] == "channel"
    else:
        assert facts["held"] == [[0.3, 0.0, 0.0]]
        net = np.array(facts["obstacles"][0]["net"])
        assert_allclose(np.hypot(net[..., 0] - 0.15, net[..., 2] + 0.007), 0.005, rtol=0, atol=1e-6)


@pytest.mark.skipif(shutil.which("gcc") is None, reason="there is no C compiler")
@pytest.mark.parametrize("name", mostly_slow(TEXTS, quick=["finger"]))
def test_export_and_load(name: str, tmp_path: Path) -> None:
    solution = solve(build(parse_scene(TEXTS[name])))
    library = load(export(solution.model, tmp_path / "robot"))
    found = library.solve()
    assert found.converged
    assert_allclose(found.x, solution.x, rtol=0, atol=1e-9)


def test_an_actuator_without_routing_is_named_and_not_drawn() -> None:
    legend = plot_solution(solve(build(parse_scene(FINGER)))).axes[0].get_legend_handles_labels()[1]
    assert "muscle: 0.02 N m" in legend


def test_joints_and_supports_are_marked_by_what_they_hold() -> None:
    lines = plot_solution(solve(build(parse_scene(PLATE)))).axes[0].get_lines()
    marked = {line.get_label(): line.get_marker() for line in lines}
    assert marked["roller tip"] == "^"
    # The slide in the plate.
    assert "D" in {line.get_marker() for line in lines}


def test_inverse() -> None:
    """The height that other inputs lead to is found again by the muscle alone."""
    driven = FINGER.replace(INPUTS, '["muscle.contraction"]')
    wanted = solve(build(parse_scene(driven)), {"muscle.contraction": 0.03}).tip().position[2]
    target = f'[[targets]]\nkind = "height"\nrod = "finger"\nheight = {wanted}\n'
    bound = '[[bounds]]\ninput = "muscle.contraction"\nlower = 0.0\nupper = 0.1\n'
    found = inverse(build(parse_scene(driven + target + bound)))
    assert found.met, found.message
    assert found.gaps[0].what == "height of finger"
    assert_allclose(found.values["muscle.contraction"].item(), 0.03, rtol=1e-6, atol=0)


def test_identification() -> None:
    """Young's modulus from heights of the tip under two forces."""
    table = '[[measurements]]\nquantity = "altitude"\nfile = "a.csv"\nrod = "finger"\ncolumns = ["z"]\nsigma = 1e-4\n'
    table += 'inputs = { "push.force.x" = "f" }\n[[unknowns]]\nparameter = "finger.material.youngs_modulus"\n'
    scene = parse_scene(FINGER.replace(INPUTS, '["push.force"]') + table)
    stiffer = parse_scene(FINGER.replace("5e8", "6e8"))
    forces = [0.02, 0.2]
    solutions = [solve(build(stiffer), {"push.force": [force, -0.03, 0.0]}) for force in forces]
    heights = [solution.tip().position[2] for solution in solutions]
    found = identify(build(scene.with_unknowns()), {"a.csv": {"f": forces, "z": heights}})
    assert_allclose(found.shared, [6e8], rtol=1e-6, atol=0)


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("gcc") is None, reason="there is no C compiler")
def test_sweep_and_derivatives_in_c(name: str, solution: Solution, folder: Path) -> None:
    assert cosserat("export", f"{name}.toml", "--output", "robot", "--derivatives", cwd=folder).returncode == 0
    library = load(folder / "robot")
    (rod, *_) = solution.model.discrete.rods
    position = library.tip[rod](library.solve().x, library.defaults)[0].full()[:, 0]
    assert_allclose(position, solution.tip(rod).position, rtol=0, atol=1e-9)
    columns = {
        "finger": "push.force.x = [0.0, 0.1, 0.2]\nspring.anchor.y = [0.0, 0.1]\nspring.stiffness = [2.0, 3.0]\n",
        "plate": "pull.force.x = [0.0, 1.0, 2.0]\nwind.force.z = [0.0, -0.1]\nleft.length = [0.2, 0.21]\n",
    }
    (folder / "grid.toml").write_text(columns[name])
    assert cosserat("sweep", f"{name}.toml", "--over", "grid.toml", "--output", "rows.csv", cwd=folder).returncode == 0
    rows = list(csv.DictReader((folder / "rows.csv").read_text().splitlines()))
    assert len(rows) == 12
    assert {row["outcome"] for row in rows} == {"converged"}


def test_bad_tables_are_refused_in_plain_words(folder: Path) -> None:
    (folder / "bad.toml").write_text(
        FINGER.replace("stiffness = 3.0", "stiffness = -3.0")
        .replace('kind = "fibre"\nrod = "finger"', 'kind = "fibre"\nrod = "thumb"')
        .replace("wall = 2e-3", "wal = 2e-3")
    )
    ended = cosserat("check", "bad.toml", cwd=folder)
    assert ended.returncode == REFUSED
    assert "loads[2].stiffness" in ended.stderr
    assert "actuators[0].rod" in ended.stderr
    assert "no rod is named 'thumb'" in ended.stderr
    assert "rods[0].section.wal" in ended.stderr
    (folder / "worse.toml").write_text(
        PLATE.replace('rod = "right"\nbody', 'rod = "wrong"\nbody')
        .replace("axis = [0, 0, 2]", "axis = [0, 0, 0]")
        .replace('rods = ["beam"]', 'rods = ["wrong"]')
    )
    ended = cosserat("check", "worse.toml", cwd=folder)
    assert ended.returncode == REFUSED
    assert all(where in ended.stderr for where in ("joints[1].rod", "supports[0].axis", "obstacles[0].rods"))


def test_a_section_that_is_not_round_has_no_contact() -> None:
    bar = '[[obstacles]]\nname = "bar"\nkind = "endless_bar"\npoint = [1, 0, 0]\naxis = [0, 1, 0]\nradius = 0.1\n'
    with pytest.raises(SceneError, match="the section of the rod 'finger' is not round"):
        parse_scene(FINGER + bar)


# Closed forms


def test_solution_vs_initial_value() -> None:
    """The clamp's wrench, the pull of the spring and the moment of the muscle lead to the tip that is reported."""
    scene = parse_scene(FINGER.replace("modes = 3, nodes = 6, tolerance = 0.05", "tolerance = 1e-6"))
    solution = solve(scene)
    assert solution.converged
    tip = solution.tip().position
    pull = STIFFNESS * (ANCHOR - tip)
    properties = rod_properties(scene.rods[0])
    assert properties.linear_density is not None
    density = float(properties.linear_density(np.array([0.5]))[0])
    weight = density * 0.3 * np.array([0, 0, -9.81])
    push = np.array([0.02, -0.03, 0.0])
    assert_allclose(solution.base_wrench().force, -(pull + weight + push), rtol=0, atol=1e-6)
    # The same rod with the spring's pull as a dead force, the muscle's moment as pre-curvature.
    bending_x, bending_y, torsion, *_ = properties.hooke(np.array([0.5]))[0].tolist()
    rod = {
        "name": "finger",
        "length": 0.3,
        "strain": "kirchhoff",
        "stiffness": {"bending_x": bending_x, "bending_y": bending_y, "torsion": torsion},
        "linear_density": density,
        "intrinsic": {"curvature": [0, MOMENT / bending_y, 0], "tangent": [0, 0, 1]},
    }
    tables: dict[str, Any] = {
        "schema": 1,
        "rods": [rod],
        "loads": [
            {"name": "weight", "kind": "gravity", "acceleration": [0, 0, -9.81]},
            {"name": "push", "kind": "tip_wrench", "rod": "finger", "force": (push + pull).tolist()},
        ],
    }
    reached = integrate(scene_from_dict(tables), solution.base_wrench().force, solution.base_wrench().moment)
    assert_allclose(reached.position, tip, rtol=0, atol=2e-6 * 0.3)


def test_tee_vs_sums_over_its_area() -> None:
    """Area and second moments by the midpoint rule on a mesh that its edges lie on, so that areas are exact."""
    step = 1e-5
    x, y = np.meshgrid(np.arange(-4e-3, 4e-3, step) + step / 2, np.arange(0.0, 8e-3, step) + step / 2)
    inside = (y > 6e-3) | (np.abs(x) < 1e-3)
    x, y = x[inside], y[inside] - y[inside].mean()
    cell = step**2
    hooke = rod_properties(parse_scene(FINGER).rods[0]).hooke(np.array([0.0]))[0]
    summed = 5e8 * cell * np.array([np.sum(y**2), np.sum(x**2), len(x)])
    assert_allclose(hooke[[0, 1, 5]], summed, rtol=1e-4, atol=0)


def plate(**loads: Any) -> Solution:
    """The plate and the beam with these loads alone, without the bar."""
    whole = tomllib.loads(PLATE)
    kept = {key: whole[key] for key in ("schema", "rods", "bodies", "joints", "supports")}
    given = [{**table, **loads[table["name"]]} for table in whole["loads"] if table["name"] in loads]
    return solve(build(scene_from_dict({**kept, "accuracy": {"modes": 5, "nodes": 8}, "loads": given})))


def test_cylindrical_joint_bears_nothing_along_and_about_its_axis() -> None:
    """Pulled and twisted along the axis, the plate hangs on the other rod alone: stretch F/EA and twist T/GJ."""
    force, moment = 30.0, 0.05
    found = plate(pull={"force": [force, 0, 0], "moment": [moment, 0, 0]})
    assert found.outcome is Outcome.CONVERGED
    body = found.body("plate")
    assert_allclose(body.position, [HALF * (1 + force / 2000), 0, 0], rtol=0, atol=1e-12)
    twist = moment * HALF / 0.04
    turned = [[1, 0, 0], [0, np.cos(twist), -np.sin(twist)], [0, np.sin(twist), np.cos(twist)]]
    straight = found.model.discrete.unloaded.frames[next(iter(found.model.discrete.frames))].start.rotation
    assert_allclose(body.rotation, turned @ straight, rtol=0, atol=1e-12)
    assert_allclose(found.base_wrench("right").force, 0.0, rtol=0, atol=1e-12)
    assert_allclose(found.base_wrench("right").moment, 0.0, rtol=0, atol=1e-12)


def test_cylindrical_joint_holds_across_its_axis() -> None:
    """Pushed across, the two rods are a beam clamped at both ends that may stretch: P (2L)³ / 192 EI."""
    force = 1e-3
    found = plate(pull={"force": [0, 0, -force]})
    sag = force * (2 * HALF) ** 3 / (192 * 0.05)
    assert_allclose(found.body("plate").position[2], -sag, rtol=1e-6, atol=0)
    assert_allclose(found.base_wrench("right").force[0], 0.0, rtol=0, atol=1e-9)


def test_roller_vs_propped_cantilever() -> None:
    """A uniform load w leaves 3 w L / 8 to the roller, up to the square of the slopes, 1e-4."""
    load = 0.01
    found = plate(wind={"force": [0, 0, -load]})
    assert found.converged
    assert_allclose(found.tip("beam").position[2], 0.0, rtol=0, atol=1e-12)
    base = found.base_wrench("beam").force
    assert_allclose(base[2], 5 / 8 * load * 0.3, rtol=1e-5, atol=0)
    assert_allclose(base[:2], 0.0, rtol=0, atol=1e-12)


def test_distance_from_the_endless_bar() -> None:
    bar = parse_scene(PLATE).obstacles[0]
    distance, gradient, hessian = EndlessBar().function(bar)([0.15 + 0.03, 7.0, 0.033])
    assert_allclose(float(distance), 0.05 - 0.005, rtol=0, atol=1e-15)
    assert_allclose(gradient.full()[:, 0], [0.6, 0, 0.8], rtol=0, atol=1e-15)
    assert_allclose(np.linalg.eigvalsh(hessian.full()), [0, 0, 20], rtol=0, atol=1e-12)


def test_exact_contact_with_the_endless_bar_vs_beams() -> None:
    """The bar under a cantilever that is pushed down at its tip bears what closes the gap there."""
    push, gap, at = 0.02, 1e-4, 0.2
    tables = {
        "schema": 1,
        "accuracy": {"modes": 5, "nodes": 8},
        "rods": [
            {
                "name": "rod",
                "length": 0.3,
                "strain": "planar",
                "stiffness": {"bending_y": 0.05},
                "base": {"tangent": [1, 0, 0]},
            }
        ],
        "loads": [{"name": "push", "kind": "tip_wrench", "rod": "rod", "force": [0, 0, -push]}],
        "obstacles": [
            {
                "name": "bar",
                "kind": "endless_bar",
                "point": [at, 0, -gap - 5e-3],
                "axis": [0, 1, 0],
                "radius": 5e-3,
            }
        ],
    }
    found = solve(scene_from_dict(tables))
    assert found.converged, found.message
    free = push * at**2 * (3 * 0.3 - at) / 6
    expected = (free - 0.05 * gap) * 3 / at**3
    # Slopes of 6e-3 rad move the contact along the round bar.
    assert_allclose(push - found.base_wrench().force[2], expected, rtol=1e-3, atol=0)
