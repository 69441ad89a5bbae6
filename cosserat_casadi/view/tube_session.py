"""Session of concentric tubes: equilibria are followed from the last one, in Python, with the steps of the first."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.accuracy.refine import solve
from cosserat_casadi.control.inverse import search_near
from cosserat_casadi.control.inverse_result import with_verdict
from cosserat_casadi.control.lifted_problem import LiftedProblem, lifted_problem
from cosserat_casadi.maths.pose import POSE_SIZE
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.input_bounds import ranges_of_inputs
from cosserat_casadi.page.drawn_model import SECTIONS
from cosserat_casadi.page.page_facts import facts_of_every_page, rounded, target_points
from cosserat_casadi.page.slider_ranges import Slider, movable
from cosserat_casadi.plots.colours import rod_colour
from cosserat_casadi.scene.input_fields import column_suffixes
from cosserat_casadi.tubes.robot import robot_of
from cosserat_casadi.tubes.tube_arrows import ALONG, arrows_on, borne_loads, sort_of
from cosserat_casadi.tubes.tube_solution import TubeSolution
from cosserat_casadi.tubes.tube_solve import model_of, moved_to, solve_at
from cosserat_casadi.view.answers import accuracy_of, stacked_inputs, state_of

NOTE = "A robot that snaps is solved anew from straight tubes, and may come to rest elsewhere than a real one."


@dataclass
class TubeSession:
    """A robot of concentric tubes that is moved from a browser.

    Attributes:
        first: the equilibrium at the scene's own inputs.
    """

    first: TubeSolution
    _present: TubeSolution = field(init=False)
    _problems: dict[str, LiftedProblem] = field(init=False, default_factory=dict)

    def __post_init__(self) -> None:
        self._present = self.first

    @property
    def input_count(self) -> int:
        """Numbers in the stacked inputs."""
        return self.first.model.inputs.size

    def facts(self) -> dict[str, Any]:
        """Facts of the scene for its page, which offers only the questions that this session answers."""
        robot = self.first.robot
        model = self.first.model
        straight = np.outer(np.linspace(0.0, 1.0, 2), [0.0, 0.0, float(robot.translations(self.first.inputs).max())])
        targets = np.array(target_points(robot.scene)).reshape(-1, 3)
        points = np.concatenate([self.first.shape.position, straight, targets])
        return {
            **facts_of_every_page(model, self._sliders(), points),
            "layout": list(self._layout()),
            "poses": [{"rod": name} for name in robot.names],
            # One plate holds all tubes.
            "rods": {tube.name: _tube(tube, index) for index, tube in enumerate(robot.scene.tubes)},
            "unloaded": [rounded(straight)],
            "actuators": {},
            "bodies": {},
            "held": [],
            "obstacles": [],
            "derivatives": True,
            "planar": False,
            "stability": None,
            "motion": False,
            "modes": False,
            "note": NOTE,
        }

    def move(self, inputs: Sequence[float | None]) -> dict[str, Any]:
        """The equilibrium for these inputs: along the way from the last one, or anew where that leads nowhere.

        Raises:
            SceneError: an input is no number, or out of its range.
        """
        given = self.first.model.pack(stacked_inputs(inputs))
        found = moved_to(self.first.model, self._present, given)
        if found.converged:
            return self._accepted(found, anew=False)
        return self._accepted(solve_at(self.first.model, given), anew=True)

    def reset(self, inputs: Sequence[float | None]) -> dict[str, Any]:
        """The equilibrium for these inputs from straight tubes, whatever was before.

        Raises:
            SceneError: likewise.
        """
        given = self.first.model.pack(stacked_inputs(inputs))
        return self._accepted(solve_at(self.first.model, given), anew=False)

    def derivatives(self) -> list[float] | None:
        """Derivatives of all tips by all inputs, [pose][input][7]; None where the robot snaps."""
        model, present = self.first.model, self._present
        parts = (part.full() for part in model.sensitivity(present.x, present.inputs))
        jacobian, by_inputs, _, poses_by_x, poses_by_inputs = parts
        try:
            columns = poses_by_inputs - poses_by_x @ np.linalg.solve(jacobian, by_inputs)
        except np.linalg.LinAlgError:
            return None
        of_tips = columns.reshape(-1, POSE_SIZE, columns.shape[1]).transpose(0, 2, 1)
        return list(of_tips.ravel().tolist())

    def eigenvalues(self) -> None:
        """There are none: stability is judged by pivots along the robot."""

    def accuracy(self) -> dict[str, Any]:
        """The estimated error of the present equilibrium, in words, and whether it is within the tolerance."""
        return accuracy_of(solve(self.first.model, self._present.inputs, start=self._present.x))

    def reach(self, pose: Mapping[str, str], position: Sequence[float]) -> dict[str, Any]:
        """Inputs that bring a tip to a point, as ``inverse`` finds them from where the robot is.

        Args:
            pose: {"rod": name} of a tube.
            position: world axes, m.

        Returns:
            the equilibrium as :meth:`move` gives it, with the inputs and a sentence on whether the point is met.
        """
        target = scenes.PositionTarget(kind="position", position=tuple(position), **pose)
        (name,) = pose.values()
        if name not in self._problems:
            self._problems[name] = self._problem(target)
        origin = self._problems[name].variables.clipped(self._present.inputs)
        problem = replace(self._problems[name], targets=(target,), origin=origin)
        found = with_verdict(search_near(problem, self._present, stable=False, starts=0), stable=False)
        solution = found.solution
        assert isinstance(solution, TubeSolution)
        state = self._accepted(replace(solution, model=self.first.model), anew=False)
        return {**state, "inputs": solution.inputs.tolist(), "text": solution.message, "met": found.met}

    def _problem(self, target: scenes.PositionTarget) -> LiftedProblem:
        """The inverse problem of a tip, made once: other points are other parameters of it."""
        model = self.first.model
        changes = {"targets": (target,), "bounds": self._bounds()}
        asked = model_of(robot_of(model.scene.model_copy(update=changes)), model.steps)
        return lifted_problem(asked, (target,), self._present, stable=False)

    def _accepted(self, found: TubeSolution, *, anew: bool) -> dict[str, Any]:
        if found.converged:
            self._present = found
        numbers = [part.ravel() for part in _drawn(found)]
        return {**state_of(found, np.concatenate(numbers), anew=anew), "text": found.message}

    def _layout(self) -> Iterator[dict[str, Any]]:
        """Where each part lies among the drawn numbers: tubes, then the arrows of loads."""
        robot = self.first.robot
        tube = {"kind": "rod", "rows": POSE_SIZE, "columns": len(SECTIONS)}
        parts: list[dict[str, Any]] = [{**tube, "name": name} for name in robot.names]
        for load, _ in borne_loads(robot):
            columns = ALONG if load.spread else 1
            owner = load.name.partition(".")[0]
            parts.append({"kind": "arrows", "name": owner, "rows": 6, "columns": columns, "sort": sort_of(load)})
        first = 0
        for part in parts:
            yield {**part, "first": first}
            first += part["rows"] * part["columns"]

    def _sliders(self) -> list[Slider]:
        """A slider for each number: over its range, a turn of a drive, or loads that bend the robot to an arc."""
        model = self.first.model
        robot = model.robot
        lower, upper = ranges_of_inputs(model.scene, model.inputs)
        length = float(robot.length.max())
        force = float(robot.bending.sum()) / length**2
        scales = {"rad": np.pi, "N": force, "N m": force * length, "N/m": force / length, "m/s²": 9.81}
        sliders = []
        for entry, span in model.inputs:
            for k, suffix in zip(range(span.start, span.stop), column_suffixes(*entry.shape), strict=True):
                value = float(self.first.inputs[k])
                reach = scales.get(entry.unit, abs(value))
                least = float(lower[k]) if np.isfinite(lower[k]) else value - reach
                most = float(upper[k]) if np.isfinite(upper[k]) else value + reach
                label = suffix.removeprefix(".")
                sliders.append(Slider(entry.name, label, entry.unit, k, value, min(least, value), max(most, value)))
        return sliders

    def _bounds(self) -> tuple[scenes.Bound, ...]:
        """The scene's bounds, or else the ends of the sliders of the drives."""
        if self.first.model.scene.bounds:
            return self.first.model.scene.bounds
        by_hand = movable(self.first.model)
        return tuple(
            scenes.Bound(input=slider.input, lower=slider.least, upper=slider.most)
            for slider in self._sliders()
            if slider.input in by_hand
        )


def _tube(tube: scenes.Tube, index: int) -> dict[str, Any]:
    """Colour and outer radius of a tube, m; nothing of one that is given by its stiffness."""
    described: dict[str, Any] = {"colour": rod_colour(index), "carried": index > 0, "see_through": True, "disks": []}
    if tube.section is not None:
        radii = [float(tube.section.outer_radius)] * len(SECTIONS)
        described |= {"shape": "circle", "x": radii, "y": radii}
    return described


def _drawn(solution: TubeSolution) -> Iterator[FloatArray]:
    """Drawn parts in the order of the layout, a row for each section or arrow."""
    robot = solution.robot
    for reach in robot.translations(solution.inputs):
        position, quaternion = solution.shape.between(float(reach) * SECTIONS)
        yield np.hstack([position, quaternion])
    for load, tube in borne_loads(robot):
        starts, vector = arrows_on(solution, load, tube)
        # What the housing bears is no arrow: one of no length keeps its place.
        places = starts or [np.zeros(3)]
        yield np.array([[*place, *(vector if starts else np.zeros(3))] for place in places])
