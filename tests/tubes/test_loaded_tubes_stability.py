"""Stability of tubes under loads: against the Hessian of a discretised energy, and what a path over it shows."""

from __future__ import annotations

import itertools
import json
from pathlib import Path

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import SceneError, TubeSolution, all_equilibria, follow, parse_scene, solve
from cosserat_casadi.tubes.loaded_model import LoadedTubeModel
from cosserat_casadi.tubes.robot import Robot, robot_of
from cosserat_casadi.tubes.tube_solve import solution_near
from tests.commands import cosserat
from tests.reference.rods import rotation_from_quaternion
from tests.scenes import push
from tests.scenes import scene as scene_of_rods

TWO = """
schema = 1
accuracy = { tolerance = 1e-6 }
[[tubes]]
name = "outer"
stiffness = { bending = 0.06, torsion = 0.045 }
linear_density = 0.3
straight = 0.08
curved = 0.12
curvature = 14.0
rotation = 0.0
translation = 0.13
[[tubes]]
name = "inner"
stiffness = { bending = 0.025, torsion = 0.019 }
linear_density = 0.2
straight = 0.15
curved = 0.14
curvature = 18.0
rotation = 2.9
translation = 0.20
[[loads]]
name = "push"
kind = "tip_wrench"
rod = "inner"
force = [0.0, -0.2, 0.3]
[[loads]]
name = "weight"
kind = "gravity"
acceleration = [0, 0, -9.81]
"""

ELEMENTS = 20


class Elements:
    """The energy of a robot in short elements: unknown are its curvatures and the twists of all tubes.

    The frame is carried from the plate on by rotations of the elements, forces act on the middles of elements, and
    nothing is eliminated.
    """

    def __init__(self, robot: Robot) -> None:
        self.robot = robot
        inputs = robot.inputs
        n = robot.size
        reach = robot.translations(inputs)
        length = float(reach.max())
        # Tubes end where elements do.
        h = length / ELEMENTS
        assert np.allclose(reach / h, np.round(reach / h))
        curvature = ca.SX.sym("c", 2, ELEMENTS)
        twist = ca.SX.sym("twist", n, ELEMENTS)
        housing = ca.SX.sym("housing", n)
        compliance = (robot.length - reach) / robot.torsion
        energy = ca.dot(housing**2, 1 / compliance) / 2
        angles = ca.DM(robot.rotations(inputs)) + housing
        rotation = ca.SX.eye(3)
        place = ca.SX.zeros(3)
        for k in range(ELEMENTS):
            middle = (k + 0.5) * h
            c = curvature[:, k]
            u = ca.vertcat(-c[1], c[0], 0)
            turned = angles + h / 2 * twist[:, k]
            half = rotation @ self._rotation(h / 2 * u)
            for i in range(n):
                if middle < reach[i]:
                    bent = robot.curvature[i] * (middle > reach[i] - robot.curved[i])
                    wanted = bent * ca.vertcat(ca.cos(turned[i]), ca.sin(turned[i]))
                    energy += h * robot.bending[i] * ca.sumsqr(c - wanted) / 2
                    energy += h * robot.torsion[i] * twist[i, k] ** 2 / 2
                    energy -= self._work(i, spread=True, at=place + h / 2 * half[:, 2]) * h
            place = place + h * half[:, 2]
            rotation = rotation @ self._rotation(h * u)
            angles = angles + h * twist[:, k]
            for i in range(n):
                if abs((k + 1) * h - reach[i]) < h / 2:
                    energy -= self._work(i, spread=False, at=place)
        # Beyond its tip a tube has no twist to speak of.
        present = [(k, i) for k in range(ELEMENTS) for i in range(n) if (k + 0.5) * h < reach[i]]
        free = [ca.vec(curvature), housing, *[twist[i, k] for k, i in present]]
        absent = [twist[i, k] for k in range(ELEMENTS) for i in range(n) if (k, i) not in present]
        if absent:
            energy = ca.substitute(energy, ca.vertcat(*absent), ca.DM.zeros(len(absent)))
        x = ca.vertcat(*free)
        hessian, gradient = ca.hessian(energy, x)
        self.function = ca.Function("energy", [x], [energy, gradient, hessian])
        self.present = present
        self.h = h

    @staticmethod
    def _rotation(omega: ca.SX) -> ca.SX:
        """By the map of Cayley, without branches, with the angle of the rotation to third order."""
        hat = ca.skew(omega / 2)
        return ca.inv(ca.SX.eye(3) - hat) @ (ca.SX.eye(3) + hat)

    def _work(self, tube: int, *, spread: bool, at: ca.SX) -> ca.SX:
        work = ca.SX(0.0)
        for number, load in enumerate(self.robot.loads):
            start = self.robot.load_start(number)
            if load.spread == spread:
                work += load.shares[tube] * ca.dot(ca.DM(self.robot.inputs[start : start + 3]), at)
        return work

    def near(self, found: TubeSolution) -> np.ndarray:
        """Unknowns of the elements near an equilibrium."""
        shape = found.shape
        robot = self.robot
        inside = (robot.length - robot.translations(robot.inputs)) / robot.torsion
        ends = np.arange(ELEMENTS + 1) * self.h
        # The tangent's turn from one end of an element to the other, in the axes of the frame there.
        tangents = np.array([rotation_from_quaternion(q) for q in shape.quaternion])
        at_ends = [np.argmin(np.abs(shape.distance - end)) for end in ends]
        curvature = []
        for first, last in itertools.pairwise(at_ends):
            turn = tangents[first].T @ tangents[last][:, 2]
            curvature += [turn[0] / self.h, turn[1] / self.h]
        twist = [np.diff(shape.angles[at_ends, i])[k] / self.h for k, i in self.present]
        return np.concatenate([curvature, inside * shape.torques[0], twist])

    def eigenvalues(self, found: TubeSolution) -> tuple[np.ndarray, float]:
        """Of the Hessian at the equilibrium of the elements, and its energy."""
        x = self.near(found)
        for _ in range(12):
            energy, gradient, hessian = (part.full() for part in self.function(x))
            step = np.linalg.solve(hessian, -gradient[:, 0])
            x = x + step
            if np.abs(step).max() < 1e-9:
                break
        assert np.abs(step).max() < 1e-8
        return np.linalg.eigvalsh(hessian), float(energy[0, 0])


