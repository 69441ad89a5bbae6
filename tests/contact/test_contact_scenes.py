"""Random rods in contact: what converged holds, by gaps, forces and balance, and beside discrete rods."""

from __future__ import annotations

import tomllib

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import build, discretise, follow, parse_scene, solve
from cosserat_casadi.equilibrium.relax import PATH_OF_ENERGY
from cosserat_casadi.paths.friction_path import FrictionPath
from tests.contact.verdict import NEAR, compared, evenly_apart, faults
from tests.families import mostly_slow
from tests.reference.contact_scenes import COMPOSED, contact_scene, smooth_scene
from tests.reference.discrete_rods import discrete_equilibrium, discrete_friction_path


@pytest.mark.parametrize("seed", mostly_slow([*range(12), 199], [3]))
def test_random_contact_holds(seed: int) -> None:
    text = contact_scene(seed)
    scene = parse_scene(text)
    solution = solve(build(scene, discretise(scene, 7)))
    assert solution.converged, solution.message
    assert faults(solution) == []
    assert list(compared(text, solution)) == []


@pytest.mark.slow
@pytest.mark.parametrize("family", ["bodies", "moving", "pairs"])
def test_other_contacts_are_where_discrete_rods_have_them(family: str) -> None:
    text = COMPOSED[family](4)
    scene = parse_scene(text)
    solution = solve(build(scene, discretise(scene, 7)))
    assert solution.converged and solution.contacts
    assert list(compared(text, solution)) == []


@pytest.mark.parametrize(("seed", "pressed"), [pytest.param(126, "ball", marks=pytest.mark.slow), (127, "bar")])
def test_large_loads_do_not_push_a_rod_through_a_layer_while_both_grow(seed: int, pressed: str) -> None:
    """The ball is farther from the straight rod than it is wide, the bar is nearer."""
    scene = parse_scene(smooth_scene(seed))
    solution = solve(build(scene, discretise(scene, 5)))
    assert solution.converged, solution.message
    assert pressed in {contact.obstacle for contact in solution.contacts}


def test_a_rod_that_snaps_while_loads_and_layers_grow_settles() -> None:
    """All loads growing at once stall; the weight alone, on whole layers, leads to the same equilibrium."""
    scene = parse_scene(smooth_scene(195))
    model = build(scene, discretise(scene, 5))
    solution = solve(model)
    assert solution.converged, solution.message
    assert PATH_OF_ENERGY in solution.message
    path = follow(model, "weight.acceleration", [0, 0, -9.81], {"weight.acceleration": [0, 0, 0]})
    assert path.converged
    assert_allclose(solution.tip().position, path.solution(-1).tip().position, rtol=0, atol=1e-8)


@pytest.mark.slow
def test_a_path_with_friction_ends_where_that_of_discrete_rods_does() -> None:
    text = COMPOSED["friction"](2)
    scene = parse_scene(text)
    model = build(scene, discretise(scene, 7))
    path = follow(model, "weight.acceleration", [0, 0, -9.81], {"weight.acceleration": [0, 0, 0]})
    assert isinstance(path, FrictionPath) and path.converged
    assert {stretch.slips for stretch in path.rubbing(-1)} == {True, False}
    assert list(compared(text, path.solution(0), path)) == []
    # An equilibrium without friction is elsewhere.
    (friction, *_) = [line for line in text.splitlines() if line.startswith("friction")]
    unhindered = solve(build(parse_scene(text.replace(friction, "friction = 0.0")), discretise(scene, 7)))
    assert np.abs(unhindered.tip().position - path.solution(-1).tip().position).max() > 10 * NEAR


@pytest.mark.slow
def test_friction_between_rods_moves_them_as_it_moves_discrete_ones() -> None:
    """Friction changes their ends alike; the errors of coarse discrete rods are in both of theirs."""
    text = COMPOSED["rubbing"](4)
    scene = parse_scene(text)
    model = build(scene, discretise(scene, 4))
    path = follow(model, "weight.acceleration", [0, 0, -9.81], {"weight.acceleration": [0, 0, 0]})
    assert isinstance(path, FrictionPath) and path.converged
    rubbed, plain = evenly_apart(path.solution(-1), 24), evenly_apart(solve(model), 24)
    tables = [tomllib.loads(text) for _ in range(2)]
    tables[1]["rod_contacts"][0]["friction"] = 0.0
    ends = [discrete_friction_path(table, evenly_apart(path.solution(0), 24), path.factor) for table in tables]
    assert ends[0] is not None and ends[1] is not None
    for rod, most in (("lower", 4e-4), ("upper", 1.5e-4)):
        change = (rubbed[rod][0] - plain[rod][0])[1:]
        assert np.abs(change).max() > most
        assert_allclose(change, ends[0][rod] - ends[1][rod], rtol=0, atol=8e-5)


@pytest.mark.slow
def test_discrete_rods_converge_at_second_order() -> None:
    text = smooth_scene(0)
    scene = parse_scene(text)
    solution = solve(build(scene, discretise(scene, 9)))
    off = []
    for segments in (20, 40, 80):
        poses = evenly_apart(solution, segments)
        minimum = discrete_equilibrium(tomllib.loads(text), poses)
        off.append(np.abs(minimum.ends["rod"] - poses["rod"][0][1:]).max())
    assert_allclose(np.log2(np.divide(off[:-1], off[1:])), 2.0, rtol=0, atol=0.2)
