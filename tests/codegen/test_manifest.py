"""The manifest of an exported folder against the model, and the header against the manifest."""

from __future__ import annotations

import json
import re
from importlib.metadata import version
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Discretisation, Model, build, discretise
from cosserat_casadi.codegen.export import folder_files
from cosserat_casadi.codegen.manifest import MANIFEST
from cosserat_casadi.model.unknowns import BlockKind
from cosserat_casadi.rod.properties import STRAINS
from tests.families import mostly_slow
from tests.scenes import HOOK, WEIGHT, WIND, push, rod, scene

PIN = {"rod": "rod", "kind": "pinned", "position": [0.3, 0.0, 0.5]}
TWO = [rod("planar", name="one"), rod(["bending_x", "torsion", "extension"], name="two")]

MODELS: dict[str, Model] = {
    name: build(wanted, discretise(wanted, modes, 3))
    for name, wanted, modes in [
        ("planar", scene(push(), strain="planar", title="A strip"), 3),
        ("legendre", scene(WIND, push(frame="body", moment=[0.1, 0, 0.2]), WEIGHT, strain="planar"), 2),
        ("cut and held", scene(HOOK, supports=[PIN]), (2, 3, 1)),
        ("nothing free", scene(push(), strain="planar", inputs=[]), 2),
        ("some free", scene(push(), WIND, strain="planar", inputs=["wind.force"], accuracy={"tolerance": 3e-5}), 2),
        (
            "two rods",
            scene({**push(), "rod": "two"}, WEIGHT, rods=TWO, supports=[{**PIN, "rod": "two", "kind": "pinned"}]),
            1,
        ),
    ]
}


@pytest.fixture(scope="module", params=mostly_slow(MODELS, quick=["legendre", "cut and held", "some free", "two rods"]))
def exported(request: pytest.FixtureRequest) -> tuple[Model, dict[str, str], dict[str, Any]]:
    model = MODELS[request.param]
    files = folder_files(model, "lib", 1.234e-7)
    return model, files, json.loads(files[MANIFEST])


Exported = tuple[Model, dict[str, str], dict[str, Any]]


def test_general_facts(exported: Exported) -> None:
    model, files, manifest = exported
    assert manifest["schema"] == 1
    assert manifest["name"] == "lib"
    assert manifest["title"] == model.scene.title
    assert manifest["versions"] == {
        "cosserat_casadi": version("cosserat-casadi"),
        "casadi": ca.CasadiMeta.version(),
    }
    assert manifest["tolerance"] == model.scene.accuracy.tolerance
    assert manifest["error_estimate"] == 1.2e-7
    assert manifest["files"] == sorted(files)


def test_inputs(exported: Exported) -> None:
    model, _, manifest = exported
    entries = manifest["inputs"]
    assert tuple(entry["name"] for entry in entries) == model.inputs.names
    first = 0
    for entry in entries:
        load, field = entry["name"].split(".")
        given = next(one for one in model.scene.loads if one.name == load)
        units = {
            "gravity": {"acceleration": "m/s²"},
            "tip_wrench": {"force": "N", "moment": "N m"},
            "point_wrench": {"force": "N", "moment": "N m"},
            "distributed_wrench": {"force": "N/m", "moment": "N m/m"},
        }
        assert entry["unit"] == units[given.kind][field]
        assert entry["axes"] == ("section" if getattr(given, "frame", None) == "body" else "world")
        assert entry["first"] == first
        assert len(entry["value"]) == int(np.prod(entry["shape"]))
        first += len(entry["value"])
    assert first == model.inputs.size
    stacked = np.concatenate([np.zeros(0), *[entry["value"] for entry in entries]])
    assert_allclose(stacked, model.pack(), rtol=0, atol=0)


