"""The budget of a turn of a control loop that fits a period, by what the parts of a turn take."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import ExportError, export, load
from cosserat_casadi.codegen import turn_budget
from cosserat_casadi.codegen.turn_budget import ALWAYS, MOST_ITERATIONS, TurnCosts, fitting, foreseen_costs
from tests.codegen.contact_libraries import over_bar
from tests.codegen.libraries import RECIPES, Recipe
from tests.commands import cosserat
from tests.conftest import ROOT

COSTS = TurnCosts(step=10.0, point=4.0, end=30.0, measured=True)


@pytest.mark.parametrize("period", [2e-4, 3.3e-4, 1e-3, 1.0])
def test_largest_budget_that_fits(period: float) -> None:
    """Its longest turn fits the period, and that of one Newton step more does not, but for the most there are."""
    budget = fitting(COSTS, period)
    assert COSTS.worst(budget.iterations, budget.steps) <= 1e6 * period
    more = budget.iterations + 1
    assert more > MOST_ITERATIONS or COSTS.worst(more, (more + 1) // 2) > 1e6 * period
    assert (fitting(COSTS, 1.0).iterations, fitting(COSTS, 1.0).steps) == (ALWAYS.iterations, ALWAYS.steps)


def test_period_that_nothing_fits_is_refused() -> None:
    with pytest.raises(ExportError, match="--period: a turn of this scene may take"):
        fitting(COSTS, 1e-5)


@pytest.mark.parametrize("has_compiler", [True, False])
def test_folder_for_a_period(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, has_compiler: bool) -> None:
    """Header, defaults and manifest agree, measured or foreseen; what is solved is the same."""
    if not has_compiler:
        monkeypatch.setattr(turn_budget, "find_compiler", _none)
    model = RECIPES["tiny"].model()
    costs = foreseen_costs(model)
    period = 100 * costs.worst(1, 1) * 1e-6
    described = json.loads((export(model, tmp_path / "tiny", period=period) / "manifest.json").read_text())["turn"]
    assert described["times"] == ("measured" if has_compiler else "foreseen")
    assert described["longest_us"] <= 1e6 * period
    config = (tmp_path / "tiny" / "tiny_config.h").read_text()
    defined = [int(found) for found in re.findall(r"#define SOLVER_DEFAULT_\w+ (\d+)", config)]
    assert defined == [described["max_iterations"], described["max_continuation_steps"]]
    header = (tmp_path / "tiny" / "tiny.h").read_text()
    assert f"longest turn, {described['longest_us']:.4g} us, fits a period of {1e6 * period:.4g} us" in header
    monkeypatch.undo()
    found = load(tmp_path / "tiny").solve()
    assert_allclose(model.residual(found.x, model.pack()).full(), 0.0, rtol=0, atol=1e-9)


def _none(wanted: str | None = None) -> str:
    raise ExportError


def test_budget_without_a_period_is_not_measured(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """So that a folder is the same on every machine."""
    monkeypatch.setattr(turn_budget, "measured_costs", None)
    described = json.loads((export(RECIPES["tiny"].model(), tmp_path / "tiny") / "manifest.json").read_text())
    assert described["turn"] == {"max_iterations": ALWAYS.iterations, "max_continuation_steps": ALWAYS.steps}


@pytest.mark.parametrize("period", [0.0, -1e-3, float("nan"), float("inf")])
def test_no_period_is_refused(tmp_path: Path, period: float) -> None:
    with pytest.raises(ExportError, match="must be a positive number of seconds"):
        export(RECIPES["tiny"].model(), tmp_path / "tiny", period=period)


def test_period_of_a_scene_in_exact_contact_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ExportError, match="is not known for a scene in exact contact"):
        export(Recipe(over_bar(), 2, 4).model(), tmp_path / "bar", period=1e-3)


@pytest.mark.slow
def test_period_by_the_command(tmp_path: Path) -> None:
    scene = str(ROOT / "examples" / "planar_strip.toml")
    written = cosserat("export", scene, "--output", "strip", "--period", "1e-2", cwd=tmp_path)
    assert written.returncode == 0, written.stderr
    assert json.loads((tmp_path / "strip" / "manifest.json").read_text())["turn"]["period_s"] == 0.01
    refused = cosserat("export", scene, "--page", "strip.html", "--period", "1e-2", cwd=tmp_path)
    assert refused.returncode == 2
    assert "--period: is for the sources in C" in refused.stderr