@pytest.mark.parametrize(
    ("settings", "falling"),
    [
        pytest.param([], [0, 0, 1], marks=pytest.mark.slow),
        (["push.force=[0.3,0.1,-0.5]"], [0, 0, 1]),
        pytest.param(["push.force=[0.0,0.0,-2.5]"], [0, 0, 1], marks=pytest.mark.slow),
        pytest.param(
            ["inner.curvature=0.0", "outer.curvature=0.0", "push.force=[0,0,-12.0]"], [2], marks=pytest.mark.slow
        ),
        (["inner.curvature=0.0", "outer.curvature=0.1", "push.force=[0.1,0,-60.0]"], [4]),
    ],
)
def test_falling_directions_vs_elements(settings: list[str], falling: list[int]) -> None:
    scene = parse_scene(TWO, settings)
    robot = robot_of(scene)
    starts = all_equilibria(scene).solutions
    # Steps that end near every end of an element.
    model = LoadedTubeModel(robot, 12)
    elements = Elements(robot)
    counts = []
    for start in starts:
        found = solution_near(model, robot.inputs, start.x)
        assert found.converged
        eigenvalues, energy = elements.eigenvalues(found)
        counts.append(found.stability.falling)
        assert found.stability.falling == int((eigenvalues < 0.0).sum())
        assert_allclose(energy, found.energy, rtol=0, atol=2e-3 * abs(found.energy) + 1e-4)
        assert (-1) ** counts[-1] == np.sign(found.stability.determinant)
    assert counts == falling


def test_pivots_are_symmetric() -> None:
    """The steps are symplectic: what the pivots are made of is a second variation."""
    scene = parse_scene(TWO, ["push.force=[0.3,0.4,-0.5]", "accuracy.tolerance=1e-3"])
    found = solve(scene)
    variations = found.model.varied(found.x, found.inputs)
    configuration = variations.configuration
    for before, after, step in zip(configuration[:-1], configuration[1:], variations.of_steps, strict=True):
        pivot = np.linalg.solve(-step, after @ np.linalg.inv(before))
        assert_allclose(pivot, pivot.T, rtol=0, atol=1e-11 * np.abs(pivot).max())
    at_plate = (variations.at_plate @ np.linalg.inv(configuration[-1]))[:, :2]
    assert_allclose(at_plate, at_plate.T, rtol=0, atol=1e-11 * np.abs(at_plate).max())


