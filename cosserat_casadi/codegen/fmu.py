"""Export of a scene in motion as an FMU, which other simulators step by the Functional Mock-up Interface 3.0.

The archive contains a library for this machine and its sources. Two XML files describe the variables, and how the
sources are compiled.
"""

from __future__ import annotations

import hashlib
import io
import os
import platform
import zipfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from xml.etree import ElementTree

from cosserat_casadi.accuracy.verified import Verified
from cosserat_casadi.codegen.contact.moving import starts_unloaded
from cosserat_casadi.codegen.export import folder_files
from cosserat_casadi.codegen.kernel_files import kernel_sources
from cosserat_casadi.codegen.kernels import kernel
from cosserat_casadi.codegen.library import VERBATIM
from cosserat_casadi.codegen.motion_outputs import MotionOutput, MotionOutputs, motion_outputs
from cosserat_casadi.codegen.motion_parts import check_motion
from cosserat_casadi.codegen.names import Names, model_names
from cosserat_casadi.compiling.c_tables import numbers
from cosserat_casadi.compiling.compiler import compiled_texts, find_compiler
from cosserat_casadi.compiling.texts import render, resource
from cosserat_casadi.errors import ExportError, Problem
from cosserat_casadi.files import check_writable, write_atomically
from cosserat_casadi.model.build import Model
from cosserat_casadi.motion.step_words import STEP_ITERATIONS, STEP_PARTS, STEP_TOLERANCE
from cosserat_casadi.numerics.progress import StageProgress
from cosserat_casadi.scene.input_fields import column_suffixes

STEP_NAME = "step"
"""Name of the parameter with the step of the integrator."""

COURSE = " Set for the end of a communication step; moves there in it, with a rate that does not jump."
"""Sentence of the description of a base or a length on its values."""

SUFFIX = ".fmu"

STEP = 1e-3
"""Default step of the integrator, s."""

FMI_SOURCES = (
    "fmi3.c",
    "fmi3.h",
    "fmi3_instances.c",
    "fmi3_course.c",
    "fmi3_steps.c",
    "fmi3_values.c",
    "fmi3_states.c",
    "fmi3_derivatives.c",
    "fmi3_missing.c",
)
"""Files of the folder ``c`` that an FMU includes unchanged."""

ARCHITECTURES = {"amd64": "x86_64", "arm64": "aarch64"}
"""Names of architectures that the standard spells differently."""

SUFFIXES = {"linux": ".so", "darwin": ".dylib", "windows": ".dll"}
"""Suffixes of shared libraries by system."""

EPOCH = (1980, 1, 1, 0, 0, 0)
"""Time stamp of every file in the archive, so that equal scenes give equal bytes."""


def check_fmu(path: str | os.PathLike[str]) -> None:
    """Refuse a file that could not be written, before any work is done for it.

    Raises:
        ExportError: the name does not end in ``.fmu``.
        SceneError: the path is a folder, or its folder cannot be written to.
    """
    if Path(path).suffix != SUFFIX:
        raise ExportError(Problem("--fmu", f"{path} does not end in {SUFFIX}", "name the file so"))
    check_writable(Path(path), "--fmu")


