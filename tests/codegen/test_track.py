"""A control loop in C: solution and derivatives turn after turn, each begun with the Jacobian of the turn before."""

from __future__ import annotations

import json
import subprocess
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from cosserat_casadi import Outcome
from cosserat_casadi.codegen.status import OUTCOMES
from cosserat_casadi.codegen.turn_budget import ALWAYS, SETTLING_ITERATIONS
from tests.codegen.libraries import QUICK, Exported, Recipe, run
from tests.codegen.test_hard_cases import deep_arch
from tests.families import mostly_slow
from tests.scenes import cable_lengths

Library = Callable[[str], Exported]

TURNS = 60


def loop(made: Exported, step: float) -> dict[str, Any]:
    """Turns of a loop whose inputs wander about the scene's own, step by step."""
    program = made.program("track.c", *QUICK)
    printed = run(program, *[repr(float(value)) for value in made.model.pack()], repr(step))
    found: dict[str, Any] = json.loads(printed)
    return found


@pytest.mark.parametrize(
    "name", mostly_slow(["planar", "spatial", "pair", "tendons", "robot"], quick=["planar", "spatial", "robot"])
)
def test_track_vs_solve_and_sensitivity(library: Library, name: str) -> None:
    """The same solution and, at it, the same derivatives bit for bit; what is not finite is called so and survived."""
    found = loop(library(name), 0.2)
    assert found["converged"] == TURNS - 1
    # Both residuals are below 1e-11; the tension of a short cable is softest to them.
    assert found["off"] < 1e-7
    assert found["off_slope"] == 0.0
    # What was given no number keeps the solution and the Jacobian of the turn before.
    assert (found["lost"], found["kept"]) == (2, 1)


@pytest.mark.parametrize("name", ["spatial", "robot"])
def test_small_turns_need_no_jacobian_but_that_of_the_derivatives(library: Library, name: str) -> None:
    assert loop(library(name), 0.02)["jacobians"] == 0


WRAPPED = [f"-Wl,--wrap=cables_k_{kernel}" for kernel in ("residual", "jacobian", "rate", "tangent")]


def cables(
    made: Exported,
    inputs: np.ndarray,
    iterations: int = ALWAYS.iterations,
    steps: int = ALWAYS.steps,
    *,
    derivatives: bool = True,
) -> dict[str, Any]:
    """Turns of a loop at these inputs, with this budget for a turn, with or without derivatives."""
    text = f"{len(inputs)}\n" + "\n".join(" ".join(map(repr, row)) for row in inputs.tolist())
    program = made.program("cables.c", *QUICK, *WRAPPED)
    command = [str(program), str(iterations), str(steps), *([] if derivatives else ["without"])]
    done = subprocess.run(command, input=text, capture_output=True, text=True, check=True, timeout=100)
    found: dict[str, Any] = json.loads(done.stdout)
    # The bounds that the header states.
    assert found["iterations"] <= iterations
    assert found["residuals"] <= iterations + steps + 2
    assert found["jacobians"] <= iterations + steps + 2
    assert found["rates"] <= steps + 1
    assert found["moved_when_lost"] == 0
    return found


@pytest.mark.parametrize("step", [2e-4, 6e-4])
def test_cables_of_given_lengths_are_tracked_without_a_cold_start(library: Library, step: float) -> None:
    """Tensions move by more than half a unit a turn, strains by a tenth: Newton stays on the branch."""
    found = cables(library("cables"), cable_lengths(step, 500))
    assert (found["failures"], found["lost"], found["warm_failures"], found["cold_starts"]) == (0, 0, 0, 0)
    assert found["continuations"] == 0
    assert found["iterations"] < 10
    assert found["apart"] < 1e-8


def test_turns_without_derivatives_keep_their_jacobian(library: Library) -> None:
    """While few steps are enough a Jacobian serves many turns; the solutions are those of a solve at every turn."""
    turns = 500
    found = cables(library("cables"), cable_lengths(2e-4, turns), derivatives=False)
    assert (found["failures"], found["lost"], found["cold_starts"], found["continuations"]) == (0, 0, 0, 0)
    assert found["all_jacobians"] < turns / 2
    assert found["apart"] < 1e-8
    with_derivatives = cables(library("cables"), cable_lengths(2e-4, turns))
    assert with_derivatives["all_jacobians"] >= turns


def test_turns_without_derivatives_go_as_far(library: Library) -> None:
    """Large turns and lost ones: as with derivatives."""
    made = library("cables")
    found = cables(made, cable_lengths(4e-3, 100), derivatives=False)
    assert (found["failures"], found["lost"]) == (0, 0)
    assert found["apart"] < 1e-8
    near = cable_lengths(2e-4, 20)
    near[5:10] += [0.12, -0.06, -0.06]
    found = cables(made, near, 6, 2, derivatives=False)
    assert (found["failures"], found["lost"]) == (0, 5)