@pytest.mark.slow
def test_a_load_is_followed() -> None:
    scene = parse_scene(TWO, ["accuracy.tolerance=1e-3", "inner.rotation=2.0"])
    path = follow(scene, "push.force.z", -0.5)
    assert path.converged
    assert path.unit == "N"
    assert path.stable is not None
    assert path.stable.all()
    end = solve(scene, {"push.force.z": -0.5})
    assert_allclose(path.tip().position[-1], end.tip().position, rtol=0, atol=1e-3 * 0.2)


@pytest.mark.slow
def test_a_force_moves_the_snap_and_its_mirror_image() -> None:
    snaps = []
    for force in ("[0,-0.4,0]", "[0,0.4,0]"):
        settings = ["weight.acceleration=[0,0,0]", "accuracy.tolerance=1e-4", f"push.force={force}"]
        path = follow(parse_scene(TWO, settings), "inner.rotation", 9.0)
        assert path.converged
        first, second = path.events
        snaps.append((first.value, second.value))
        assert first.solution.stability.neutral
        assert first.snaps_to is not None
        assert first.snaps_to.stable
        assert first.released_energy is not None
        assert first.released_energy > 0.0
    # The mirror image across the plane of x and z turns the other way.
    assert_allclose(snaps[0][0] + snaps[1][1], 2 * np.pi, rtol=0, atol=1e-4)
    assert_allclose(snaps[1][0] + snaps[0][1], 2 * np.pi, rtol=0, atol=1e-4)
    assert abs(snaps[0][0] - snaps[1][0]) > 0.1


@pytest.mark.slow
def test_a_force_tips_a_robot_that_was_turned_to_where_it_would_snap() -> None:
    scene = parse_scene(TWO, ["weight.acceleration=[0,0,0]", "accuracy.tolerance=1e-4", "push.force=[0,0,0]"])
    turned = follow(scene, "inner.rotation", 5.4).solutions[-1]
    assert turned.stable
    pushed = follow(scene, "push.force.y", -0.6, first=turned)
    snap = pushed.events[0]
    assert_allclose(pushed.solutions[0].x[:2], turned.angles, rtol=0, atol=1e-3)
    assert snap.kind == "limit"
    assert snap.solution.stability.neutral
    # Under that force it snaps at that rotation.
    bent = parse_scene(TWO, ["weight.acceleration=[0,0,0]", "accuracy.tolerance=1e-4"])
    under = follow(bent, "inner.rotation", 9.0, {"push.force": [0.0, snap.value, 0.0]})
    assert_allclose(under.events[0].value, 5.4, rtol=0, atol=1e-3)


def test_a_path_begins_at_an_equilibrium_of_its_own_robot() -> None:
    scene = parse_scene(TWO, ["accuracy.tolerance=1e-3"])
    other = solve(parse_scene(TWO.partition("[[loads]]")[0], ["accuracy.tolerance=1e-3"]))
    with pytest.raises(SceneError, match="other names"):
        follow(scene, "push.force.y", 1.0, first=other)
    with pytest.raises(SceneError, match="stands beside values"):
        follow(scene, "push.force.y", 1.0, {"push.force.x": 1.0}, first=solve(scene))
    of_rods = scene_of_rods(push(force=[0.0, 0.0, 0.0]))
    with pytest.raises(SceneError, match="needs concentric tubes"):
        follow(of_rods, "push.force", [1.0, 0.0, 0.0], first=other)


@pytest.mark.slow
def test_loads_that_follow_have_no_energy() -> None:
    scene = parse_scene(FOLLOWING, ["accuracy.tolerance=1e-3"])
    found = solve(scene)
    assert found.converged
    assert found.stable is None
    assert found.stability.falling is None
    assert not found.stability.neutral
    assert follow(scene, "push.force.x", 0.1).stable is None
    assert found.to_dict()["stable"] is None


