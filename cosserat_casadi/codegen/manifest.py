"""Manifest of an exported folder: its functions, shapes, units, discretisation and sizes, as data."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Mapping
from importlib.metadata import version
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np

from cosserat_casadi.accuracy.verified import Verified
from cosserat_casadi.codegen.functions_in_c import FunctionInC, functions_in_c
from cosserat_casadi.codegen.input_values import listed_values
from cosserat_casadi.codegen.names import Names, library_names
from cosserat_casadi.compiling.compiler import EXPORT_ANEW
from cosserat_casadi.compiling.printed_kernels import Kernel, PrintedKernel
from cosserat_casadi.errors import ExportError, Problem, refuse
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.function_table import ARGUMENT_UNITS
from cosserat_casadi.model.input_bounds import ranges_of_inputs
from cosserat_casadi.model.inputs import Input
from cosserat_casadi.model.unknowns import BlockKind
from cosserat_casadi.rod.properties import STRAINS
from cosserat_casadi.scene import NamedNumbers, Scene
from cosserat_casadi.tubes.tube_functions import TubeFunctions

MANIFEST = "manifest.json"

ARRANGEMENTS = "arrangements"
"""Key of the arrangements of contacts, which only a folder of a scene in exact contact has."""

TUBES = "tubes"
"""Key of the names of the tubes, which only a folder of concentric tubes has."""

SCHEMA = 1
"""Version of the manifest that is written, and that can be read."""

EXPORT_FIRST = "write one with cosserat export"
"""Remedy for a missing manifest."""


def read_manifest(folder: Path) -> Any:
    """Read the manifest of a folder, without checks.

    Raises:
        ExportError: the manifest cannot be read, or is not JSON.
    """
    try:
        return json.loads((folder / MANIFEST).read_text(encoding="utf-8"))
    except OSError:
        raise ExportError(Problem(str(folder), f"holds no {MANIFEST} that can be read", EXPORT_FIRST)) from None
    except (ValueError, RecursionError):
        raise ExportError(Problem(str(folder / MANIFEST), "is not JSON", EXPORT_FIRST)) from None


def is_sound(described: Any, is_own: Callable[[Any], bool]) -> bool:
    """Whether a manifest has the name of the library, files, values of inputs, and the entries of its kind.

    Args:
        described: the manifest.
        is_own: check of the entries of its kind; it may raise any error of reading wrong data.
    """
    try:
        library_names(described["name"])
        listed_values(described["inputs"])
        values = [np.asarray(entry["value"], dtype=np.float64) for entry in described["inputs"]]
        files = all(isinstance(file, str) for file in described["files"])
        return files and all(value.ndim == 1 for value in values) and is_own(described)
    except (ExportError, AttributeError, KeyError, OverflowError, TypeError, ValueError):
        return False


def check_folder(folder: Path, described: Mapping[str, Any], sizes: Mapping[str, int]) -> None:
    """Refuse a folder of another version, or whose header and manifest have different sizes, as in mixed exports.

    A library compiled with the sizes of the header would write beyond arrays that have the sizes of the manifest.

    Args:
        folder: the exported folder.
        described: its manifest, sound.
        sizes: sizes in the manifest, by macro without the name of the library.

    Raises:
        ExportError: the schema is another one, or sizes differ; the error lists all of them.
    """
    schema = described.get("schema")
    if schema != SCHEMA:
        problem = f"has the schema {schema!r}, where this version reads {SCHEMA}"
        raise ExportError(Problem(str(folder / MANIFEST), problem, EXPORT_ANEW))
    library = described["name"]
    header = folder / f"{library}.h"
    try:
        text = header.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError):
        # The compiler is not called without it: it is told to be missing then.
        return
    problems = []
    for macro, size in sizes.items():
        name = f"{library.upper()}_{macro}"
        defined = re.search(rf"^#define {name} (\d+)$", text, re.MULTILINE)
        if defined is None:
            problems.append(Problem(str(header), f"does not define {name}", EXPORT_ANEW))
        elif int(defined.group(1)) != size:
            problem = f"says {name} {defined.group(1)}, where {MANIFEST} has {size}"
            problems.append(Problem(str(header), problem, EXPORT_ANEW))
    refuse(problems, ExportError)


def input_count(described: Mapping[str, Any]) -> int:
    """Number of entries of the vector of inputs in a manifest."""
    return sum(len(entry["value"]) for entry in described["inputs"])


def manifest(
    model: Model,
    names: Names,
    kernels: list[Kernel],
    error_estimate: float | None,
    verified: Verified | None = None,
) -> dict[str, Any]:
    """Make the manifest as plain data.

    Args:
        model: the exported model.
        names: names of the library and its parts.
        kernels: the generated kernels.
        error_estimate: error of the tip pose at the scene's inputs, over the length; None if unknown.
        verified: ranges over which the discretisation keeps the tolerance; None if unknown.
    """
    known = {entry.kernel: entry for entry in functions_in_c(model, names)}
    return {
        **head_entries(names, model),
        **_output_entries(model),
        "unknowns": [entry for entry, _ in described_unknowns(model)],
        "discretisation": model.resolution,
        **accuracy_entries(model.scene, error_estimate, verified),
        "functions": [_function_entry(kernel, known) for kernel in kernels],
    }


def head_entries(names: Names, model: Model | TubeFunctions) -> dict[str, Any]:
    """First entries of every manifest: name, title, versions, inputs and parameters."""
    return {
        "schema": SCHEMA,
        "name": names.name,
        "title": model.scene.title,
        "versions": {"cosserat_casadi": version("cosserat-casadi"), "casadi": ca.CasadiMeta.version()},
        "inputs": input_entries(model),
        **({"parameters": parameter_entries(model)} if model.parameters.size else {}),
    }


def with_manifest(files: Mapping[str, str], described: Mapping[str, Any]) -> dict[str, str]:
    """Add the manifest, which lists all files, to the files of a folder."""
    entries = {**described, "files": sorted([*files, MANIFEST])}
    return {**files, MANIFEST: json.dumps(entries, indent=1, ensure_ascii=False) + "\n"}


def accuracy_entries(scene: Scene, error_estimate: float | None, verified: Verified | None) -> dict[str, Any]:
    """Entries for the tolerance of a scene and the error of its discretisation; arguments as for :func:`manifest`."""
    return {
        "tolerance": scene.accuracy.tolerance,
        "tolerance_binds": scene.accuracy.binds,
        "error_estimate": None if error_estimate is None else float(f"{error_estimate:.2g}"),
        **({} if verified is None else {"verified": verified.plain()}),
    }


def input_entries(model: Model | TubeFunctions) -> list[dict[str, Any]]:
    """Entries for the inputs in the order of their vector."""
    lower, upper = ranges_of_inputs(model.scene, model.inputs)
    return [
        _stacked_entry(entry, indices, axes=entry.axes, lower=_ends(lower[indices]), upper=_ends(upper[indices]))
        for entry, indices in model.inputs
    ]


def _ends(values: FloatArray) -> list[float | None]:
    """Bounds of ranges, with None for infinity, which JSON does not have."""
    return [value if np.isfinite(value) else None for value in values.tolist()]


def parameter_entries(model: Model | TubeFunctions) -> list[dict[str, Any]]:
    """Entries for the parameters in the order of their vector."""
    return [_stacked_entry(entry, indices) for entry, indices in model.parameters]


def _stacked_entry(entry: Input | NamedNumbers, indices: slice, **further: Any) -> dict[str, Any]:
    """Entry of an input or a parameter: its indices in the vector, and its value in the scene."""
    return {
        "name": entry.name,
        "unit": entry.unit,
        **further,
        "first": indices.start,
        "shape": list(entry.shape),
        "value": entry.default.ravel(order="F").tolist(),
    }


def actuator_entries(model: Model) -> list[dict[str, Any]]:
    """Entries for the actuators in the order of the scene, with their efforts and conjugates."""
    entries = []
    for actuator in model.scene.actuators:
        effort, conjugate = (model.actuator[actuator.name].name_out(i) for i in range(2))
        described = {"name": actuator.name, "kind": actuator.kind, "rod": actuator.rod}
        entries.append({**described, "effort": effort, "conjugate": conjugate})
    return entries


def _output_entries(model: Model) -> dict[str, Any]:
    """Entries for actuators, bodies and the order of sensitivities, if a scene has these."""
    described: dict[str, Any] = {}
    if model.scene.actuators:
        described["actuators"] = actuator_entries(model)
    if model.scene.joints_with_coordinate:
        described["joints"] = [joint.name for joint in model.scene.joints_with_coordinate]
    if model.scene.bodies:
        described["bodies"] = [body.name for body in model.scene.bodies]
        rods = [{"rod": rod} for rod in model.discrete.rods]
        described["sensitivities"] = [*rods, *({"body": body} for body in described["bodies"])]
    return described


def described_unknowns(model: Model) -> list[tuple[dict[str, Any], str]]:
    """Entries for the unknowns in the order of their vector, strains to flows, each with its description."""
    described: list[tuple[dict[str, Any], str]] = []
    discrete = model.discrete

    def add(rod: str, what: dict[str, Any], first: int, count: int, words: str, **further: float) -> None:
        described.append(({"rod": rod, **what, "first": first, "count": count, **further}, words))

    for rod, discrete_rod in discrete.rods.items():
        begin = discrete.unknowns.strain(rod).start
        basis = discrete_rod.properties.basis.capitalize()
        for component, columns in discrete_rod.columns.items():
            strain = STRAINS[component]
            first = int(begin + (columns.start if isinstance(columns, slice) else columns[0]))
            count = int(discrete_rod.at_nodes[component].shape[1])
            words = f"{basis} coefficients of {strain} of rod {rod}, element after element"
            add(rod, {"strain": strain}, first, count, words)
    supports = {support.rod: support.kind for support in model.scene.supports}
    # Every entry has a rod: bodies without rods get the first one.
    first_rod = next(iter(discrete.rods))
    for placed in discrete.constraints:
        rod = placed.rod or first_rod
        what = {"tie": placed.where}
        words = f"multipliers of the tie {placed.where} on rod {rod}"
        if not placed.closes_assembly and placed.joint is None:
            what = {"support": supports[placed.rod]}
            words = f"multipliers of the support ({supports[placed.rod]}) of rod {rod}"
        add(rod, what, discrete.multipliers(placed).start, placed.size, words)
    for name in discrete.frames:
        holders = [joint.rod for joint in model.scene.joints if joint.rod and name == ("body", joint.body)]
        place = discrete.deviation(name)
        rod = name.name if name.kind == "rod" else (holders or [first_rod])[0]
        words = f"displacement of the {name} and change of its quaternion"
        add(rod, {"frame": str(name)}, place.start, place.stop - place.start, words)
    for placed in discrete.free_coordinates:
        words = f"angle (rad) of {placed.where}, or its displacement over the length of the rod"
        add(placed.rod or first_rod, {"joint": placed.where}, discrete.coordinate(placed).start, 1, words)
    for cable in discrete.cables:
        tendon = cable.tendon
        unit = discrete.tension_unit(tendon.rod)
        words = f"tension of the tendon {tendon.name}, in units of {unit:.6g} N"
        add(tendon.rod, {"tendon": tendon.name}, discrete.tension(cable).start, 1, words, unit_N=unit)
    for stop in discrete.stops:
        words = f"force or moment of the stop of {stop.owner}"
        add(stop.placed.rod or first_rod, {"stop": stop.owner}, discrete.stop(stop).start, 1, words)
    for block, place in discrete.unknowns.of_kind(BlockKind.FLOW):
        branches = len(discrete.rods[block.owner].properties.branches)
        words = f"strains of the dashpots of rod {block.owner} since rest, as its strains, one branch after the other"
        add(block.owner, {"branches": branches}, place.start, block.size, words)
    return described


def _function_entry(kernel: Kernel, every: Mapping[str, FunctionInC]) -> dict[str, Any]:
    """Entry of a kernel, with the function of the header that calls it, if it is not a part of an assembly."""
    function = kernel.signature if isinstance(kernel, PrintedKernel) else kernel
    known = every.get(function.name())
    units = ARGUMENT_UNITS if known is None else known.units
    arguments = [_vector_entry(function.name_in(i), function.size_in(i), units) for i in range(function.n_in())]
    results = [_vector_entry(function.name_out(i), function.size_out(i), units) for i in range(function.n_out())]
    return {
        "name": function.name(),
        **_public_entry(known),
        "arguments": arguments,
        "results": results,
        "instructions": kernel.n_instructions(),
    }


def _public_entry(known: FunctionInC | None) -> dict[str, str]:
    """Entries by which ``load`` offers a kernel; empty if only the solver calls it."""
    if known is None or not known.spec.public:
        return {}
    described = {"function": known.spec.name}
    if known.owner is not None:
        described["owner"] = known.owner
    described["symbol"] = known.symbol
    if known.spec.differentiable:
        described["external"] = known.external
    return described


def _vector_entry(name: str, shape: tuple[int, int], units: Mapping[str, str]) -> dict[str, Any]:
    return {"name": name, "shape": list(shape), "unit": units.get(name, "1")}
