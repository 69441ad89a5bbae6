"""Random rods with loads on tables, bars and balls: what converged holds, judged by gaps, forces and balance alone."""

from __future__ import annotations

import pytest

from cosserat_casadi import build, discretise, parse_scene, solve
from tests.contact.verdict import faults
from tests.families import mostly_slow
from tests.reference.contact_scenes import contact_scene


@pytest.mark.parametrize("seed", mostly_slow(range(12), [3]))
def test_random_contact_holds(seed: int) -> None:
    scene = parse_scene(contact_scene(seed))
    solution = solve(build(scene, discretise(scene, 7)))
    assert solution.converged, solution.message
    assert faults(solution) == []