FOLLOWING = TWO.replace("force = [0.0, -0.2, 0.3]", 'force = [0.0, -0.2, 0.3]\nframe = "body"')


def with_load(**keys: str) -> str:
    lines = [f"{key} = {value}" for key, value in {"name": '"more"', "rod": '"inner"', **keys}.items() if value]
    return TWO + "[[loads]]\n" + "\n".join(lines) + "\n"


@pytest.mark.parametrize(
    ("text", "where"),
    [
        (TWO.replace("linear_density = 0.2\n", ""), ["tubes[1].linear_density"]),
        (TWO.replace('rod = "inner"', 'rod = "middle"'), ["loads[0].rod"]),
        (TWO.replace('"push"', '"inner"'), ["loads[0].name"]),
        (with_load(kind='"point_wrench"', at="0.5", moment="[1, 0, 0]"), ["loads[2].moment"]),
        (with_load(kind='"foundation"', stiffness="[1, 1, 1]"), ["loads[2].kind"]),
        (with_load(kind='"distributed_wrench"', moment="[1, 0, 0]"), ["loads[2].moment"]),
        (with_load(kind='"distributed_wrench"', force="[1, 0, 0]", frame='"body"'), ["loads[2].frame"]),
        (with_load(kind='"distributed_wrench"', force="[[1, 2], 0, 0]"), ["loads[2].force"]),
        (with_load(kind='"gravity"', rod="", rods='["none"]', acceleration="[0, 0, 1]"), ["loads[2].rods[0]"]),
        (with_load(kind='"gravity"', rod="", bodies='["none"]', acceleration="[0, 0, 1]"), ["loads[2].bodies[0]"]),
    ],
)
def test_refused_loads(text: str, where: list[str]) -> None:
    with pytest.raises(SceneError) as refused:
        parse_scene(text)
    assert [problem.where for problem in refused.value.problems] == where


@pytest.mark.parametrize(
    ("values", "problem"),
    [
        ({"push.force": [1.0, 2.0]}, "must be three numbers"),
        ({"push.force": 1.0}, "must be three numbers"),
        ({"push.force.x": [1.0, 2.0]}, "must be a number"),
        ({"push.moment.x": 1.0}, "is no input"),
        ({"weight.acceleration.z": np.nan}, "must be finite"),
    ],
)
def test_refused_values_of_loads(values: dict[str, object], problem: str) -> None:
    with pytest.raises(SceneError, match=problem):
        solve(parse_scene(TWO), values)


@pytest.mark.slow
def test_commands_take_loads(tmp_path: Path) -> None:
    (tmp_path / "tubes.toml").write_text(TWO.replace("1e-6", "1e-3"))
    (tmp_path / "following.toml").write_text(FOLLOWING.replace("1e-6", "1e-3"))
    ended = cosserat("solve", "tubes.toml", "--set", "push.force=[0,0,-0.1]", "--plot", "t.png", "--json", cwd=tmp_path)
    assert ended.returncode == 0, ended.stderr
    data = json.loads(ended.stdout)
    assert data["inputs"]["push.force.z"] == -0.1
    assert len(data["tip_angles"]) == 2
    assert data["stable"] is True
    ended = cosserat("solve", "tubes.toml", "--all", "--output", "a.json", cwd=tmp_path)
    assert ended.returncode == 3
    assert "others may be missing" in " ".join(ended.stdout.split())
    ended = cosserat("solve", "following.toml", "--stable", "--output", "b.json", cwd=tmp_path)
    assert ended.returncode == 2
    assert "the loads have no energy" in " ".join(ended.stderr.split())
    line = ("path", "following.toml", "--input", "push.force.x", "--to", "0.1", "--csv", "p.csv", "--plot", "p.svg")
    ended = cosserat(*line, cwd=tmp_path)
    assert ended.returncode == 0, ended.stderr
    assert (tmp_path / "p.csv").read_text().splitlines()[1].split(",")[1] == ""
    ended = cosserat("check", "tubes.toml", cwd=tmp_path)
    assert "6 unknowns" in ended.stdout
