"""The task: a robot, a move of its tip, bounds on its tendons; what is known of the robot and what is moved."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from cosserat_casadi import Model, build, inverse, read_scene

SCENE = Path(__file__).parents[1] / "two_section_robot.toml"

TENDONS = ["lower_east", "lower_north", "upper_west", "upper_south"]

TENSIONS = [f"{tendon}.tension" for tendon in TENDONS]

COUNT = len(TENDONS)

STEP, STAGES = 0.02, 20
"""Time between two steps, s, and how many of them the controllers look ahead."""

LARGEST, RATE = 30.0, 30.0
"""Bounds on the tensions, which are not negative, N, and on their rates, N/s."""

START, MOVE, DURATION = np.array([-0.04, -0.075, 0.37]), np.array([0.0, 0.15, 0.0]), 0.3
"""Where the tip rests at first and where it goes, m, and in which time, s."""

SETTLING, WATCHED = 0.2, 1.0
"""Time at rest before the move, and after it, s."""

DAMPING, EMPTY = "backbone.damping={retardation_time=2e-3}", "payload.force=[0, 0, 0]"
"""What is changed in the scene: the rod is damped, and its payload of 0.1 N taken off."""

PAYLOAD = 0.4e-3
"""Mass at the tip, kg: a tenth of the robot's."""


def wanted_at(seconds: np.ndarray) -> np.ndarray:
    """Wanted points of the tip: a straight line with the least jerk, at rest before and after it."""
    share = np.clip(seconds / DURATION, 0.0, 1.0)
    smooth = share**3 * (10 - 15 * share + 6 * share**2)
    return START + smooth[:, None] * MOVE


def known_model() -> Model:
    """What the controllers know: the robot without payload, and a force at its tip to make up for it."""
    inputs = f"inputs={[*TENSIONS, 'payload.force']}"
    return build(read_scene(SCENE, [inputs, DAMPING, EMPTY, "accuracy={modes=2, nodes=2}"]))


def moved_model(modes: int = 4) -> Model:
    """What is moved: with more modes, and a payload; its tip is to be where the move begins."""
    body = f"bodies=[{{name='load', mass={PAYLOAD}, inertia=[1e-9, 1e-9, 1e-9]}}]"
    joint = "joints=[{body='load', rod='backbone', kind='fixed'}]"
    accuracy = f"accuracy={{modes={modes}, nodes=6}}"
    target = f"targets=[{{kind='position', rod='backbone', position={START.tolist()}}}]"
    changes = [f"inputs={TENSIONS}", DAMPING, EMPTY, accuracy, body, joint, target]
    return build(read_scene(SCENE, changes), moving=True)


def start_tensions(model: Model) -> np.ndarray:
    """Tensions that hold the tip where the move begins, N."""
    # The move is one of this model, whatever its modes leave.
    found = inverse(model, estimate_error=False)
    if not found.met:
        raise RuntimeError(found.solution.message)
    return np.array([float(found.values[name]) for name in TENSIONS])