def test_legendre_coefficients_stand_degree_after_degree() -> None:
    model = MODELS["legendre"]
    entries = {e["name"]: e for e in json.loads(folder_files(model, "lib")[MANIFEST])["inputs"]}
    assert entries["wind.force"]["shape"] == [3, 2]
    assert entries["wind.force"]["value"] == [0.4, 0.2, 0.0, 0.3, 0.0, 0.0]
    assert entries["push.moment"]["axes"] == "section"
    assert entries["weight.acceleration"]["axes"] == "world"


def test_unknowns(exported: Exported) -> None:
    """Entries cover the vector without a gap, and an entry of a strain moves that strain alone."""
    model, _, manifest = exported
    found = np.concatenate([np.arange(e["first"], e["first"] + e["count"]) for e in manifest["unknowns"]])
    assert sorted(found.tolist()) == list(range(model.size))
    strains = [entry for entry in manifest["unknowns"] if "strain" in entry]
    assert [e["rod"] for e in strains] == [r.name for r in model.scene.rods for _ in r.admitted]
    for entry in strains:
        basis, place = model.discrete.rods[entry["rod"]], model.discrete.unknowns.strain(entry["rod"])
        assert STRAINS.index(entry["strain"]) in basis.columns
        x = np.zeros(model.size)
        x[entry["first"] : entry["first"] + entry["count"]] = 1.0
        assert np.all(x[: place.start] == 0)
        assert np.all(x[place.stop :] == 0)
        columns = basis.columns[STRAINS.index(entry["strain"])]
        assert np.all(x[place][columns] == 1.0)
        assert np.count_nonzero(x) == len(x[place][columns])
    supports = [entry for entry in manifest["unknowns"] if "strain" not in entry]
    assert [(e["rod"], e["support"]) for e in supports] == [(s.rod, s.kind) for s in model.scene.supports]
    assert sum(e["count"] for e in supports) == model.size - model.discrete.unknowns.count(BlockKind.STRAIN)


def test_discretisation_builds_the_same_model(exported: Exported) -> None:
    model, files, manifest = exported
    again = {
        name: Discretisation(**{**kept, "modes": tuple(kept["modes"]), "breaks": tuple(kept["breaks"])})
        for name, kept in manifest["discretisation"].items()
    }
    assert again == model.discretisation
    assert folder_files(build(model.scene, again), "lib", manifest["error_estimate"]) == files


def test_functions(exported: Exported) -> None:
    model, files, manifest = exported
    entries = {entry["name"]: entry for entry in manifest["functions"]}
    rods = list(model.discrete.rods)
    for word, own in {"residual": model.path_residual, "jacobian": model.path_jacobian}.items():
        assert_shapes(entries[f"lib_k_{word}"], own, own.n_out())
    for name in rods:
        suffix = f"_{name}" if len(rods) > 1 else ""
        assert_shapes(entries[f"lib_k_igm{suffix}"], model.igm[name], 3)
        assert_shapes(entries[f"lib_k_tip{suffix}"], model.tip[name], 2)
        assert_shapes(entries[f"lib_k_tip_jacobian{suffix}"], model.tip_jacobian[name], 2)
        assert_shapes(entries[f"lib_k_shape{suffix}"], model.shape[name], 2)
    for name, entry in entries.items():
        assert re.search(rf"\b{name}\(", files["lib_kernels.h"]), name
        assert entry["instructions"] > 0


def assert_shapes(entry: dict[str, Any], own: ca.Function, results: int) -> None:
    arguments = [(own.name_in(i), list(own.size_in(i))) for i in range(own.n_in())]
    assert [(a["name"], a["shape"]) for a in entry["arguments"]] == arguments
    outputs = [(own.name_out(i), list(own.size_out(i))) for i in range(results)]
    assert [(r["name"], r["shape"]) for r in entry["results"]] == outputs


def test_units_of_arguments_and_results(exported: Exported) -> None:
    _, _, manifest = exported
    units = {
        value["name"]: value["unit"]
        for entry in manifest["functions"]
        for value in (*entry["arguments"], *entry["results"])
    }
    assert units["x"] == units["residual"] == units["quaternion"] == units["load_factor"] == "1"
    assert units["position"] == units["base_position"] == "m"
    assert units["base_force"] == "N"
    assert units["base_moment"] == "N m"
    assert units["inputs"] == "inputs"


