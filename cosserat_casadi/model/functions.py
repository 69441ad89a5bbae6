"""The named functions of a model, one maker each."""

from __future__ import annotations

import re

import casadi as ca
import numpy as np

from cosserat_casadi.maths import chebyshev
from cosserat_casadi.maths.rotation import quaternion_product, quaternion_to_matrix, rotate
from cosserat_casadi.maths.typing import FloatArray, Matrix
from cosserat_casadi.model.couplings import Carrier
from cosserat_casadi.model.system import Arguments, DiscreteScene, System, balance, ratio_of, rod_actions
from cosserat_casadi.rod import kinematics
from cosserat_casadi.rod.transport import largest_turn

RESOLVED_TURN = 2.0
"""Turn of an interval between nodes, rad, beyond which no polynomial through the nodes follows the rod.

Interpolation at Chebyshev nodes converges from π nodes a wave on, and the Magnus series up to a turn of π.
"""

RESOLVED_NORM = 1e-2
"""Error of the tip's |Q| = 1 beyond which a solution of the literal system does not follow the rod."""


NOISE = 1e-14
"""Share of the largest entry of a linear response below which an entry is rounding."""


def _arguments(discrete: DiscreteScene) -> Arguments:
    return Arguments(ca.MX.sym("x", discrete.size), ca.MX.sym("inputs", discrete.layout.size))


def _path_arguments(discrete: DiscreteScene) -> Arguments:
    symbols = _arguments(discrete)
    return Arguments(symbols.x, symbols.inputs, ca.MX.sym("factor"))


def _listed(arguments: Arguments) -> list[Matrix]:
    return [arguments.x, arguments.inputs, arguments.factor]


def _name(word: str, rod: str) -> str:
    """Name of a rod's function; CasADi takes no two underscores in a row."""
    return re.sub("_+", "_", f"{word}_{rod}")


def residual(discrete: DiscreteScene) -> ca.Function:
    """(x, inputs) ↦ residual."""
    a = _arguments(discrete)
    return ca.Function("residual", [a.x, a.inputs], [System(discrete, a).residual], ["x", "inputs"], ["residual"])


def jacobian(discrete: DiscreteScene) -> ca.Function:
    """(x, inputs) ↦ (jacobian, residual)."""
    a = _arguments(discrete)
    system = System(discrete, a)
    outputs = [system.jacobian, system.residual]
    return ca.Function("jacobian", [a.x, a.inputs], outputs, ["x", "inputs"], ["jacobian", "residual"])


def input_jacobian(discrete: DiscreteScene) -> ca.Function:
    """(x, inputs) ↦ ∂ residual / ∂ inputs."""
    a = _arguments(discrete)
    derivative = ca.jacobian(System(discrete, a).residual, a.inputs)
    return ca.Function("input_jacobian", [a.x, a.inputs], [derivative], ["x", "inputs"], ["input_jacobian"])


def path_residual(discrete: DiscreteScene) -> ca.Function:
    """(x, inputs, factor) ↦ residual."""
    a = _path_arguments(discrete)
    outputs = [System(discrete, a).residual]
    return ca.Function("path_residual", _listed(a), outputs, ["x", "inputs", "factor"], ["residual"])


def path_jacobian(discrete: DiscreteScene) -> ca.Function:
    """(x, inputs, factor) ↦ ∂ residual / ∂x."""
    a = _path_arguments(discrete)
    outputs = [System(discrete, a).jacobian]
    return ca.Function("path_jacobian", _listed(a), outputs, ["x", "inputs", "factor"], ["jacobian"])


def path_rate(discrete: DiscreteScene) -> ca.Function:
    """(x, inputs, factor, inputs_rate, factor_rate) ↦ rate of the residual at fixed x."""
    a = _path_arguments(discrete)
    inputs_rate, factor_rate = ca.MX.sym("inputs_rate", discrete.layout.size), ca.MX.sym("factor_rate")
    moving, speed = ca.vertcat(a.inputs, a.factor), ca.vertcat(inputs_rate, factor_rate)
    joined = ca.MX.sym("inputs_and_factor", moving.shape[0])
    parts = Arguments(a.x, joined[:-1], joined[-1])
    rate = ca.substitute(ca.jtimes(System(discrete, parts).residual, joined, speed), joined, moving)
    names = ["x", "inputs", "factor", "inputs_rate", "factor_rate"]
    return ca.Function("path_rate", [*_listed(a), inputs_rate, factor_rate], [rate], names, ["residual_rate"])


