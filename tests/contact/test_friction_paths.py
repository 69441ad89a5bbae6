"""Friction on paths: sticking and slipping against a spring, a capstan, cycles, energy, directions, what is told."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import build, discretise, follow, read_scene, scene_from_dict, solve
from cosserat_casadi.errors import SceneError
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.paths.friction_path import FrictionPath
from tests.conftest import ROOT
from tests.families import mostly_slow

RADIUS = 0.01
LENGTH = 0.2
WIDTH = 2e-3
STIFFNESS = 1e6
WEIGHT = 1000.0 * np.pi * RADIUS**2 * 9.81
"""Of the rod, N/m."""
SPRING = 50.0
"""Along the rail, N/m."""


@cache
def block(
    friction: float = 0.3,
    back: float = 0.3,
    across: float = 0.3,
    axis: tuple[float, ...] = (1, 0, 0),
    hinge: float = 0.0,
) -> Model:
    """A stiff rod that lies on a table, on a rail with a spring; or on a hinge along it, with a spring in N m/rad."""
    gap = WIDTH - np.cbrt(3 * WEIGHT * WIDTH**2 / STIFFNESS)
    rod = {
        "name": "rod",
        "length": LENGTH,
        "strain": "kirchhoff",
        "section": {"shape": "circle", "radius": RADIUS},
        "material": {"youngs_modulus": 1e12, "poisson_ratio": 0.3, "density": 1000.0},
        "base": {"position": [0, 0, RADIUS + gap], "tangent": [1, 0, 0]},
    }
    table = {
        "name": "table",
        "kind": "plane",
        "point": [0, 0, 0],
        "normal": [0, 0, 1],
        "width": WIDTH,
        "stiffness": STIFFNESS,
        "friction": {"along": friction, "back": back, "across": across},
    }
    push = {"name": "push", "kind": "point_wrench", "rod": "rod", "at": 1.0, "force": [0, 0, 0]}
    rail = {"name": "rail", "kind": "prismatic", "rod": "rod", "at": 0.0, "axis": list(axis), "stiffness": SPRING}
    if hinge:
        rail |= {"kind": "revolute", "stiffness": hinge}
        push["moment"] = [0, 0, 0]
    weight = {"name": "weight", "kind": "gravity", "acceleration": [0, 0, -9.81]}
    scene = {"schema": 1, "rods": [rod], "joints": [rail], "obstacles": [table], "loads": [weight, push]}
    scene = scene_from_dict(scene)
    return build(scene, discretise(scene, 1, 4))


def pushed(model: Model, force: float, first: FrictionPath | None = None, axis: int = 0) -> FrictionPath:
    """The path on which the push grows to a force."""
    value = np.zeros(3)
    value[axis] = force
    path = follow(model, "push.force", value, first=first)
    assert isinstance(path, FrictionPath)
    assert path.converged, path.message
    return path


def ways(path: FrictionPath, axis: int = 0) -> FloatArray:
    """Way of the rod along the rail, m."""
    return np.asarray(path.position(0.0)[:, axis])


LIMIT = 0.3 * WEIGHT * LENGTH
"""Friction at which the rod slips, N."""


def test_a_rod_sticks_below_and_slips_above_the_limit() -> None:
    """Below it is held by the layer, as stiff along the table as across it; above the spring bears the rest."""
    stuck = pushed(block(), 0.9 * LIMIT)
    assert_allclose(ways(stuck)[-1], 0.9 * LIMIT / (STIFFNESS * LENGTH + SPRING), rtol=1e-3, atol=0)
    assert [(found.slips, found.start, found.end) for found in stuck.rubbing(-1)] == [(False, 0.0, 1.0)]
    slid = pushed(block(), 2.0 * LIMIT)
    assert_allclose(ways(slid)[-1], LIMIT / SPRING, rtol=1e-3, atol=0)
    assert [(found.slips, found.start, found.end) for found in slid.rubbing(-1)] == [(True, 0.0, 1.0)]
    (contact,) = slid.solution(-1).contacts
    assert_allclose(contact.force, [-LIMIT, 0, LIMIT / 0.3], rtol=1e-3, atol=1e-6)
    *_, stretch = slid.to_dict()["contact"]["rubbing"]
    last = {"row": len(slid.factor) - 1, "obstacle": "table", "rod": "rod", "from": 0.0, "to": 1.0, "slips": True}
    assert stretch == last
    assert "rod slips on table from 0 to 1" in repr(slid)


@pytest.mark.slow
def test_a_cycle_of_the_load_is_that_of_a_spring_that_slips() -> None:
    """Loaded to 3, unloaded to 0.5 and loaded back: stick, slip, stick, as Prandtl's element.

    What the push does in a whole cycle is what friction takes.
    """
    forward = pushed(block(), 3 * LIMIT)
    reach = LIMIT / (STIFFNESS * LENGTH)
    assert_allclose(ways(forward)[-1], 2 * LIMIT / SPRING, rtol=1e-3, atol=0)
    # It turns round: the layer is dragged from one side to the other, and then the spring pulls it back.
    held = pushed(block(), 1.2 * LIMIT, forward)
    assert_allclose(ways(held)[-1] - ways(forward)[-1], -1.8 * LIMIT / (STIFFNESS * LENGTH + SPRING), rtol=1e-2, atol=0)
    back = pushed(block(), 0.5 * LIMIT, forward)
    assert_allclose(ways(back)[-1], 1.5 * LIMIT / SPRING, rtol=1e-3, atol=0)
    again = pushed(block(), 3 * LIMIT, back)
    assert_allclose(ways(again)[-1], ways(forward)[-1], rtol=1e-6, atol=0)
    work = 0.0
    for path in (back, again):
        force = path.all_inputs[:, path.model.inputs.slices["push.force"]][:, 0]
        work += float(np.sum((force[1:] + force[:-1]) / 2 * np.diff(ways(path))))
    assert_allclose(work, 2 * LIMIT * (0.5 * LIMIT / SPRING - 2 * reach), rtol=5e-2, atol=0)
    assert work > 0


def test_what_is_held_stays_however_many_points_the_path_has() -> None:
    """At the same load nothing moves on, and the force of friction stays what it was."""
    once = pushed(block(), 0.9 * LIMIT)
    twice = pushed(block(), 0.9 * LIMIT, pushed(block(), 0.9 * LIMIT, once))
    assert_allclose(twice.x[-1], once.x[-1], rtol=0, atol=1e-11)


@pytest.mark.parametrize(
    ("axis", "force", "coefficient"),
    mostly_slow([(0, 1, 0.2), (0, -1, 0.4), (1, 1, 0.5)], quick=[(0, 1, 0.2), (0, -1, 0.4)]),
)
def test_directions_have_coefficients_of_their_own(axis: int, force: int, coefficient: float) -> None:
    rail = tuple(float(i == axis) for i in range(3))
    model = block(0.2, 0.4, 0.5, rail)
    bears = coefficient * WEIGHT * LENGTH
    path = pushed(model, force * 2 * bears, axis=axis)
    assert_allclose(ways(path, axis)[-1], force * bears / SPRING, rtol=2e-3, atol=0)


@pytest.mark.slow
def test_a_rod_that_turns_about_its_axis_rubs_at_its_radius() -> None:
    """The moment above the radius times the limit is the spring's."""
    limit, spring = RADIUS * LIMIT, 2e-3
    path = follow(block(hinge=spring), "push.moment", [1.2 * limit, 0, 0])
    assert path.converged, path.message
    rotation = path.tip().rotation[-1]
    assert_allclose(np.arctan2(rotation[2, 1], rotation[1, 1]), 0.2 * limit / spring, rtol=5e-3, atol=0)


