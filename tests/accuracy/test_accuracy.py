"""The tolerance: what is picked for it meets it, and is no larger than it must be."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Model, Scene, Solution, build, discretise, read_scene, scene_from_dict, solve
from cosserat_casadi.accuracy.coarsen import Coarsening
from cosserat_casadi.accuracy.cost import (
    MOST_IN_COLUMNS,
    TIME_IN_COLUMNS,
    TOGETHER,
    foreseen_operations,
    foreseen_statements,
    foreseen_time,
    spread_on,
    terms_of,
    time_in_columns,
)
from cosserat_casadi.accuracy.preview import FinerShift, Preview
from cosserat_casadi.accuracy.resolution import Resolution
from cosserat_casadi.codegen.columns import in_columns, on_path
from cosserat_casadi.compiling.listing import LANES
from cosserat_casadi.compiling.scalars_in_c import columns_in_fours
from cosserat_casadi.equilibrium.metrics import pose_distance
from cosserat_casadi.maths.calls import with_dense_results
from cosserat_casadi.maths.pose_change import change_size
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.rod.discretisation import Discretisation
from tests.conftest import CASES
from tests.families import mostly_slow
from tests.reference.random_scenes import random_scene
from tests.scenes import HOOK, WEIGHT, push, scene

B1 = CASES / "rods" / "steel_b1_kirchhoff.toml"


def fine(wanted: Scene, modes: int = 14, nodes: int = 36) -> Solution:
    return solve(build(wanted, discretise(wanted, modes, nodes, "magnus8")))


@pytest.mark.skipif(not B1.exists(), reason="the reference cases are not beside this checkout")
def test_planar_load_takes_modes_in_its_plane_only() -> None:
    wanted = read_scene(B1, ("accuracy.tolerance=1e-8",))
    solution = solve(wanted)
    assert solution.converged
    assert solution.model.size <= 10
    assert pose_distance(solution, fine(wanted)) <= 1e-8


@pytest.mark.parametrize("seed", mostly_slow(range(300, 312), quick=(303,)))
def test_tolerance_is_met(seed: int) -> None:
    """And the estimate is not below the truth."""
    tolerance = (1e-3, 1e-5, 1e-7, 1e-9)[seed % 4]
    wanted = scene_from_dict({**random_scene(seed), "accuracy": {"tolerance": tolerance}})
    solution = solve(wanted)
    assert solution.converged, solution.message
    chosen = solution.model.discretisation["rod"]
    error = pose_distance(solution, fine(wanted, max(chosen.modes) + 7, 2 * chosen.nodes + 14))
    assert solution.error_estimate is not None
    assert error <= solution.error_estimate <= tolerance


def test_unloaded_rod_takes_one_mode() -> None:
    solution = solve(scene(accuracy={"tolerance": 1e-9}))
    assert solution.converged
    assert solution.model.discretisation["rod"].modes == (1, 1, 1)
    assert solution.error_estimate is not None
    assert solution.error_estimate <= 1e-9
    assert_allclose(solution.x, 0.0, rtol=0, atol=0)


def test_fixed_modes_are_kept_and_nodes_follow() -> None:
    solution = solve(scene(push(), accuracy={"modes": [5, 5, 4], "tolerance": 1e-3}))
    assert solution.model.discretisation["rod"].modes == (5, 5, 4)
    assert solution.error_estimate is not None


def test_modes_follow_the_inputs_given() -> None:
    flat = solve(scene(push(force=[0.9, 0.0, 0.0])))
    turned = solve(scene(push(force=[0.9, 0.0, 0.0])), {"push.force": [0.0, 0.9, 0.0]})
    assert flat.model.discretisation["rod"].modes[::2] == (1, 1)
    assert turned.model.discretisation["rod"].modes[1:] == (1, 1)
    assert min(flat.model.discretisation["rod"].modes[1], turned.model.discretisation["rod"].modes[0]) > 2


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["clamped", "pinned"])
def test_held_rod_is_right_between_its_ends(kind: str) -> None:
    """Its tip is right with any modes, so the tip must not be what is looked at."""
    held = {"rod": "rod", "kind": kind, "position": [0.2, 0.15, 0.6]}
    pose = {"quaternion": [1.0, 0.0, 0.0, 0.0]} if kind == "clamped" else {}
    wanted = scene(WEIGHT, supports=[{**held, **pose}], accuracy={"tolerance": 1e-3})
    solution = solve(wanted)
    assert solution.converged, solution.message
    assert pose_distance(solution, fine(wanted, 11, 26)) <= 1e-3


def test_coarsened_model_is_where_the_reference_foresees() -> None:
    """Previews against solved models, and the start that coarsening hands over against the solution."""
    wanted = scene(push(force=[4.0, 2.0, -1.0]), WEIGHT, HOOK, strain="reissner")
    reference = fine(wanted, 9, 22)
    preview = Preview(reference)
    chosen, handed_over = Coarsening(preview, 1e-6).run()
    solution = solve(build(wanted, chosen))
    modes = {name: d.modes for name, d in chosen.items()}
    start = preview.with_modes(modes)
    foreseen = preview.mode_shift(modes) + preview.grid_shift(start, modes, chosen)
    assert_allclose(Preview(solution).tips.change_from(preview.tips), foreseen, rtol=0, atol=2e-8)
    assert change_size(foreseen) <= 1.01e-6
    assert_allclose(handed_over, solution.x, rtol=0, atol=1e-3)


def test_reference_knows_its_own_error() -> None:
    """Not too small, and not so large that levels are refined in vain."""
    wanted = scene(push(force=[4.0, 2.0, -1.0]), WEIGHT)
    truth = fine(wanted)
    for modes, nodes in ((5, 30), (7, 30), (9, 10)):
        reference = solve(build(wanted, discretise(wanted, modes, nodes, "magnus6")))
        resolution = Resolution(Preview(reference))
        true = pose_distance(reference, truth)
        assert true <= resolution.modes_error + resolution.grid_error <= 100 * true


@pytest.mark.parametrize("strain", ["planar", "kirchhoff", "reissner"])
def test_foreseen_operations_vs_counted(strain: str) -> None:
    """Ratios are what a choice needs."""
    wanted = scene(push(), WEIGHT, strain=strain)
    counted, foreseen = [], []
    for modes, nodes in ((3, 5), (5, 8)):
        model = build(wanted, discretise(wanted, modes, nodes))
        counted.append(model.operations(model.jacobian))
        foreseen.append(foreseen_operations(model.discrete.rods["rod"].properties, model.discretisation["rod"]).all)
    assert_allclose(foreseen[1] / foreseen[0], counted[1] / counted[0], rtol=0.35)
    assert_allclose(foreseen, counted, rtol=0.5)


@pytest.mark.parametrize("seed", mostly_slow([301, 303, 306], quick=[301]))
def test_tolerance_binds_the_whole_shape_where_asked(seed: int) -> None:
    """Of the tip alone the same tolerance leaves other sections wrong by far more."""
    wanted = [
        scene_from_dict({**random_scene(seed), "accuracy": {"tolerance": 1e-7, "shape": shape}})
        for shape in (False, True)
    ]
    of_tip, of_shape = (solve(one) for one in wanted)
    chosen = of_shape.model.discretisation["rod"]
    truth, X = fine(wanted[1], max(chosen.modes) + 7, 2 * chosen.nodes + 14), np.linspace(0, 1, 101)
    assert of_shape.converged
    assert of_shape.shape_error_estimate is not None
    assert pose_distance(of_shape, truth, X) <= 1e-7
    assert pose_distance(of_shape, truth, X) <= 1.1 * of_shape.shape_error_estimate
    assert pose_distance(of_tip, truth, X) > 2e-7


WIND = {"name": "wind", "kind": "distributed_wrench", "rod": "rod", "frame": "body"}


@pytest.mark.slow
@pytest.mark.parametrize(
    "magnitude",
    [{"force": [0.5, 0.0, 0.1]}, {"moment": [0.0, 0.1, 0.05]}],
    ids=["force", "moment"],
)
def test_foreseen_operations_of_spread_loads(magnitude: dict[str, list[float]]) -> None:
    """What a spread load adds is a good part of the whole, and seen."""
    counted, foreseen = [], []
    for loads in ((push(),), (push(), {**WIND, **magnitude})):
        wanted = scene(*loads)
        model = build(wanted, discretise(wanted, 7, 14, "magnus4"))
        rod, chosen = model.discrete.rods["rod"].properties, model.discretisation["rod"]
        counted.append(model.operations(model.jacobian))
        foreseen.append(foreseen_operations(rod, chosen, spread_on(wanted, "rod")).all)
    # Moments that follow pass down the rod with the others: 1.37 times as many.
    assert counted[1] > 1.3 * counted[0]
    assert_allclose(foreseen[1] / foreseen[0], counted[1] / counted[0], rtol=0.1, atol=0)


def statements_of(model: Model) -> int:
    """Statements of the Jacobian by columns, however many."""
    form = in_columns(on_path(model), "jacobian")
    assert form is not None
    return columns_in_fours(form, with_dense_results(model.path_jacobian, "jacobian")).n_instructions()


FOLLOWING = {**WIND, "force": [0.5, 0.0, 0.1]}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("strain", "modes", "nodes", "loads", "by_columns"),
    [
        ("kirchhoff", 6, 6, (), True),
        ("kirchhoff", 6, 18, (), True),
        ("reissner", 5, 8, (), True),
        ("kirchhoff", 5, 10, (FOLLOWING,), True),
        ("reissner", 5, 14, (FOLLOWING,), True),
        ("kirchhoff", 4, 54, (FOLLOWING,), False),
    ],
)
def test_loops_are_foreseen(
    strain: str, modes: int, nodes: int, loads: tuple[dict[str, Any], ...], by_columns: bool
) -> None:
    """Beyond the limit of code by columns kernels are loops; the forecast knows on which side a model is.

    Rods without couples have shorter code than the law says, which is of all loads.
    """
    wanted = scene(push(), WEIGHT, *loads, strain=strain)
    model = build(wanted, discretise(wanted, modes, nodes, "magnus6"))
    rod, chosen = model.discrete.rods["rod"].properties, model.discretisation["rod"]
    foreseen = foreseen_statements(terms_of(rod, chosen, spread_on(wanted, "rod")))
    counted = statements_of(model)
    assert_allclose(np.log(foreseen / counted), 0.0, rtol=0, atol=np.log(1.7))
    assert (counted <= MOST_IN_COLUMNS) == by_columns
    assert (foreseen <= MOST_IN_COLUMNS) == by_columns


def foreseen_times(modes: int, nodes: Iterable[int], *loads: dict[str, Any]) -> FloatArray:
    wanted = scene(push(), WEIGHT, *loads)
    rod = build(wanted, discretise(wanted, modes, 6, "magnus6")).discrete.rods["rod"].properties
    candidates = [discretise(wanted, modes, count, "magnus6")["rod"] for count in nodes]
    return np.array([foreseen_time(rod, chosen, spread_on(wanted, "rod")) for chosen in candidates])


def test_no_cliff_is_foreseen() -> None:
    """Time grows with the intervals as a straight line does while all is code by columns."""
    times = foreseen_times(6, range(6, 20))
    growth = times[1:] / times[:-1]
    assert growth.min() > 1.0
    assert growth.max() < 1.5
    assert_allclose(np.diff(times, 2), 0.0, rtol=0, atol=1e-9)


def test_columns_are_foreseen_in_fours() -> None:
    """Three components with four modes are three groups of four columns, with five modes four groups."""
    assert TOGETHER == LANES
    intervals = 12
    times = np.array([foreseen_times(modes, [intervals])[0] for modes in (4, 5)])
    law = TIME_IN_COLUMNS
    entries = law.entries * (15**2 - 12**2)
    # Intervals take three numbers of the strain about each axis with magnus6.
    turns = law.turns * 3 * intervals * (4 * 15 - 3 * 12)
    in_columns = law.in_columns * 3 * intervals * (4 - 3)
    assert_allclose(np.diff(times)[0], in_columns + turns + entries, rtol=1e-12, atol=0)


SHORT_ENOUGH = [("kirchhoff", 6, 15, "magnus6"), ("reissner", 4, 15, "magnus4")]
"""Strain, modes, intervals and integrator of rods that forces per length follow."""


@pytest.mark.parametrize(("strain", "modes", "nodes", "transport"), mostly_slow(SHORT_ENOUGH, quick=SHORT_ENOUGH[1:]))
def test_forces_that_follow_take_no_products_of_columns(strain: str, modes: int, nodes: int, transport: str) -> None:
    """Beside a dead force they add products with the matrix of integration, once for all columns."""
    dead = {**FOLLOWING, "frame": "world"}
    counted = []
    for wind in (dead, FOLLOWING):
        wanted = scene(push(), WEIGHT, wind, strain=strain)
        counted.append(statements_of(build(wanted, discretise(wanted, modes, nodes, transport))))
    products = 3 * (nodes + 1) ** 2
    assert counted[1] - counted[0] <= 6 * products


def test_loops_are_foreseen_to_take_longer() -> None:
    """Where a spread load makes the code too long by columns, one more interval makes it loops, which take longer."""
    wanted = scene(push(), WEIGHT, FOLLOWING)
    rod = build(wanted, discretise(wanted, 6, 6, "magnus6")).discrete.rods["rod"].properties
    nodes = range(12, 60)
    terms = [terms_of(rod, discretise(wanted, 6, n, "magnus6")["rod"], spread_on(wanted, "rod")) for n in nodes]
    is_loops = [foreseen_statements(own) > MOST_IN_COLUMNS for own in terms]
    first = is_loops.index(True)
    assert is_loops == sorted(is_loops) and first > 0
    times = foreseen_times(6, nodes, FOLLOWING)
    assert times[first] > time_in_columns(terms[first])
    assert (times[1:] / times[:-1]).min() > 1.0


def test_components_give_up_modes_together() -> None:
    """One mode less of one component is too many, one less of all does: their changes make up for each other."""
    tables, tolerance = random_scene(1005), 1.1e-5
    for load in tables["loads"]:
        if load["kind"] == "tip_wrench":
            load["force"] = [2 * v for v in load["force"]]
    wanted = scene_from_dict({**tables, "accuracy": {"tolerance": tolerance}})
    solution, truth = solve(wanted), fine(wanted)
    chosen = solution.model.discretisation["rod"]
    assert chosen.modes == (5, 5, 5)
    assert pose_distance(solution, truth) <= tolerance
    assert pose_distance(solve(build(wanted, {"rod": replace(chosen, modes=(5, 6, 6))})), truth) > tolerance


def test_choice_is_cheaper_than_its_neighbours() -> None:
    """One mode or one interval less, and the tolerance is missed."""
    wanted = scene(push(force=[3.0, 0.0, -1.0]), accuracy={"tolerance": 1e-7})
    solution, truth = solve(wanted), fine(wanted)
    chosen = solution.model.discretisation["rod"]
    assert chosen.modes[::2] == (1, 1)
    fewer = replace(chosen, modes=(1, chosen.modes[1] - 1, 1))
    coarser = replace(chosen, nodes=chosen.nodes - 2)
    for changed in (fewer, coarser):
        assert pose_distance(solve(build(wanted, {"rod": changed})), truth) > 0.5e-7


class _Blind:
    """A preview that can foresee neither fewer modes nor more."""

    discretisation = {"rod": Discretisation((5,), 12)}
    is_assembly = False
    supports = ()
    model = discrete = scene = property(lambda self: self)

    def share_of_more_modes(self, added: int) -> float:
        return 0.0

    def mode_shift(self, modes: object) -> np.ndarray:
        return np.full(12, np.nan)

    def finer_shift(self, grids: object, sweeps: int) -> FinerShift:
        return FinerShift(tips=np.full((2, 3), np.nan), shapes=np.full((2, 3), np.nan))


def test_what_cannot_be_foreseen_is_an_infinite_error(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Resolution, "_product_modes", 0)
    resolution = Resolution(_Blind())  # type: ignore[arg-type]
    assert resolution.extrapolated_error == np.inf
    assert resolution.hidden_error == np.inf
    assert resolution.modes_error == np.inf
    assert resolution.missing_modes(resolution.modes_error, 1e-3) > 0
