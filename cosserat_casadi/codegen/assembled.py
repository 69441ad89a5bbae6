"""The equations of an assembly as parts of rods, and the blocks of its Jacobian."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from cosserat_casadi.codegen.blocks import Blocks, blocks
from cosserat_casadi.codegen.column_parts import parted_by_columns
from cosserat_casadi.codegen.names import Names
from cosserat_casadi.codegen.parameters import input_jacobian, with_parameters_behind_inputs
from cosserat_casadi.codegen.parts import Parted, parted, parted_by_rows
from cosserat_casadi.compiling.printed_kernels import Kernel
from cosserat_casadi.compiling.scalars_in_c import with_calls_in_fours
from cosserat_casadi.model.build import Model


@dataclass(frozen=True)
class Assembled:
    """Parts of the solver of an assembly.

    Attributes:
        blocks: of the Jacobian.
        residual: the residual in parts.
        jacobian: entries of ∂ residual / ∂x in parts.
        input_jacobian: ∂ residual / ∂ (inputs, parameters) in parts, entries by their index in the dense matrix.
    """

    blocks: Blocks
    residual: Parted
    jacobian: Parted
    input_jacobian: Parted

    @property
    def kernels(self) -> list[Kernel]:
        """All functions; functions of the residual call their intervals in fours."""
        of_residual = map(with_calls_in_fours, self.residual.kernels)
        return [*of_residual, *self.jacobian.kernels, *self.input_jacobian.kernels]


def assembled(model: Model, names: Names) -> Assembled | None:
    """The equations of an assembly in parts; None where one dense Jacobian does."""
    partition = blocks(model.discrete, model.path_jacobian.sparsity_out(0))
    if partition is None:
        return None
    residual = _path_function(with_parameters_behind_inputs(model.path_residual), dense=True)
    by_inputs = _path_function(input_jacobian(model))
    return Assembled(
        blocks=partition,
        residual=parted(residual, partition.parts, names.kernel("residual")),
        jacobian=_jacobian(model, partition, names.kernel("jacobian")),
        input_jacobian=parted_by_rows(by_inputs, partition.parts, names.kernel("input_jacobian")),
    )


def _jacobian(model: Model, partition: Blocks, name: str) -> Parted:
    """∂ residual / ∂x in parts, by columns where it has such a form."""
    by_columns = None if model.discrete.pairs else parted_by_columns(model, partition, name)
    if by_columns is not None:
        return by_columns
    jacobian = with_parameters_behind_inputs(model.path_jacobian)
    return parted(jacobian, partition.entry_parts, name)


def _path_function(function: ca.Function, *, dense: bool = False) -> ca.Function:
    """A map (x, inputs, factor) ↦ result of one that may not depend on the factor."""
    symbols = function.mx_in()
    result = function.call(symbols)[0]
    given = symbols if len(symbols) == 3 else [*symbols, ca.MX.sym("factor")]
    return ca.Function("path", given, [ca.densify(result) if dense else result])
