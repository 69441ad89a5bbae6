"""A quasi-static rod in do-mpc: the unknowns are algebraic states, the equilibrium is their equation."""

from __future__ import annotations

import warnings

import numpy as np
import pytest
from numpy.testing import assert_allclose

from tests.control.quasi_static import IPOPT, LARGEST, RATE, STAGES, STEP, arrival, effort, optimum, robot

with warnings.catch_warnings():
    warnings.simplefilter("ignore")  # it says which of its own extras are not installed
    do_mpc = pytest.importorskip("do_mpc")


@pytest.mark.filterwarnings("ignore::FutureWarning")  # by do-mpc
def test_do_mpc_vs_nlp() -> None:
    """Its terminal cost sees no algebraic state: the last of one more stage is the arrival, by a weight in time."""
    model, near = robot()
    described = do_mpc.model.Model("discrete", symvar_type="MX")
    tensions = described.set_variable("_x", "tensions", shape=(3, 1))
    rates = described.set_variable("_u", "rates", shape=(3, 1))
    x = described.set_variable("_z", "rod", shape=(model.size, 1))
    last = described.set_variable("_tvp", "last")
    described.set_rhs("tensions", tensions + STEP * rates)
    described.set_alg("equilibrium", model.residual(x, tensions))
    described.setup()
    controller = do_mpc.controller.MPC(described)
    controller.settings.n_horizon = STAGES + 1
    controller.settings.t_step = STEP
    controller.settings.nlpsol_opts = IPOPT
    controller.set_objective(
        mterm=0 * last, lterm=(1 - last) * effort(tensions, rates) + last * arrival(model, x, tensions)
    )
    controller.set_rterm(rates=0.0)
    for side, largest_rate, tension in (("lower", -RATE, 0.0), ("upper", RATE, LARGEST)):
        controller.bounds[side, "_u", "rates"] = largest_rate
        controller.bounds[side, "_x", "tensions"] = tension
    ahead = controller.get_tvp_template()
    ahead["_tvp", STAGES, "last"] = 1.0
    controller.set_tvp_fun(lambda _: ahead)
    controller.setup()
    controller.x0, controller.z0, controller.u0 = near.inputs, near.x, np.zeros(3)
    controller.set_initial_guess()
    first = controller.make_step(near.inputs)
    assert controller.solver_stats["success"]
    found = np.array([controller.opt_x_num["_x", k, 0, -1].full()[:, 0] for k in range(1, STAGES + 1)])
    expected = optimum()
    assert_allclose(found, expected, rtol=0, atol=1e-6)
    assert_allclose(near.inputs + STEP * first[:, 0], expected[0], rtol=0, atol=1e-6)
