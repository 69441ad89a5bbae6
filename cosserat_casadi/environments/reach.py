"""Environment of Gymnasium: a moving robot has to bring a tip to a target and keep it there.

Its state moves by the step in C. gymnasium is an extra.
"""

from __future__ import annotations

import os
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import casadi as ca
import gymnasium
import numpy as np
import numpy.typing as npt

from cosserat_casadi.accuracy.choose import choose
from cosserat_casadi.codegen.compiled import Compiled
from cosserat_casadi.codegen.compiled_motion import StepMemory, StepState
from cosserat_casadi.codegen.export import export
from cosserat_casadi.codegen.kernels import kernel
from cosserat_casadi.codegen.load import load
from cosserat_casadi.codegen.motion_outputs import motion_outputs
from cosserat_casadi.codegen.plain import vector
from cosserat_casadi.control.decision_variables import DecisionVariables, decision_variables
from cosserat_casadi.errors import Problem, SceneError, refuse
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model, build
from cosserat_casadi.model.discretise import discretise
from cosserat_casadi.rod.discretisation import Discretisation
from cosserat_casadi.scene import Scene, read_scene
from cosserat_casadi.scene.records import HashedTable

DRAWS = 20
"""Number of random inputs that are tried for a target."""

LARGEST = float(np.finfo(np.float64).max)
"""Bound of the observations: any finite number."""

Observation = npt.NDArray[np.float64]


@dataclass
class _Episode:
    """State of an episode.

    Attributes:
        state: state of the motion.
        inputs: stacked inputs.
        inputs_rate: present rates of the inputs, units per second.
        aimed: inputs of the last action.
        target: target position of the tip, m, shape (3,).
        memory: memory of the steps in C.
        periods: number of periods that have passed.
    """

    state: StepState
    inputs: FloatArray
    inputs_rate: FloatArray
    aimed: FloatArray
    target: FloatArray
    memory: StepMemory
    periods: int = 0