def write_fmu(
    model: Model,
    path: str | os.PathLike[str],
    name: str,
    *,
    error_estimate: float | None = None,
    verified: Verified | None = None,
    compiler: str | None = None,
    progress: StageProgress | None = None,
) -> Path:
    """Write a model in motion as an FMU for co-simulation, with directional derivatives.

    Its inputs are those of the scene; its outputs are poses and velocities of tips and bodies, efforts of actuators and
    their conjugates. It begins at rest, in the equilibrium at its inputs, or in the unloaded shape if the scene starts
    there or has a free base. Over a communication step, loads change linearly to the value that is set, and bases and
    lengths with continuous rates. Its parameters are those of the scene, and the longest step of the integrator.

    Args:
        model: a model that was built with its motion.
        path: the file, ending in ``.fmu``.
        name: prefix of every symbol, a C identifier.
        error_estimate: error of the tip pose, as for :func:`cosserat_casadi.export`.
        verified: ranges of the tolerance, as for :func:`cosserat_casadi.export`.
        compiler: C compiler; by default the command in the environment variable CC, then cc, gcc, clang, python-zig.
        progress: callback with the file under compilation, the number of compiled files, and of all files.

    Raises:
        ExportError: the file, the name or a motion of this scene is refused, there is no compiler, or it fails; nothing
            was written.
    """
    check_motion(model)
    check_fmu(path)
    names = model_names(name, model)
    found = find_compiler(compiler)
    outputs = motion_outputs(model)
    simulation = model.scene.simulation
    step = STEP
    if simulation is not None and simulation.step is not None:
        step = simulation.step
    listed = variables(model, outputs.entries, step)
    texts = folder_files(model, name, error_estimate, verified=verified, dynamics=True, estimate_errors=False)
    sources = {file: text for file, text in texts.items() if file.endswith((".c", ".h")) and "_demo." not in file}
    sources |= _fmu_sources(model, names, outputs, step)
    token = _token(sources)
    sources[f"{name}_fmu.c"] = sources[f"{name}_fmu.c"].replace("@{token}", token)
    included = {*VERBATIM, *FMI_SOURCES}
    library = compiled_texts(name, sources, found, included, progress)
    compiled = sorted(file for file in sources if file.endswith(".c") and file not in included)
    system = platform.system().lower()
    files = {
        "modelDescription.xml": model_description(model, name, token, listed, step),
        "sources/buildDescription.xml": build_description(name, compiled),
        **{f"sources/{file}": text.encode() for file, text in sources.items()},
        f"binaries/{_machine()}-{system}/{name}{SUFFIXES.get(system, '.so')}": library.read_bytes(),
        "resources/scene.toml": texts["scene.toml"].encode(),
    }
    write_atomically(Path(path), _archive(files))
    return Path(path)


def _fmu_sources(model: Model, names: Names, outputs: MotionOutputs, step: float) -> dict[str, str]:
    """Write the sources of an FMU besides the library: its interface, and the kernels of its outputs."""
    functions = [
        kernel(model, outputs.function, names.kernel("motion_outputs")),
        kernel(model, outputs.jacobian, names.kernel("motion_outputs_jacobian")),
    ]
    moves = list[int]()
    quaternions = [0] * model.inputs.size
    for entry, span in model.inputs:
        moves += [int(entry.declared.moves)] * entry.size
        quaternions[span.start] = int(entry.field == "base.quaternion")
    words = {
        "name": names.name,
        "MACRO": names.macro,
        "outputs": len(outputs.entries),
        "moves": numbers(moves) or "0",
        "quaternions": numbers(quaternions) or "0",
        **_parameter_words(model, names),
        "budget": f"{STEP_TOLERANCE!r}, {STEP_ITERATIONS}, {STEP_PARTS}",
        "step": repr(step),
        "unloaded": int(starts_unloaded(model)),
        "starts_in_contact": model.scene.touches_exactly,
        "token": "@{token}",
    }
    return {
        f"{names.name}_fmu.c": render("fmu.c.in", words),
        **kernel_sources(functions, names, f"{names.name}_outputs"),
        **{file: resource("c", file) for file in FMI_SOURCES},
    }


def _parameter_words(model: Model, names: Names) -> dict[str, str | int]:
    """Words for the number of parameters, their values, and their place in calls of the library."""
    count = model.parameters.size
    arguments = {
        "parameters": "parameters",
        "d_parameters": "d_parameters",
        "d_x_d_parameters": "d_x_d_parameters",
        "nothing": "0",
    }
    return {
        "parameter_count": count,
        "parameter_defaults": f"{names.macro}_PARAMETER_DEFAULTS" if count else "{0}",
        **{word: f", {argument}" if count else "" for word, argument in arguments.items()},
    }


def _token(sources: Mapping[str, str]) -> str:
    """Token that ties a description to a library: a hash of all sources."""
    digest = hashlib.sha256()
    for file in sorted(sources):
        digest.update(f"{file}\0{sources[file]}\0".encode())
    return digest.hexdigest()[:32]


def _machine() -> str:
    machine = platform.machine().lower()
    return ARCHITECTURES.get(machine, machine)


