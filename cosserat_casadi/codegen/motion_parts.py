"""The equations of motion of a scene in parts of rods, and the blocks in which the matrices of a step are eliminated.

A scene with one dense Jacobian is one part and one block. State (x, v, a) and inputs (with rates and accelerations) are
one vector each, so that parts are cut as parts of statics are.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import casadi as ca
import numpy as np

from cosserat_casadi.codegen.blocks import INTERFACE, Blocks, blocks
from cosserat_casadi.codegen.contact.checks import refused_in_motion
from cosserat_casadi.codegen.contact.moving import contact_pattern
from cosserat_casadi.codegen.names import Names
from cosserat_casadi.codegen.parameters import given_size
from cosserat_casadi.codegen.parts import Parted, parted, parted_by_rows, placed
from cosserat_casadi.compiling.printed_kernels import Kernel
from cosserat_casadi.compiling.scalars_in_c import with_calls_in_fours
from cosserat_casadi.errors import ExportError, Problem, refuse
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.discrete_scene import DiscreteScene
from cosserat_casadi.model.function_table import PARAMETERS
from cosserat_casadi.model.unknowns import BlockKind
from cosserat_casadi.motion.contact_checks import untouchable
from cosserat_casadi.motion.motion_checks import immovable
from cosserat_casadi.motion.stops_facing import stop_facings

MATRICES = ("stiffness", "damping", "mass")
"""Derivatives of the equations by x, v and a."""


@dataclass(frozen=True)
class MotionInC:
    """Parts of the step in C.

    Attributes:
        blocks: blocks of stiffness, damping and mass together.
        order: the blocks in which the linear systems of a step are eliminated.
        residual: the equations in parts.
        matrices: entries of stiffness, then damping, then mass in parts, in the order of the pattern.
        input_matrices: derivatives by inputs, their rates, their accelerations, in parts, by index in the dense matrix.
    """

    blocks: Blocks
    order: Blocks
    residual: Parted
    matrices: Parted
    input_matrices: Parted

    @property
    def kernels(self) -> list[Kernel]:
        """All functions; those without loops compute four intervals at a time."""
        functions = [*self.residual.kernels, *self.matrices.kernels, *self.input_matrices.kernels]
        return [with_calls_in_fours(function) for function in functions]


def motion_in_c(model: Model, names: Names) -> MotionInC:
    """Make the equations of motion of a model in parts."""
    state, inputs, factor, arguments = _symbols(model)
    plain = model.inverse_dynamics.call(arguments)[0], model.dynamics_jacobian.call(arguments)[: len(MATRICES)]
    equations, matrices = _stops_apart(model, arguments[0], *plain)
    pattern = matrices[0].sparsity() + matrices[1].sparsity() + matrices[2].sparsity() + contact_pattern(model)
    partition = blocks(model.discrete, pattern)
    if partition is not None:
        order = partition
    else:
        # One block without an interface; all of its matrix is filled but rows and columns of flows.
        filled = np.arange(model.size - model.discrete.unknowns.count(BlockKind.FLOW))
        rows, columns = np.meshgrid(filled, filled)
        dense = ca.Sparsity.triplet(model.size, model.size, rows.ravel().tolist(), columns.ravel().tolist())
        partition = order = Blocks([0] * model.size, pattern + dense, [0] * model.size)
        if len(filled) < model.size:
            order = replace(partition, owners=_flows_apart(model.discrete))
    residual = ca.Function("motion", [state, inputs, factor], [equations])
    return MotionInC(
        blocks=partition,
        order=order,
        residual=parted(residual, partition.parts, names.kernel("motion_residual")),
        matrices=_matrices(partition, [state, inputs, factor], matrices, names.kernel("motion_matrices")),
        input_matrices=_input_matrices(model, partition, names.kernel("motion_input_matrices")),
    )


def _flows_apart(discrete: DiscreteScene) -> list[int]:
    """Index of each unknown's block: flows of one strain in one branch are coupled by its stiffness alone.

    The rows of flows are diagonal and are eliminated first; the other unknowns are the interface.
    """
    owners = np.full(discrete.size, INTERFACE)
    number = 0
    for block, entries in discrete.unknowns.of_kind(BlockKind.FLOW):
        rod = discrete.rods[block.owner]
        for first in range(entries.start, entries.stop, rod.size):
            for columns in rod.columns.values():
                owners[first + columns.start : first + columns.stop] = number
                number += 1
    return [int(owner) for owner in owners]


def check_motion(model: Model, *, on_device: bool = False) -> None:
    """Refuse a scene whose motion is not supported in C, or not together with batches on a GPU.

    Raises:
        ExportError: with every fault.
    """
    problems = [*immovable(model), *refused_in_motion(model.scene)]
    if model.scene.touches_exactly:
        problems += untouchable(model, None)
    if on_device and stop_facings(model):
        remedy = "export the scene twice: with --dynamics, and with --cuda"
        problems.append(Problem("--cuda", "steps with rigid stops of joints are not written for a GPU", remedy))
    refuse(problems, ExportError)


def _stops_apart(model: Model, x: ca.MX, residual: ca.MX, matrices: Sequence[Any] = ()) -> tuple[ca.MX, Sequence[Any]]:
    """Remove the pairs of rigid stops from the equations and their derivatives by x, v and a.

    In steps, rigid stops push like obstacles, so that the balances along the coordinates of joints exclude their
    pushes. The row of a pair equates its push to the residual of that balance. Without rigid stops nothing changes.
    """
    stops = stop_facings(model)
    if not stops:
        return residual, matrices
    rows = ca.vertsplit(ca.densify(residual))
    rows_of = [ca.vertsplit(matrix) for matrix in matrices]
    unit = [ca.MX.eye(model.size)[own.push_entry, :] for own in stops]
    for own, push in zip(stops, unit, strict=True):
        rows[own.coordinate_entry] += own.stop.side * x[own.push_entry]
        for of_positions in rows_of[:1]:
            of_positions[own.coordinate_entry] += own.stop.side * push
    for own, push in zip(stops, unit, strict=True):
        held = own.stop.side * rows[own.coordinate_entry]
        rows[own.push_entry] = x[own.push_entry] - ca.fmax(held, 0)
        for number, of_one in enumerate(rows_of):
            by_one = -own.stop.side * (held > 0) * of_one[own.coordinate_entry]
            of_one[own.push_entry] = by_one + push if number == 0 else by_one
    return ca.vertcat(*rows), [ca.vertcat(*of_one) for of_one in rows_of]


def _symbols(model: Model) -> tuple[ca.MX, ca.MX, ca.MX, list[ca.MX]]:
    """Symbols of the state, the inputs and an unused factor; and the arguments of the model's functions in motion.

    Parameters are appended to the inputs; the corresponding entries after rates and accelerations are unused.
    """
    size, count, given = model.size, model.inputs.size, given_size(model)
    state = ca.MX.sym("state", 3 * size)
    inputs = ca.MX.sym("inputs", 3 * given)
    arguments = [state[k * size : (k + 1) * size] for k in range(3)]
    moving = [inputs[k * given : k * given + count] for k in range(3)]
    if model.parameters.size:
        moving.insert(1, inputs[count:given])
    return state, inputs, ca.MX.sym("factor"), arguments + moving


def _matrices(partition: Blocks, symbols: Sequence[ca.MX], matrices: Sequence[ca.MX], name: str) -> Parted:
    """Make the entries of stiffness, damping and mass in parts; entries of one owner are together."""
    number = {entry: k for k, entry in enumerate(zip(*partition.pattern.get_triplet(), strict=True))}
    owner_of = partition.entry_parts
    places = list[int]()
    owners = list[int]()
    for which, matrix in enumerate(matrices):
        for entry in zip(*matrix.sparsity().get_triplet(), strict=True):
            places.append(which * len(number) + number[entry])
            owners.append(owner_of[number[entry]])
    entries = ca.vertcat(*[matrix.nz[:] for matrix in matrices])
    whole = parted(ca.Function("motion", [*symbols], [entries]), owners, name)
    return placed(whole, places)


def _input_matrices(model: Model, partition: Blocks, name: str) -> Parted:
    """Make the derivatives by inputs, rates and accelerations, each followed by columns for those by parameters."""
    state, inputs, factor, arguments = _symbols(model)
    # In the function's own symbols CasADi sees through the call, and writes a quarter of the derivatives.
    given = model.inverse_dynamics.mx_in()
    residual, _ = _stops_apart(model, given[0], model.inverse_dynamics.call(given)[0])
    symbols = dict(zip(model.inverse_dynamics.name_in(), given, strict=True))
    by_each = []
    for name_of_order in ("inputs", "inputs_rate", "inputs_acceleration"):
        by_each.append(ca.jacobian(residual, symbols[name_of_order]))
        # Parameters have no rates and no accelerations.
        by_each.append(ca.MX(model.size, model.parameters.size))
    if model.parameters.size:
        by_each[1] = ca.jacobian(residual, symbols[PARAMETERS])
    by_inputs = ca.Function("by_inputs", given, [ca.horzcat(*by_each)])
    matrix = by_inputs.call(arguments)[0]
    return parted_by_rows(ca.Function("motion", [state, inputs, factor], [matrix]), partition.parts, name)
