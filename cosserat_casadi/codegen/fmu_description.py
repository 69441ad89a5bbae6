"""The two XML files of an FMU: what its variables are, and how its sources are compiled. FMI standard, version 3.0."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from importlib.metadata import version
from xml.etree import ElementTree

from cosserat_casadi.codegen.motion_outputs import MotionOutput
from cosserat_casadi.model.build import Model
from cosserat_casadi.scene.input_fields import column_suffixes

STEP_NAME = "step"
"""Name of the parameter that is the step of the integrator."""

COURSE = " Set for the end of a communication step; moves there in it, with a rate that does not jump."
"""Sentence of the description of a base or a length on its values."""


@dataclass(frozen=True)
class Variable:
    """A variable of an FMU; its value reference is its place in the list of all.

    Attributes:
        name: dotted.
        unit: SI unit.
        description: one sentence.
        causality: "independent", "input", "output" or "parameter".
        start: value where none is set; None of a computed variable.
    """

    name: str
    unit: str
    description: str
    causality: str
    start: float | None = None


def variables(model: Model, outputs: Sequence[MotionOutput], step: float) -> list[Variable]:
    """All variables in the order of their value references: time, inputs, outputs, step, parameters of the scene.

    Args:
        model: the model.
        outputs: the outputs of its motion.
        step: of the integrator, s.
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
    """The file ``modelDescription.xml``.

    Args:
        model: the model.
        name: identifier in C.
        token: tells that this description belongs to the library.
        listed: all variables.
        step: of the integrator, s.
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
    """The file ``sources/buildDescription.xml``.

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
