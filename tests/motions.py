"""Motions made up for the tests: from one equilibrium to another along a cosine, without a simulation."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
import numpy.typing as npt

from cosserat_casadi import Model, Scene, build, solve
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.motion.trajectory import Account, Energies, Motion, MotionOutcome, MotionState, StepStatistics
from tests.scenes import HOOK, push, rod, scene

STATISTICS = StepStatistics(steps=57, rejected=3, iterations=211, jacobians=18, smallest_step=2.5e-4, largest_step=0.03)
START = "At rest in the equilibrium of the inputs at t = 0."


class Swing:
    """Unknowns and inputs that go from those of one equilibrium to those of another in a time, and stop there."""

    def __init__(self, model: Model, values: Mapping[str, npt.ArrayLike], duration: float) -> None:
        before = solve(model)
        after = solve(model, values)
        self.x = before.x
        self.x_change = after.x - before.x
        self.inputs = before.inputs
        self.inputs_change = after.inputs - before.inputs
        self.frequency = np.pi / duration

    def at(self, time: float) -> MotionState:
        """The state, by (1 - cos)/2 of the way."""
        phase = self.frequency * time
        way = (1 - np.cos(phase)) / 2
        speed = self.frequency * np.sin(phase) / 2
        acceleration = self.frequency**2 * np.cos(phase) / 2
        return MotionState(
            x=self.x + way * self.x_change,
            v=speed * self.x_change,
            a=acceleration * self.x_change,
            inputs=self.inputs + way * self.inputs_change,
        )


def motion_of(
    scene: Scene, values: Mapping[str, npt.ArrayLike], duration: float = 0.5, frames: int = 21, **changes: Any
) -> Motion:
    """A made-up motion of a scene to the equilibrium of these values; fields of the record may be changed."""
    model = build(scene)
    swing = Swing(model, values, duration)
    times = np.linspace(0.0, duration, frames)
    states = [swing.at(time) for time in times]
    return Motion(**{**_fields(model, times, states, swing), **changes})


def _fields(model: Model, times: FloatArray, states: list[MotionState], swing: Swing) -> dict[str, Any]:
    return {
        "model": model,
        "outcome": MotionOutcome.COMPLETED,
        "message": MotionOutcome.COMPLETED.value,
        "times": times,
        "x": np.array([state.x for state in states]).reshape(len(times), model.size),
        "v": np.array([state.v for state in states]).reshape(len(times), model.size),
        "a": np.array([state.a for state in states]).reshape(len(times), model.size),
        "inputs": np.array([state.inputs for state in states]).reshape(len(times), model.inputs.size),
        "error_estimate": 3e-5,
        "statistics": STATISTICS,
        "start": START,
        "interpolant": swing.at,
        "account": partial(told, energies(times)),
    }


def told(energy: Energies) -> Account:
    """Energies of a motion from which none goes on."""
    return energy, None


def with_energies(motion: Motion, **changed: FloatArray) -> Motion:
    """A motion with other energies."""
    return replace(motion, account=partial(told, replace(motion.energy, **changed)))


def energies(times: FloatArray) -> Energies:
    """Made-up energies that look like those of a swing."""
    return Energies(
        kinetic=0.02 * np.sin(12 * times) ** 2,
        elastic=0.05 * np.cos(12 * times) ** 2,
        potential=-0.03 * times,
        dissipated=0.01 * times,
        work=0.04 * np.sin(3 * times),
        impacts=0.002 * (times > 0.1),
        imbalance=1e-6 * np.sin(40 * times),
    )


def swinging_rod(**changes: Any) -> Motion:
    """A rod in space, pushed at its tip and hooked between its ends; the push moves."""
    return motion_of(scene(push(), HOOK, strain="kirchhoff"), {"push.force": [-0.6, 0.4, 0.3]}, **changes)


def planar_swing(**changes: Any) -> Motion:
    """A rod in the x–z plane."""
    flat = scene(push(force=[0.9, 0.0, -0.4]), strain="planar")
    return motion_of(flat, {"push.force": [-0.8, 0.0, 0.3]}, **changes)


def two_rods_on_a_platform(**changes: Any) -> Motion:
    """Two rods in space that carry a platform between them; a tendon pulls one of them."""
    stiff = {"bending_x": 1.0, "bending_y": 1.0, "torsion": 0.8}
    left = rod(name="left", stiffness=stiff)
    right = rod(name="right", stiffness=stiff, base={"position": [0.3, 0.0, 0.0]})
    platform = {
        "schema": 1,
        "title": "Two rods, one platform",
        "bodies": [{"name": "platform", "mass": 0.1, "centre_of_mass": [0.15, 0.0, 0.0]}],
        "joints": [
            {"kind": "spherical", "rod": "left", "body": "platform", "position": [0.0, 0.0, 0.0]},
            {"kind": "fixed", "rod": "right", "body": "platform", "position": [0.3, 0.0, 0.0]},
        ],
        "actuators": [{"name": "cable", "kind": "tendon", "rod": "left", "offset": [0.01, 0.0], "tension": 5.0}],
    }
    weight = {"name": "weight", "kind": "gravity", "acceleration": [0.0, 0.0, -9.81]}
    crown = {"name": "crown", "kind": "body_wrench", "body": "platform", "force": [0.0, 0.0, 0.0]}
    both = scene(weight, crown, **{**platform, "rods": [left, right]})
    return motion_of(both, {"crown.force": [0.8, 0.9, -0.5], "cable.tension": 30.0}, **changes)


def without_start() -> Motion:
    """What a simulation gives that found no state to start from: no row at all."""
    motion = swinging_rod()
    none = np.zeros(0)
    return Motion(
        model=motion.model,
        outcome=MotionOutcome.NO_START,
        message=MotionOutcome.NO_START.value,
        times=none,
        x=motion.x[:0],
        v=motion.v[:0],
        a=motion.a[:0],
        inputs=motion.inputs[:0],
        error_estimate=float("nan"),
        statistics=StepStatistics(0, 0, 0, 0, float("nan"), float("nan")),
        start="",
        interpolant=motion.interpolant,
        account=partial(told, energies(none)),
    )
