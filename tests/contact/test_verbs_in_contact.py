"""The table of docs/contact.md: what works with which contact, and with what sentence the rest is refused."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from cosserat_casadi import (
    Model,
    Scene,
    Solution,
    build,
    export,
    follow,
    identify,
    inverse,
    linearise,
    load,
    modes_of,
    scene_from_dict,
    simulate,
    solve,
    sweep,
)
from cosserat_casadi.codegen.acados import acados_expressions
from cosserat_casadi.codegen.contact.compiled import CompiledContact
from cosserat_casadi.codegen.fmu import write_fmu
from cosserat_casadi.codegen.motion_stage import compiled_motion_stage
from cosserat_casadi.codegen.stage import compiled_stage
from cosserat_casadi.control import embedded, motion_stage, relaxed_contact
from cosserat_casadi.errors import CosseratError
from cosserat_casadi.estimation.estimate import estimate
from cosserat_casadi.mjcf.export import mjcf_of
from cosserat_casadi.page.page import export_page
from cosserat_casadi.view.view_session import opened
from tests.conftest import ROOT
from tests.page.pages_made import wasm_compiler

Verb = Callable[[str, Path], object]
"""A use of the scene of one column, which may write to a folder."""

LENGTH = 0.1
RADIUS = 5e-3

MEASURED = {
    "name": "tips",
    "quantity": "position",
    "file": "tips.csv",
    "rod": "rod",
    "columns": ["x", "y", "z"],
    "sigma": 1e-3,
}
DATA = {"tips.csv": {"x": np.full(2, 0.096), "y": np.zeros(2), "z": np.full(2, -0.02)}}


def rod(name: str = "rod", **base: Any) -> dict[str, Any]:
    """A rod of rubber that lies along x."""
    return {
        "name": name,
        "length": LENGTH,
        "strain": "planar",
        "base": {"tangent": [1, 0, 0], **base},
        "material": {"youngs_modulus": 2e6, "poisson_ratio": 0.45, "density": 1100.0},
        "section": {"shape": "circle", "radius": RADIUS},
    }


FLOOR = {"name": "floor", "kind": "plane", "point": [0, 0, -0.02], "normal": [0, 0, 1]}
HEAD = {
    "bodies": [{"name": "head", "mass": 0.01, "radius": 0.01}],
    "joints": [{"body": "head", "rod": "rod", "kind": "fixed"}],
}
BELOW = rod("other", position=[0.07, -0.05, -0.013], tangent=[0, 1, 0])
TOUCH = {"rods": ["rod", "other"], "width": 4e-3}

CONTACTS: dict[str, dict[str, Any]] = {
    "exact, rods": {"obstacles": [FLOOR]},
    "exact, bodies": {"obstacles": [FLOOR | {"bodies": ["head"]}], **HEAD},
    "exact with friction": {"obstacles": [FLOOR | {"friction": 0.3}]},
    "smooth": {"obstacles": [FLOOR | {"width": 8e-3}]},
    "smooth with friction": {"obstacles": [FLOOR | {"width": 8e-3, "friction": 0.3}]},
    "rods on rods": {"rods": [rod(), BELOW], "rod_contacts": [TOUCH]},
    "these with friction": {"rods": [rod(), BELOW], "rod_contacts": [TOUCH | {"friction": 0.3}]},
    "rods on rods, exact": {
        "rods": [rod(), BELOW],
        "rod_contacts": [{"rods": ["rod", "other"], "exact": True}],
        "simulation": {"duration": 0.03, "start": "unloaded", "tolerance": 1e-2},
    },
}
"""What a scene of each column has beside a rod and its push, by the heading of the column."""


@cache
def touching(contact: str, *more: str) -> Scene:
    """A scene of one column, with what a verb asks for."""
    asked = {
        "parameters": {"parameters": ["rod.material.youngs_modulus"]},
        "targets": {"targets": [{"kind": "position", "rod": "rod", "position": [0.096, 0.0, -0.02]}]},
        "identify": {
            "measurements": [MEASURED],
            "unknowns": [{"parameter": "rod.material.youngs_modulus", "lower": 1e6, "upper": 4e6}],
        },
        "estimate": {
            "measurements": [MEASURED],
            "unknowns": [{"input": "push.force.z", "per_row": True, "prior": {"mean": -0.1, "sigma": 0.05}}],
        },
    }
    push = {"name": "push", "kind": "tip_wrench", "rod": "rod", "force": [0, 0, -0.1]}
    tables: dict[str, Any] = {
        "schema": 1,
        "rods": [rod()],
        "loads": [push],
        "inputs": ["push.force"],
        "accuracy": {"modes": 2, "nodes": 4},
        "simulation": {"duration": 1e-3, "start": "equilibrium", "tolerance": 1e-2},
        **CONTACTS[contact],
    }
    for name in more:
        tables |= asked[name]
    return scene_from_dict(tables)


@cache
def rest(contact: str) -> Solution:
    return solve(model(contact))


@cache
def model(contact: str, *, moving: bool = False) -> Model:
    return build(touching(contact), moving=moving)


def _solved(contact: str, _: Path) -> str:
    found = rest(contact)
    assert found.converged, found.message
    assert found.contacts
    return found.message


def _judged(contact: str, _: Path) -> str:
    assert rest(contact).stable
    return ""


def _followed(contact: str, _: Path) -> str:
    path = follow(model(contact), "push.force", [0.0, 0.0, -0.12])
    assert path.converged, path.message
    return path.message


def _moved(contact: str, _: Path) -> str:
    motion = simulate(model(contact, moving=True))
    assert motion.converged, motion.message
    assert motion.events or contact != "rods on rods, exact"
    return motion.message


def _inverted(contact: str, _: Path) -> str:
    return inverse(build(touching(contact, "targets")), estimate_error=False).solution.message


def _identified(contact: str, _: Path) -> str:
    found = identify(build(touching(contact, "identify").with_unknowns()), DATA)
    assert found.cases, found.message
    return found.message


def _estimated(contact: str, _: Path) -> str:
    found = estimate(build(touching(contact, "estimate").with_unknowns()), DATA)
    assert found.found.any(), found.outcomes
    return found.message


def _swept(contact: str, _: Path) -> str:
    assert sweep(model(contact), {"push.force.z": [-0.1, -0.11]}, cores=1).converged.all()
    return ""


def _with_parameters(contact: str, _: Path) -> str:
    found = solve(build(touching(contact, "parameters")), parameters={"rod.material.youngs_modulus": 2.2e6})
    assert found.converged, found.message
    return found.message


def _exported(**options: bool) -> Verb:
    def written(contact: str, folder: Path) -> object:
        return export(model(contact, moving=options.get("dynamics", False)), folder / "robot", **options)

    return written


def _loaded(contact: str, folder: Path) -> str:
    library = load(export(model(contact), folder / "robot"))
    started = library.start() if isinstance(library, CompiledContact) else library.solve()
    assert started.converged, started.message
    return started.message


def _compiled_stage_in_motion(contact: str, _: Path) -> str:
    stage = motion_stage(model(contact, moving=True), 1e-2)
    compiled = compiled_motion_stage(stage, "verb")
    written = stage.equations.function
    random = np.random.default_rng(0)
    arguments = [1e-3 * random.standard_normal(written.size1_in(k)) for k in range(written.n_in())]
    values = [np.array(function(*arguments)).ravel() for function in (compiled.equations.function, written)]
    np.testing.assert_allclose(values[0], values[1], rtol=1e-10, atol=1e-10 * np.abs(values[1]).max())
    return ""


VERBS: dict[str, Verb] = {
    "`solve`": _solved,
    "stability": _judged,
    "`path`": _followed,
    "`simulate`": _moved,
    "`modes`": lambda contact, _: modes_of(rest(contact), count=1).modes[0],
    "`linearise`": lambda contact, _: linearise(rest(contact)),
    "`inverse`": _inverted,
    "`identify`": _identified,
    "`estimate`": _estimated,
    "`sweep`": _swept,
    "parameters": _with_parameters,
    "`export`": _exported(),
    "`load`": _loaded,
    "`export`, parameters": lambda contact, folder: export(build(touching(contact, "parameters")), folder / "robot"),
    "`export --derivatives`": _exported(derivatives=True),
    "`export --dynamics`": _exported(dynamics=True),
    "`export --stability`": _exported(stability=True),
    "`export --batches`": _exported(batches=True),
    "`export --cuda`": _exported(cuda=True),
    "`export --fmu`": lambda contact, folder: write_fmu(model(contact, moving=True), folder / "robot.fmu", "robot"),
    "`export --mjcf`": lambda contact, _: mjcf_of(touching(contact)).left_out,
    "`export --page`": lambda contact, folder: export_page(rest(contact), folder / "page.html"),
    "`view`": lambda contact, _: opened(rest(contact)),
    "`embedded`": lambda contact, _: embedded(model(contact), rest(contact)),
    "`relaxed_contact`, `embedded`": lambda contact, _: embedded(relaxed_contact(model(contact), 2), rest(contact)),
    "`relaxed_contact`, `acados_expressions`": lambda contact, _: acados_expressions(
        relaxed_contact(model(contact), 2), "robot"
    ),
    "`compiled_stage`": lambda contact, _: compiled_stage(model(contact), "verb", curvature=False),
    "`motion_stage`": lambda contact, _: motion_stage(model(contact, moving=True), 1e-2).equations.function,
    "`compiled_motion_stage`": _compiled_stage_in_motion,
    "`acados_expressions`": lambda contact, _: acados_expressions(model(contact), "robot"),
}
"""The cheapest use of each row of the table; what it returns has the sentences that the user is told."""

QUICK = ("`solve`", "stability", "`export --mjcf`", "`embedded`", "`relaxed_contact`, `embedded`")
"""Rows that are tried with the quick tests where they work."""


def table() -> tuple[list[str], dict[str, list[str]]]:
    """Headings of the columns of the table, and its rows by verb."""
    page = (ROOT / "docs" / "contact.md").read_text(encoding="utf-8")
    text = page.split("<!-- verbs in contact -->")[1].split("<!-- end of verbs in contact -->")[0]
    lines = [[cell.strip() for cell in line.strip("|").split("|")] for line in text.strip().splitlines()]
    return lines[0][1:], {line[0]: line[1:] for line in lines[2:]}


def cells() -> Iterator[Any]:
    """Verb, contact and what the table says of them."""
    contacts, rows = table()
    for verb, row in rows.items():
        for contact, said in zip(contacts, row, strict=True):
            quick = verb in QUICK or said.startswith("no: ")
            name = f"{verb} {contact}".replace("`", "")
            yield pytest.param(verb, contact, said, marks=() if quick else pytest.mark.slow, id=name)


def test_the_table_names_all_verbs_and_contacts() -> None:
    contacts, rows = table()
    assert contacts == list(CONTACTS)
    assert list(rows) == list(VERBS)


@pytest.mark.parametrize(("verb", "contact", "said"), list(cells()))
def test_the_table_is_true(verb: str, contact: str, said: str, tmp_path: Path) -> None:
    answer, _, sentence = said.partition(": ")
    if answer == "no":
        with pytest.raises(CosseratError) as refused:
            VERBS[verb](contact, tmp_path)
        assert sentence and sentence in str(refused.value)
        assert not list(tmp_path.iterdir())
        return
    if verb == "`export --page`":
        wasm_compiler()
    told = VERBS[verb](contact, tmp_path)
    assert answer == ("yes, but" if sentence else "yes")
    assert sentence in str(told)
