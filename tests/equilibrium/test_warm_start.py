"""Turn after turn from the solution before: a solve that is near never begins again from the unloaded scene."""

from __future__ import annotations

import importlib

import numpy as np
import pytest

from cosserat_casadi import Model, build, discretise, scene_from_dict, solve
from tests.scenes import cable_lengths, three_cables


@pytest.fixture(scope="module")
def model() -> Model:
    wanted = three_cables()
    return build(wanted, discretise(wanted, 2, 4))


def refuse(*arguments: object) -> None:
    raise AssertionError("a warm solve began again from the unloaded scene")


@pytest.mark.slow
@pytest.mark.parametrize(("step", "turns"), [(2e-4, 500), (6e-4, 500), (6e-4, 120)])
@pytest.mark.parametrize("kind", ["unknowns", "solution"])
def test_cables_moved_turn_after_turn(
    model: Model, step: float, turns: int, kind: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    lengths = cable_lengths(step, turns)
    found = solve(model, model.inputs.unpack(lengths[0]))
    assert found.converged
    monkeypatch.setattr(importlib.import_module("cosserat_casadi.equilibrium.solve"), "load_path", refuse)
    furthest = 0.0
    for inputs in lengths[1:]:
        before = found
        found = solve(model, model.inputs.unpack(inputs), start=before if kind == "solution" else before.x)
        assert found.converged, found.message
        furthest = max(furthest, float(np.abs(found.x - before.x)[-3:].max()))
    # Tensions move by more than any shape may: they must not count.
    assert furthest > 1.0


def platform() -> Model:
    """Three rods on a circle of 80 mm carry a plate; their lengths are inputs."""
    angles = [2 * np.pi * k / 3 for k in range(3)]
    places = [[float(np.cos(angle)), float(np.sin(angle)), 0.0] for angle in angles]
    legs = [
        {
            "name": f"leg_{k}",
            "length": 0.4,
            "strain": "kirchhoff",
            "material": {"youngs_modulus": 60e9, "poisson_ratio": 0.33, "density": 6450.0},
            "section": {"shape": "circle", "radius": 1e-3},
            "base": {"position": [0.08 * number for number in place]},
        }
        for k, place in enumerate(places)
    ]
    joints = [
        {"kind": "fixed", "rod": f"leg_{k}", "body": "plate", "position": [0.05 * number for number in place]}
        for k, place in enumerate(places)
    ]
    wanted = scene_from_dict(
        {
            "schema": 1,
            "inputs": [f"leg_{k}.length" for k in range(3)],
            "rods": legs,
            "bodies": [{"name": "plate", "mass": 0.05}],
            "joints": joints,
            "loads": [{"name": "weight", "kind": "gravity", "acceleration": [0.0, 0.0, -9.81]}],
        }
    )
    return build(wanted, discretise(wanted, 4, 8))


def test_platform_moved_by_millimetres(monkeypatch: pytest.MonkeyPatch) -> None:
    """Multipliers of a platform move far in a turn: solves that are right begin nowhere else."""
    model = platform()
    step = 3e-3
    amplitude = 0.03
    phases = np.arange(16)[:, None] * step / amplitude + 2 * np.pi * np.arange(3) / 3
    lengths = 0.4 + amplitude * np.cos(phases)
    found = solve(model, lengths[0])
    assert found.converged
    monkeypatch.setattr(importlib.import_module("cosserat_casadi.equilibrium.solve"), "load_path", refuse)
    for turn in lengths[1:]:
        found = solve(model, turn, start=found)
        assert found.converged, found.message
        assert found.iterations <= 6
