"""The page: one self-contained HTML file."""

from __future__ import annotations

import base64
import gzip
import html
import json
from collections.abc import Sequence
from importlib import resources
from pathlib import Path
from typing import Any

from cosserat_casadi.accuracy.ranges import Given
from cosserat_casadi.codegen.contact.checks import check_contact
from cosserat_casadi.compiling.texts import fill
from cosserat_casadi.equilibrium.contact.contact_equations import Grids
from cosserat_casadi.equilibrium.contact.contact_state import without_contacts
from cosserat_casadi.equilibrium.solution import Solution
from cosserat_casadi.errors import ExportError, Problem
from cosserat_casadi.files import write_atomically
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model, build
from cosserat_casadi.page.drawn_contact import ALONG_LINE, contact_page_files, ends_of_sliders
from cosserat_casadi.page.drawn_model import DrawnModel
from cosserat_casadi.page.page_facts import page_facts
from cosserat_casadi.page.slider_ranges import sliders
from cosserat_casadi.page.webassembly import find_wasm_compiler, linked, wasm_of

LARGEST = 3_000_000
"""Largest size of a page, bytes: within the limits of e-mail attachments."""

SCRIPTS = ("symmetric_eigenvalues.js", "shapes.js", "frame_pacing.js", "scenery.js", "panel.js", "tip_dragging.js")
"""Scripts of every page, in load order; the script of the solver follows."""

IN_CONTACT = {"beginning": "the equilibrium at the scene's own inputs", "along_line": ALONG_LINE}
"""Further facts for a page with exact contact: start of its solver, number of drawn points of a contact line."""


def export_page(
    solution: Solution, file: Path, asked: Given | None = None, load_cases: FloatArray | None = None
) -> Path:
    """Write the scene of an equilibrium as one HTML file, which solves it for the values of the sliders.

    Args:
        solution: the equilibrium at the inputs of the scene; the page has its discretisation. A model from
            :func:`cosserat_casadi.choose` is accurate over the whole ranges of the sliders.
        file: path of the HTML file.
        asked: ranges of the sliders; by default those of the choice of modes.
        load_cases: stacked inputs, one case per row, shape (k, m). A page with exact contact has the arrangements of
            contacts on the way to each case; the default cases are both ends of every slider.

    Raises:
        ExportError: there is no compiler for WebAssembly, the page would be too large, or the export to C does not
            support the scene with exact contact.
        WriteError: the file cannot be written.
    """
    model = page_model(solution)
    check_contact(model.scene, {})
    compiler = find_wasm_compiler()
    if model.scene.touches_exactly:
        cases = ends_of_sliders(model, sliders(model, asked)) if load_cases is None else load_cases
        module = linked(contact_page_files(model, cases), compiler)
    else:
        module = wasm_of(DrawnModel(model.discrete), compiler)
    facts = facts_of_page(solution, model, asked)
    content = page_text(facts, [asset("wasm_robot.js")], module).encode()
    if len(content) > LARGEST:
        problem = f"the page would have {len(content) / 1e6:.1f} MB, more than {LARGEST / 1e6:g} MB"
        raise ExportError(Problem("--page", problem, "a larger tolerance makes it smaller"))
    write_atomically(file, content)
    return file


def page_model(solution: Solution) -> Model:
    """The model for the inputs of a page, without contacts: their forces are not inputs."""
    model = solution.model
    if not model.scene.touches_exactly:
        return model
    scene = without_contacts(model.scene)
    return build(scene, Grids(model.discretisation).discretisation(scene))


def facts_of_page(solution: Solution, model: Model, asked: Given | None = None) -> dict[str, Any]:
    """Facts of a scene for a page with a solver.

    Args:
        solution: the equilibrium at the inputs of the scene.
        model: result of :func:`page_model`.
        asked: ranges of the sliders.
    """
    facts = {**page_facts(solution, model, asked), **asked_accuracy(solution)}
    if model.scene.touches_exactly:
        # Other rods are counted behind the obstacles.
        rods = model.scene.rods if model.scene.rods_touch_exactly else ()
        touched = [*model.scene.obstacles, *rods]
        facts |= {"obstacle_names": [record.name for record in touched], **IN_CONTACT}
    return facts


def asked_accuracy(solution: Solution) -> dict[str, Any]:
    """The tolerance of errors, None if none applies, and the remedy for larger errors."""
    accuracy = solution.model.scene.accuracy
    return {"tolerance": accuracy.tolerance if accuracy.binds else None, "remedy": solution.remedy}


def page_text(facts: dict[str, Any], engine: Sequence[str], module: bytes = b"") -> str:
    """The page of a scene.

    Args:
        facts: facts of the scene.
        engine: texts of the scripts that define ``openRobot``, and of dependent scripts.
        module: the solver as WebAssembly; empty for a page with a server.
    """
    texts = [*map(asset, SCRIPTS), *engine, asset("start.js")]
    scripts = "\n".join(f"<script>\n{text}</script>" for text in texts)
    # Without the time stamp of the archive, the same scene gives the same page.
    packed = base64.b64encode(gzip.compress(module, 9, mtime=0)).decode() if module else ""
    words = {
        "title": html.escape(str(facts["title"])),
        "style": asset("page.css"),
        "three": asset("three.min.js"),
        "scripts": scripts,
        "where": "here in your browser" if module else "by the program that opened this page",
        # No text of the scene can close its HTML element.
        "facts": json.dumps(facts, ensure_ascii=False).replace("<", "\\u003c"),
        "module": packed,
    }
    return fill(asset("page.html.in"), words)


def asset(name: str) -> str:
    """A file of this package's folder ``assets``."""
    return (resources.files("cosserat_casadi.page") / "assets" / name).read_text(encoding="utf-8")
