"""Equilibria and frequencies of chains in MuJoCo, by its own forces and mass matrix."""

from __future__ import annotations

from typing import Any

import mujoco
import numpy as np

from cosserat_casadi import Scene, Solution
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.mjcf.export import mjcf_of
from tests.derivatives import central_differences

DIFFERENCE = 1e-6
"""Change of a coordinate by which forces are differenced, rad and m."""


class Chain:
    """A model of MuJoCo in the equilibrium of its controls, to which it is led while gravity and controls grow."""

    def __init__(self, scene: Scene, links: int, shares: int = 4) -> None:
        self.model: Any = mujoco.MjModel.from_xml_string(mjcf_of(scene, links).text)
        # Forces of the integrator ``discrete`` are those of a step.
        self.model.opt.integrator = mujoco.mjtIntegrator.mjINT_EULER
        self.data: Any = mujoco.MjData(self.model)
        mujoco.mj_resetDataKeyframe(self.model, self.data, 0)
        controls = self.data.ctrl.copy()
        gravity = self.model.opt.gravity.copy()
        self.q: FloatArray = self.data.qpos.copy()
        for share in np.linspace(1.0 / shares, 1.0, shares):
            self.model.opt.gravity[:] = share * gravity
            self.data.ctrl[:] = share * controls
            self._find()

    def _find(self) -> None:
        """Newton's method for the equilibrium of the present controls."""
        for _ in range(40):
            force = self._force(self.q)
            if np.abs(force).max() < 1e-10:
                return
            step = np.linalg.solve(self.stiffness(), force)
            step *= min(1.0, 0.5 / np.abs(step).max())
            mujoco.mj_integratePos(self.model, self.q, step, 1.0)
        raise AssertionError(f"no equilibrium: a force of {np.abs(force).max()} is left")

    def _force(self, q: FloatArray) -> FloatArray:
        """Force on each coordinate at rest, shape (nv,)."""
        self.data.qpos[:] = q
        self.data.qvel[:] = 0.0
        mujoco.mj_forward(self.model, self.data)
        return np.asarray(self.data.qfrc_passive + self.data.qfrc_actuator - self.data.qfrc_bias)

    def stiffness(self) -> FloatArray:
        """Rate of minus the forces with the coordinates, shape (nv, nv)."""

        def force_after(step: FloatArray) -> FloatArray:
            moved = self.q.copy()
            mujoco.mj_integratePos(self.model, moved, step, 1.0)
            return self._force(moved)

        rates = central_differences(force_after, np.zeros(self.model.nv), DIFFERENCE)
        self._force(self.q)
        return -rates

    def frequencies(self, count: int) -> FloatArray:
        """Lowest frequencies without damping, Hz, shape (count,)."""
        stiffness = self.stiffness()
        mass = np.zeros_like(stiffness)
        mujoco.mj_fullM(self.model, self.data, mass)
        squares = np.linalg.eigvals(np.linalg.solve(mass, stiffness))
        return np.sqrt(np.sort(squares.real)[:count]) / (2 * np.pi)

    def tip(self, rod: str) -> FloatArray:
        """Position of a tip, m, shape (3,)."""
        return np.array(self.data.site(f"{rod}/tip").xpos)


def settled(scene: Scene, links: int, seconds: float, damping: float = 0.02) -> Any:
    """Model and data of a scene after some time, with a retardation time of its joints at least, s."""
    model: Any = mujoco.MjModel.from_xml_string(mjcf_of(scene, links).text)
    data: Any = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    model.dof_damping[:] = np.maximum(model.dof_damping, damping * model.jnt_stiffness[model.dof_jntid])
    for _ in range(round(seconds / model.opt.timestep)):
        mujoco.mj_step(model, data)
    return model, data


def kept_loop(scene: Scene, links: int) -> Any:
    """Data of a scene with loops after 0.4 s from its keyframe, in which it is to stay."""
    model: Any = mujoco.MjModel.from_xml_string(mjcf_of(scene, links).text)
    data: Any = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    mujoco.mj_forward(model, data)
    # A gap is what the midpoint rule leaves: unloaded, that of a slider-crank is the length of its rod.
    assert np.abs(data.efc_pos[: data.ne]).max() < 0.2 / links**2
    for _ in range(400):
        mujoco.mj_step(model, data)
    assert np.abs(data.qvel).max() < 1e-3
    return data


def error_in_loop(solution: Solution, links: int) -> float:
    """Distance of the section at X = 0.4 from that of a solution, relative to the rod's length.

    Loads bend the middle by several per cent of the length; the tips are held.
    """
    (rod,) = solution.model.scene.rods
    data = kept_loop(solution.model.scene, links)
    gap = data.body(f"{rod.name}/{links // 5 * 2}").xpos - solution.pose(0.4).position
    return float(np.linalg.norm(gap)) / rod.length
