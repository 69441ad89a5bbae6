"""What a page of a scene in exact contact computes and draws is what `solve` finds, and contacts come and go."""

from __future__ import annotations

import ctypes
import json
from collections.abc import Callable
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Model, Scene, Solution, build, scene_from_dict, solve
from cosserat_casadi.compiling.compiler import compiled_texts, find_compiler
from cosserat_casadi.compiling.texts import files_in_c
from cosserat_casadi.equilibrium.contact.gaps import touching_points
from cosserat_casadi.errors import ExportError
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.page.drawn_contact import ALONG_LINE, contact_page_files, ends_of_sliders
from cosserat_casadi.page.drawn_model import drawn_numbers
from cosserat_casadi.page.page import export_page, facts_of_page, page_model
from cosserat_casadi.page.slider_ranges import sliders
from cosserat_casadi.page.webassembly import linked
from tests.families import mostly_slow
from tests.page.pages_made import run_node, wasm_compiler

ROD = {
    "name": "rod",
    "length": 1.0,
    "strain": "planar",
    "base": {"tangent": [1, 0, 0]},
    "stiffness": {"bending_y": 0.5},
}
PUSH = {"name": "push", "kind": "tip_wrench", "rod": "rod", "force": [0.0, 0.0, -1.2]}


def over_bar() -> Scene:
    """A rod that is pushed over a bar: a point of contact that slides along it."""
    bar = {"name": "bar", "kind": "capsule", "from": [0.4, -0.5, -0.12], "to": [0.4, 0.5, -0.12], "radius": 0.04}
    return _scene(loads=[PUSH], inputs=["push.force"], obstacles=[bar])


def on_table() -> Scene:
    """A heavy rod that lies down on a table: a line of contact."""
    weight = {"name": "weight", "kind": "gravity", "acceleration": [0.0, 0.0, -9.0]}
    table = {"name": "table", "kind": "plane", "point": [0, 0, -0.03], "normal": [0, 0, 1]}
    rod = {**ROD, "linear_density": 0.5, "stiffness": {"bending_y": 0.02}}
    return _scene(rods=[rod], loads=[weight], inputs=["weight.acceleration"], obstacles=[table])


def ball_on_table() -> Scene:
    """A rod with a ball at its tip that is pushed on a table."""
    table = {"name": "table", "kind": "plane", "point": [0, 0, -0.1], "normal": [0.1, 0, 1], "bodies": ["ball"]}
    ball = {"name": "ball", "mass": 0.01, "radius": 0.05}
    joint = {"body": "ball", "rod": "rod", "kind": "fixed"}
    return _scene(loads=[PUSH], inputs=["push.force"], obstacles=[table], bodies=[ball], joints=[joint])


def _scene(**tables: object) -> Scene:
    return scene_from_dict({"schema": 1, "accuracy": {"modes": 2, "nodes": 4}, "rods": [ROD], **tables})


CASES: dict[Callable[[], Scene], list[FloatArray]] = {
    over_bar: [np.array([0.0, 0.0, push]) for push in (-1.2, -1.4, -0.1, -0.9)],
    on_table: [np.array([0.0, 0.0, weight]) for weight in (-9.0, -7.0, -0.05, 0.5)],
    ball_on_table: [np.array([0.0, 0.0, push]) for push in (-1.2, -0.9, 0.2)],
}
"""Inputs that sliders are moved to one after the other; in some the contact is open."""

ALL = pytest.mark.parametrize("made", mostly_slow([over_bar, on_table, ball_on_table], quick=[ball_on_table]))


@cache
def scene_of(made: Callable[[], Scene]) -> tuple[Solution, Model, dict[str, str]]:
    """The equilibrium at the scene's own inputs, the model of its page, and the texts in C."""
    solution = solve(build(made()))
    model = page_model(solution)
    ends = ends_of_sliders(model, sliders(model))
    # The sliders of a weight go little about it.
    return solution, model, contact_page_files(model, np.array(CASES[made]) if made is on_table else ends)


class Page:
    """The C of a page as a library of this machine."""

    def __init__(self, texts: dict[str, str], model: Model, drawn: int) -> None:
        sources = {file: text for file, text in texts.items() if file.endswith((".c", ".h")) and "_demo" not in file}
        self.library = ctypes.CDLL(str(compiled_texts("page", sources, find_compiler(None), set(files_in_c()))))
        self.model, self.drawn_count = model, drawn
        self.known = False
        for word in ("inputs", "drawn", "d_poses", "contact"):
            getattr(self.library, f"page_{word}").restype = ctypes.POINTER(ctypes.c_double)
        for word in ("error_estimate", "smallest_eigenvalue"):
            getattr(self.library, f"page_{word}").restype = ctypes.c_double

    def array(self, word: str, count: int, *arguments: int) -> FloatArray:
        found = getattr(self.library, f"page_{word}")(*arguments)
        return np.array(found[:count])

    def move(self, inputs: FloatArray) -> None:
        for i, value in enumerate(inputs):
            self.library.page_inputs()[i] = value
        status = self.library.page_track() if self.known else self.library.page_solve()
        assert status == 0
        self.known = True
        self.library.page_draw()


