"""Bodies that must not pass through bars and balls, and what a scene pays for a body that touches: nothing else."""

from __future__ import annotations

import numpy as np
import pytest

from cosserat_casadi import Solution, build, parse_scene, solve
from cosserat_casadi.equilibrium.contact.contact_equations import ContactEquations, Grids
from cosserat_casadi.equilibrium.contact.contact_state import ContactState, Touch
from cosserat_casadi.equilibrium.contact.cushions import Barriers
from cosserat_casadi.equilibrium.contact.passing_through import passes_through
from cosserat_casadi.model.inputs import input_layout
from cosserat_casadi.numerics.outcome import Outcome
from tests.contact.test_contact_of_assemblies import BALL, HEAD, PUSH, ROD

SMALL = """
[[obstacles]]
name = "small"
kind = "sphere"
centre = [1.0, 0.0, {height}]
radius = 0.02
bodies = ["ball"]
"""
"""The tip sinks past it: by F/3 EI = 0.2 m, the ball of 0.05 m in the way or beside it."""


def shapes(height: float) -> tuple[Solution, Solution]:
    """The rod before and after the push, as if the sphere at a height were not there."""
    bare = build(parse_scene(HEAD + ROD + PUSH + BALL))
    model = build(parse_scene(HEAD + ROD + PUSH + BALL + SMALL.format(height=height)), bare.discretisation)
    found = []
    for force in (0.01, 0.3):
        free = solve(bare, {"push.force": [0.0, 0.0, -force]})
        assert free.converged
        shape = Solution(model, free.inputs, free.x, Outcome.CONVERGED, "", residual_norm=0.0, iterations=0)
        found.append(shape)
    return found[0], found[1]


@pytest.mark.parametrize(("height", "passed"), [(-0.1, True), (-0.45, False)])
def test_a_ball_does_not_pass_through_a_sphere(height: float, passed: bool) -> None:
    before, after = shapes(height)
    assert passes_through(before, after) == passed
    barriers = Barriers(before.model, before.inputs)
    assert [(body.name, obstacle.name) for body, obstacle in barriers.watched_bodies] == [("ball", "small")]
    assert barriers.are_between(before.x, after.x) == passed
    # Neither end is inside: what is seen is the way.
    assert not barriers.give_way(before.x)
    assert not barriers.give_way(after.x)


def test_a_ball_in_the_middle_of_a_sphere_has_given_way() -> None:
    before, after = shapes(-0.1)
    middle = before.x + 0.5 * (after.x - before.x)
    assert Barriers(before.model, before.inputs).give_way(middle)


DISK = """
[[disks]]
name = "ball"
rod = "rod"
at = [0.997]
radius = 0.05
thickness = 0.1
"""


@pytest.mark.parametrize(("carried", "word"), [(BALL, "bodies"), (DISK, "disks")], ids=["body", "disk"])
def test_no_step_takes_a_ball_or_a_disk_through_a_smooth_sphere(carried: str, word: str) -> None:
    """The base comes down by more than the sphere is thick: in one step the tip would be below it, and free.

    Beside the sphere it comes down.
    """
    head = 'inputs = ["rod.base.position"]\n' + HEAD + ROD + carried
    sphere = SMALL.format(height=-0.2).replace("bodies", word) + "width = 0.01\n"
    model = build(parse_scene(head + sphere), build(parse_scene(head)).discretisation)
    above = solve(model)
    below = solve(model, {"rod.base.position": [0.0, 0.0, -0.5]}, start=above)
    assert below.tip().position[2] > -0.2
    aside = solve(
        model, {"rod.base.position": [0.0, 0.3, -0.5]}, start=solve(model, {"rod.base.position": [0, 0.3, 0]})
    )
    np.testing.assert_allclose(aside.tip().position, [1.0, 0.3, -0.5], rtol=0, atol=1e-9)


def test_a_body_that_touches_pays_for_its_contact_alone() -> None:
    """Until it touches a scene has the instructions that it has without the obstacle; then a force and a gap more."""
    bare = build(parse_scene(HEAD + ROD + PUSH + BALL))
    scene = parse_scene(HEAD + ROD + PUSH + BALL + SMALL.format(height=-0.2))
    near = build(scene, bare.discretisation)
    for name in ("path_residual", "path_jacobian", "input_jacobian"):
        assert getattr(near, name).n_instructions() == getattr(bare, name).n_instructions()
    assert near.size == bare.size
    given = input_layout(scene).pack()
    touching = ContactEquations(scene, given, Grids(bare.discretisation), ContactState((Touch.ball("small", "ball"),)))
    placed = touching.nominal
    assert placed.model.size == bare.size
    assert len(placed.force_units) == 1
    more = placed.model.path_residual.n_instructions() - bare.path_residual.n_instructions()
    assert 0 < more <= FORCE
    assert placed.gaps.size_out(0) == (1, 1)


FORCE = 80
"""Most instructions of the force on a body."""