def _archive(files: Mapping[str, bytes]) -> bytes:
    """A zip archive that depends on its files alone."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
        for file, content in files.items():
            entry = zipfile.ZipInfo(file, EPOCH)
            entry.compress_type = zipfile.ZIP_DEFLATED
            archive.writestr(entry, content)
    return buffer.getvalue()


@dataclass(frozen=True)
class Variable:
    """A variable of an FMU; its value reference is its place in the list of all.

    Attributes:
        name: dotted name.
        unit: SI unit.
        description: one sentence.
        causality: "independent", "input", "output" or "parameter".
        start: default value; None for a computed variable.
    """

    name: str
    unit: str
    description: str
    causality: str
    start: float | None = None


def variables(model: Model, outputs: Sequence[MotionOutput], step: float) -> list[Variable]:
    """List all variables in the order of their value references: time, inputs, outputs, step, parameters of the scene.

    Args:
        model: the model.
        outputs: the outputs of its motion.
        step: step of the integrator, s.
    """
    listed = [Variable("time", "s", "Time.", "independent")]
    for entry, _ in model.inputs:
        axes = "" if entry.axes == "none" else f", {entry.axes} axes"
        suffixes = column_suffixes(*entry.shape)
        for suffix, start in zip(suffixes, entry.default.ravel(order="F").tolist(), strict=True):
            described = f"Entry of {entry.name}{axes}."
            if entry.declared.moves:
                described += COURSE
            listed.append(Variable(f"{entry.name}{suffix}", entry.unit, described, "input", start))
    listed += [Variable(output.name, output.unit, output.description, "output") for output in outputs]
    described = "Longest step of the integrator: every communication step is divided into equal ones."
    listed.append(Variable(STEP_NAME, "s", described, "parameter", step))
    for parameter, span in model.parameters:
        described = f"Number of {parameter.name}, held from the start on."
        for cell, value in zip(parameter.cell_names, model.parameters.pack()[span].tolist(), strict=True):
            listed.append(Variable(cell, parameter.unit, described, "parameter", value))
    return listed


def model_description(model: Model, name: str, token: str, listed: Sequence[Variable], step: float) -> bytes:
    """Write the file ``modelDescription.xml``.

    Args:
        model: the model.
        name: identifier in C.
        token: token that ties the description to the library.
        listed: all variables.
        step: step of the integrator, s.
    """
    root = ElementTree.Element(
        "fmiModelDescription",
        fmiVersion="3.0",
        modelName=name,
        instantiationToken=token,
        description=model.scene.title or name,
        generationTool=f"cosserat_casadi {version('cosserat-casadi')}",
        variableNamingConvention="structured",
    )
    ElementTree.SubElement(
        root,
        "CoSimulation",
        modelIdentifier=name,
        canGetAndSetFMUState="true",
        canSerializeFMUState="true",
        providesDirectionalDerivatives="true",
        canHandleVariableCommunicationStepSize="true",
    )
    units = ElementTree.SubElement(root, "UnitDefinitions")
    for unit in sorted({variable.unit for variable in listed}):
        ElementTree.SubElement(units, "Unit", name=unit)
    categories = ElementTree.SubElement(root, "LogCategories")
    for category in ("logStatusDiscard", "logStatusError"):
        ElementTree.SubElement(categories, "Category", name=category)
    simulation = model.scene.simulation
    if simulation is not None:
        ElementTree.SubElement(
            root, "DefaultExperiment", startTime="0", stopTime=repr(simulation.duration), stepSize=repr(step)
        )
    described = ElementTree.SubElement(root, "ModelVariables")
    for reference, variable in enumerate(listed):
        described.append(_variable_element(reference, variable))
    structure = ElementTree.SubElement(root, "ModelStructure")
    outputs = [str(i) for i, variable in enumerate(listed) if variable.causality == "output"]
    for kind in ("Output", "InitialUnknown"):
        for reference in outputs:
            ElementTree.SubElement(structure, kind, valueReference=reference)
    return _text(root)


def _variable_element(reference: int, variable: Variable) -> ElementTree.Element:
    element = ElementTree.Element(
        "Float64",
        name=variable.name,
        valueReference=str(reference),
        description=variable.description,
        causality=variable.causality,
        unit=variable.unit,
    )
    element.set("variability", "fixed" if variable.causality == "parameter" else "continuous")
    if variable.start is not None:
        element.set("start", repr(variable.start))
    return element


def build_description(name: str, sources: Sequence[str]) -> bytes:
    """Write the file ``sources/buildDescription.xml``.

    Args:
        name: identifier in C.
        sources: files to compile; these include the other files of the folder.
    """
    root = ElementTree.Element("fmiBuildDescription", fmiVersion="3.0")
    configuration = ElementTree.SubElement(root, "BuildConfiguration", modelIdentifier=name)
    files = ElementTree.SubElement(configuration, "SourceFileSet", language="C99")
    for source in sources:
        ElementTree.SubElement(files, "SourceFile", name=source)
    return _text(root)


def _text(root: ElementTree.Element) -> bytes:
    ElementTree.indent(root)
    text: bytes = ElementTree.tostring(root, encoding="utf-8", xml_declaration=True)
    return text + b"\n"
