"""What an exported folder holds, as data: functions, shapes, units, discretisation, sizes."""

from __future__ import annotations

from dataclasses import asdict
from importlib.metadata import version
from typing import Any

import casadi as ca

from cosserat_casadi.codegen.names import Names
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.inputs import ROD_UNITS
from cosserat_casadi.model.registry import EFFECTS
from cosserat_casadi.rod.properties import STRAINS

MANIFEST = "manifest.json"

UNITS = {
    "position": "m",
    "base_position": "m",
    "base_force": "N",
    "base_moment": "N m",
    "generalised_force": "EI/L",
    "tension": "N",
    "length": "m",
    "pressure": "Pa",
    "volume": "m³",
}
"""Units of arguments and results that have one; the rest, stacked inputs apart, are without."""


def manifest(model: Model, names: Names, functions: list[ca.Function], error_estimate: float | None) -> dict[str, Any]:
    """The manifest as plain data.

    Args:
        model: what is exported.
        names: what things are called.
        functions: the generated kernels.
        error_estimate: of the tip's pose at the scene's inputs, relative to the length; None where it is not known.
    """
    return {
        "schema": 1,
        "name": names.name,
        "title": model.scene.title,
        "versions": {"cosserat_casadi": version("cosserat-casadi"), "casadi": ca.CasadiMeta.version()},
        "inputs": input_entries(model),
        **_output_entries(model),
        "unknowns": unknown_entries(model),
        "discretisation": {name: asdict(chosen) for name, chosen in model.discretisation.items()},
        "tolerance": model.scene.accuracy.tolerance,
        "error_estimate": None if error_estimate is None else float(f"{error_estimate:.2g}"),
        "functions": [_function_entry(function) for function in functions],
    }


def input_entries(model: Model) -> list[dict[str, Any]]:
    """Inputs in the order of their vector."""
    kinds = {cause.name: cause for cause in model.scene.causes}
    entries = []
    for name, place, default in zip(
        model.inputs.names, model.inputs.slices.values(), model.inputs.defaults, strict=True
    ):
        load, field = name.split(".", 1)
        cause = kinds.get(load)
        entries.append(
            {
                "name": name,
                "unit": ROD_UNITS[field] if cause is None else EFFECTS[cause.kind].magnitudes[field],
                "axes": _axes(cause, default),
                "first": place.start,
                "shape": list(default.shape),
                "value": default.ravel(order="F").tolist(),
            }
        )
    return entries


def _axes(cause: Any, default: FloatArray) -> str:
    if default.shape[0] == 1:
        return "none"
    return "section" if getattr(cause, "frame", "world") == "body" else "world"


def actuator_entries(model: Model) -> list[dict[str, Any]]:
    """Actuators in the order of the scene, with what they exert and what they work on."""
    entries = []
    for actuator in model.scene.actuators:
        effort, conjugate = (model.actuator[actuator.name].name_out(i) for i in range(2))
        described = {"name": actuator.name, "kind": actuator.kind, "rod": actuator.rod}
        entries.append({**described, "effort": effort, "extent": conjugate})
    return entries


def _output_entries(model: Model) -> dict[str, Any]:
    """Actuators, bodies and the order of the sensitivities, of scenes that have such."""
    described: dict[str, Any] = {}
    if model.scene.actuators:
        described["actuators"] = actuator_entries(model)
    if model.scene.bodies:
        described["bodies"] = [body.name for body in model.scene.bodies]
        rods = [{"rod": rod} for rod in model.discrete.rods]
        described["sensitivities"] = [*rods, *({"body": body} for body in described["bodies"])]
    return described


def unknown_entries(model: Model) -> list[dict[str, Any]]:
    """Unknowns in the order of their vector: strain coordinates, multipliers, moving frames, unknown tensions."""
    entries: list[dict[str, Any]] = []
    for rod, discrete_rod in model.discrete.rods.items():
        first = model.discrete.rod_slices[rod].start
        for component, columns in discrete_rod.columns.items():
            count = discrete_rod.at_nodes[component].shape[1]
            start = columns.start if isinstance(columns, slice) else columns[0]
            entries.append({"rod": rod, "strain": STRAINS[component], "first": int(first + start), "count": int(count)})
    first = model.discrete.strain_size
    for support, hold in model.discrete.holds:
        entries.append({"rod": support.rod, "support": support.kind, "first": first, "count": hold.size})
        first += hold.size
    for tie in model.discrete.couplings.ties:
        place = model.discrete.tie_slices[tie.where]
        entries.append({"rod": tie.rod, "tie": tie.where, "first": place.start, "count": tie.joint.size})
    for carrier, place in model.discrete.moving_slices.items():
        holders = [joint.rod for joint in model.scene.joints if carrier == ("body", joint.body)]
        rod, frame = (holders or [carrier.name])[0], f"{carrier.kind} {carrier.name}"
        entries.append({"rod": rod, "frame": frame, "first": place.start, "count": place.stop - place.start})
    for tendon, _ in model.discrete.cables:
        unit = model.discrete.tension_unit(tendon.rod)
        first = model.discrete.tension_place(tendon.name)
        entries.append({"rod": tendon.rod, "tendon": tendon.name, "first": first, "count": 1, "unit_N": unit})
    return entries


def _function_entry(function: ca.Function) -> dict[str, Any]:
    return {
        "name": function.name(),
        "arguments": [_scalar_entry(function.name_in(i), function.size_in(i)) for i in range(function.n_in())],
        "results": [_scalar_entry(function.name_out(i), function.size_out(i)) for i in range(function.n_out())],
        "instructions": function.n_instructions(),
    }


def _scalar_entry(name: str, shape: tuple[int, int]) -> dict[str, Any]:
    return {"name": name, "shape": list(shape), "unit": UNITS.get(name, "inputs" if name == "inputs" else "1")}
