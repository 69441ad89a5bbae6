"""Prices in scalar operations: exact for small models, bounds for large ones, and never long to wait for."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import casadi as ca
import pytest

from cosserat_casadi import build, parse_scene, read_scene
from cosserat_casadi.cli.main import app, run
from cosserat_casadi.model.operation_cost import price, prices_of_effects, without_load
from cosserat_casadi.model.operations import COUNTED_EXACTLY, Count, count, counts, most_operations, operations
from tests.commands import WIRE

LUMEN = """
schema = 1
[[rods]]
name = "cath"
length = 0.12
strain = "kirchhoff"
material = { youngs_modulus = 8e6, poisson_ratio = 0.48, density = 1150.0 }
section = { shape = "annulus", outer_radius = 1.0e-3, inner_radius = 0.4e-3 }
[[loads]]
name = "weight"
kind = "gravity"
acceleration = [0, -9.81, 0]
[[obstacles]]
name = "vessel"
kind = "lumen"
points = [[0, 0, -0.02], [0, 0, 0.03], [0.006, 0, 0.07], [0.02, 0, 0.11], [0.045, 0, 0.16]]
radius = [4e-3, 4e-3, 3.5e-3, 3.5e-3, 3.5e-3]
width = 5e-4
"""
"""A rod in a smooth lumen has several million scalar operations in its Jacobian."""

PLANAR = """
schema = 1
accuracy = { modes = 2, nodes = 4 }
[[rods]]
name = "rod"
length = 0.12
strain = "planar"
material = { youngs_modulus = 8e6, poisson_ratio = 0.48 }
section = { shape = "circle", radius = 1e-3 }
[[loads]]
name = "push"
kind = "tip_wrench"
rod = "rod"
force = [0, 0, -1e-3]
"""


@pytest.fixture
def lumen(tmp_path: Path) -> Path:
    path = tmp_path / "lumen.toml"
    path.write_text(LUMEN)
    return path


@pytest.fixture
def expanded(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """Numbers of the scalar nodes whose common terms were shared."""
    nodes: list[int] = []
    share = ca.cse

    def counted_cse(expressions: ca.SX | Sequence[ca.SX]) -> ca.SX | list[ca.SX]:
        several = expressions if isinstance(expressions, list) else [expressions]
        nodes.append(sum(ca.n_nodes(expression) for expression in several))
        return share(expressions)

    monkeypatch.setattr(ca, "cse", counted_cse)
    return nodes


def test_no_large_model_is_expanded_to_be_priced(lumen: Path, expanded: list[int]) -> None:
    scene = read_scene(lumen)
    shown: list[str] = []
    of_effects = prices_of_effects(scene, lambda stage, done, total: shown.append(f"{stage}: {done} of {total}"))
    cost = price(build(scene))
    assert max(expanded) < COUNTED_EXACTLY
    assert shown == ["Counting the operations of weight: 0 of 2", "Counting the operations of vessel: 1 of 2"]
    assert not cost.jacobian.exact
    assert cost.jacobian.number > cost.residual.number > of_effects["vessel"].number > of_effects["weight"].number > 0


def test_check_of_a_large_scene_says_at_most(
    lumen: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], expanded: list[int]
) -> None:
    monkeypatch.setattr("sys.argv", ["cosserat", "check", str(lumen)])
    assert run(app) == 0
    printed = " ".join(capsys.readouterr().out.split())
    assert "residual and Jacobian at most" in printed
    assert max(expanded) < COUNTED_EXACTLY


def test_bounds_are_not_below_the_count(tmp_path: Path) -> None:
    scene = tmp_path / "rod.toml"
    scene.write_text(PLANAR)
    model = build(read_scene(scene))
    for function in (model.residual, model.jacobian, model.igm["rod"]):
        exact = operations(function)
        assert exact <= most_operations(function) <= 3 * exact
        assert count(function) == Count(exact, exact=True)
    assert prices_of_effects(model.scene)["push"].exact


def test_bound_of_each_kind_of_instruction() -> None:
    """Products of matrices, scalar products, norms, elementwise operations, calls and maps."""
    x = ca.MX.sym("x", 3)
    matrix = ca.MX.sym("matrix", ca.Sparsity.lower(3))
    cube = ca.Function("cube", [x], [x**3])
    stacked = ca.MX.sym("stacked", 3, 5)
    results = {
        "product": (matrix @ x, 2 * 6),
        "dot": (ca.dot(x, x), 5),
        "norm": (ca.norm_2(x), 6),
        "sum": (x + ca.sin(x), 6),
        "called": (cube(x), 6),
        "mapped": (cube.map(5)(stacked), 30),
        "moved": (ca.vertcat(x, x)[::2], 0),
    }
    for name, (result, most) in results.items():
        function = ca.Function(name, [x, matrix, stacked], [result])
        assert operations(function) <= most_operations(function) <= most


def test_compared_functions_are_counted_alike() -> None:
    """A small function beside a large one has a bound too: what is subtracted was counted in one way."""
    x = ca.MX.sym("x", COUNTED_EXACTLY)
    large = ca.Function("large", [x], [ca.sin(x)])
    small = ca.Function("small", [x], [ca.sin(x[0])])
    assert counts([small]) == [Count(1, exact=True)]
    assert counts([small, large]) == [Count(1, exact=False), Count(COUNTED_EXACTLY, exact=False)]
    assert str(Count(20_123_456, exact=False)) == "at most 21,000,000"
    assert str(Count(1234, exact=True)) == "1,234"
    assert str(Count(7, exact=False)) == "at most 7"
    assert str(Count(7, exact=False) - Count(5_011, exact=False)) == "about -5,000"


def test_a_scene_without_a_load_has_nothing_that_is_of_it() -> None:
    """Its inputs, ranges, bounds, parameters and motions go with it: the scene is as one that never had it."""
    tendon = '[[actuators]]\nname = "{}"\nkind = "tendon"\nrod = "wire"\ntension = 1.0\noffset = [1e-3, 0.0]\n'
    bound = '[[bounds]]\ninput = "{}.tension"\nlower = 0.0\n'
    motion = '[[motions]]\ninput = "{}.tension"\namplitude = 0.1\nfrequency = 1.0\n'

    def text(*names: str) -> str:
        """A wire with tendons of these names."""
        inputs = [f"{name}.tension" for name in names]
        parameters = ["wire.length", *(f"{name}.offset.x" for name in names)]
        ranges = "".join(f'"{entry}" = [0.0, 2.0]\n' for entry in inputs)
        head = f"schema = 1\ninputs = {inputs}\nparameters = {parameters}\n[ranges]\n{ranges}"
        return head + WIRE + "".join(table.format(name) for table in (tendon, bound, motion) for name in names)

    assert without_load(parse_scene(text("east", "north")), "east") == parse_scene(text("north"))
