"""The file of modes: the equilibrium, and eigenvalue, frequency, damping and shape of each mode."""

from __future__ import annotations

from typing import Any

import numpy as np

from cosserat_casadi.motion.mode_shapes import RodShape
from cosserat_casadi.motion.vibration_modes import Modes
from cosserat_casadi.results.solution_file import listed_abscissae


def modes_result(modes: Modes) -> dict[str, Any]:
    """Modes as the data of their file."""
    return {
        "title": modes.model.scene.title,
        "converged": modes.converged,
        "outcome": modes.outcome.label,
        "message": modes.message,
        "equilibrium": modes.solution.to_dict(),
        "modes": _mode_entries(modes),
    }


def _mode_entries(modes: Modes) -> list[dict[str, Any]]:
    if not modes.modes:
        return []
    shapes: dict[str, RodShape] = {}
    for name in modes.model.discretisation:
        shapes[name] = modes.shape(listed_abscissae(modes.model.element_ends(name)), name)
    return [
        {
            "eigenvalue": [mode.eigenvalue.real, mode.eigenvalue.imag],
            "angular_frequency": mode.angular_frequency,
            "frequency": mode.frequency,
            "damping_ratio": mode.damping_ratio,
            "error_estimate": mode.error_estimate,
            "shape": {name: _shape_entry(shape, index) for name, shape in shapes.items()},
        }
        for index, mode in enumerate(modes.modes)
    ]


def _shape_entry(shape: RodShape, index: int) -> dict[str, Any]:
    """Displacements and rotations of one mode, with imaginary parts if it is not in phase everywhere."""
    position = shape.position[index]
    rotation = shape.rotation[index]
    entry: dict[str, Any] = {"X": shape.X, "position": position.real, "rotation": rotation.real}
    if np.any(position.imag) or np.any(rotation.imag):
        entry["imaginary"] = {"position": position.imag, "rotation": rotation.imag}
    return entry