def test_header_agrees_with_the_manifest(exported: Exported) -> None:
    model, files, manifest = exported
    macros = dict(re.findall(r"^#define LIB_(\w+) (\d+)", files["lib.h"], re.M))
    macros = {key: number for key, number in macros.items() if not key.startswith(("VERSION", "POSE", "TOLERANCE"))}
    sizes = {key: int(macros.pop(key)) for key in ("UNKNOWNS", "INPUTS", "RODS", "BODIES")}
    assert sizes == {
        "BODIES": len(model.scene.bodies),
        "UNKNOWNS": sum(entry["count"] for entry in manifest["unknowns"]),
        "INPUTS": sum(len(entry["value"]) for entry in manifest["inputs"]),
        "RODS": len(manifest["discretisation"]),
    }
    places = {f"INPUT_{e['name'].replace('.', '_').upper()}": str(e["first"]) for e in manifest["inputs"]}
    counts = {f"INPUT_{e['name'].replace('.', '_').upper()}_SIZE": str(len(e["value"])) for e in manifest["inputs"]}
    assert macros == places | counts
    for entry in manifest["inputs"]:
        comment = f"/* {len(entry['value'])} numbers, {entry['unit']}, {entry['axes']} axes */"
        assert f"{entry['first']} {comment}" in files["lib.h"]
    for entry in manifest["unknowns"]:
        span = f"   {entry['first']} .. {entry['first'] + entry['count'] - 1}: "
        line = next(line for line in files["lib.h"].splitlines() if line.startswith(span))
        assert f"rod {entry['rod']}" in line
        assert entry.get("strain", entry.get("support")) in line
    for name in model.discrete.rods:
        suffix = f"_{name}" if len(model.discrete.rods) > 1 else ""
        for word in ("igm", "tip", "tip_jacobian", "shape"):
            assert f"void lib_{word}{suffix}(" in files["lib.h"]


def test_readme_and_demo_agree_with_the_manifest(exported: Exported) -> None:
    model, files, manifest = exported
    for entry in manifest["inputs"]:
        assert (
            f"| {entry['first']} … {entry['first'] + len(entry['value']) - 1} | `{entry['name']}`" in files["README.md"]
        )
    for name in files:
        assert f"`{name}`" in files["README.md"] or name == "README.md"
    assert "DEFAULTS[ROOM] = LIB_DEFAULTS;" in files["lib_demo.c"]
    given = re.search(r"LIB_DEFAULTS \{(.*)\}", files["lib.h"])
    assert given is not None
    numbers = [float(word) for word in given[1].replace("(lib_real)", "").split(",")]
    assert_allclose(numbers, model.pack() if model.inputs.size else [0.0], rtol=0, atol=0)


@pytest.mark.parametrize(("estimate", "written"), [(None, None), (0.0, 0.0), (3.14159e-9, 3.1e-9)])
def test_error_estimate(estimate: float | None, written: float | None) -> None:
    wanted = scene(push(), strain="planar")
    files = folder_files(build(wanted, discretise(wanted, 1, 2)), "lib", estimate)
    assert json.loads(files[MANIFEST])["error_estimate"] == written
    said = "was not estimated" if estimate is None else f"estimated error {estimate:.1e}"
    assert said in files["README.md"]


def test_odd_titles_survive(tmp_path: Path) -> None:
    title = 'quotes " and \\ and \x07 and 𝛼\nand a second line'
    wanted = scene(push(), title=title, strain="planar")
    text = folder_files(build(wanted, discretise(wanted, 1, 2)), "lib")[MANIFEST]
    (tmp_path / MANIFEST).write_text(text, encoding="utf-8")
    assert json.loads((tmp_path / MANIFEST).read_text(encoding="utf-8"))["title"] == title