class ReachEnvironment(gymnasium.Env[Observation, Observation]):  # type: ignore[misc]
    """Bring the tip of a rod to a target by the inputs that the scene bounds.

    An action gives the wanted values of these inputs, from −1 at the lower bound to 1 at the upper one. Tensions and
    other loads move there linearly in a control period. The rate of a base or a length does not jump: it changes
    linearly, to the rate that would lead from the action before to this one in a period. At the end of the period the
    base or the length is half way between the two, and it never exceeds its bounds.

    An observation stacks position and velocity of the tip (m, m/s), the inputs in the same shares as actions, the last
    actions of bases and lengths, and the target (m). The reward is minus the distance to the target over the length of
    the rod. An episode is truncated at its duration, and terminated if a step cannot be computed: ``info["status"]`` is
    the sentence that says why, ``info["distance"]`` the distance in m.

    Targets are tips of equilibria, stable or not, at random inputs within the bounds;
    ``options={"target": …}`` of :meth:`reset` names one.

    Modes and nodes are chosen for these ranges, unless the scene fixes them. The model is built and compiled: seconds
    the first time, then it is taken from the cache.

    Args:
        scene: a scene, or the path of its file, with a range in ``[[bounds]]`` for every input that acts. Its
            parameters have the values of the scene.
        rod: name of the rod with the moving tip; the first rod by default.
        period: time between two actions, s.
        step: longest step of the integrator, s.
        duration: duration of an episode, s.

    Attributes:
        rod: name of the rod whose tip moves.
        model: the model of the scene in motion.
        library: its compiled folder.
        period: time between two actions, s.
        dt: length of a step of the integrator, s.
        error_estimate: the largest estimated error of an equilibrium within the bounds, over the length of the rod;
            None if the scene fixes its modes. Errors of the motion are not estimated.

    Raises:
        SceneError: the scene is faulty, has no such rod, or an input that acts has no range.
        ValueError: a time is not > 0.
        RuntimeError: there is no equilibrium at the scene's inputs.
    """

    metadata: dict[str, Any] = {"render_modes": []}  # noqa: RUF012  (so declared by gymnasium)

    def __init__(
        self,
        scene: Scene | str | os.PathLike[str],
        rod: str | None = None,
        *,
        period: float = 0.02,
        step: float = 2e-3,
        duration: float = 2.0,
    ) -> None:
        if not all(np.isfinite(time) and time > 0 for time in (period, step, duration)):
            raise ValueError(f"period, step and duration must be > 0, got {period}, {step}, {duration}")
        described = (scene if isinstance(scene, Scene) else read_scene(Path(scene))).baked()
        self.rod = _rod_name(described, rod)
        discretisation, self.error_estimate = _chosen(described)
        self.model = build(described, discretisation, moving=True)
        self._acting = _acting_inputs(self.model)
        self._moves = _moving_entries(self.model)
        self._late = self._moves[self._acting.indices]
        self.library = _compiled(self.model)
        self._seen = _seen_function(self.model, self.rod)
        self._length = next(entry.length for entry in described.rods if entry.name == self.rod)
        self.period = period
        self._steps = int(np.ceil(period / step - 1e-9))
        self.dt = period / self._steps
        self._periods = int(np.ceil(duration / period - 1e-9))
        actions = len(self._acting.indices)
        self.action_space = gymnasium.spaces.Box(-1.0, 1.0, (actions,), dtype=np.float64)
        # Observations are finite, but have no bounds that are known beforehand.
        seen = 9 + actions + int(self._late.sum())
        self.observation_space = gymnasium.spaces.Box(-LARGEST, LARGEST, (seen,), dtype=np.float64)
        self._episode = self._begun(self.model.pack(), np.zeros(3))

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        """Begin at rest, in the equilibrium of the scene's own inputs, with a new target.

        Args:
            seed: seed of the targets.
            options: ``target``: a position in m, shape (3,), instead of a random one.

        Raises:
            ValueError: the target is not three finite numbers.
            RuntimeError: there is no equilibrium at the scene's inputs, or at twenty random ones.
        """
        super().reset(seed=seed)
        target = (options or {}).get("target")
        chosen = self._random_target() if target is None else _finite(target, 3, "target")
        self._episode = self._begun(self.model.pack(), chosen)
        tip = self._tip()
        return self._observation(tip), self._info(tip, "")

    def step(self, action: Observation) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        """Move the inputs towards the values of an action, over one control period.

        Args:
            action: shares of the ranges, −1 to 1, shape (k,); values beyond count as the bounds.

        Raises:
            ValueError: the action does not have one finite number for each moved input.
        """
        shares = np.clip(_finite(action, len(self._acting.indices), "action"), -1.0, 1.0)
        episode = self._episode
        aimed = episode.aimed.copy()
        aimed[self._acting.indices] = self._from_share(shares)
        asked_rate = (aimed - episode.aimed) / self.period
        acceleration = np.where(self._moves, (asked_rate - episode.inputs_rate) / self.period, 0.0)
        episode.inputs_rate = np.where(self._moves, episode.inputs_rate, asked_rate)
        episode.aimed = aimed
        episode.periods += 1
        path = episode.inputs, episode.inputs_rate, acceleration
        taken, inputs, rates = self.library.steps(episode.state, self.dt, self._steps, *path, memory=episode.memory)
        episode.state = taken.state
        episode.inputs = inputs
        episode.inputs_rate = rates
        # Evaluated once for observation, reward and info.
        tip = self._tip()
        reward = -self._distance(tip) / self._length
        if not taken.done:
            return self._observation(tip), reward, True, False, self._info(tip, taken.status.value)
        truncated = episode.periods >= self._periods
        return self._observation(tip), reward, False, truncated, self._info(tip, "")

    def _begun(self, inputs: FloatArray, target: FloatArray) -> _Episode:
        """An episode that begins at rest, in the equilibrium of some inputs."""
        found = self.library.solve(inputs)
        state = self.library.rest(inputs, found.x) if found.converged else None
        if state is None:
            raise RuntimeError(f"no episode can begin: {found.outcome.value}")
        return _Episode(state, inputs, np.zeros_like(inputs), inputs, target, self.library.step_memory())

    def _random_target(self) -> FloatArray:
        """The tip in equilibrium at random inputs within the bounds, m."""
        for _ in range(DRAWS):
            inputs = self.model.pack().copy()
            share = self.np_random.uniform(-1.0, 1.0, len(self._acting.indices))
            inputs[self._acting.indices] = self._from_share(share)
            found = self.library.solve(inputs)
            if found.converged:
                return np.asarray(self.model.tip[self.rod](found.x, inputs)[0].full().ravel())
        raise RuntimeError(f"none of {DRAWS} random inputs within the bounds has an equilibrium: narrow the bounds")

    def _from_share(self, share: FloatArray) -> FloatArray:
        """Values of the moved inputs, from shares −1 to 1 of their ranges."""
        return self._acting.lower + (share + 1.0) / 2.0 * (self._acting.upper - self._acting.lower)

    def _share(self, inputs: FloatArray) -> FloatArray:
        """Shares −1 to 1 of the moved inputs in their ranges."""
        ranges = self._acting.upper - self._acting.lower
        return 2.0 * (inputs[self._acting.indices] - self._acting.lower) / ranges - 1.0

    def _tip(self) -> FloatArray:
        """Position and velocity of the tip, m and m/s, shape (6,)."""
        episode = self._episode
        state = episode.state
        return np.asarray(self._seen(state.x, state.v, episode.inputs, episode.inputs_rate).full().ravel())

    def _observation(self, tip: FloatArray) -> Observation:
        episode = self._episode
        actions = self._share(episode.aimed)[self._late]
        return np.concatenate([tip, self._share(episode.inputs), actions, episode.target])

    def _distance(self, tip: FloatArray) -> float:
        return float(np.linalg.norm(tip[:3] - self._episode.target))

    def _info(self, tip: FloatArray, status: str) -> dict[str, Any]:
        return {"status": status, "distance": self._distance(tip)}


