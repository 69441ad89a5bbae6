"""The linear response of the unloaded scene to its loads: the first tangent of a load path."""

from __future__ import annotations

import casadi as ca
import numpy as np

from cosserat_casadi.maths.numbers import without_rounding
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.model.discrete_scene import DiscreteScene
from cosserat_casadi.model.function_table import Expressions
from cosserat_casadi.model.load_assembly import nonlinear_inputs
from cosserat_casadi.model.scene_equations import SceneEquations
from cosserat_casadi.model.system import Arguments, System

NOISE = 1e-14
"""Share of the largest entry of a linear response below which an entry is rounding."""


def unloaded_response(
    discrete: DiscreteScene,
    path_jacobian: ca.Function,
    path_rate: ca.Function,
    inputs: Matrix,
) -> Matrix:
    """dx/dλ of the unloaded scene: its linear response to the loads, size×1.

    The Jacobian there is constant and the loads are linear in the inputs, so that evaluations give the affine map. If
    lengths and bases of rods are inputs, or numbers of loads that depend on poses, the map is linearised at the scene's
    own values.

    Args:
        discrete: the scene.
        path_jacobian: derivative by x of the residual on the load path.
        path_rate: derivative of the residual along the rates of inputs and load factor.
        inputs: stacked inputs.
    """
    size = discrete.layout.size
    unloaded = np.zeros(discrete.size)
    no_rate = np.zeros(size)
    origin = np.zeros(size)
    # Inputs in which the rate is not affine: geometry, and inputs of loads that depend on poses.
    geometry = sorted({*discrete.layout.geometry, *nonlinear_inputs(discrete)})
    origin[geometry] = discrete.layout.pack()[geometry]
    jacobian = path_jacobian(unloaded, origin, 0.0)
    # The rate at zero inputs, and with one input at a time set to one.
    linear = np.setdiff1d(np.arange(size), geometry, assume_unique=True)
    probes = np.hstack([np.zeros((size, 1)), np.eye(size)[:, linear]])
    at_probes = path_rate.map(len(linear) + 1)(unloaded, origin[:, None] + probes, 0.0, no_rate, 1.0).full()
    rates = np.repeat(at_probes[:, :1], size + 1, axis=1)
    rates[:, 1 + linear] = at_probes[:, 1:]
    deviation = inputs
    if geometry:
        # Inputs with values at nodes, by which obstacles are raised and rub, have no effect in the unloaded scene.
        felt = [index for index in geometry if index not in discrete.layout.nodal]
        values = discrete.layout.pack()
        moved = ca.MX.sym("moved", len(felt))
        places = ca.DM(np.eye(size)[:, felt])
        rate = path_rate(unloaded, ca.DM(values) + places @ (moved - ca.DM(values[felt])), 0.0, no_rate, 1.0)
        slope = ca.Function("slope", [moved], [ca.jacobian(rate, moved)])
        rates[:, 1 + np.asarray(felt, dtype=int)] += slope(values[felt]).full()
        deviation = inputs - ca.DM(origin)
    response = rates
    # A scene whose rods admit no strain has no unknowns.
    if discrete.size:
        response = -np.linalg.solve(jacobian.full(), rates)
    at_origin = response[:, :1]
    constant = ca.DM(without_rounding(at_origin[:, 0], NOISE))
    by_inputs = without_rounding(response[:, 1:] - at_origin, NOISE)
    return constant + ca.sparsify(ca.DM(by_inputs)) @ deviation


def parametric_response(written: Expressions) -> Matrix:
    """dx/dλ of the unloaded scene, size×1, where its numbers are parameters: a linear system for each p."""
    discrete = written.discrete
    load_factor = ca.MX.sym("load_factor")
    if not discrete.size:
        return ca.MX(0, 1)
    # A symbol, since some Jacobians are derivatives by it.
    x = ca.MX.sym("x", discrete.size)
    equations = SceneEquations(System(discrete, Arguments(x, written["inputs"], load_factor)))
    rate = ca.jacobian(equations.residual, load_factor)
    start = [ca.MX(ca.DM.zeros(discrete.size, 1)), ca.MX(0.0)]
    jacobian, right_side = ca.substitute([equations.jacobian, rate], [x, load_factor], start)
    response: Matrix = -ca.solve(jacobian, right_side, "qr")
    return response
