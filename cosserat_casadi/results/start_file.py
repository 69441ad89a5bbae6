"""Reading a result file: the initial equilibrium of a motion."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from cosserat_casadi.equilibrium.solution import Solution
from cosserat_casadi.equilibrium.solve import solve
from cosserat_casadi.errors import Problem, SceneError
from cosserat_casadi.maths.numbers import known
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model, build
from cosserat_casadi.model.element_ends import CLOSEST, element_ends
from cosserat_casadi.motion.checkpoint import Checkpoint, read_checkpoint
from cosserat_casadi.rod.discretisation import Discretisation
from cosserat_casadi.scene import Scene
from cosserat_casadi.scene.accuracy import MOST_FIBRES, MOST_MODES, MOST_NODES, MOST_SECTIONS

WHERE = "--from"

AGREEMENT = 1e-6
"""Largest distance of positions from those of the file, over the length, for the same equilibrium."""


def read_start(path: str | Path, scene: Scene) -> Solution | Checkpoint:
    """The equilibrium of a result file, checked against a scene; for the file of a motion, its checkpoint.

    A result file lists strains along the rods, which give the strain coordinates. Multipliers, floating frames and
    exact contacts are found by a further solve, at the inputs of the file and on its discretisation.

    Args:
        path: path of a file written by ``cosserat solve``.
        scene: the scene; apart from inputs it must be the scene of the file.

    Raises:
        SceneError: the file cannot be read, holds no equilibrium, or its equilibrium is not one of the scene.
    """
    checkpoint = read_checkpoint(path)
    if checkpoint is not None:
        return checkpoint
    data = _read(Path(path))
    if data.get("converged") is not True:
        raise _refusal(path, "holds no equilibrium", "solve the scene first")
    # Free bases are clamped in statics.
    held = scene.held().baked()
    try:
        model = build(held, _discretisation(data, held))
        # Contacts are searched again: the elements of the file, split at contacts, differ from those of the scene.
        guess = None if held.touches_exactly else _strain_coordinates(model, data)
        solution = solve(model, _inputs(model, data), start=guess)
        distance = _distance(solution, data)
    except (KeyError, TypeError, ValueError, IndexError) as error:
        problem = "is no result file of this scene: something that it should hold is missing or of another shape"
        raise _refusal(path, problem, "write it with cosserat solve SCENE --output") from error
    # With NaN the comparison is false.
    if not (solution.converged and distance <= AGREEMENT):
        problem = "holds an equilibrium that this scene does not have"
        raise _refusal(path, problem, "the scene was changed since: solve it again")
    return solution


def _read(path: Path) -> dict[str, Any]:
    try:
        # Numbers are read in double precision: one of 400 digits is infinite, and refused.
        data = json.loads(path.read_text(encoding="utf-8"), parse_int=_whole_number)
    except OSError as error:
        raise _refusal(path, f"cannot be read: {error.strerror}", "") from error
    except (ValueError, RecursionError) as error:
        raise _refusal(path, "is not JSON", "write it with cosserat solve SCENE --output") from error
    if not isinstance(data, dict):
        raise _refusal(path, "is no result file", "write it with cosserat solve SCENE --output")
    return data


def _whole_number(digits: str) -> int | float:
    """An integer of JSON as a number; infinite beyond the range of double precision."""
    number = float(digits)
    return int(number) if math.isfinite(number) else number


def _refusal(path: str | Path, problem: str, remedy: str) -> SceneError:
    return SceneError(Problem(WHERE, f"{path} {problem}", remedy))


def _discretisation(data: Mapping[str, Any], scene: Scene) -> dict[str, Discretisation]:
    """The discretisation of every rod.

    Raises:
        ValueError: an invalid discretisation.
    """
    chosen = {}
    for rod in scene.rods:
        entry = data["discretisation"][rod.name]
        breaks = element_ends(scene, rod.name) if scene.touches_exactly else tuple(entry["breaks"])
        modes = tuple(entry["modes"])
        _check_whole(*modes, least=1, most=MOST_MODES)
        _check_whole(entry["nodes"], least=2, most=MOST_NODES)
        sums = entry.get("sections", 0), entry.get("fibres", 0)
        _check_whole(sums[0], least=0, most=MOST_SECTIONS)
        _check_whole(sums[1], least=0, most=MOST_FIBRES)
        places = _finite_array(breaks)
        if places[0] != 0.0 or places[-1] != 1.0 or np.diff(places).min() < CLOSEST:
            raise ValueError("breaks do not ascend from 0 to 1")
        chosen[rod.name] = Discretisation(modes, entry["nodes"], tuple(places.tolist()), entry["transport"], *sums)
    return chosen


def _check_whole(*numbers: Any, least: int, most: int) -> None:
    for number in numbers:
        if type(number) is not int or not least <= number <= most:
            raise ValueError(f"{number!r} is no number from {least} to {most}")


def _finite_array(listed: Any) -> FloatArray:
    """An array of the file, with finite numbers.

    Raises:
        ValueError: a number is missing or not finite.
    """
    array = np.asarray(listed, dtype=float)
    if not array.size or not np.all(np.isfinite(array)):
        raise ValueError("numbers are missing or not finite")
    return array


def _abscissae(listed: Any) -> FloatArray:
    """Abscissae X of the file.

    Raises:
        ValueError: an abscissa is outside [0, 1].
    """
    X = _finite_array(listed)
    if X.ndim != 1 or X.min() < 0.0 or X.max() > 1.0:
        raise ValueError("an abscissa does not lie on the rod")
    return X


def _inputs(model: Model, data: Mapping[str, Any]) -> dict[str, FloatArray]:
    """Values of the inputs in the file; further inputs have the values of the scene."""
    values = {}
    for entry in model.inputs.entries:
        if entry.name not in data["inputs"]:
            continue
        listed = _finite_array(data["inputs"][entry.name])
        components, degrees = entry.shape
        # Legendre coefficients are rows in the file.
        values[entry.name] = listed.reshape(degrees, components).T
    return values


def _strain_coordinates(model: Model, data: Mapping[str, Any]) -> FloatArray:
    """Unknowns, shape (size,): strain coordinates fitted to the strains of the file, other unknowns zero."""
    x = model.unloaded()
    stacked = model.pack(_inputs(model, data))
    for name, rod in model.discrete.rods.items():
        X = _abscissae(data["rods"][name]["X"])
        strain = _finite_array(data["rods"][name]["strain"])
        intrinsic = known(rod.properties.intrinsic_strain(X))
        # Strain coordinates refer to the reference length, strains to the current length of the rod.
        deviation = (strain - intrinsic) * model.length_ratio(name, stacked)
        q = x[model.discrete.unknowns.strain(name)]
        for component, columns in rod.columns.items():
            strain_of = known(rod.strain_of(component, X))
            q[columns] = np.linalg.lstsq(strain_of, deviation[:, component], rcond=None)[0]
    return x


def _distance(solution: Solution, data: Mapping[str, Any]) -> float:
    """Largest distance between positions of a solution and of the file, over the length of the rod."""
    distances = []
    for name, rod in solution.model.discrete.rods.items():
        listed = data["rods"][name]
        position = solution.pose(_abscissae(listed["X"]), name).position
        change = position - _finite_array(listed["position"])
        distances.append(float(np.abs(change).max()) / rod.properties.length)
    return max(distances)