@ALL
def test_what_is_drawn_and_told_is_what_solve_finds(made: Callable[[], Scene]) -> None:
    solution, model, texts = scene_of(made)
    count = len(drawn_numbers(model, solution))
    page = Page(texts, model, count)
    before = solution
    touching = []
    for inputs in CASES[made]:
        wanted = solve(model, inputs, start=before)
        assert wanted.converged, wanted.message
        page.move(inputs)
        points = [touching_points(wanted, contact, ALONG_LINE) for contact in wanted.contacts]
        numbers = page.array("drawn", count + sum(own.size for own in points))
        assert_allclose(numbers[:count], drawn_numbers(model, wanted), rtol=0, atol=1e-8)
        assert_allclose(numbers[count:], np.concatenate([*map(np.ravel, points), []]), rtol=0, atol=1e-8)
        assert page.library.page_contacts() == len(wanted.contacts)
        for number, contact in enumerate(wanted.contacts):
            described = page.array("contact", 8, number)
            is_line = contact.kind == "line"
            assert_allclose(described[2:5], [is_line, contact.start, contact.end], rtol=0, atol=1e-8)
            assert_allclose(described[5:], contact.force, rtol=0, atol=1e-7)
        assert_allclose(page.library.page_smallest_eigenvalue(), wanted.smallest_eigenvalue, rtol=1e-5)
        assert page.library.page_error_estimate() >= 0
        touching.append(bool(wanted.contacts))
        before = wanted
    # A slider takes the rod off its obstacle.
    assert touching[0] and not all(touching)


def test_the_last_equilibrium_stays_where_there_is_none() -> None:
    solution, model, texts = scene_of(ball_on_table)
    count = len(drawn_numbers(model, solution))
    page = Page(texts, model, count)
    assert not page.library.page_stays()
    page.move(np.array([0.0, 0.0, -0.9]))
    before = page.array("drawn", count + 3)
    assert page.library.page_contacts() == 1
    page.library.page_inputs()[2] = float("nan")
    for word in ("track", "solve"):
        assert getattr(page.library, f"page_{word}")() != 0
    page.library.page_draw()
    assert page.library.page_stays()
    assert page.library.page_contacts() == 1
    assert_allclose(page.array("drawn", count + 3), before, rtol=0, atol=0)
    page.library.page_inputs()[2] = 0.2
    assert page.library.page_solve() == 0
    assert not page.library.page_stays()


@pytest.mark.slow
@ALL
def test_the_module_finds_the_same(made: Callable[[], Scene], tmp_path: Path) -> None:
    compiler = wasm_compiler()
    solution, model, texts = scene_of(made)
    facts = facts_of_page(solution, model)
    (tmp_path / "facts.json").write_text(json.dumps(facts))
    (tmp_path / "inputs.json").write_text(json.dumps([inputs.tolist() for inputs in CASES[made]]))
    (tmp_path / "module.wasm").write_bytes(linked(texts, compiler))
    answer = run_node("solve.js", *(tmp_path / name for name in ("facts.json", "inputs.json", "module.wasm")))
    assert answer["imports"] == []
    before = solution
    for inputs, found in zip(CASES[made], answer["solved"], strict=True):
        assert found["found"] and not found["anew"], found["text"]
        wanted = solve(model, inputs, start=before)
        assert_allclose(found["drawn"], drawn_numbers(model, wanted), rtol=0, atol=1e-8)
        assert_allclose(found["eigenvalues"], [wanted.smallest_eigenvalue], rtol=1e-5)
        assert len(found["contacts"]) == len(wanted.contacts)
        for told, contact in zip(found["contacts"], wanted.contacts, strict=True):
            assert_allclose(told["points"], touching_points(wanted, contact, ALONG_LINE), rtol=0, atol=1e-8)
            assert_allclose(told["force"], contact.force, rtol=0, atol=1e-7)
            assert told["words"].startswith(f"{contact.owner} touches {contact.obstacle}")
        # A little further on the tip is where the derivatives say.
        nearby = inputs + np.array([0.0, 0.0, 1e-6])
        moved = solve(model, nearby, start=wanted)
        poses = [wanted.tip(), *(wanted.body(body.name) for body in model.scene.bodies)]
        poses_moved = [moved.tip(), *(moved.body(body.name) for body in model.scene.bodies)]
        derivatives = np.reshape(found["derivatives"], (len(poses), 3, 7))
        for pose, pose_moved, derivative in zip(poses, poses_moved, derivatives, strict=True):
            expected = (pose_moved.position - pose.position) / 1e-6
            assert_allclose(derivative[2, :3], expected, rtol=1e-3, atol=1e-5)
        before = wanted


def test_a_page_needs_no_compiler_to_refuse_what_c_does_not_know() -> None:
    disk = {"name": "disk", "mass": 0.01, "radius": 0.05, "thickness": 0.01}
    table = {"name": "table", "kind": "plane", "point": [0, 0, -0.3], "normal": [0, 0, 1], "bodies": ["disk"]}
    joint = {"body": "disk", "rod": "rod", "kind": "fixed"}
    refused = _scene(loads=[PUSH], inputs=["push.force"], obstacles=[table], bodies=[disk], joints=[joint])
    with pytest.raises(ExportError, match="nor of a disk"):
        export_page(solve(build(refused)), Path("never.html"))
