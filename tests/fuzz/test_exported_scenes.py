"""Seeded scenes in C beside Python, away from the numbers of the scene: functions, solves, derivatives, motions."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Compiled, Model, SceneError, build, export, load, scene_from_dict, solve
from cosserat_casadi.codegen.compiled_motion import StepState
from cosserat_casadi.maths.typing import FloatArray
from tests.codegen.libraries import GENERATED, gcc
from tests.conftest import c_flags, quickest_compiler
from tests.families import mostly_slow
from tests.reference.exported_scenes import exported_scene

QUICK = 3
"""Seed of a scene whose C takes a compiler least."""

OF_SIGN = ("length", "modulus", "radius", "width", "height", "stiffness", "density", "tension", "mass", "area")
"""Ends of the names of numbers that have a sign: they move by a share of themselves."""

NOT_KNOWN = 1.0
"""What C tells as an error that its sweeps do not find; Python takes Newton's steps then, as docs/accuracy.md says."""

STEP = 1e-6
"""Share of the numbers by which differences are taken."""


def away(rng: np.random.Generator, layout: Any, share: float) -> FloatArray:
    """Inputs or parameters away from the scene's numbers, stacked; quaternions stay of norm 1."""
    moved = [np.zeros(0)]
    for entry in layout.entries:
        default = np.asarray(entry.default, dtype=float).ravel(order="F")
        size = np.abs(default).max(initial=0.0)
        if entry.name.endswith("quaternion"):
            turned = default + share * rng.normal(size=4)
            moved.append(turned / np.linalg.norm(turned))
        elif entry.name.endswith(OF_SIGN) or any(f".{word}." in entry.name for word in ("section", "material")):
            moved.append(default * (1 + 0.3 * share * rng.uniform(-1, 1, default.size)))
        elif entry.name.endswith((".at", "span", "holes", "pull", "knots")):
            moved.append(default * (1 + 0.05 * share * rng.uniform(-1, 0, default.size)))
        else:
            moved.append(default + share * (size or 0.1) * rng.normal(size=default.size))
    return np.concatenate(moved)


def compiled(model: Model, folder: Path, **options: bool) -> Compiled:
    """The library of a model, of whose sources gcc has nothing to say."""
    export(model, folder / "lib", "lib", **options)
    for source in sorted((folder / "lib").glob("lib*.c")):
        gcc(*GENERATED, "-Werror", "-fsyntax-only", source)
    found = load(folder / "lib", " ".join([quickest_compiler(), *c_flags()]))
    assert isinstance(found, Compiled)
    return found


def drawn_model(seed: int, *, moving: bool = False) -> Model:
    """The model of a seed; scenes that a model of theirs refuses are left out."""
    try:
        return build(scene_from_dict(exported_scene(seed, moving=moving)), moving=moving)
    except SceneError as refused:
        pytest.skip(str(refused))


def stacked(rng: np.random.Generator, library: Compiled, share: float) -> tuple[FloatArray, FloatArray]:
    """Inputs and parameters; those of the scene where the share is zero."""
    if share == 0.0:
        return library.defaults.copy(), library.parameters.pack()
    return away(rng, library.inputs, share), away(rng, library.parameters, share)


@pytest.mark.parametrize("seed", mostly_slow(range(40), quick=[QUICK]))
def test_exported_scenes_vs_python(seed: int, tmp_path: Path) -> None:
    rng = np.random.default_rng(seed)
    model = drawn_model(seed)
    library = compiled(model, tmp_path, batches=seed % 3 == 0)
    rows = []
    for share in (0.0, 0.1, 0.3):
        inputs, p = stacked(rng, library, share)
        given = (inputs, p) if p.size else (inputs,)
        x = 0.3 * rng.normal(size=model.size)
        same_functions(library, model, (x, *given))
        ours = library.solve(inputs, parameters=p)
        try:
            theirs = solve(model, inputs, parameters=p)
        except SceneError:
            # C takes values as they are.
            continue
        assert ours.outcome is theirs.outcome
        rows.append((inputs, p, ours))
        if ours.converged:
            assert_allclose(ours.x, theirs.x, rtol=0, atol=1e-6 * max(1.0, np.abs(theirs.x).max()))
            assert ours.error_estimate is not None
            assert theirs.error_estimate is not None
            if ours.error_estimate < NOT_KNOWN:
                assert_allclose(np.log(ours.error_estimate + 1e-11), np.log(theirs.error_estimate + 1e-11), atol=0.4)
            same_derivatives(rng, library, inputs, p, ours.x)
    many = library.solve_batch(np.array([row[0] for row in rows]), parameters=np.array([row[1] for row in rows]))
    for one, (_, _, alone) in zip(many, rows, strict=True):
        assert one.outcome is alone.outcome
        assert not one.converged or np.allclose(one.x, alone.x, rtol=0, atol=1e-7 * max(1.0, np.abs(alone.x).max()))


