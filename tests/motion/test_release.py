"""Rods that are let go: a load that is gone at once, a tendon that is cut, an arch that snaps through."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import EquilibriumPath, Scene, Solution, build, follow, read_scene, simulate, solve
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.motion.trajectory import Motion
from tests.conftest import ROOT
from tests.scenes import rod, scene

STIFFNESS = 2.0  # N m²
DENSITY = 0.5  # kg/m
LENGTH = 1.0  # m

# Roots of cos β cosh β = −1: clamped–free bending.
BETA = np.array([1.875104068711961, 4.694091132974175, 7.854757438237613, 10.995540734875467, 14.137168391046471])


def beam(**changes: object) -> dict[str, object]:
    """A rod that bends in one plane."""
    stiffness = {"bending_y": STIFFNESS}
    return rod("planar", name="beam", length=LENGTH, stiffness=stiffness, linear_density=DENSITY, **changes)


def released_tip(force: float, times: FloatArray) -> FloatArray:
    """Deflection of the tip of a beam that a force at the tip held, by the beam's modes, shape (T,), m.

    With shapes of unit mean square, which are 2 at the tip, mode n holds the share 4 / β⁴ of F ℓ³ / EI and swings with
    ω = β² sqrt(EI / (ρA ℓ⁴)).
    """
    frequencies = BETA**2 * np.sqrt(STIFFNESS / (DENSITY * LENGTH**4))
    amplitudes = 4.0 / BETA**4 * force * LENGTH**3 / STIFFNESS
    return np.asarray(np.cos(np.outer(times, frequencies)) @ amplitudes)


def test_a_load_is_let_go_vs_modes_of_a_beam() -> None:
    force = 0.06
    push = {"name": "push", "kind": "tip_wrench", "rod": "beam", "force": [0.0, 0.0, 0.0]}
    simulation = {"duration": 0.8, "frames": 41, "tolerance": 1e-4}
    let_go = scene(push, rods=[beam()], inputs=["push.force"], simulation=simulation)
    held = solve(let_go, {"push.force": [force, 0.0, 0.0]})
    motion = simulate(let_go, start=held)
    assert motion.converged, motion.message
    deflection = motion.tip().position[:, 0]
    assert_allclose(deflection[0], force * LENGTH**3 / (3.0 * STIFFNESS), rtol=1e-3, atol=0)
    # The modes that are left out hold 1e-5 of the length, what is not linear 1e-6.
    assert_allclose(deflection, released_tip(force, motion.times), rtol=0, atol=1e-4 * LENGTH)


def test_a_cut_tendon_leaves_its_energy_to_the_damping() -> None:
    tension = 20.0
    offset = 0.01
    tendon = {"name": "cable", "kind": "tendon", "rod": "beam", "offset": [offset, 0.0], "tension": tension}
    cut = {"input": "cable.tension", "times": [0.0, 0.1], "values": [tension, 0.0], "interpolation": "step"}
    # Steps are no more exact than paths have to be: a thousandth of the energy takes a smaller tolerance than they do.
    simulation = {"duration": 4.0, "frames": 201, "tolerance": 3e-4}
    damped = beam(damping={"retardation_time": 0.05})
    motion = simulate(scene(rods=[damped], actuators=[tendon], motions=[cut], simulation=simulation))
    assert motion.converged, motion.message
    # The tendon bends the rod into a circle: a moment T d all along it.
    elastic = (tension * offset) ** 2 * LENGTH / (2.0 * STIFFNESS)
    before = motion.times < 0.1
    assert_allclose(motion.energy.elastic[before], elastic, rtol=1e-9, atol=0)
    assert_allclose(motion.energy.kinetic[before], 0.0, rtol=0, atol=1e-12 * elastic)
    assert_allclose(motion.energy.dissipated[-1], elastic, rtol=1e-3, atol=0)
    assert_allclose(motion.tip().position[-1], [0.0, 0.0, LENGTH], rtol=0, atol=1e-3)
    (warning,) = motion.warnings
    assert "cable.tension jumps at 0.1 s" in warning


# An arch

PUSHED = -910.0
"""Force on the crown beyond the limit load of 897 N, N."""

BELOW = -893.0

MODES = ["accuracy.modes=8", "accuracy.nodes=24", "rods.0.linear_density=1.0", 'inputs=["crown.force"]']


def arch(*settings: str) -> Scene:
    return read_scene(ROOT / "examples" / "deep_arch.toml", [*MODES, "rods.0.damping={bending_y=2e6}", *settings])


@cache
def arch_path() -> EquilibriumPath:
    return follow(build(arch()), "crown.force", [0.0, 0.0, PUSHED])


def below_the_limit(path: EquilibriumPath) -> Solution:
    """The last equilibrium before the limit point that holds less than a load."""
    limit = next(event for event in path.events if event.kind == "limit")
    before = path.factor[: limit.position]
    (index,) = np.flatnonzero(before <= BELOW / PUSHED)[-1:]
    return path.solution(int(index))


def crown(motion: Motion) -> FloatArray:
    """Positions of the crown, shape (T, 3), m."""
    return np.asarray(motion.section("arch", [0.5]).position[:, 0])


@pytest.mark.slow
def test_an_arch_snaps_through_to_the_far_equilibrium_of_its_path() -> None:
    path = arch_path()
    start = below_the_limit(path)
    assert start.stable
    force = float(start.inputs[2])
    push = f'{{ input = "crown.force", times = [0.0, 5.0], values = [[0, 0, {force}], [0, 0, {PUSHED}]] }}'
    motion = simulate(arch(f"motions=[{push}]", "simulation={ duration = 400.0, tolerance = 1e-3 }"), start=start)
    assert motion.converged, motion.message
    assert path.stable[-1]
    length = motion.model.scene.rods[0].length
    crown_of_far = path.position(0.5)[-1]
    reached = crown(motion)
    assert np.linalg.norm(reached[0] - crown_of_far) > 0.2 * length
    assert_allclose(reached[-1], crown_of_far, rtol=0, atol=1e-3 * length)


@pytest.mark.slow
@pytest.mark.parametrize("interpolation", ["linear", "cubic"])
def test_an_arch_below_its_limit_load_stays_on_its_side(interpolation: str) -> None:
    start = below_the_limit(arch_path())
    force = float(start.inputs[2])
    values = f"[[0, 0, {force}], [0, 0, -895]]"
    push = f'{{ input = "crown.force", times = [0.0, 5.0], values = {values}, interpolation = "{interpolation}" }}'
    motion = simulate(arch(f"motions=[{push}]", "simulation={ duration = 100.0, tolerance = 1e-3 }"), start=start)
    assert motion.converged, motion.message
    length = motion.model.scene.rods[0].length
    assert np.ptp(crown(motion), axis=0).max() < 0.05 * length
