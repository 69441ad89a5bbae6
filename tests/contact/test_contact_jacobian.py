"""The Jacobian of rods in exact contact, of which forces and gaps share a part, against automatic derivatives."""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Scene, build, discretise, solve
from cosserat_casadi.equilibrium.contact.contact_equations import ContactEquations, Grids
from cosserat_casadi.equilibrium.contact.contact_state import state_in, without_contacts
from cosserat_casadi.model.inputs import input_layout
from tests.families import mostly_slow
from tests.scenes import rod, scene

BAR = {"name": "bar", "kind": "capsule", "from": [0.5, -0.5, -0.08], "to": [0.5, 0.5, -0.08], "radius": 0.05}
TABLE = {"name": "table", "kind": "plane", "point": [0, 0, -0.1], "normal": [0, 0, 1]}
BALL = {"name": "ball", "kind": "sphere", "centre": [0.4, 0.02, -0.25], "radius": 0.2}
PUSH = {"name": "push", "kind": "tip_wrench", "rod": "rod", "force": [0, 0, -3.0]}
WEIGHT = {"name": "weight", "kind": "distributed_wrench", "rod": "rod", "force": [0, 0, -60.0]}
PRESS = {"name": "press", "kind": "point_wrench", "rod": "rod", "at": 0.8, "force": [0, 0, -2.0]}
FLAT = rod("planar", base={"position": [0, 0, 0], "tangent": [1, 0, 0]})
SPATIAL = rod("kirchhoff", base={"position": [0, 0, 0], "tangent": [1, 0, 0]})

STOUT = rod("planar", name="stout", length=0.7, base={"position": [0.1, 0.2, 0], "tangent": [1, 0, 0]})
PULL = {"name": "pull", "kind": "tip_wrench", "rod": "stout", "force": [0, 0, -9.0]}

Records = list[dict[str, Any]]

SCENES: dict[str, tuple[Records, Records, dict[str, Any], list[str]]] = {
    "a point on a bar": ([FLAT], [PUSH], BAR, ["point"]),
    "a point on a ball, in space": ([SPATIAL], [PUSH], BALL, ["point"]),
    "a line": ([FLAT], [WEIGHT], TABLE, ["line"]),
    "a line with a load inside": ([FLAT], [WEIGHT, PRESS], TABLE, ["line"]),
    "two rods of unlike lengths": ([FLAT, STOUT], [PUSH, PULL], BAR, ["point", "point"]),
}


def in_contact(name: str) -> Scene:
    """One of the scenes."""
    rods, loads, obstacle, _ = SCENES[name]
    return scene(rods=rods, loads=loads, obstacles=[obstacle])


@pytest.mark.parametrize(
    "name",
    mostly_slow(SCENES, quick=["a line with a load inside"]),
)
def test_the_jacobian_is_that_of_automatic_derivatives(name: str) -> None:
    wanted = in_contact(name)
    solution = solve(build(wanted, discretise(wanted, 3, 6)))
    assert solution.converged, solution.message
    assert [contact.kind for contact in solution.contacts] == SCENES[name][3]
    loaded = solution.model.scene
    plain = without_contacts(loaded)
    given = input_layout(plain).pack()
    state = state_in(loaded)
    equations = ContactEquations(plain, given, Grids(solution.model.discretisation), state)
    written = equations.written
    z = ca.vertcat(*written.unknowns)
    by_hand = ca.Function("by_hand", written.arguments, [written.jacobian])
    automatic = ca.Function("automatic", written.arguments, [ca.jacobian(written.residual, z)])
    sizes = [unknowns.shape[0] for unknowns in written.unknowns]
    rng = np.random.default_rng(4)
    # Anywhere: the forces do not balance, and the gaps are open. The places of contact are moved too.
    x = solution.x + 0.05 * rng.normal(size=sizes[0])
    forces = rng.normal(size=sizes[1])
    places = np.array(state.places) + 0.01
    arguments = [x, forces, places, given]
    expected = automatic(*arguments).full()
    assert_allclose(by_hand(*arguments).full(), expected, rtol=0, atol=1e-11 * np.abs(expected).max())
