"""World positions of points of rods and bodies as functions of the unknowns and inputs of a model, with derivatives.

Rods of assemblies and free rods need no special treatment: a point moves with the strains of its rod and the pose of
its base, as far as these are unknowns.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import cached_property

import casadi as ca
import numpy as np

from cosserat_casadi.compiling.shared_records import Held
from cosserat_casadi.maths.calls import KEPT
from cosserat_casadi.maths.typing import FloatArray, Matrix
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.system import Arguments, System
from cosserat_casadi.motion.contact_law import PointsRecord, called, called_in_c, function_record
from cosserat_casadi.motion.repeated_call import INTERPRETED, Libraries, RepeatedCall, repeated


class MovingPoints:
    """World positions of some points, with the functions of their derivatives.

    Args:
        model: the model, built for a motion.
        placed: function of a system ↦ positions, 3×M.
        name: name of the points in C.
        libraries: shared objects that contain :attr:`in_iterations` and :attr:`in_derivatives`.
        shares: energy unit of forces on the points over the unit of each balance, shape (n,); None if both are equal
            for all unknowns that move the points.
        parts: the points of each rod, if they are of several; steps in C share the code of a rod among its pairs.
    """

    def __init__(
        self,
        model: Model,
        placed: Callable[[System], Matrix],
        name: str,
        libraries: Libraries = INTERPRETED,
        shares: FloatArray | None = None,
        parts: Sequence[MovingPoints] = (),
    ) -> None:
        x = ca.MX.sym("x", model.size)
        inputs = ca.MX.sym("inputs", stacked_size(model))
        written = in_stacked_inputs(model, x, inputs, lambda system: [placed(system)])
        positions = ca.densify(ca.vec(ca.MX(*written)))
        weights = ca.MX.sym("weights", positions.shape[0])
        total = ca.dot(weights, positions)
        gradient = ca.densify(ca.gradient(total, x))
        self._symbols = [x, inputs, weights]
        self._written = (positions, total, gradient)
        self._name = name
        self._libraries = libraries
        self._parts = parts
        self.shares = shares

    def in_balances(self, by_unknowns: FloatArray) -> FloatArray:
        """Scale generalised forces on the points, or their derivatives, to the units of balances, (n,) or (n, n)."""
        return by_unknowns if self.shares is None else (by_unknowns.T * self.shares).T

    @property
    def in_iterations(self) -> list[ca.Function]:
        """Functions that iterations and guards call: positions, and the derivative of their weighted sum."""
        positions, _, gradient = self._written
        return [
            ca.Function(f"{self._name}_positions", self._symbols[:2], [positions]),
            ca.Function(f"{self._name}_gradient", self._symbols, [gradient]),
        ]

    @property
    def velocities(self) -> ca.Function:
        """(x, inputs, v, rate) ↦ velocities of the points, for steps of given size."""
        x, inputs, _ = self._symbols
        v, rate = ca.MX.sym("v", x.shape[0]), ca.MX.sym("rate", inputs.shape[0])
        moved = ca.jtimes(self._written[0], x, v) + ca.jtimes(self._written[0], inputs, rate)
        return ca.Function(f"{self._name}_velocities", [x, inputs, v, rate], [ca.densify(moved)])

    @property
    def in_derivatives(self) -> list[ca.Function]:
        """Functions for Jacobians: derivative of the positions, and second one of their weighted sum, by columns."""
        positions, _, gradient = self._written
        first, second = (ca.densify(ca.jacobian(part, self._symbols[0])) for part in (positions, gradient))
        return [
            ca.Function(f"{self._name}_jacobian", self._symbols[:2], [ca.vec(first)]),
            ca.Function(f"{self._name}_hessian", self._symbols, [ca.vec(second)]),
        ]

    @property
    def count(self) -> int:
        """Number of the points."""
        return int(self._written[0].shape[0]) // 3

    @cached_property
    def in_law(self) -> Held:
        """Record of the points for the contact law in C without friction."""
        return self._record({"positions": function_record(self._positions), "gradient": function_record(self.gradient)})

    def in_rubbing_steps(self, libraries: Libraries) -> Held:
        """Record of the points for steps in C with friction, with functions of shared objects or programs."""
        positions, gradient = self.in_iterations
        of_iterations = {"positions": positions, "velocities": self.velocities, "gradient": gradient}
        records = {name: called_in_c(function, libraries.residual) for name, function in of_iterations.items()}
        _, hessian = self.in_derivatives
        by_unknowns = function_record(repeated(hessian, libraries.jacobians, as_scalars=False))
        return self._record(records | {"hessian": by_unknowns})

    def _record(self, functions: Mapping[str, Held]) -> Held:
        """Make the record of the points with the records of their functions."""
        x, inputs, _ = self._symbols
        held = Held(PointsRecord(self.count, x.shape[0], inputs.shape[0]))
        for name, function in functions.items():
            held.point(name, function)
        if self.shares is not None:
            held.share("shares", self.shares)
        return held

    @cached_property
    def in_steps(self) -> dict[str, ca.Function]:
        """Functions that steps in C call, by name.

        Positions and the derivative of their weighted sum as :attr:`in_iterations`; velocities, of (x, inputs, v,
        rate); second derivatives of the sum as :attr:`in_derivatives`; and, where inputs move the points, derivatives
        of the sum and of its derivative with the inputs.
        """
        if self._parts:
            return self._from_parts()
        positions, gradient = self.in_iterations
        _, hessian = self.in_derivatives
        functions = {
            "positions": positions,
            "velocities": self.velocities,
            "gradient": gradient,
            "hessian": hessian,
        }
        written, total, by_x = self._written
        _, inputs, _ = self._symbols
        if ca.jacobian_sparsity(written, inputs).nnz():
            results = [ca.densify(ca.gradient(total, inputs)), ca.densify(ca.jacobian(by_x, inputs))]
            functions["by_inputs"] = ca.Function("by_inputs", self._symbols, results)
        return functions

    def _from_parts(self) -> dict[str, ca.Function]:
        """Functions that steps in C call, which call those of the parts: generated code has each of these once."""
        x, inputs, weights = self._symbols
        stacked = {"positions": [], "velocities": [ca.MX.sym("v", *x.shape), ca.MX.sym("rate", *inputs.shape)]}
        ends = np.cumsum([0, *[3 * part.count for part in self._parts]]).tolist()
        functions = {}
        for word in dict.fromkeys(word for part in self._parts for word in part.in_steps):
            results = []
            for part, own in zip(self._parts, ca.vertsplit(weights, ends), strict=True):
                if word in part.in_steps:
                    plain = part.in_steps[word]
                    symbols = plain.mx_in()
                    routine = ca.Function(f"{part._name}_{word}", symbols, plain.call(symbols), KEPT)
                    results.append(routine.call([x, inputs, *stacked.get(word, [own])]))
            # Derivatives of sums of weighted positions add up.
            of_results = zip(*results, strict=True)
            whole = [ca.vertcat(*each) if word in stacked else sum(each) for each in of_results]
            symbols = [x, inputs, *stacked.get(word, [weights])]
            functions[word] = ca.Function(f"{self._name}_{word}", symbols, whole)
        return functions

    @cached_property
    def _positions(self) -> RepeatedCall:
        return repeated(self.in_iterations[0], self._libraries.residual)

    @cached_property
    def gradient(self) -> RepeatedCall:
        """(x, inputs, weights) ↦ derivative of the weighted sum of positions by the unknowns, shape (n,)."""
        return repeated(self.in_iterations[1], self._libraries.residual)

    def positions(self, x: FloatArray, inputs: FloatArray) -> FloatArray:
        """Positions of the points, shape (M, 3), m; the last result is kept for other contacts and guards."""
        at = [np.ascontiguousarray(values, dtype=float) for values in (x, inputs)]
        called("known_positions", self.in_law.address, *(values.ctypes.data for values in at))
        return self._positions.results[0].reshape(-1, 3).copy()

    @cached_property
    def by_inputs(self) -> RepeatedCall:
        """(x, inputs, weights) ↦ derivative of the weighted sum of positions by the inputs, shape (m,)."""
        derivative = ca.densify(ca.gradient(self._written[1], self._symbols[1]))
        return RepeatedCall(ca.Function("by_inputs", self._symbols, [derivative]))

    def straight_on(
        self, x: FloatArray, inputs: FloatArray, v: FloatArray, rate: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Velocities, and accelerations at constant rates of unknowns and inputs, of the points, shape (M, 3) each."""
        first, second = np.split(self._straight_on(x, inputs, v, rate), 2)
        return first.reshape(-1, 3), second.reshape(-1, 3)

    def hessian(self, x: FloatArray, inputs: FloatArray, weights: FloatArray) -> FloatArray:
        """Second derivative of the weighted sum of positions with respect to the unknowns, shape (n, n)."""
        stacked = self._hessian(x, inputs, weights)
        return stacked.reshape(len(x), len(x))

    def jacobian(self, x: FloatArray, inputs: FloatArray) -> FloatArray:
        """Derivative of the positions with respect to the unknowns, shape (M, 3, n)."""
        stacked = self._jacobian(x, inputs)
        return stacked.reshape(len(x), -1, 3).transpose(1, 2, 0)

    @cached_property
    def _straight_on(self) -> RepeatedCall:
        x, inputs, _ = self._symbols
        v, rate = ca.MX.sym("v", x.shape[0]), ca.MX.sym("rate", inputs.shape[0])

        def rate_of(values: ca.MX) -> ca.MX:
            return ca.jtimes(values, x, v) + ca.jtimes(values, inputs, rate)

        first = rate_of(self._written[0])
        results = [ca.densify(ca.vertcat(first, rate_of(first)))]
        return repeated(ca.Function("straight_on", [x, inputs, v, rate], results), None)

    @cached_property
    def _hessian(self) -> RepeatedCall:
        return repeated(self.in_derivatives[1], self._libraries.jacobians, as_scalars=False)

    @cached_property
    def _jacobian(self) -> RepeatedCall:
        return repeated(self.in_derivatives[0], self._libraries.jacobians, as_scalars=False)