def _chosen(scene: Scene) -> tuple[Mapping[str, Discretisation], float | None]:
    """The discretisation of every rod, and the largest estimated error of an equilibrium within the bounds."""
    if scene.accuracy.fixed:
        return discretise(scene), None
    # Inputs that no action moves keep their values.
    acting = dict.fromkeys(bound.input for bound in scene.bounds)
    ranges = {name: pairs for name, pairs in scene.ranges.items() if name in acting}
    choice = choose(scene.model_copy(update={"inputs": tuple(acting), "ranges": HashedTable(ranges)}))
    return choice.model.discretisation, choice.error_estimate


def _rod_name(scene: Scene, rod: str | None) -> str:
    names = [entry.name for entry in scene.rods]
    if rod is None:
        return names[0]
    if rod not in names:
        raise SceneError(Problem("rod", f"there is no rod {rod!r}", f"the rods are {', '.join(names)}"))
    return rod


def _finite(value: npt.ArrayLike, size: int, name: str) -> FloatArray:
    """Numbers that are all finite, as a vector of a known size.

    Raises:
        ValueError: a number is not finite; the name says which argument.
    """
    numbers = vector(value, size, name)
    if not np.all(np.isfinite(numbers)):
        raise ValueError(f"{name} must have finite numbers, got {numbers.tolist()}")
    return numbers


def _seen_function(model: Model, rod: str) -> ca.Function:
    """(x, v, inputs, inputs_rate) ↦ position and velocity of the tip, 6×1: each call is one step of an episode."""
    outputs = motion_outputs(model)
    names = [output.name for output in outputs.entries]
    wanted = [f"{rod}.tip.{quantity}.{axis}" for quantity in ("position", "velocity") for axis in "xyz"]
    arguments = outputs.function.mx_in()
    seen = outputs.function.call(arguments)[0][[names.index(name) for name in wanted]]
    return kernel(model, ca.Function("seen", arguments, [seen]), "seen")


def _acting_inputs(model: Model) -> DecisionVariables:
    """The inputs that an action moves: entries with bounds in the scene, unless both bounds are equal.

    Raises:
        SceneError: an input has no range; an action is a share of it.
    """
    bounded = decision_variables(model)
    without_range = bounded.indices[~(np.isfinite(bounded.lower) & np.isfinite(bounded.upper))]
    problems = []
    for entry, entries in model.inputs:
        if np.any((without_range >= entries.start) & (without_range < entries.stop)):
            problem = f"{entry.name} has no range between two bounds"
            problems.append(Problem("bounds", problem, "give lower and upper; what shall not act needs no bounds"))
    refuse(problems)
    moves = bounded.upper > bounded.lower
    return DecisionVariables(bounded.indices[moves], bounded.lower[moves], bounded.upper[moves])


def _moving_entries(model: Model) -> npt.NDArray[np.bool_]:
    """Whether each entry of the stacked inputs moves rods or prescribes a length."""
    moves = np.zeros(model.inputs.size, dtype=bool)
    for entry, entries in model.inputs:
        moves[entries] = entry.declared.moves
    return moves


def _compiled(model: Model) -> Compiled:
    with tempfile.TemporaryDirectory() as folder:
        library = load(export(model, Path(folder) / "robot", "robot", dynamics=True, estimate_errors=False))
    assert isinstance(library, Compiled)
    return library
