"""Outputs of a linearised scene: positions of tips, bodies and sections, and the conjugates of actuators."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeAlias

import casadi as ca
import numpy as np

from cosserat_casadi.equilibrium.solution import Solution
from cosserat_casadi.errors import Problem, refuse
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model

AXES = ("x", "y", "z")

Place: TypeAlias = tuple[str, float]
"""A section of a rod: its name and the abscissa X."""


@dataclass(frozen=True)
class Outputs:
    """Outputs as linear functions of unknowns and inputs.

    Attributes:
        names: of all outputs.
        by_x: derivatives with the unknowns in motion, shape (outputs, size).
        by_inputs: derivatives with the inputs, shape (outputs, inputs).
    """

    names: tuple[str, ...]
    by_x: FloatArray
    by_inputs: FloatArray


def outputs_of(solution: Solution, wanted: Sequence[str | Place] | None) -> Outputs:
    """The wanted outputs.

    Raises:
        SceneError: with every one that is none.
    """
    model = solution.model
    x = ca.MX.sym("x", model.size)
    inputs = ca.MX.sym("inputs", model.inputs.size)
    known = _known_outputs(model, x, inputs)
    chosen = _default_outputs(model) if wanted is None else list(wanted)
    problems: list[Problem] = []
    values = []
    names: list[str] = []
    for output in chosen:
        if isinstance(output, str) and output in known:
            name = output
            value = known[name]
        elif not isinstance(output, str) and output[0] in model.shape and 0.0 <= output[1] <= 1.0:
            rod, X = output
            name = f"{rod}.position({X:g})"
            value = model.shape[rod](x, inputs, X)[0]
        else:
            remedy = f"its outputs are sections (rod, X) with X in [0, 1], and {', '.join(known)}"
            problems.append(Problem("outputs", f"{output!r} is not an output of this scene", remedy))
            continue
        values.append(value)
        names += [name] if value.shape[0] == 1 else [f"{name}.{axis}" for axis in AXES]
    refuse(problems)
    stacked = ca.vertcat(*values)
    derivatives = ca.Function("outputs", [x, inputs], [ca.jacobian(stacked, x), ca.jacobian(stacked, inputs)])
    by_x, by_inputs = derivatives(solution.x, solution.inputs)
    # Flows are behind the unknowns that sections see.
    unseen = np.zeros((len(names), model.in_motion.size - model.size))
    return Outputs(tuple(names), np.hstack([by_x.full(), unseen]), by_inputs.full())


def _default_outputs(model: Model) -> list[str | Place]:
    """Tips, and middles of rods whose tip a support holds."""
    held = {support.rod for support in model.scene.supports}
    chosen: list[str | Place] = []
    for rod in model.discrete.rods:
        if rod in held:
            chosen.append((rod, 0.5))
        else:
            chosen.append(f"{rod}.tip.position")
    return chosen


def _known_outputs(model: Model, x: ca.MX, inputs: ca.MX) -> dict[str, ca.MX]:
    """All that has a name and may be an output."""
    known = {}
    for rod in model.discrete.rods:
        known[f"{rod}.tip.position"] = model.tip[rod](x, inputs)[0]
    for body in model.body:
        known[f"{body}.position"] = model.body[body](x, inputs)[0]
    for actuator, function in model.actuator.items():
        known[f"{actuator}.{function.name_out(1)}"] = function(x, inputs)[1]
    return known
