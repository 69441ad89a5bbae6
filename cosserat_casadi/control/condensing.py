"""Linearisation of a horizon of stages in motion, with states as functions of the rates of the inputs alone.

Newton's method on all stages at once eliminates the unknowns of each stage by its linearised equations of motion, and
the states from one stage to the next: lifted Newton's method with condensing, J. Albersmeyer and M. Diehl, *SIAM J.
Optim.* 20 (2010) 1655, and H. G. Bock, K.-J. Plitt, *IFAC Proceedings Volumes* 17 (1984) 1603. The unknowns of the
quadratic problem are the rates: a few numbers per stage, for any number of unknowns of the rods.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca
import numpy as np

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.function_table import PARAMETERS
from cosserat_casadi.motion.collocated_stage import MotionStage, StageEquations
from cosserat_casadi.motion.repeated_call import RepeatedCall


@dataclass(frozen=True)
class Horizon:
    """A guess of a motion over N stages, whose stages need not be continuous and whose equations need not hold.

    Attributes:
        states: states at the ends of all stages, shape (N + 1, state_size); all but the first are guesses.
        unknowns: unknowns of all stages, shape (N, unknowns_size).
    """

    states: FloatArray
    unknowns: FloatArray


@dataclass(frozen=True)
class Condensed:
    """The horizon linearised about a guess.

    Attributes:
        guess: the guess.
        residual: largest entry of the equations of motion, and of the gaps between stages, at the guess.
        states_by_rates: ∂ states / ∂ steered rates of all stages, shape (N + 1, state_size, N · steered).
        states_by_inputs: ∂ states / ∂ all inputs at the beginning, for fixed rates, shape (N + 1, state_size, inputs).
        states_shift: change of the states that closes the guess at its rates, shape (N + 1, state_size).
        unknowns_by_rates: ∂ unknowns / ∂ steered rates of all stages, shape (N, unknowns_size, N · steered).
        unknowns_shift: change of the unknowns that closes the guess at its rates, shape (N, unknowns_size).
    """

    guess: Horizon
    residual: float
    states_by_rates: FloatArray
    states_by_inputs: FloatArray
    states_shift: FloatArray
    unknowns_by_rates: FloatArray
    unknowns_shift: FloatArray

    def moved(self, change: FloatArray) -> Horizon:
        """Return the motion, to first order, for changed steered rates.

        Args:
            change: change of the rates, stage by stage, shape (N · steered,), units per second.
        """
        states = self.guess.states + self.states_shift + self.states_by_rates @ change
        unknowns = self.guess.unknowns + self.unknowns_shift + self.unknowns_by_rates @ change
        return Horizon(states, unknowns)


class Condensing:
    """Lineariser of a horizon.

    Args:
        stage: every stage of the horizon.
        equations: equations of the stage, compiled or not.
        stages: number of stages N.
        steered: indices of the inputs whose rates are decision variables; the other inputs move as prescribed.

    Raises:
        ValueError: there is no stage, or an index is not that of an input.
    """

    def __init__(self, stage: MotionStage, equations: StageEquations, stages: int, steered: Sequence[int]) -> None:
        inputs = stage.model.inputs.size
        if stages < 1:
            raise ValueError(f"stages must be 1 or more, got {stages}")
        if len(set(steered)) < len(steered) or not all(0 <= number < inputs for number in steered):
            raise ValueError(f"steered must be different numbers from 0 to {inputs - 1}, got {list(steered)}")
        self._stage = stage
        self._stages = stages
        self._steered = list(steered)
        arguments = stage.symbols
        slopes = equations.function.jacobian()(*arguments, ca.DM(stage.unknowns_size, 1))
        results = [equations.function(*arguments), *slopes]
        self._widths = [result.shape[1] for result in results]
        column = ca.vertcat(*[ca.vec(ca.densify(result)) for result in results])
        self._evaluate = RepeatedCall(ca.Function("stages", arguments, [column]).map(stages))
        self._transition = stage.transition.full()
        self._drive = stage.drive.full()

    def condensed(
        self, guess: Horizon, inputs: FloatArray, inputs_rate: FloatArray, p: FloatArray | None = None
    ) -> Condensed:
        """The horizon linearised about a guess.

        Args:
            guess: states and unknowns.
            inputs: inputs at the beginnings of all stages, shape (N, inputs).
            inputs_rate: rates of the inputs in the stages, shape (N, inputs), units per second.
            p: stacked parameters of all stages, if a stage takes them, shape (N, parameters).

        Raises:
            ValueError: an array has a wrong shape.
            numpy.linalg.LinAlgError: the equations of a stage do not determine its unknowns.
        """
        given = np.zeros((self._stages, 0)) if p is None else p
        self._check(guess, inputs, inputs_rate, given)
        linear = self._linearised(guess, inputs, inputs_rate, given)
        unsolved, by_state, by_unknowns, by_inputs, *_, by_rate = linear
        size = self._stage.state_size
        count = len(self._steered)
        right = [unsolved, by_state, by_inputs, by_rate[:, :, self._steered]]
        solved = -np.linalg.solve(by_unknowns, np.concatenate(right, axis=2))
        moving = inputs.shape[1]
        alone, with_state, with_inputs, with_rate = np.split(solved, [1, 1 + size, 1 + size + moving], axis=2)
        reached = guess.states[:-1] @ self._transition.T + guess.unknowns @ self._drive.T
        gaps = reached - guess.states[1:]

        states_by_rates = np.zeros((self._stages + 1, size, self._stages * count))
        states_by_inputs = np.zeros((self._stages + 1, size, moving))
        states_shift = np.zeros((self._stages + 1, size))
        unknowns_by_rates = np.zeros((self._stages, self._stage.unknowns_size, self._stages * count))
        unknowns_shift = np.zeros((self._stages, self._stage.unknowns_size))
        for k in range(self._stages):
            here = slice(k * count, (k + 1) * count)
            unknowns_by_rates[k] = with_state[k] @ states_by_rates[k]
            # Inputs at the beginning of a stage are the sum of their changes by all earlier rates.
            unknowns_by_rates[k, :, : k * count] += self._stage.duration * np.tile(with_inputs[k][:, self._steered], k)
            unknowns_by_rates[k, :, here] += with_rate[k]
            unknowns_shift[k] = alone[k, :, 0] + with_state[k] @ states_shift[k]
            states_by_rates[k + 1] = self._transition @ states_by_rates[k] + self._drive @ unknowns_by_rates[k]
            unknowns_by_inputs = with_inputs[k] + with_state[k] @ states_by_inputs[k]
            states_by_inputs[k + 1] = self._transition @ states_by_inputs[k] + self._drive @ unknowns_by_inputs
            states_shift[k + 1] = self._transition @ states_shift[k] + self._drive @ unknowns_shift[k] + gaps[k]
        # NumPy's maximum is NaN where either is.
        worst = float(np.maximum(np.abs(unsolved).max(), np.abs(gaps).max()))
        return Condensed(
            guess=guess,
            residual=worst,
            states_by_rates=states_by_rates,
            states_by_inputs=states_by_inputs,
            states_shift=states_shift,
            unknowns_by_rates=unknowns_by_rates,
            unknowns_shift=unknowns_shift,
        )

    def _check(self, guess: Horizon, inputs: FloatArray, inputs_rate: FloatArray, p: FloatArray) -> None:
        """Refuse arrays of wrong shapes, whose entries would be misread.

        Raises:
            ValueError: arrays have wrong shapes; the error lists all of them.
        """
        stage = self._stage
        moving = (self._stages, stage.model.inputs.size)
        expected = {
            "states": (guess.states, (self._stages + 1, stage.state_size)),
            "unknowns": (guess.unknowns, (self._stages, stage.unknowns_size)),
            "inputs": (inputs, moving),
            "inputs_rate": (inputs_rate, moving),
            "p": (p, (self._stages, stage.sizes.get(PARAMETERS, 0))),
        }
        wrong = [
            f"{name} must have the shape {shape}, not {np.shape(given)}"
            for name, (given, shape) in expected.items()
            if np.shape(given) != shape
        ]
        if wrong:
            raise ValueError("; ".join(wrong))

    def _linearised(
        self, guess: Horizon, inputs: FloatArray, inputs_rate: FloatArray, p: FloatArray
    ) -> list[FloatArray]:
        """Evaluate the residual of all stages and its derivatives, each of shape (N, unknowns_size, columns)."""
        parameters = [p] if p.size else []
        arguments = [guess.states[:-1], guess.unknowns, inputs, *parameters, inputs_rate]
        columns = self._evaluate(*[argument.ravel() for argument in arguments])
        # Entries stand by columns, one stage after the other.
        stages = columns.reshape(self._stages, -1, self._stage.unknowns_size).transpose(0, 2, 1)
        return np.split(stages, np.cumsum(self._widths)[:-1], axis=2)
