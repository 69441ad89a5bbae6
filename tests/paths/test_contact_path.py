"""Paths of rods that touch obstacles: the events between arrangements of contacts against shooting."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose
from rich.console import Console
from scipy.optimize import brentq, fsolve

from cosserat_casadi import build, discretise, follow, parse_scene, scene_from_dict, solve
from cosserat_casadi.cli.reports.path import print_path
from cosserat_casadi.numerics.trace import PathOutcome
from cosserat_casadi.paths.contact_path import ContactPath, follow_contact_path
from cosserat_casadi.paths.equilibrium_path import InputChange
from cosserat_casadi.plots.path_plot import plot_path
from tests.commands import cosserat
from tests.contact.test_contact import PUSH, ROD, free_span
from tests.contact.test_contact import TABLE as HEAVY_ROD
from tests.reference.planar import elastica_end
from tests.scenes import rod, scene

BENDING, LENGTH, WEIGHT, HEIGHT = 0.03, 1.2, 0.981, 0.08

LIFT = '[[loads]]\nname = "lift"\nkind = "tip_wrench"\nrod = "rod"\nforce = [0, 0, 0]\n'
TABLE = HEAVY_ROD.replace("[[obstacles]]", LIFT + "[[obstacles]]")

BAR = f"""
inputs = ["rod.base.position"]
{ROD.replace('"kirchhoff"', '"planar"')}
{PUSH}
[[obstacles]]
name = "bar"
kind = "capsule"
from = [0.8, -1.0, -0.07]
to = [0.8, 1.0, -0.07]
radius = 0.05
"""


def followed(text: str, name: str, value: list[float], modes: int) -> ContactPath:
    scene = parse_scene(text)
    path = follow(build(scene, discretise(scene, modes)), name, value)
    assert isinstance(path, ContactPath)
    return path


@pytest.fixture(scope="module")
def lowered() -> ContactPath:
    """The weight grows from zero."""
    return followed(TABLE, "weight.acceleration", [0, 0, -9.81], 8)


@pytest.fixture(scope="module")
def lifted() -> ContactPath:
    """The tip of the rod that lies there is lifted."""
    return followed(TABLE, "lift.force", [0, 0, 0.8], 8)


def span(length: float, curvature: float, force: float, weight: float) -> np.ndarray:
    """x, z, θ and κ of a heavy elastica at the end of a span that begins level; force of what is beyond its start."""
    return elastica_end(length, [0.0, 0.0, 0.0, curvature], [0.0, force], BENDING, weight)


def root(missed: object, guess: list[float]) -> np.ndarray:
    # What it says of its progress at the last digits is no matter: the root is held against the equations.
    found, *_ = fsolve(missed, guess, xtol=1e-13, full_output=True)
    assert_allclose(missed(found), 0.0, rtol=0, atol=1e-10)  # type: ignore[operator]
    return np.asarray(found)


def test_a_coarser_path_finds_its_points_on_a_finer_one(lowered: ContactPath) -> None:
    """In every arrangement of contacts, at the factors of the coarser path: solves for themselves find the same."""
    coarse = followed(TABLE, "weight.acceleration", [0, 0, -9.81], 6)
    arrangements = {}
    for index, near, x in coarse.between_events(lowered):
        assert x is not None
        factor = float(coarse.factor[index])
        shape = lowered.shape(near, x, factor)
        rough = coarse.shape(index, coarse.x[index], factor)
        assert_allclose(shape.tip().position, rough.tip().position, rtol=0, atol=1e-3)
        assert lowered.arrangement[near] == coarse.arrangement[index]
        arrangements[coarse.arrangement[index]] = factor, shape
    assert sorted(arrangements) == [0, 1, 2]
    for factor, shape in arrangements.values():
        alone = solve(lowered.model, {"weight.acceleration": [0, 0, -9.81 * factor]})
        assert_allclose(shape.tip().position, alone.tip().position, rtol=0, atol=1e-9)


@pytest.mark.slow
def test_a_rod_comes_to_lie_on_a_table(lowered: ContactPath) -> None:
    """The tip touches; it carries more and more, until it lies level: from there on a line grows."""
    assert lowered.converged
    assert [event.kind for event in lowered.events] == ["touch", "point_to_line"]
    touch, lies_down = lowered.events

    def at_touch(unknown: np.ndarray) -> list[float]:
        share, curvature = unknown
        _, z, _, kappa = span(LENGTH, curvature, -share * WEIGHT * LENGTH, share * WEIGHT)
        return [z + HEIGHT, kappa]

    share, _ = root(at_touch, [0.0094, -0.1])
    assert_allclose(touch.factor, share, rtol=1e-8, atol=0)

    def lying_down(unknown: np.ndarray) -> list[float]:
        share, curvature, reaction = unknown
        _, z, theta, kappa = span(LENGTH, curvature, reaction - share * WEIGHT * LENGTH, share * WEIGHT)
        return [z + HEIGHT, theta, kappa]

    share, _, reaction = root(lying_down, [0.085, -0.3, 0.03])
    assert_allclose(lies_down.factor, share, rtol=1e-8, atol=0)
    assert lies_down.contact is not None
    assert (lies_down.contact.obstacle, lies_down.contact.start) == ("table", 1.0)
    before = lies_down.position - 1
    assert_allclose(lowered.contacts(before)[0].ends, [reaction], rtol=1e-7, atol=0)
    (line,) = lowered.contacts(-1)
    assert (line.kind, line.end) == ("line", 1.0)


def test_points_are_equilibria_that_hold(lowered: ContactPath) -> None:
    """Along the way nothing is inside the table, nothing pulls, and a solve for itself finds the same."""
    for index in (0, 4, 9, -1):
        solution = lowered.solution(index)
        assert solution.converged, solution.message
        assert solution.stable
        assert_allclose(solution.smallest_eigenvalue, lowered.smallest_eigenvalue[index], rtol=1e-6, atol=0)
        assert_allclose(solution.tip().position, lowered.tip().position[index], rtol=0, atol=1e-12)
        assert all(min(contact.ends) > -1e-6 for contact in solution.contacts)
        z = solution.pose(np.linspace(0.0, 1.0, 501)).position[:, 2]
        assert z.min() > -HEIGHT - 1e-8
    end = solve(lowered.model)
    assert_allclose(end.tip().position, lowered.tip().position[-1], rtol=0, atol=1e-10)
    assert_allclose(end.contacts[0].start, lowered.contacts(-1)[0].start, rtol=0, atol=1e-9)


@pytest.mark.slow
def test_a_tip_that_is_lifted(lifted: ContactPath) -> None:
    """The line shrinks to a point where the spans on either side meet, and the point lets go."""
    assert lifted.converged
    assert [event.kind for event in lifted.events] == ["slide_from_tip", "line_to_point", "lift_off"]
    rises, shrinks, lets_go = lifted.events
    # Without lift the tip lies there unloaded: it rises at once.
    assert_allclose(rises.factor, 0.0, rtol=0, atol=1e-9)

    length, _, _ = free_span(BENDING, WEIGHT, HEIGHT)
    free = LENGTH - length
    lift = brentq(lambda force: span(free, 0.0, force - WEIGHT * free, WEIGHT)[3], 0.1, 0.5, xtol=1e-14)
    assert_allclose(0.8 * shrinks.factor, lift, rtol=1e-8, atol=0)
    assert shrinks.contact is not None
    assert_allclose(shrinks.contact.start * LENGTH, length, rtol=1e-7, atol=0)

    def letting_go(unknown: np.ndarray) -> list[float]:
        force, curvature, place = unknown
        _, z, theta, _ = span(place, curvature, force - WEIGHT * LENGTH, WEIGHT)
        *_, kappa = span(LENGTH, curvature, force - WEIGHT * LENGTH, WEIGHT)
        return [z + HEIGHT, theta, kappa]

    force, _, place = root(letting_go, [0.6, -3.1, 0.43])
    assert_allclose(0.8 * lets_go.factor, force, rtol=1e-8, atol=0)
    assert lets_go.contact is not None
    assert_allclose(lets_go.contact.start * LENGTH, place, rtol=1e-7, atol=0)
    assert lifted.contacts(-1) == ()


@pytest.mark.slow
def test_a_rod_is_drawn_over_a_bar() -> None:
    """Contact slides to the tip; the tip goes round the bar and slips off it where the path turns."""
    path = followed(BAR, "rod.base.position", [-0.25, 0, 0], 9)
    kinds = [event.kind for event in path.events]
    assert kinds[:2] == ["slide_to_tip", "limit"]
    slide, slip = path.events[:2]
    assert path.stable is not None
    assert path.stable[slip.position - 1]
    assert not path.stable[slip.position + 1]

    def at_tip(unknown: np.ndarray) -> list[float]:
        shift, curvature, force = unknown

        def shape(end: float) -> np.ndarray:
            # What is beyond a section pulls it by the push and by N along the normal at the tip.
            pull = [-force * np.sin(end), force * np.cos(end) - 3.0]
            return elastica_end(1.0, [-shift, 0.0, 0.0, curvature], pull, 0.5)

        angle = brentq(lambda end: shape(end)[2] - end, -1.0, 0.5, xtol=1e-14)
        x, z, theta, kappa = shape(angle)
        return [x + 0.05 * np.sin(theta) - 0.8, z - 0.05 * np.cos(theta) + 0.07, kappa]

    shift, _, force = root(at_tip, [0.195, -0.1, 3.0])
    assert_allclose(0.25 * slide.factor, shift, rtol=1e-8, atol=0)
    assert_allclose(path.contacts(slide.position)[0].start, 1.0, rtol=0, atol=0)
    assert_allclose(path.contacts(slide.position - 1)[0].ends, [force], rtol=1e-7, atol=0)


def test_no_step_takes_a_rod_through_a_thin_wire() -> None:
    thin = BAR.replace('inputs = ["rod.base.position"]', 'inputs = ["push.force"]').replace(
        "radius = 0.05", "radius = 4e-3"
    )
    path = followed(thin.replace("-0.07]", "-0.21]"), "push.force", [0, 0, -3.0], 4)
    assert [event.kind for event in path.events] == ["touch"]
    assert path.contacts(-1)[0].obstacle == "bar"
    # How the point slides as the rod moves is part of the second variation.
    assert path.smallest_eigenvalue is not None
    assert_allclose(path.smallest_eigenvalue[-1], path.solution(-1).smallest_eigenvalue, rtol=1e-9, atol=0)


def wire_met_by_elastica(name: str, push: float, section: float, radius: float = 1e-4) -> dict[str, object]:
    """A wire across a cantilever of length and stiffness one, which a tip force touches it with at a section."""
    (curvature,) = root(lambda k: elastica_end(1.0, [0.0, 0.0, 0.0, k[0]], [0.0, -push], 1.0)[3:], [-push])
    x, z, angle, _ = elastica_end(section, [0.0, 0.0, 0.0, curvature], [0.0, -push], 1.0)
    middle = np.array([x + radius * np.sin(angle), z - radius * np.cos(angle)])
    ends = {word: [middle[0], y, middle[1]] for word, y in (("from", -1.0), ("to", 1.0))}
    return {"name": name, "kind": "capsule", "radius": radius, **ends}


@pytest.mark.parametrize("push", [0.05, 0.3])
def test_a_rod_touches_the_first_of_two_thin_wires(push: float) -> None:
    """Steps are longer than the wires are thick: where one touches the rod, another one may be behind it already."""
    wires = [wire_met_by_elastica("first", push, 0.55), wire_met_by_elastica("second", push + 0.01, 0.4)]
    single = rod("planar", length=1.0, stiffness={"bending_y": 1.0}, base={"tangent": [1, 0, 0]})
    tip = {"name": "push", "kind": "tip_wrench", "rod": "rod", "force": [0, 0, -1.0]}
    table = {"schema": 1, "rods": [single], "loads": [tip], "obstacles": wires, "accuracy": {"modes": 5}}
    path = follow(build(scene_from_dict(table)), "push.force", [0.0, 0.0, -1.0])
    touch, *_ = path.events
    assert path.converged and touch.kind == "touch" and touch.contact is not None
    assert touch.contact.obstacle == "first"
    assert_allclose([touch.factor, touch.contact.start], [push, 0.55], rtol=1e-6, atol=0)


@pytest.mark.slow
def test_without_contact_it_is_the_path_of_the_scene_without_obstacles() -> None:
    low = TABLE.replace("-0.08]", "-5.0]")
    bare = parse_scene(low[: low.index("[[obstacles]]")])
    free = follow(build(bare, discretise(bare, 5)), "lift.force", [0, 0, 0.3])
    path = followed(low, "lift.force", [0, 0, 0.3], 5)
    assert path.events == ()
    assert_allclose(path.tip().position[-1], free.tip().position[-1], rtol=0, atol=1e-12)


def test_files_and_figure_name_the_events(lowered: ContactPath) -> None:
    data = json.loads(json.dumps(lowered.to_dict()))
    touch, lies_down = data["events"]
    assert touch["contact"] == {"obstacle": "table", "rod": "rod", "from": 1.0, "to": 1.0, "kind": "point"}
    assert lies_down["kind"] == "point_to_line"
    tip = touch["rods"]["rod"]["tip"]
    assert_allclose(tip["position"], lowered.event_position(lowered.events[0], 1.0), rtol=0, atol=1e-12)
    assert len(tip["quaternion"]) == 4
    (contact,) = data["path"][-1]["contacts"]
    assert contact["kind"] == "line"
    assert len(contact["point_forces"]) == 2
    assert data["path"][0]["contacts"] == []
    labels = [text.get_text() for text in plot_path(lowered).axes[0].get_legend().get_texts()]
    assert {"touch", "point to line"} <= set(labels)


@pytest.mark.slow
def test_scene_path_meets_its_tolerance() -> None:
    scene = parse_scene(TABLE.replace("1e-7", "1e-6"))
    path = follow(scene, "weight.acceleration", [0, 0, -9.81])
    assert path.converged
    assert path.error_estimate is not None
    assert path.error_estimate < 1e-6
    assert_allclose(path.events[1].factor, 0.0853380845, rtol=1e-6, atol=0)


def test_a_report_fits_a_terminal_of_80_columns(lowered: ContactPath) -> None:
    console = Console(record=True, width=80)
    print_path(console, lowered, [])
    text = console.export_text()
    assert "after it" in text and "x, m" in text
    assert "…" not in text


@pytest.mark.slow
def test_command(tmp_path: Path) -> None:
    scene = tmp_path / "table.toml"
    scene.write_text(TABLE.replace("[[rods]]", "[[rods]]", 1).replace("tolerance = 1e-7", "modes = 5"))
    arguments = ["--input", "weight.acceleration", "--to", "[0,0,-2]", "--output", "path.json"]
    ended = cosserat("path", scene.name, *arguments, cwd=tmp_path)
    assert ended.returncode == 0, ended.stdout
    assert "2 changes of contact" in ended.stdout.replace("\n", " ")
    kinds = [event["kind"] for event in json.loads((tmp_path / "path.json").read_text())["events"]]
    assert kinds == ["touch", "point_to_line"]


def test_without_a_next_arrangement_the_path_ends_and_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    """Honest where it can go no further: the points before are kept."""
    monkeypatch.setattr("cosserat_casadi.paths.contact_path.entered", lambda *_: None)
    path = followed(TABLE, "weight.acceleration", [0, 0, -9.81], 4)
    assert not path.converged
    assert path.outcome.label == "contact_unsettled"
    assert "no set of contacts" in path.message
    assert len(path.factor) > 2


def test_parameters_move_along_a_path() -> None:
    """A rod grows soft while its base turns, until its tip touches: equations and gaps are those there."""
    base = {"position": [0, 0, 0], "quaternion": [np.sqrt(0.5), 0, np.sqrt(0.5), 0]}
    weight = {"name": "weight", "kind": "distributed_wrench", "rod": "rod", "force": [0, 0, -0.5]}
    table = {"name": "table", "kind": "plane", "point": [0, 0, -0.1], "normal": [0, 0, 1]}
    bent = rod("planar", base=base, intrinsic={"curvature": [0, 0.1, 0]})
    named = ["rod.stiffness.bending_y", "rod.base.quaternion", "rod.intrinsic.curvature.y[0]"]
    heavy = scene(weight, rods=[bent], obstacles=[table], parameters=named)
    model = build(heavy, discretise(heavy, 4, 16))
    angle = np.radians(80.0)
    last = [0.02, np.cos(angle / 2), 0, np.sin(angle / 2), 0, 0.1]
    begin = np.append(model.pack(), model.parameters.pack())
    change = np.append(np.zeros(model.inputs.size), last - model.parameters.pack())
    path = follow_contact_path(InputChange(model, named[0], begin, change))
    assert path.outcome is PathOutcome.CONVERGED
    wanted = solve(model, parameters=dict(zip(named, np.split(np.array(last), [1, 5]), strict=True)))
    assert_allclose(path.solution(-1).tip().position, wanted.tip().position, rtol=0, atol=1e-9)
    for index in range(0, len(path.factor), 9):
        factor = float(path.factor[index])
        arrangement = path.arrangements[path.arrangement[index]]
        z = path.x[index]
        ends = [arrangement.at(factor + step) for step in (1e-5, -1e-5)]
        over, under = (end.residual(z, end.given) for end in ends)
        assert_allclose(arrangement.rate(z, factor), (over - under) / 2e-5, rtol=0, atol=1e-8)
        gaps = arrangement.gaps(z, factor)["rod", "table"]
        slopes = [gaps.at(0.5 + step)[1] for step in (1e-5, -1e-5)]
        assert_allclose(gaps.at(0.5)[2], (slopes[0] - slopes[1]) / 2e-5, rtol=2e-2)
