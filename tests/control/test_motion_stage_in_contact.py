"""A stage in motion in exact contact: its forces by another route, and its motions against the simulator."""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Model, SceneError, build, scene_from_dict, simulate
from cosserat_casadi.control import Condensing, Horizon, MotionStage, gauss, motion_stage, radau
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.motion.contact_forces import Follower, MovingContact
from cosserat_casadi.motion.facings import facings
from cosserat_casadi.motion.section_pairs import TouchingPairs

LENGTH = 0.1
FRAMES = 21
PUSH = {"name": "push", "kind": "tip_wrench", "rod": "rod", "force": [0, 0, -0.1]}
FLOOR = {"name": "floor", "kind": "plane", "point": [0, 0, -0.01], "normal": [0, 0, 1]}


def rod(name: str = "rod", strain: str = "planar", times: float = 1.0, **base: Any) -> dict[str, Any]:
    return {
        "name": name,
        "length": LENGTH,
        "strain": strain,
        "base": {"tangent": [1, 0, 0], **base},
        "material": {"youngs_modulus": times * 2e6, "poisson_ratio": 0.45, "density": 1100.0},
        "section": {"shape": "circle", "radius": [5e-3, 4e-3]},
        "damping": {"retardation_time": 2e-3},
    }


def falling(**floor: Any) -> Model:
    """A rod that is pushed onto a floor."""
    tables = {
        "schema": 1,
        "rods": [rod()],
        "loads": [PUSH],
        "inputs": ["push.force"],
        "obstacles": [FLOOR | floor],
        "accuracy": {"modes": 2, "nodes": 4},
        "simulation": {"duration": 0.04, "start": "unloaded", "tolerance": 1e-4, "frames": FRAMES},
    }
    return build(scene_from_dict(tables), moving=True)


def assembly() -> Model:
    """Rods of four stiffnesses, two of which hold a ball, and a free one carries another."""
    tables = {
        "schema": 1,
        "accuracy": {"modes": 1, "nodes": 4},
        "rods": [
            rod("a", "kirchhoff"),
            rod("b", "kirchhoff", 7.0, position=[0.03, 0, 0]),
            rod("c", "kirchhoff", 3.0, free=True, position=[0, 0.05, 0.1]),
            rod("d", "kirchhoff", 2.0, rod="c", at=0.5, tangent=[0, 1, 0]),
        ],
        "bodies": [{"name": "head", "mass": 0.01, "radius": 0.01}],
        "joints": [
            {"body": "head", "rod": "a", "kind": "fixed"},
            {"body": "head", "rod": "b", "kind": "spherical", "position": [0.03, 0, 0]},
        ],
        "obstacles": [
            {
                "name": "ball",
                "kind": "sphere",
                "centre": [0.05, 0.05, 0.15],
                "radius": 0.02,
                "rods": ["a", "b", "c", "d"],
                "bodies": ["head"],
            },
            FLOOR | {"normal": [0.1, 0, 1], "rods": ["b", "c", "d"], "restitution": 0.3},
        ],
    }
    return build(scene_from_dict(tables), moving=True)


def pairs_of(stage: MotionStage) -> TouchingPairs:
    assert stage.pairs is not None
    return stage.pairs


def stage_by_stage(stage: MotionStage, x: FloatArray, inputs: FloatArray, count: int) -> FloatArray:
    """States at the ends of stages, each of which Newton's method solves from the one before."""
    arguments = stage.symbols
    state, unknowns, _, smoothing, _ = arguments
    residual = stage.equations.function(state, unknowns, inputs, smoothing, np.zeros(len(inputs)))
    newton = ca.rootfinder(
        "newton",
        "newton",
        {"x": unknowns, "p": ca.vertcat(state, smoothing), "g": residual},
        {"line_search": False, "abstol": 1e-11, "max_iter": 60},
    )
    states = [stage.state(x)]
    guess: Any = stage.still(x)
    for _ in range(count):
        guess = newton(x0=guess, p=np.append(states[-1], 1e-6))["x"]
        states.append(stage.next_state(states[-1], guess).full()[:, 0])
    return np.array(states)


