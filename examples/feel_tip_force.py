"""A moving tendon robot feels a force at its tip, from where a camera sees the tip and what its tendons pull.

An extended Kalman filter: the step of the compiled library moves the belief on, its exact derivatives move the
covariance. The force is unknown and wanders. ``feel_tip_force.c`` is the same filter in C, for a controller.
"""

from __future__ import annotations

import argparse
import tempfile
import time
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from cosserat_casadi import Compiled, Model, build, export, load, scene_from_dict
from cosserat_casadi.codegen.compiled_motion import StepMemory, StepState

if TYPE_CHECKING:
    from matplotlib.figure import Figure

PERIOD = 4e-3
"""Time between two measurements, s."""

CAMERA = 5e-4
"""Standard deviation of each coordinate of the tip that is seen, m."""

GAUGE = 0.05
"""Standard deviation of each tension that is measured, N."""

WANDER = 0.1
"""Standard deviation of what each component of the force wanders in a second, N."""

JOLTS = 0.02
"""Standard deviation of the changes of each generalised velocity, in a period, that no model knows, 1/s."""

SPREAD = (1e-3, 1e-2, 0.05)
"""Standard deviations of the first belief: coordinates, velocities (1/s), force (N)."""

TENDONS = ("lower_east", "lower_north", "upper_west", "upper_south")
PULLS = np.array([8.0, 2.0, 9.0, 4.0])
"""Tensions about which the robot moves, N."""

TRUE, FELT = "#222222", "#4477aa"


def robot(modes: int = 2, nodes: int = 6) -> Model:
    """A backbone of nitinol with two sections of tendons, 12 unknowns with two modes of each strain."""
    offsets = {"lower_east": [8e-3, 0.0], "lower_north": [0.0, 8e-3], "upper_west": [-6e-3, 0.0]}
    offsets["upper_south"] = [0.0, -6e-3]
    actuators: list[dict[str, Any]] = []
    for name, pull in zip(TENDONS, PULLS.tolist(), strict=True):
        span = [0.0, 0.5] if name.startswith("lower") else [0.0, 1.0]
        tendon = {"name": name, "kind": "tendon", "rod": "backbone", "tension": pull}
        actuators.append({**tendon, "offset": offsets[name], "span": span})
    backbone = {
        "name": "backbone",
        "length": 0.4,
        "strain": "kirchhoff",
        "material": {"youngs_modulus": 60e9, "poisson_ratio": 0.33, "density": 6450.0},
        "section": {"shape": "circle", "radius": 0.7e-3},
        "damping": {"retardation_time": 5e-3},
    }
    weight = {"name": "weight", "kind": "gravity", "acceleration": [0.0, 0.0, -9.81]}
    touch = {"name": "touch", "kind": "tip_wrench", "rod": "backbone", "force": [0.0, 0.0, 0.0]}
    scene = {
        "schema": 1,
        "title": "A tendon robot that feels what its tip touches",
        "inputs": ["touch.force", *[f"{name}.tension" for name in TENDONS]],
        "accuracy": {"modes": modes, "nodes": nodes},
        "rods": [backbone],
        "loads": [weight, touch],
        "actuators": actuators,
    }
    return build(scene_from_dict(scene), moving=True)


def exported(model: Model, folder: Path) -> Path:
    """The robot as C sources, with its motion."""
    return export(model, folder, "robot", dynamics=True)


def compiled(model: Model) -> Compiled:
    """The robot in C, compiled."""
    with tempfile.TemporaryDirectory() as folder:
        return load(exported(model, Path(folder) / "robot"))


@dataclass(frozen=True)
class Plant:
    """The robot and where its force and its tensions stand among the inputs.

    Attributes:
        model: the robot.
        library: the same in C.
    """

    model: Model
    library: Compiled

    @property
    def force(self) -> slice:
        """Entries of the force."""
        return self.model.inputs.slices["touch.force"]

    @property
    def tensions(self) -> list[int]:
        """Entries of the tensions."""
        return [self.model.inputs.slices[f"{name}.tension"].start for name in TENDONS]

    def inputs(self, force: np.ndarray, tensions: np.ndarray) -> np.ndarray:
        """Stacked inputs."""
        stacked = self.model.pack()
        stacked[self.force] = force
        stacked[self.tensions] = tensions
        return stacked

    def tip(self, state: StepState) -> np.ndarray:
        """Where the tip is, m."""
        position: np.ndarray = self.model.tip["backbone"](state.x, self.model.pack())[0].full().ravel()
        return position

    def tip_derivative(self, state: StepState) -> np.ndarray:
        """Its derivative with the unknowns, 3×size."""
        derivative: np.ndarray = self.model.tip_jacobian["backbone"](state.x, self.model.pack())[0].full()
        return derivative[:3]

    def at_rest(self) -> StepState:
        """The robot at rest, before it is touched."""
        inputs = self.inputs(np.zeros(3), PULLS)
        found = self.library.solve(inputs)
        state = self.library.rest(inputs, found.x) if found.converged else None
        if state is None:
            raise RuntimeError(f"the robot has no state at rest: {found.outcome.value}")
        return state