def capstan(friction: float, width: float, stiffness: float) -> Model:
    """A band that is bent as it lies round a post, and held at one end."""
    radius = 0.03 + 0.95 * width
    band = {
        "name": "band",
        "length": radius * np.pi,
        "strain": ["bending_y", "extension"],
        "stiffness": {"bending_y": 1e-4, "extension": 2e3},
        "intrinsic": {"curvature": [0, 1 / radius, 0]},
        "base": {"position": [0, 0, radius], "tangent": [1, 0, 0]},
    }
    post = {
        "name": "post",
        "kind": "capsule",
        "from": [0, -0.5, 0],
        "to": [0, 0.5, 0],
        "radius": 0.03,
        "width": width,
        "stiffness": stiffness,
        "friction": friction,
    }
    pull = {"name": "pull", "kind": "tip_wrench", "rod": "band", "frame": "body", "force": [0, 0, 0]}
    scene = scene_from_dict({"schema": 1, "rods": [band], "obstacles": [post], "loads": [pull]})
    return build(scene, discretise(scene, 5, 10))


@pytest.mark.parametrize(
    ("friction", "width", "stiffness"),
    [
        (0.3, 1e-3, 1e6),
        pytest.param(0.3, 1e-3, 1e7, marks=pytest.mark.slow),
        pytest.param(0.1, 1e-3, 1e6, marks=pytest.mark.slow),
        pytest.param(0.3, 3e-4, 1e7, marks=pytest.mark.slow),
    ],
)
def test_a_band_round_a_post_is_a_capstan(friction: float, width: float, stiffness: float) -> None:
    """The pull grows by exp(μ θ) over the angle θ, and by what the layer stores: ln T₂/T₁ = μ θ + (d₂ − d₁)/r.

    With d the depth in the layer, the energy of the layer is f d/4 and its force per length f = T/r.
    """
    path = follow(capstan(friction, width, stiffness), "pull.force", [0, 0, 10.0])
    assert path.converged, path.message
    end = path.solution(-1)
    X = np.array([0.3, 0.8])
    pull = end.internal_wrench(X)[:, 5]
    poses = end.pose(X)
    angle = np.unwrap(np.arctan2(-poses.rotation[:, 2, 2], poses.rotation[:, 0, 2]))
    distance = np.linalg.norm(poses.position, axis=1)
    grows = friction * np.diff(angle) - np.diff(distance) / distance.mean()
    assert_allclose(np.log(pull[1] / pull[0]), grows[0], rtol=2e-3, atol=0)
    assert all(stretch.slips for stretch in path.rubbing(-1) if stretch.end - stretch.start > 0.2)


