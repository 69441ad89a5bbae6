"""Refinement levels: what a solution lacks, and where each verdict leads."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from cosserat_casadi import Scene, Solution, build, discretise, parse_scene, read_scene, solve
from cosserat_casadi.accuracy.assess import Enough, NeedsFinerGrid, NeedsModes, NeedsNodes, NoEquilibrium, assess
from cosserat_casadi.accuracy.levels import (
    GRID_FACTOR,
    MOST_GRID_FACTOR,
    REFERENCE_MODES,
    Level,
    is_thin,
    layer_nodes,
    layer_sections,
)
from cosserat_casadi.equilibrium.metrics import pose_distance, prolong
from cosserat_casadi.numerics.outcome import Outcome
from cosserat_casadi.scene.accuracy import MOST_SECTIONS
from tests.conftest import ROOT
from tests.contact.test_smooth_contact import ON_A_BAR
from tests.scenes import WEIGHT, push, scene

BENT = scene(push(force=[3.0, 1.0, -0.5]), WEIGHT)


def solved(wanted: Scene, modes: int, nodes: int) -> Solution:
    return solve(build(wanted, discretise(wanted, modes, nodes, "magnus6")))


def rolled(turns: float) -> Scene:
    straight = {"name": "rod", "length": 1.0, "strain": "planar", "stiffness": {"bending_y": 1.0}}
    return scene(push(force=[0, 0, 0], moment=[0, 2 * np.pi * turns, 0]), rods=[straight])


@pytest.mark.parametrize(
    ("modes", "nodes", "verdict"),
    [(5, 30, NeedsModes), (9, 9, NeedsFinerGrid), (9, 14, Enough)],
)
def test_verdict_names_what_leaves_the_error(modes: int, nodes: int, verdict: type) -> None:
    assert isinstance(assess(solved(BENT, modes, nodes), 1e-8), verdict)


def test_missing_modes_are_extrapolated() -> None:
    verdict = assess(solved(BENT, 4, 30), 1e-6)
    assert isinstance(verdict, NeedsModes)
    assert verdict.extrapolated
    assert verdict.modes > 4


def test_too_bent_for_its_grid_needs_nodes_that_resolve_it() -> None:
    verdict = assess(solved(rolled(5.0), 2, 6), 1e-6)
    assert isinstance(verdict, NeedsNodes)
    assert 6 < verdict.nodes <= 12


def test_failed_solve_is_no_equilibrium() -> None:
    stalled = replace(solved(BENT, 4, 10), outcome=Outcome.LOAD_STALLED)
    assert isinstance(assess(stalled, 1e-6), NoEquilibrium)


def test_extrapolated_modes_skip_three_levels_at_most() -> None:
    level = Level(1)
    assert level.with_extrapolated_modes(1000) == Level(4)
    assert level.with_extrapolated_modes(REFERENCE_MODES[2]) == Level(2)
    assert level.with_modes(REFERENCE_MODES[1]) == Level(2)
    assert level.with_modes(REFERENCE_MODES[5]) == Level(5)
    assert level.with_modes(REFERENCE_MODES[-1] + 1) is None


def test_the_finest_level_is_tried_before_extrapolated_modes_are_given_up() -> None:
    finest = Level(1).finest
    below = Level(finest - 1)
    more = REFERENCE_MODES[finest] + 2
    assert below.with_modes(more) is None
    assert below.with_extrapolated_modes(more) == Level(finest)


def test_modes_beyond_the_finest_level_are_tried_where_a_level_has_what_is_extrapolated() -> None:
    finest = Level(1).finest
    last = len(REFERENCE_MODES) - 1
    most = REFERENCE_MODES[last]
    assert last > finest + 1
    # Step by step, however many are missing.
    assert Level(finest).with_extrapolated_modes(most) == Level(finest + 1)
    assert Level(finest + 1).with_extrapolated_modes(most) == Level(finest + 2)
    assert Level(finest).with_extrapolated_modes(most + 1) is None
    assert Level(last).with_extrapolated_modes(most) is None


def test_what_is_known_of_the_grid_is_kept_with_more_modes() -> None:
    level = Level(2, min_nodes=90)
    finer = level.with_finer_grid()
    assert finer is not None
    above = finer.with_modes(finer.modes + 1)
    assert above == Level(3, GRID_FACTOR, 90)
    assert above.nodes(0.0) == 90
    assert above.nodes(400.0) > 90


def test_grid_is_given_up_after_some_factors() -> None:
    level: Level | None = Level(2)
    factors = []
    while level is not None:
        factors.append(level.grid_factor)
        level = level.with_finer_grid()
    assert factors[0] == 1.0
    assert factors[-2] < MOST_GRID_FACTOR <= factors[-1]


@pytest.mark.parametrize(("tolerance", "index"), [(1e-2, 1), (1e-4, 1), (1e-5, 2), (1e-12, 2)])
def test_first_level(tolerance: float, index: int) -> None:
    assert Level.first(tolerance) == Level(index)


@pytest.mark.slow
def test_first_level_of_an_assembly_tells_how_fast_it_converges() -> None:
    """Three modes are always kept there, so that on five modes nothing is left to compare with."""
    platform = read_scene(ROOT / "examples" / "shaken_platform.toml")
    assert Level.first(platform.accuracy.tolerance).modes == 5
    tried: list[str] = []
    solve(platform, report=tried.append)
    first = discretise(platform, 7, 10)
    assert tried[0].startswith(f"{build(platform, first).size} unknowns")
    # Nothing finer is needed: what follows is the coarsened model.
    assert len(tried) == 2


FREE_ON_A_BAR = ON_A_BAR.replace("accuracy = { modes = 2, nodes = 24 }", "")
"""The rod on a bar whose modes are chosen."""

WIRE = ["bar.radius=1e-3", "bar.width=5e-4"]
"""A bar that becomes a wire, whose layer a rod of 2 mm radius is in for √(2 w d) = 1.7 mm to both sides."""


def test_levels_beside_a_thin_wire_that_rubs_see_its_layer() -> None:
    """Friction is at the nodes: on fewer intervals the rod sinks between them, and its path stalls.

    Eleven elements of 45 mm are to have nodes at most 1.5 times as far apart as half of the pressed stretch in their
    middles, where they are π/2 times as far apart as on the average.
    """
    wire = parse_scene(FREE_ON_A_BAR, [*WIRE, "bar.friction=0.1"])
    nodes = int(np.ceil(np.pi / 2 * 500 / 11 / (1.5 * np.sqrt(2 * 0.5 * (1 + 2)))))
    assert layer_nodes(wire) == nodes == 28
    assert is_thin(wire)
    assert Level.first(1e-4, layer_nodes=nodes).nodes(0.0) == nodes
    assert Level.first(1e-4, layer_nodes=nodes).with_finer_grid().nodes(0.0) == np.ceil(GRID_FACTOR * nodes)
    few = build(wire, discretise(wire, 3, 10))
    # Zeros: it is not let settle.
    coarse = solve(few, start=np.zeros(few.size), estimate_error=False)
    assert coarse.outcome is Outcome.LOAD_STALLED


def test_sections_of_layers_follow_the_tolerance() -> None:
    """On eleven elements of 45 mm: a quarter of the stretch apart their error is 1.5e-3; it falls by the power four."""
    half = np.sqrt(2 * 0.5 * (1 + 2))
    for tolerance, closer in ((1e-2, 1), (1.5e-3, 1), (1.5e-3 / 2**4, 2), (1.5e-3 / 4**4, 4)):
        wire = parse_scene(FREE_ON_A_BAR, WIRE)
        assert layer_sections(wire, tolerance) == np.ceil(closer * 500 / 11 / (0.5 * half))
    assert layer_sections(parse_scene(FREE_ON_A_BAR, [*WIRE, "bar.friction=0.1"]), 1e-6) == 0


def test_finer_sums_are_given_up_at_the_most_sections() -> None:
    level = Level.first(1e-4, sections=600)
    finer = level.with_finer_sums(2.0)
    assert finer is not None and finer == replace(level, sections=1200)
    most = finer.with_finer_sums(2.0)
    assert most is not None and most == replace(level, sections=MOST_SECTIONS)
    assert most.with_finer_sums(2.0) is None
    # What rubs is summed at the nodes.
    at_nodes = Level.first(1e-4, layer_nodes=28)
    assert at_nodes.with_finer_sums(2.0) == at_nodes.with_finer_grid()


def test_the_layer_of_a_thin_wire_is_summed_between_nodes() -> None:
    """A wire asks for no intervals of its own: on eight the rod lies in its layer as on sixteen."""
    wire = parse_scene(FREE_ON_A_BAR, WIRE)
    assert layer_nodes(wire) == 0
    assert not is_thin(wire)
    seen = solve(build(wire, discretise(wire, 3, 8)), estimate_error=False)
    assert seen.converged
    (contact,) = seen.contacts
    assert contact.gap is not None and 0.0 < contact.gap < 5e-4
    finer = build(wire, discretise(wire, 3, 16))
    assert pose_distance(seen, solve(finer, start=prolong(seen, finer), estimate_error=False)) < 1e-4


def test_a_thick_bar_and_a_table_ask_for_no_intervals_of_their_own() -> None:
    thick = parse_scene(FREE_ON_A_BAR, ["bar.radius=0.02", "bar.width=5e-3"])
    assert 0 < layer_nodes(thick) < 12
    assert not is_thin(thick)
    table = FREE_ON_A_BAR.partition("[[obstacles]]")[0]
    table += '[[obstacles]]\nname = "table"\nkind = "plane"\npoint = [0, 0, -0.03]\nnormal = [0, 0, 1]\nwidth = 5e-4\n'
    assert layer_nodes(parse_scene(table)) == 0