@dataclass(frozen=True)
class Belief:
    """What the robot believes of itself.

    Attributes:
        state: the motion.
        force: on its tip, N.
        covariance: of unknowns, velocities and force, square.
        memory: of the steps.
    """

    state: StepState
    force: np.ndarray
    covariance: np.ndarray
    memory: StepMemory

    @property
    def mean(self) -> np.ndarray:
        """Unknowns, velocities and force, stacked."""
        return np.concatenate([self.state.x, self.state.v, self.force])

    def deviating(self, change: np.ndarray) -> Belief:
        """The belief with another mean."""
        size = len(self.state.x)
        state = replace(self.state, x=self.state.x + change[:size], v=self.state.v + change[size : 2 * size])
        return replace(self, state=state, force=self.force + change[2 * size :])


def first_belief(plant: Plant) -> Belief:
    """At rest and untouched, as far as one knows."""
    size = plant.model.size
    deviations = np.repeat(SPREAD, [size, size, 3])
    return Belief(plant.at_rest(), np.zeros(3), np.diag(deviations**2), plant.library.step_memory())


def predicted(plant: Plant, belief: Belief, tensions: np.ndarray) -> Belief:
    """One period on, with the tensions that were measured: they, the force and the motion are not quite as believed."""
    inputs = plant.inputs(belief.force, tensions)
    taken, derivatives = plant.library.step_sensitivity(belief.state, PERIOD, inputs, memory=belief.memory)
    if derivatives is None:
        raise RuntimeError(f"no step: {taken.status.value}")
    size = plant.model.size
    transition = np.eye(2 * size + 3)
    transition[: 2 * size, : 2 * size] = derivatives.by_start
    transition[: 2 * size, 2 * size :] = derivatives.by_inputs[:, plant.force]
    covariance = transition @ belief.covariance @ transition.T
    pulls = derivatives.by_inputs[:, plant.tensions]
    covariance[: 2 * size, : 2 * size] += GAUGE**2 * pulls @ pulls.T
    covariance[size : 2 * size, size : 2 * size] += JOLTS**2 * np.eye(size)
    covariance[2 * size :, 2 * size :] += WANDER**2 * PERIOD * np.eye(3)
    return Belief(taken.state, belief.force, covariance, belief.memory)


def corrected(plant: Plant, belief: Belief, seen: np.ndarray) -> Belief:
    """The belief after the tip was seen; coordinate after coordinate, so that nothing is inverted."""
    missed = seen - plant.tip(belief.state)
    derivative = plant.tip_derivative(belief.state)
    size = plant.model.size
    change = np.zeros(2 * size + 3)
    covariance = belief.covariance.copy()
    for innovation, row in zip(missed, derivative, strict=True):
        gain = covariance[:, :size] @ row
        gain /= row @ gain[:size] + CAMERA**2
        left = np.eye(len(change))
        left[:, :size] -= np.outer(gain, row)
        change += gain * (innovation - row @ change[:size])
        # Joseph's form stays positive under rounding.
        covariance = left @ covariance @ left.T + CAMERA**2 * np.outer(gain, gain)
    return replace(belief.deviating(change), covariance=covariance)


@dataclass(frozen=True)
class Run:
    """A motion of the true robot, and what was measured of it.

    Attributes:
        states: unknowns, velocities and force, stacked, shape (k, 2 size + 3).
        tensions: as measured, shape (k, 4), N.
        seen: the tip, shape (k, 3), m.
    """

    states: np.ndarray
    tensions: np.ndarray
    seen: np.ndarray


def wave(steps: int) -> np.ndarray:
    """Tensions of the move, steps×4, N."""
    phase = 2 * np.pi * np.arange(steps)[:, None] * PERIOD / np.array([0.5, 0.7, 0.6, 0.9])
    tensions: np.ndarray = PULLS * (1 + 0.4 * np.sin(phase))
    return tensions