def same_functions(library: Compiled, model: Model, given: tuple[FloatArray, ...]) -> None:
    """Residual and poses of tips and bodies."""
    pairs = [(library.residual, model.residual)]
    pairs += [(library.tip[rod], model.tip[rod]) for rod in model.tip]
    pairs += [(library.body[body], model.body[body]) for body in model.body]
    for in_c, in_python in pairs:
        for ours, theirs in zip(in_c.call(list(given)), in_python.call(list(given)), strict=False):
            wanted = theirs.full()
            assert_allclose(ours.full(), wanted, rtol=0, atol=1e-11 * max(1e-9, np.abs(wanted).max()))


def same_derivatives(
    rng: np.random.Generator, library: Compiled, inputs: FloatArray, p: FloatArray, x: FloatArray
) -> None:
    """Derivatives of the solution with inputs and parameters, along one direction each, by differences of solves."""
    by_inputs = library.sensitivity(inputs, x, parameters=p)
    by_parameters = library.parameter_sensitivity(inputs, x, parameters=p)
    assert by_inputs is not None
    assert by_parameters is not None
    for place, columns in enumerate((by_inputs[0], by_parameters.x)):
        values = (inputs, p)[place]
        direction = rng.normal(size=values.size) * np.where(values == 0.0, 1e-2, np.abs(values))
        ends = []
        for sign in (1, -1):
            moved = [inputs, p]
            moved[place] = values + sign * STEP * direction
            ends.append(library.solve(moved[0], start=x, parameters=moved[1]))
        if all(end.converged for end in ends):
            change = (ends[0].x - ends[1].x) / (2 * STEP)
            assert_allclose(columns @ direction, change, rtol=0, atol=1e-3 * max(1e-2, np.abs(change).max()))


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(20))
def test_exported_motions_vs_python(seed: int, tmp_path: Path) -> None:
    """Equations of motion and their derivatives in a state that moves, under other inputs and parameters."""
    rng = np.random.default_rng(seed)
    model = drawn_model(seed, moving=True)
    library = compiled(model, tmp_path, dynamics=True, batches=seed % 4 == 0, estimate_errors=seed % 2 == 0)
    inputs, p = stacked(rng, library, 0.2)
    here = model.at(p) if p.size else model
    x, v, a = 0.3 * rng.normal(size=(3, model.size))
    rate, acceleration = 0.1 * rng.normal(size=(2, inputs.size)) * np.abs(inputs)
    ours = library.inverse_dynamics(StepState(x, v, a), inputs, rate, acceleration, parameters=p)
    theirs = here.inverse_dynamics(x, v, a, inputs, rate, acceleration).full().ravel()
    assert_allclose(ours, theirs, rtol=0, atol=1e-10 * np.abs(theirs).max())
    linear = library.linearise(StepState(x, v, a), inputs, rate, parameters=p)
    stiffness, damping, mass, _ = here.dynamics_jacobian(x, v, a, inputs, rate, 0 * rate)
    for one, other in ((linear.stiffness, stiffness), (linear.damping, damping), (linear.mass, mass)):
        wanted = other.full()
        assert_allclose(one, wanted, rtol=0, atol=1e-10 * np.abs(wanted).max())
