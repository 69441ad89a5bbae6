"""The solver of a page with exact contact: a library of contact arrangements, with a drawing function for each."""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca
import numpy as np

from cosserat_casadi.codegen.contact.arrangements import Chosen, chosen_arrangements
from cosserat_casadi.codegen.contact.checks import check_contact
from cosserat_casadi.codegen.contact.kernels import ArrangementKernels
from cosserat_casadi.codegen.contact.sources import SOLVE_ITERATIONS, SOLVE_PARTS, contact_files
from cosserat_casadi.codegen.kernel_files import kernel_sources
from cosserat_casadi.codegen.memory import largest_room
from cosserat_casadi.codegen.names import Names, scene_names
from cosserat_casadi.compiling.texts import render
from cosserat_casadi.equilibrium.contact.contact_state import Touch
from cosserat_casadi.maths.numbers import as_vector
from cosserat_casadi.maths.typing import FloatArray, Matrix
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.floating_frames import FrameName
from cosserat_casadi.page.drawn_model import drawn_column, drawn_parts, sections_of
from cosserat_casadi.page.slider_ranges import Slider
from cosserat_casadi.page.webassembly import NAME

ALONG_LINE = 25
"""Number of drawn points of an interval of contact."""


def contact_page_files(model: Model, cases: FloatArray) -> dict[str, str]:
    """Source texts, by file name: library of a scene with exact contact, drawing functions, and functions for the page.

    Args:
        model: model of the scene without contacts.
        cases: stacked inputs, one case per row, shape (k, m); further columns are ignored. The library has the
            arrangements on the way to each case with an equilibrium, case by case.

    Raises:
        ExportError: the export to C does not support the scene or its contacts.
    """
    check_contact(model.scene, {})
    stability = model.has_potential(np.ones(model.inputs.size))
    inputs = cases[:, : model.inputs.size]
    chosen = chosen_arrangements(model, inputs, estimate_errors=True, leave_out=True, stability=stability)
    names = scene_names(NAME, model.scene)
    functions = drawn_kernels(chosen, model, names)
    generated = kernel_sources(functions, names, f"{NAME}_drawn")
    words = {
        "name": names.name,
        "MACRO": names.macro,
        "drawn": max(function.size1_out(0) for function in functions),
        "drawn_kernels": ", ".join(function.name() for function in functions),
        "iterations": SOLVE_ITERATIONS,
        "parts": SOLVE_PARTS,
        "stability": stability,
        "arguments": largest_room(generated, "ARG") + 2,
        "results": largest_room(generated, "RES") + 1,
        "integers": largest_room(generated, "IW") + 1,
        "reals": largest_room(generated, "W") + 1,
    }
    return {
        **contact_files(model, chosen, names, None),
        **generated,
        "page.c": render("page_in_contact.c.in", words),
    }


def ends_of_sliders(model: Model, moved: Sequence[Slider]) -> FloatArray:
    """Stacked inputs, shape (2 k, m): one slider at an end, all other inputs at the values of the scene."""
    cases = np.tile(model.pack(), (2 * len(moved), 1))
    for row, slider in enumerate(moved):
        cases[2 * row, slider.index] = slider.least
        cases[2 * row + 1, slider.index] = slider.most
    return cases


def drawn_kernels(chosen: Chosen, free: Model, names: Names) -> list[ca.Function]:
    """Functions of each arrangement, (z, inputs) ↦ numbers of the picture, followed by the points of each contact.

    Args:
        chosen: arrangements.
        free: model of the scene without contacts, which defines the layout of the picture.
        names: names of the library.
    """
    functions = []
    for number, equations in enumerate(chosen.equations):
        own = ArrangementKernels(equations, names.kernel(str(number)))
        written = equations.written
        scene = drawn_column(drawn_parts(written.system, free.discrete, written.given))
        points = [ca.vec(_touching_points(own, touch)) for touch in written.state.touches]
        functions.append(own.written_kernel("drawn", [ca.vertcat(scene, *points)]))
    return functions


def _touching_points(own: ArrangementKernels, touch: Touch) -> Matrix:
    """Centres of touching sections, or the contact point of the ball of a body, as expressions, 3×k, m."""
    system = own.equations.written.system
    if touch.of_body:
        (body,) = [body for body in system.discrete.scene.bodies if body.name == touch.owner]
        frame = system.frame(FrameName("body", body.name))
        return ca.densify(frame.position - body.ball_radius * own.normal_of_body(touch))
    shares = np.linspace(0.0, 1.0, ALONG_LINE if touch.is_line else 1)
    X = as_vector([touch.start + (touch.end - touch.start) * share for share in shares.tolist()])
    position, _ = sections_of(system, touch.owner, X)
    return position