def true_motion(plant: Plant, steps: int, seed: int) -> Run:
    """The robot as it is: it begins beside where one believes it, and nothing of it is known but what is measured."""
    noise = np.random.default_rng(seed)
    belief = first_belief(plant).deviating(
        noise.normal(size=2 * plant.model.size + 3) * np.repeat(SPREAD, _sizes(plant))
    )
    rows = []
    tensions = wave(steps)
    seen = []
    for pulls in tensions:
        inputs = plant.inputs(belief.force, pulls)
        taken = plant.library.step(belief.state, PERIOD, inputs, memory=belief.memory)
        if not taken.done:
            raise RuntimeError(f"no step: {taken.status.value}")
        jolted = replace(taken.state, v=taken.state.v + noise.normal(size=plant.model.size) * JOLTS)
        wandered = belief.force + noise.normal(size=3) * WANDER * np.sqrt(PERIOD)
        belief = replace(belief, state=jolted, force=wandered)
        rows.append(belief.mean)
        seen.append(plant.tip(jolted) + noise.normal(size=3) * CAMERA)
    measured = tensions + noise.normal(size=tensions.shape) * GAUGE
    return Run(np.array(rows), measured, np.array(seen))


def _sizes(plant: Plant) -> list[int]:
    return [plant.model.size, plant.model.size, 3]


def filtered(plant: Plant, run: Run) -> list[Belief]:
    """What the robot believes after each measurement."""
    belief = first_belief(plant)
    beliefs = []
    for tensions, seen in zip(run.tensions, run.seen, strict=True):
        belief = corrected(plant, predicted(plant, belief, tensions), seen)
        beliefs.append(belief)
    return beliefs


def normalised_error(belief: Belief, truth: np.ndarray) -> float:
    """Squared error of the belief, normalised by its covariance (NEES): as many as entries, on average."""
    scale = np.sqrt(np.diag(belief.covariance))
    correlation = belief.covariance / scale[:, None] / scale
    error = (truth - belief.mean) / scale
    return float(error @ np.linalg.solve(correlation, error))


def draw(run: Run, beliefs: list[Belief], path: str) -> None:
    """The force as it was and as it was felt, with a band of two standard deviations."""
    from matplotlib import pyplot as plt

    figure: Figure
    figure, axes = plt.subplots(3, 1, figsize=(7, 6), sharex=True, layout="constrained")
    times = PERIOD * np.arange(1, len(beliefs) + 1)
    felt = np.array([belief.force for belief in beliefs])
    deviation = np.sqrt([np.diag(belief.covariance)[-3:] for belief in beliefs])
    for i, axis in enumerate("xyz"):
        axes[i].fill_between(
            times, felt[:, i] - 2 * deviation[:, i], felt[:, i] + 2 * deviation[:, i], color=FELT, alpha=0.25
        )
        axes[i].plot(times, felt[:, i], color=FELT, label="felt, ± 2 standard deviations")
        axes[i].plot(times, run.states[:, -3 + i], color=TRUE, linewidth=1, label="true")
        axes[i].set_ylabel(f"force {axis} [N]")
    axes[0].legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=2, frameon=False)
    axes[-1].set_xlabel("time [s]")
    figure.savefig(path, dpi=150)
    plt.close(figure)


def main() -> None:
    """Run the filter once, print what it felt, draw it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--steps", type=int, default=250, help="measurements, 4 ms apart")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--output", help="picture to write")
    parser.add_argument("--export", type=Path, help="folder to write the robot to, in C, and nothing else")
    chosen = parser.parse_args()
    model = robot()
    if chosen.export:
        exported(model, chosen.export)
        return
    plant = Plant(model, compiled(model))
    run = true_motion(plant, chosen.steps, chosen.seed)
    began = time.perf_counter()
    beliefs = filtered(plant, run)
    spent = (time.perf_counter() - began) / chosen.steps
    missed = np.linalg.norm([belief.force - row[-3:] for belief, row in zip(beliefs, run.states, strict=True)], axis=1)
    late = missed[len(missed) // 2 :]
    print(f"force at the tip: {1e3 * np.sqrt(np.mean(late**2)):.1f} mN off in the mean of the second half")
    print(f"{1e3 * spent:.2f} ms for a measurement in Python, of {1e3 * PERIOD:g} ms")
    if chosen.output:
        draw(run, beliefs, chosen.output)


if __name__ == "__main__":
    main()