def path_tangent(discrete: DiscreteScene) -> ca.Function:
    """Inputs ↦ dx/dfactor of the unloaded scene: its linear response.

    The Jacobian there is constant and the loads are linear in the inputs: an affine map, found by evaluating it. Where
    lengths and bases of rods are inputs, it is the map's linear part at the scene's own values.
    """
    size, inputs = discrete.layout.size, ca.MX.sym("inputs", discrete.layout.size)
    unloaded, still, rest = np.zeros(discrete.size), np.zeros(size), np.zeros(size)
    geometry = discrete.layout.geometry
    rest[geometry] = discrete.layout.pack()[geometry]
    jacobian = path_jacobian(discrete)(unloaded, rest, 0.0)
    rate, probes = path_rate(discrete), np.hstack([np.zeros((size, 1)), np.eye(size)])
    probes[:, 1:][:, geometry] = 0.0
    rates = rate.map(size + 1)(unloaded, rest[:, None] + probes, 0.0, still, 1.0).full()
    if geometry:
        slope = ca.Function("slope", [inputs], [ca.jacobian(rate(unloaded, inputs, 0.0, still, 1.0), inputs)])
        rates[:, 1:][:, geometry] = rates[:, :1] + slope(discrete.layout.pack()).full()[:, geometry]
    response = -np.linalg.solve(jacobian.full(), rates) if discrete.size else rates
    matrix = ca.sparsify(ca.DM(_without_noise(response[:, 1:] - response[:, :1])))
    moved = inputs - ca.DM(rest) if geometry else inputs
    constant = ca.DM(_without_noise(response[:, 0]))
    return ca.Function("path_tangent", [inputs], [constant + matrix @ moved], ["inputs"], ["tangent"])


def _without_noise(values: FloatArray) -> FloatArray:
    """Values without what is rounding beside the largest, which differs with the number of threads of a BLAS."""
    largest = float(np.abs(values).max(initial=0.0))
    return np.where(np.abs(values) < NOISE * largest, 0.0, values)


def igm(discrete: DiscreteScene, rod: str) -> ca.Function:
    """(q, base_position, base_quaternion, inputs) ↦ (generalised_force, base_force, base_moment).

    Report (2.19) with the base pose free: forces in N, moments in N m about the base, world frame; generalised
    forces in units of EI/ℓ. Wrenches of supports are unknowns of the scene, not loads, and are left out.
    """
    discrete_rod = discrete.rods[rod]
    q, inputs = ca.MX.sym("q", discrete_rod.size), ca.MX.sym("inputs", discrete.layout.size)
    position, quaternion = ca.MX.sym("base_position", 3), ca.MX.sym("base_quaternion", 4)
    rotation = quaternion_to_matrix(quaternion)
    arguments = Arguments(q, inputs)
    place = kinematics.shape(discrete_rod, q, ratio_of(discrete, rod, arguments))
    model = balance(place, rod_actions(discrete, rod, rotation.T, arguments))
    actuated = model.actuation_force
    outputs = [
        model.generalised_force if actuated is None else model.generalised_force + actuated,
        rotation @ model.statics.base_force,
        rotation @ model.statics.base_moment,
    ]
    return ca.Function(
        _name("igm", rod),
        [q, position, quaternion, inputs],
        outputs,
        ["q", "base_position", "base_quaternion", "inputs"],
        ["generalised_force", "base_force", "base_moment"],
    )


def tip(discrete: DiscreteScene, rod: str) -> ca.Function:
    """(x, inputs) ↦ (position, quaternion, rotation) of the tip, world frame."""
    a = _arguments(discrete)
    system = System(discrete, a)
    pose, base = system.tip(rod), system.base(rod)
    quaternion = quaternion_product(ca.MX(base.quaternion), pose.quaternion)
    position = base.position + rotate(ca.MX(base.quaternion), pose.position)
    outputs = [position, quaternion, quaternion_to_matrix(quaternion)]
    names = ["position", "quaternion", "rotation"]
    return ca.Function(_name("tip", rod), [a.x, a.inputs], outputs, ["x", "inputs"], names)


