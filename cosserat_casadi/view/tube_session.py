"""Session of concentric tubes: continuation from the last equilibrium, in Python, with the steps of the first one."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.control.inverse import search_near
from cosserat_casadi.control.inverse_result import Inverse
from cosserat_casadi.control.lifted_problem import LiftedProblem, lifted_problem
from cosserat_casadi.maths.pose import POSE_SIZE
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.input_bounds import ranges_of_inputs
from cosserat_casadi.page.drawn_model import SECTIONS
from cosserat_casadi.page.page_facts import facts_of_every_page, rounded
from cosserat_casadi.page.slider_ranges import Slider
from cosserat_casadi.plots.colours import rod_colour
from cosserat_casadi.plots.scenery import target_points
from cosserat_casadi.scene.input_fields import column_suffixes
from cosserat_casadi.tubes.robot import robot_of
from cosserat_casadi.tubes.tube_arrows import ALONG, arrows_on, borne_loads, sort_of
from cosserat_casadi.tubes.tube_solution import TubeSolution
from cosserat_casadi.tubes.tube_solve import model_of, moved_to, solve_at
from cosserat_casadi.view.robot_session import OF_EVERY_SESSION, RobotSession, stacked_inputs, state_of

NOTE = "A robot that snaps is solved anew from straight tubes. A real robot may come to rest elsewhere."


class TubeSession(RobotSession):
    """A robot of concentric tubes moved from a browser; after a failure it stays at its last equilibrium."""

    questions = OF_EVERY_SESSION | {"reach"}
    searched = search_near

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
            # All tubes start at one base plate.
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

    def derivatives(self) -> list[float] | None:
        """Derivatives of all tip poses by all inputs, [pose][input][7]; None at a snap."""
        model, present = self.first.model, self._present
        parts = (part.full() for part in model.sensitivity(present.x, present.inputs))
        jacobian, by_inputs, _, poses_by_x, poses_by_inputs = parts
        try:
            columns = poses_by_inputs - poses_by_x @ np.linalg.solve(jacobian, by_inputs)
        except np.linalg.LinAlgError:
            return None
        of_tips = columns.reshape(-1, POSE_SIZE, columns.shape[1]).transpose(0, 2, 1)
        return list(of_tips.ravel().tolist())

    def _read(self, inputs: Sequence[float | None]) -> FloatArray:
        """Stacked inputs from the page; SceneError if one is not a number or out of range."""
        return np.asarray(self.model.pack(stacked_inputs(inputs)))

    def _followed(self, given: FloatArray) -> TubeSolution:
        return moved_to(self.first.model, self._present, given)

    def _solved(self, given: FloatArray) -> TubeSolution:
        return solve_at(self.model, given)

    def _lifted(self, scene: scenes.Scene) -> LiftedProblem:
        asked = model_of(robot_of(scene), self.model.steps)
        return lifted_problem(asked, scene.targets, self._present, stable=False)

    def _reached(self, found: Inverse) -> dict[str, Any]:
        solution = found.solution
        assert isinstance(solution, TubeSolution)
        solution = replace(solution, model=self.model)
        state = self._accepted(solution.inputs, solution, anew=False)
        return {**state, "text": solution.message, "met": found.met}

    def _accepted(self, given: FloatArray, found: TubeSolution, *, anew: bool) -> dict[str, Any]:
        if found.converged:
            self._present = found
        numbers = [part.ravel() for part in _drawn(found)]
        return {**state_of(found, np.concatenate(numbers), anew=anew), "text": found.message}

    def _layout(self) -> Iterator[dict[str, Any]]:
        """Layout of the parts in the drawn numbers: tubes, then arrows of loads."""
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
        """A slider for each input: over its range, one turn of a drive, or loads that bend the robot to an arc."""
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


def _tube(tube: scenes.Tube, index: int) -> dict[str, Any]:
    """Colour and outer radius of a tube, m; no radius for a tube given by its stiffness."""
    described: dict[str, Any] = {"colour": rod_colour(index), "carried": index > 0, "see_through": True, "disks": []}
    if tube.section is not None:
        radii = [float(tube.section.outer_radius)] * len(SECTIONS)
        described |= {"shape": "circle", "x": radii, "y": radii}
    return described


def _drawn(solution: TubeSolution) -> Iterator[FloatArray]:
    """Drawn parts in the order of the layout, one row for each section or arrow."""
    robot = solution.robot
    for reach in robot.translations(solution.inputs):
        position, quaternion = solution.shape.between(float(reach) * SECTIONS)
        yield np.hstack([position, quaternion])
    for load, tube in borne_loads(robot):
        starts, vector = arrows_on(solution, load, tube)
        # A load on the housing is not drawn: an arrow of length zero fills its place.
        places = starts or [np.zeros(3)]
        yield np.array([[*place, *(vector if starts else np.zeros(3))] for place in places])