def errors(model: Model, counts: list[int], sections: int = 16) -> list[float]:
    """Largest distance of the tip, over the length, between so many stages and the simulator, from rest."""
    motion = simulate(model)
    assert motion.converged and any(event.kind == "impact" for event in motion.events), motion.message
    inputs = model.pack()

    def tips(rows: FloatArray) -> FloatArray:
        return np.array([model.tip["rod"](x, inputs)[0].full()[:, 0] for x in rows])

    expected = tips(motion.x)
    found = []
    for count in counts:
        stage = motion_stage(model, 0.04 / count, sections=sections)
        states = stage_by_stage(stage, model.unloaded(), inputs, count)[:: count // (FRAMES - 1)]
        own = tips(np.array([stage.x(state).full()[:, 0] for state in states]))
        found.append(float(np.linalg.norm(own - expected, axis=1).max()) / LENGTH)
    return found


def test_forces_and_gaps_vs_those_of_the_simulator() -> None:
    """Any shape and forces, on rods and bodies of an assembly, whose equations are in units of their own."""
    model = assembly()
    pairs = pairs_of(motion_stage(model, 0.01, sections=4))
    random = np.random.default_rng(1)
    x = 0.05 * random.standard_normal(model.size)
    forces = random.uniform(0.5, 2.0, pairs.count)
    inputs = model.pack()
    seen = facings(model)
    numbers = {(facing.owner, facing.obstacle.name, facing.of_body): k for k, facing in enumerate(seen)}
    touches = [
        MovingContact(numbers[each.owner, each.obstacle.name, each.of_body], place, slides=False)
        for each in pairs.touching
        for place in each.places
    ]
    follower = Follower(seen, tuple(touches))
    _, gaps = follower.gaps(x, inputs)
    assert_allclose(pairs.gaps(x, inputs).full()[:, 0], [gap.value for gap in gaps], rtol=0, atol=1e-14)
    still = np.zeros(model.size + pairs.count)
    steady = np.zeros(model.inputs.size)
    whole = pairs.inverse_dynamics(np.append(x, forces * pairs.softness), still, still, inputs, 0.0, steady, steady)
    plain = model.inverse_dynamics(x, *[np.zeros(model.size)] * 2, inputs, steady, steady)
    pushed = -follower.rows(np.zeros(model.size), x, inputs, forces)[: model.size]
    assert_allclose((plain - whole[: model.size]).full()[:, 0], pushed, rtol=0, atol=1e-13)
    # Where a gap is open, the pair is N g = ε²/2.
    apart = np.array([gap.value for gap in gaps])
    balanced = 0.1**2 / 2 / np.abs(apart)
    held = pairs.inverse_dynamics(np.append(x, balanced * pairs.softness), still, still, inputs, 0.1, steady, steady)
    residuals = held.full()[model.size :, 0]
    assert np.sum(apart > 0) > 5
    assert_allclose(residuals[apart > 0], 0.0, rtol=0, atol=1e-14)


def test_a_rod_that_hits_a_floor_vs_the_simulator() -> None:
    coarse, fine = errors(falling(), [20, 40])
    assert coarse < 3e-3
    assert 1.7 < coarse / fine < 2.3  # Euler's method is of the first order


@pytest.mark.slow
def test_sections_between_which_a_rod_touches_vs_the_simulator() -> None:
    """For a while the place of contact is between the tip and the next of eight sections, which enters the floor."""
    (few,) = errors(falling(), [320], sections=8)
    half, more = errors(falling(), [160, 320])
    assert more < few / 2
    assert 1.7 < half / more < 2.3


@pytest.mark.slow
@pytest.mark.parametrize("restitution", [0.5, 1.0])
def test_a_rod_that_bounces_vs_the_simulator(restitution: float) -> None:
    coarse, fine, finest = errors(falling(restitution=restitution), [160, 320, 640])
    assert fine < 3e-3
    assert finest < coarse / 2.5


def test_derivatives_vs_differences() -> None:
    """With all arguments, in contact and off it, parameters of the geometry among them."""
    plain = falling(restitution=0.4, friction={"along": 0.2, "back": 0.5})
    scene = plain.scene.model_copy(update={"parameters": ("rod.length", "rod.base.position")})
    model = build(scene, plain.discretisation, moving=True)
    stage = motion_stage(model, 1e-3, parameters=True, sections=2)
    random = np.random.default_rng(0)
    function = stage.equations.function
    at = {name: 0.1 * random.standard_normal(size) for name, size in stage.sizes.items()}
    at["p"] = np.append(model.parameters.pack(), 1e-2)
    along = {name: random.standard_normal(len(value)) for name, value in at.items()}
    steps = {sign: function(*[value + sign * 1e-6 * along[name] for name, value in at.items()]) for sign in (1, -1)}
    slopes = function.jacobian()(*at.values(), ca.DM(stage.unknowns_size, 1))
    exact = sum(slope.full() @ along[name] for name, slope in zip(at, slopes, strict=True))
    assert_allclose(exact, (steps[1] - steps[-1]).full()[:, 0] / 2e-6, rtol=1e-6, atol=1e-6 * np.abs(exact).max())


def test_a_condensed_horizon_closes_in_contact() -> None:
    """Newton's method on all stages at once ends where stages that are solved one after the other are."""
    model = falling()
    count = 30
    stage = motion_stage(model, 1e-3, sections=2)
    inputs = np.tile(model.pack(), (count, 1))
    states = stage_by_stage(stage, model.unloaded(), model.pack(), count)
    condensing = Condensing(stage, stage.equations, count, [2])
    still = np.zeros_like(inputs)
    horizon = Horizon(np.tile(states[0], (count + 1, 1)), np.tile(stage.still(model.unloaded()), (count, 1)))
    for smoothing in (1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6):
        for _ in range(12):
            linear = condensing.condensed(horizon, inputs, still, np.full((count, 1), smoothing))
            horizon = linear.moved(np.zeros(count))
            if linear.residual < 1e-10:
                break
    assert linear.residual < 1e-10
    assert_allclose(horizon.states, states, rtol=0, atol=1e-8)
    with pytest.raises(ValueError, match="p must have the shape"):
        condensing.condensed(horizon, inputs, still)


def test_what_throws_back_is_refused() -> None:
    model = falling()
    for method in (radau(2), gauss(1)):
        with pytest.raises(SceneError, match="throws rods and bodies back that meet an obstacle without restitution"):
            motion_stage(model, 0.01, method)
    with pytest.raises(SceneError, match="sections: must be 1 or more, got 0"):
        motion_stage(model, 0.01, sections=0)