def stacked_size(model: Model) -> int:
    """Number of inputs and parameters of a model together."""
    return model.inputs.size + model.parameters.size


def in_stacked_inputs(
    model: Model, x: ca.MX, inputs: ca.MX, quantities: Callable[[System], list[Matrix]]
) -> list[Matrix]:
    """Quantities of a system as expressions of the unknowns and of the stacked inputs with appended parameters.

    Args:
        model: the model, which may have parameters.
        x: unknowns, n×1.
        inputs: stacked inputs and parameters, with :func:`stacked_size` rows.
        quantities: function of a system ↦ quantities.
    """
    if not model.parameters.size:
        return quantities(System(model.discrete, Arguments(x, inputs)))
    own, p = inputs[: model.inputs.size, 0], inputs[model.inputs.size :, 0]
    system = System(model.discrete, Arguments(x, own))
    written = [ca.MX(quantity) for quantity in quantities(system)]
    found: list[Matrix] = ca.graph_substitute(written, [model.parameters.symbol], [p])
    return found


def nodes_of(model: Model, rod: str, libraries: Libraries = INTERPRETED, carrier: str | None = None) -> MovingPoints:
    """Nodes of a rod, in the axes of the body that carries an obstacle, or of the world if ``carrier`` is None.

    A force on points in the axes of a body has its reaction on the body.
    """
    name = f"rod_{[record.name for record in model.scene.rods].index(rod)}"
    if carrier is None:
        return MovingPoints(model, lambda system: system.nodes(rod), name, libraries)
    name = f"{name}_from_{_number_of(model, carrier)}"
    shares = model.discrete.rods[rod].energy_unit / model.discrete.unknowns.units
    return MovingPoints(model, lambda system: system.seen_from(carrier, system.nodes(rod)), name, libraries, shares)


def nodes_of_both(model: Model, rods: tuple[str, str], libraries: Libraries = INTERPRETED) -> MovingPoints:
    """Nodes of a rod, followed by those of another rod; the energy unit is the one of the first rod."""
    numbers = [[record.name for record in model.scene.rods].index(rod) for rod in rods]
    name = "rods_{}_{}".format(*numbers)
    shares = model.discrete.rods[rods[0]].energy_unit / model.discrete.unknowns.units

    def placed(system: System) -> Matrix:
        return ca.horzcat(*[system.nodes(rod) for rod in rods])

    return MovingPoints(model, placed, name, libraries, shares, [nodes_of(model, rod, libraries) for rod in rods])


def centre_of(model: Model, body: str, libraries: Libraries = INTERPRETED) -> MovingPoints:
    """The origin of a body."""
    return MovingPoints(model, lambda system: system.body(body).position, f"body_{_number_of(model, body)}", libraries)


def _number_of(model: Model, body: str) -> int:
    return [record.name for record in model.scene.bodies].index(body)