def test_a_turn_that_strays_is_followed_from_the_last_solution(library: Library) -> None:
    """Steps of 4 mm move strains by nearly one: farther than one Newton is trusted."""
    found = cables(library("cables"), cable_lengths(4e-3, 100))
    assert (found["failures"], found["lost"]) == (0, 0)
    assert found["continuations"] > 90
    assert found["apart"] < 1e-8


def test_track_that_is_lost_leaves_everything_as_it_was(library: Library) -> None:
    """A jump too far for the budget is refused, again and again; the turn that asks for something nearer goes on."""
    made = library("cables")
    near = cable_lengths(2e-4, 20)
    near[5:10] += [0.12, -0.06, -0.06]
    found = cables(made, near, 6, 2)
    assert (found["failures"], found["lost"]) == (0, 5)


@pytest.mark.parametrize("budget", [(0, 0), (1, 0), (0, 5), (1, 1), (2, 3)])
def test_no_budget_is_too_small_to_be_kept(library: Library, budget: tuple[int, int]) -> None:
    assert cables(library("cables"), cable_lengths(6e-4, 50), *budget)["failures"] == 0


ABSURD = [1e6, 1e8, 1e12, 1e100, -1e6, -1e9]
"""Forces, N, or lengths, m, beyond all that a rod is made for."""


@pytest.mark.parametrize(
    "name", mostly_slow(["planar", "spatial", "tendons", "cables", "robot"], quick=["spatial", "robot"])
)
def test_absurd_turns_leave_everything_as_it_was(library: Library, name: str) -> None:
    """One status of a turn, and the solution before is there for the next."""
    made = library(name)
    own = made.model.pack()
    turns = np.array([own, *[own + size * (np.arange(len(own)) == i) for i in range(len(own)) for size in ABSURD]])
    found = printed(made.program("absurd.c", *QUICK), turns)
    assert (found["two_statuses"], found["moved"], found["lost_after"]) == (0, 0, 0)
    assert found["refused"] > 0


def printed(program: Any, inputs: np.ndarray, *words: object) -> dict[str, Any]:
    """What a program prints of turns at these inputs."""
    text = f"{len(inputs)}\n" + "\n".join(" ".join(map(repr, row)) for row in inputs.tolist())
    command = [str(program), *map(str, words)]
    done = subprocess.run(command, input=text, capture_output=True, text=True, check=True, timeout=100)
    found: dict[str, Any] = json.loads(done.stdout)
    return found


CONVERGED, STALLED, LOST = (
    1 + OUTCOMES.index(o) for o in (Outcome.CONVERGED, Outcome.LOAD_STALLED, Outcome.LOST_TRACK)
)


def recovered(made: Exported, inputs: np.ndarray, iterations: int, steps: int) -> list[int]:
    """Ends of turns: of track positive, of recover, which is called while the track is lost, negative; from 1 on."""
    wrapped = [f"-Wl,--wrap={made.name}_k_{kernel}" for kernel in ("residual", "jacobian", "rate")]
    found = printed(made.program("recover.c", *QUICK, *wrapped), inputs, iterations, steps)
    # The bounds that the header states, and that x goes with the memory's inputs.
    assert found["residuals"] <= iterations + steps + SETTLING_ITERATIONS + 2
    assert found["jacobians"] <= iterations + steps + SETTLING_ITERATIONS + 2
    assert found["rates"] <= steps + 1
    assert found["worst"] < 1e-11
    ends: list[int] = found["ends"]
    return ends


@pytest.mark.parametrize("budget", [(6, 2), (12, 6), (ALWAYS.iterations, ALWAYS.steps)])
def test_a_lost_track_is_found_again_while_inputs_move_on(library: Library, budget: tuple[int, int]) -> None:
    """Lengths jump by 3 cm, and go on moving: each turn comes nearer, and in the end the loop goes on."""
    near = cable_lengths(2e-4, 100)
    near[5:] += [0.03, -0.015, -0.015]
    ends = recovered(library("cables"), near, *budget)
    assert ends[:6] == [CONVERGED] * 5 + [LOST]
    assert set(ends[6:50]) <= {CONVERGED, -CONVERGED, -LOST}
    assert ends[50:] == [CONVERGED] * 50


def test_a_line_that_leads_nowhere_is_told(export_recipe: Callable[..., Exported]) -> None:
    """Beyond 8.97 N, its limit load, an arch has no equilibrium near; back below it the loop goes on."""
    beyond = np.array([0.0, 0.0, -9.5])
    below = np.array([0.0, 0.0, -5.0])
    turns = np.array([np.zeros(3), *[beyond] * 30, *[below] * 12])
    ends = recovered(export_recipe("hard_arch", Recipe(deep_arch(), 6, 10), estimates=False), turns, 12, 6)
    assert -STALLED in ends[:31]
    assert -CONVERGED not in ends[:31]
    assert -CONVERGED in ends[31:]
    assert ends[-1] == CONVERGED
