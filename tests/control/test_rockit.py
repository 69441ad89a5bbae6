"""A quasi-static rod in rockit: the unknowns are algebraic states, the equilibrium is their equation."""

from __future__ import annotations

import warnings
from collections.abc import Callable

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import solve
from tests.control import swing
from tests.control.quasi_static import IPOPT, LARGEST, RATE, STAGES, STEP, arrival, effort, optimum, robot

with warnings.catch_warnings():
    warnings.simplefilter("ignore")  # of its sources, not of what is done with it
    rockit = pytest.importorskip("rockit")


def collocated() -> object:
    return rockit.DirectCollocation(N=STAGES, degree=2)


def shot() -> object:
    return rockit.MultipleShooting(N=STAGES, intg="collocation")


@pytest.mark.slow
@pytest.mark.parametrize("method", [collocated, shot])
def test_rockit_vs_nlp(method: Callable[[], object]) -> None:
    model, near = robot()
    ocp = rockit.Ocp(T=STAGES * STEP)
    tensions, rates, x = ocp.state(3), ocp.control(3), ocp.algebraic(model.size)
    ocp.set_der(tensions, rates)
    ocp.add_alg(model.residual(x, tensions))
    ocp.subject_to(ocp.at_t0(tensions) == near.inputs)
    ocp.subject_to(tensions >= 0, include_first=False)
    ocp.subject_to(tensions <= LARGEST, include_first=False)
    ocp.subject_to(rates >= -RATE)
    ocp.subject_to(rates <= RATE)
    ocp.add_objective(ocp.sum(effort(tensions, rates)) + ocp.at_tf(arrival(model, x, tensions)))
    ocp.set_initial(x, near.x)
    ocp.set_initial(tensions, near.inputs)
    ocp.solver("ipopt", IPOPT)
    ocp.method(method())
    found = ocp.solve()
    pulled = np.asarray(found.sample(tensions, grid="control")[1])
    assert_allclose(pulled[1:], optimum(), rtol=0, atol=1e-6)
    assert solve(model, dict(zip(model.inputs.names, pulled[-1], strict=True)), start=near).converged


@pytest.mark.slow
def test_rockit_vs_nlp_in_motion() -> None:
    """Stages are steps of a discrete system: next states are linear, unknowns of the stage are controls."""
    wanted = swing.task()
    stage = wanted.stage
    ocp = rockit.Ocp(T=swing.STAGES * swing.STEP)
    count = len(swing.TENDONS)
    state, tensions = ocp.state(stage.state_size), ocp.state(count)
    unknowns, rates = ocp.control(stage.unknowns_size), ocp.control(count)
    ocp.set_next(state, stage.next_state(state, unknowns))
    ocp.set_next(tensions, tensions + swing.STEP * rates)
    ocp.subject_to(stage.equations(state, unknowns, tensions, inputs_rate=rates) == 0, include_last=False)
    ocp.subject_to(ocp.at_t0(state) == wanted.start)
    ocp.subject_to(ocp.at_t0(tensions) == wanted.near.inputs)
    ocp.subject_to(tensions >= 0, include_first=False)
    ocp.subject_to(tensions <= swing.LARGEST, include_first=False)
    ocp.subject_to(rates >= -swing.RATE, include_last=False)
    ocp.subject_to(rates <= swing.RATE, include_last=False)
    ocp.add_objective(ocp.sum(wanted.effort(rates)) + ocp.at_tf(wanted.arrival(state, tensions)))
    ocp.set_initial(state, wanted.start)
    ocp.set_initial(tensions, wanted.near.inputs)
    ocp.solver("ipopt", swing.IPOPT)
    ocp.method(rockit.MultipleShooting(N=swing.STAGES))
    pulled = np.asarray(ocp.solve().sample(tensions, grid="control")[1])
    assert_allclose(pulled, swing.optimum(wanted).tensions, rtol=0, atol=1e-6)
