"""A quasi-static rod in do-mpc: the unknowns are algebraic states, the equilibrium is their equation."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Model, Solution, solve
from tests.control import swing
from tests.control.quasi_static import (
    IPOPT,
    LARGEST,
    RATE,
    STAGES,
    STEP,
    arrival,
    effort,
    optimum,
    robot,
    robot_with_parameters,
)

pytestmark = pytest.mark.slow


def imported() -> Any:
    """The package do_mpc, as late as the tests that use it: a process that runs others need not wait for it."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # it says which of its own extras are not installed
        return pytest.importorskip("do_mpc")


MODULUS = "finger.material.youngs_modulus"


@pytest.mark.filterwarnings("ignore::FutureWarning")  # by do-mpc
def test_do_mpc_vs_nlp() -> None:
    model, near = robot()
    assert_plan_is(model, near, None, optimum())


@pytest.mark.filterwarnings("ignore::FutureWarning")  # by do-mpc
def test_do_mpc_with_a_parameter_vs_nlp() -> None:
    """A parameter of the scene is a variable of the kind _p: the plan is that of a finger with this number."""
    model = robot_with_parameters(MODULUS)
    stiffer = model.at({MODULUS: 1.5e6})
    wanted = optimum(stiffer)
    assert np.abs(wanted - optimum()).max() > 0.01
    assert_plan_is(model, solve(stiffer, raise_on_failure=True), 1.5e6, wanted)


def assert_plan_is(model: Model, near: Solution, modulus: float | None, expected: np.ndarray) -> None:
    """A plan of do-mpc that begins at an equilibrium is this one.

    Its terminal cost sees no algebraic state: the last of one more stage is the arrival, by a weight in time.
    """
    do_mpc = imported()
    described = do_mpc.model.Model("discrete", symvar_type="MX")
    tensions = described.set_variable("_x", "tensions", shape=(3, 1))
    rates = described.set_variable("_u", "rates", shape=(3, 1))
    x = described.set_variable("_z", "rod", shape=(model.size, 1))
    last = described.set_variable("_tvp", "last")
    parameters = [] if modulus is None else [described.set_variable("_p", "modulus")]
    described.set_rhs("tensions", tensions + STEP * rates)
    described.set_alg("equilibrium", model.residual(x, tensions, *parameters))
    described.setup()
    controller = do_mpc.controller.MPC(described)
    controller.settings.n_horizon = STAGES + 1
    controller.settings.t_step = STEP
    controller.settings.nlpsol_opts = IPOPT
    arrived = arrival(model, x, tensions, *parameters)
    controller.set_objective(mterm=0 * last, lterm=(1 - last) * effort(tensions, rates) + last * arrived)
    controller.set_rterm(rates=0.0)
    if modulus is not None:
        controller.set_uncertainty_values(modulus=np.array([modulus]))
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
    assert_allclose(found, expected, rtol=0, atol=1e-6)
    assert_allclose(near.inputs + STEP * first[:, 0], expected[0], rtol=0, atol=1e-6)


@pytest.mark.filterwarnings("ignore::FutureWarning")  # by do-mpc
def test_do_mpc_vs_nlp_in_motion() -> None:
    """Unknowns of a stage are algebraic states of a discrete system, the equations of motion their equation."""
    wanted = swing.task()
    stage = wanted.stage
    do_mpc = imported()
    described = do_mpc.model.Model("discrete", symvar_type="MX")
    state = described.set_variable("_x", "state", shape=(stage.state_size, 1))
    tensions = described.set_variable("_x", "tensions", shape=(2, 1))
    rates = described.set_variable("_u", "rates", shape=(2, 1))
    unknowns = described.set_variable("_z", "unknowns", shape=(stage.unknowns_size, 1))
    described.set_rhs("state", stage.next_state(state, unknowns))
    described.set_rhs("tensions", tensions + swing.STEP * rates)
    described.set_alg("motion", stage.equations(state, unknowns, tensions, inputs_rate=rates))
    described.setup()
    controller = do_mpc.controller.MPC(described)
    controller.settings.n_horizon = swing.STAGES
    controller.settings.t_step = swing.STEP
    controller.settings.nlpsol_opts = swing.IPOPT
    controller.set_objective(mterm=wanted.arrival(state, tensions), lterm=wanted.effort(rates))
    controller.set_rterm(rates=0.0)
    for side, largest_rate, tension in (("lower", -swing.RATE, 0.0), ("upper", swing.RATE, swing.LARGEST)):
        controller.bounds[side, "_u", "rates"] = largest_rate
        controller.bounds[side, "_x", "tensions"] = tension
        controller.terminal_bounds[side, "tensions"] = tension
    controller.setup()
    start = np.concatenate([wanted.start, wanted.near.inputs])
    controller.x0, controller.z0, controller.u0 = start, stage.still(wanted.near.x), np.zeros(2)
    controller.set_initial_guess()
    first = controller.make_step(start)
    assert controller.solver_stats["success"]
    expected = swing.optimum(wanted).tensions
    assert_allclose(wanted.near.inputs + swing.STEP * first[:, 0], expected[1], rtol=0, atol=1e-6)
    last = controller.opt_x_num["_x", swing.STAGES, 0, -1].full()[:, 0]
    assert_allclose(last[-2:], expected[-1], rtol=0, atol=1e-6)