def tip_jacobian(discrete: DiscreteScene, rod: str) -> ca.Function:
    """(x, inputs) ↦ derivatives of the tip's position and quaternion, stacked 7×…, with x and with inputs.

    From the variations of the rod's fields: δr of the tip, and δQ = ½ (0, δθ) ⊗ Q.
    """
    a = _arguments(discrete)
    system = System(discrete, a)
    base = system.base(rod)
    moving = discrete.couplings.carrier(rod) is not None
    if moving or discrete.rods[rod].discretisation.transport == "permuted":
        pose = ca.vertcat(*tip(discrete, rod)(a.x, a.inputs)[:2])
        own = ca.jacobian(pose, a.x)
    else:
        tangent, count = system.tangents[rod], discrete.rods[rod].size
        quaternion = ca.repmat(ca.densify(system.tip(rod).quaternion), 1, count)
        spin = ca.vertcat(ca.DM.zeros(1, count), ca.densify(tangent.rotation_of(-1)))
        turned = quaternion_product(spin, quaternion) / 2
        world = quaternion_product(ca.MX(ca.repmat(base.quaternion, 1, count)), turned)
        moved = quaternion_to_matrix(base.quaternion) @ tangent.position(-1)
        place = discrete.rod_slices[rod]
        before, after = ca.DM(7, place.start), ca.DM(7, discrete.size - place.stop)
        own = ca.horzcat(before, ca.vertcat(moved, world), after)
    directly = ca.DM.zeros(7, discrete.layout.size)
    if discrete.layout.geometry:
        directly = ca.densify(ca.jacobian(ca.vertcat(*tip(discrete, rod)(a.x, a.inputs)[:2]), a.inputs))
    outputs = [ca.densify(own), directly]
    names = ["d_pose_d_x", "d_pose_d_inputs"]
    return ca.Function(_name("tip_jacobian", rod), [a.x, a.inputs], outputs, ["x", "inputs"], names)


def shape(discrete: DiscreteScene, rod: str) -> ca.Function:
    """(x, inputs, X) ↦ (position, quaternion) at any X in [0, 1], world frame.

    The polynomial through the nodes, element by element, as a Chebyshev series: no singularity at a node, and exact
    derivatives with respect to X too.
    """
    a, X = _arguments(discrete), ca.MX.sym("X")
    system = System(discrete, a)
    place, base = system.rods[rod].shape, system.base(rod)
    row = _interpolation_row(discrete, rod, X)
    position = base.position + rotate(ca.MX(base.quaternion), place.position @ row)
    local = place.quaternion @ row
    quaternion = quaternion_product(ca.MX(base.quaternion), local / ca.sqrt(ca.sumsqr(local)))
    names = ["position", "quaternion"]
    return ca.Function(_name("shape", rod), [a.x, a.inputs, X], [position, quaternion], ["x", "inputs", "X"], names)


def fields(discrete: DiscreteScene, rod: str) -> ca.Function:
    """(x, inputs) ↦ fields at the nodes, world frame but for the internal wrench, which is in the section's."""
    a = _arguments(discrete)
    system = System(discrete, a)
    model, base = system.rods[rod], system.base(rod)
    count = discrete.rods[rod].grid.size
    turn = ca.repmat(base.quaternion, 1, count)
    rotation = quaternion_to_matrix(base.quaternion)
    outputs = [
        ca.repmat(base.position, 1, count) + rotation @ model.shape.position,
        quaternion_product(ca.MX(turn), ca.densify(model.shape.quaternion)),
        model.statics.internal_wrench(),
        rotation @ model.statics.base_force,
        rotation @ model.statics.base_moment,
    ]
    names = ["position", "quaternion", "internal_wrench", "base_force", "base_moment"]
    return ca.Function(_name("fields", rod), [a.x, a.inputs], outputs, ["x", "inputs"], names)


def actuator(discrete: DiscreteScene, name: str) -> ca.Function:
    """(x, inputs) ↦ (tension, length) of a tendon, N and m, or (pressure, volume) of a chamber, Pa and m³.

    Third comes the derivative of the length or the volume with x, 1×size: what a unit of tension or pressure does.
    """
    a = _arguments(discrete)
    effort, extent, gradient = System(discrete, a).actuator(name)
    kind = next(one.kind for one in discrete.scene.actuators if one.name == name)
    names = {"tendon": ["tension", "length"], "chamber": ["pressure", "volume"]}[kind]
    outputs = [ca.densify(ca.MX(value)) for value in (effort, extent, gradient)]
    return ca.Function(
        _name("actuator", name), [a.x, a.inputs], outputs, ["x", "inputs"], [*names, f"d_{names[1]}_d_x"]
    )


def body(discrete: DiscreteScene, name: str) -> ca.Function:
    """(x, inputs) ↦ (position, quaternion, rotation) of a rigid body, world frame."""
    a = _arguments(discrete)
    place = System(discrete, a).coupled.placements[Carrier("body", name)]
    outputs = [place.position, place.direction, place.rotation]
    names = ["position", "quaternion", "rotation"]
    return ca.Function(_name("body", name), [a.x, a.inputs], outputs, ["x", "inputs"], names)