@pytest.mark.slow  # three models
def test_a_wire_that_is_pushed_through_a_bent_lumen_needs_the_force_back_that_friction_took() -> None:
    """More friction takes more force, and pulls on the way back; a whole cycle takes work."""
    forces, works = [], []
    for friction in (0.0, 0.1, 0.3):
        changes = [
            'wire.strain="planar"',
            "wire.length=0.15",
            "vessel.width=1e-3",
            f"vessel.friction={friction}",
            'inputs=["wire.base.position"]',
            "accuracy.modes=4",
            "accuracy.nodes=8",
        ]
        model = build(read_scene(ROOT / "examples" / "wire_in_vessel.toml", changes))
        pushed_in = follow(model, "wire.base.position", [0, 0, 0.03])
        if not friction:
            forces.append(pushed_in.solution(-1).base_wrench().force[2])
            continue
        pulled_out = follow(pushed_in.model, "wire.base.position", [0, 0, 0], first=pushed_in)
        assert pushed_in.converged and pulled_out.converged
        work = 0.0
        for path in (pushed_in, pulled_out):
            force = np.array([path.solution(i).base_wrench().force[2] for i in range(len(path.factor))])
            work += float(np.sum((force[1:] + force[:-1]) / 2 * np.diff(path.position(0.0)[:, 2])))
        works.append(work)
        forces.append(pushed_in.solution(-1).base_wrench().force[2])
        assert pulled_out.solution(-1).base_wrench().force[2] < forces[0] / 2
    assert forces[0] < forces[1] < forces[2]
    assert 0.0 < works[0] < works[1]


@pytest.mark.slow
def test_a_scene_with_a_tolerance_is_refined_in_modes_and_increments() -> None:
    """Friction holds the tip back, which slides outwards as the rod comes down."""
    changes = ["table.width=2e-2", "table.friction=0.5", "accuracy.tolerance=1e-2"]
    scene = read_scene(ROOT / "examples" / "rod_on_table.toml", changes)
    path = follow(scene, "weight.acceleration", [0, 0, -9.81])
    assert path.converged, path.message
    assert path.error_estimate is not None and path.error_estimate < 1e-2
    assert "counted from factor 0" in path.message
    smooth = read_scene(ROOT / "examples" / "rod_on_table.toml", changes[:1])
    plain = follow(build(smooth, path.model.discretisation), "weight.acceleration", [0, 0, -9.81])
    assert path.tip().position[-1, 0] - plain.tip().position[-1, 0] > 5e-3


def test_a_single_equilibrium_says_that_it_does_not_rub() -> None:
    found = solve(block())
    assert found.converged and "Friction acts in motion and on paths" in found.message
    with pytest.raises(SceneError, match="branch"):
        follow(block(), "push.force", [1, 0, 0], branch=1)