def body_jacobian(discrete: DiscreteScene, name: str) -> ca.Function:
    """(x, inputs) ↦ derivatives of a body's position and quaternion, stacked 7×…, with x and with inputs."""
    a = _arguments(discrete)
    pose = ca.vertcat(*body(discrete, name)(a.x, a.inputs)[:2])
    outputs = [ca.densify(ca.jacobian(pose, a.x)), ca.densify(ca.jacobian(pose, a.inputs))]
    names = ["d_pose_d_x", "d_pose_d_inputs"]
    return ca.Function(_name("body_jacobian", name), [a.x, a.inputs], outputs, ["x", "inputs"], names)


def energy(discrete: DiscreteScene) -> ca.Function:
    """(x, inputs) ↦ elastic energy, J."""
    a = _arguments(discrete)
    return ca.Function("energy", [a.x, a.inputs], [System(discrete, a).energy()], ["x", "inputs"], ["energy"])


def potential(discrete: DiscreteScene) -> ca.Function | None:
    """(x, inputs) ↦ elastic energy less the work of dead forces, J; None where a load has no such energy."""
    a = _arguments(discrete)
    value = System(discrete, a).potential()
    if value is None:
        return None
    return ca.Function("potential", [a.x, a.inputs], [value], ["x", "inputs"], ["potential"])


def coarseness(discrete: DiscreteScene) -> ca.Function:
    """(x, inputs) ↦ largest turn of an interval over what can be resolved; in the literal system error of tip's |Q|."""
    a = _arguments(discrete)
    shares: list[Matrix] = [ca.MX(0.0)]
    for rod, discrete_rod in discrete.rods.items():
        q, ratio = a.x[discrete.rod_slices[rod]], ratio_of(discrete, rod, a)
        if discrete_rod.discretisation.transport == "permuted":
            tip = kinematics.shape(discrete_rod, q, ratio).quaternion[:, -1]
            shares.append(ca.fabs(ca.norm_2(tip) - 1) / RESOLVED_NORM)
        elif discrete_rod.properties.turning_axes:
            shares.append(largest_turn(discrete_rod, q, ratio) / RESOLVED_TURN)
    largest = ca.mmax(ca.vertcat(*shares))
    return ca.Function("coarseness", [a.x, a.inputs], [largest], ["x", "inputs"], ["coarseness"])


def operations(function: ca.Function) -> int:
    """Scalar operations of a function: expanded to scalars, common terms shared, inputs and outputs not counted.

    The kernels of the intervals stay functions of their own; each call counts with all its operations.
    """
    symbols = [ca.SX.sym(function.name_in(i), function.sparsity_in(i)) for i in range(function.n_in())]
    return _operations(ca.Function("scalar", symbols, ca.cse(list(function.call(symbols)))))


def _operations(scalar: ca.Function) -> int:
    called = {(f.nnz_in(), f.nnz_out()): _operations(f) for f in scalar.find_functions(0)}
    total = 0
    for i in range(scalar.n_instructions()):
        kind = scalar.instruction_id(i)
        if kind == ca.OP_CALL:
            total += called[len(scalar.instruction_input(i)), len(scalar.instruction_output(i))]
        elif kind not in (ca.OP_INPUT, ca.OP_OUTPUT, ca.OP_CONST):
            total += 1
    return total


def _interpolation_row(discrete: DiscreteScene, rod: str, X: Matrix) -> Matrix:
    """Weights of the nodal values at X, M×1: Chebyshev series of the element that holds X."""
    grid = discrete.rods[rod].grid
    to_coefficients = chebyshev.chebyshev_coefficients(np.eye(grid.intervals + 1))
    rows = []
    for e in range(grid.elements):
        a, b = grid.breaks[e], grid.breaks[e + 1]
        polynomials = _chebyshev_row(grid.intervals, (X - a) / (b - a))
        row = ca.DM(to_coefficients).T @ polynomials
        rows.append(row if grid.elements == 1 else _inside(grid.breaks, e, X) * row)
    return ca.vertcat(*rows)


def _inside(breaks: tuple[float, ...], element: int, X: Matrix) -> Matrix:
    """1 where X lies in the element, which owns its tip-side end, else 0."""
    above = breaks[element] < X if element else 1
    below = breaks[element + 1] >= X if element + 2 < len(breaks) else 1
    return above * below


def _chebyshev_row(degree: int, X: Matrix) -> Matrix:
    x = 2 * X - 1
    values = [ca.MX(1.0), x]
    for _ in range(degree - 1):
        values.append(2 * x * values[-1] - values[-2])
    return ca.vertcat(*values[: degree + 1])
