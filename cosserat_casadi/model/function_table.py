"""Entries of the table of a model's named functions, and the table.

A function is a method of :class:`cosserat_casadi.model.model_functions.ModelFunctions` with one of these decorators.
The model's members, the manifest, the kernels in C with their headers, and what ``load`` offers follow from the table.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from enum import Enum
from functools import cached_property
from importlib import import_module
from operator import attrgetter
from typing import Any, TypeVar

import casadi as ca

from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.model.discrete_scene import DiscreteScene
from cosserat_casadi.model.system import Arguments, MotionArguments, System

Result = TypeVar("Result")

ARGUMENT_UNITS: dict[str, str] = {
    "inputs": "inputs",
    "p": "parameters",
    "base_position": "m",
    "inputs_rate": "inputs",
    "inputs_acceleration": "inputs",
    "v": "1/s",
    "a": "1/s²",
}
"""Units of arguments; "inputs" stands for the units of the stacked inputs, "parameters" for those of the parameters."""

SCALAR_ARGUMENTS = frozenset({"X", "load_factor", "load_factor_rate"})
"""Arguments that are one number in every scene: functions in C take them by value."""


PARAMETERS = "p"
"""Name of the argument that holds the parameters of a scene."""


class Owner(Enum):
    """Family of owners of a function: one function exists for each of its members."""

    SCENE = "scene"
    ROD = "rod"
    ACTUATOR = "actuator"
    BODY = "body"
    JOINT = "joint"


@dataclass(frozen=True)
class Output:
    """A result of a function.

    Attributes:
        name: in Python, in C and in the manifest.
        unit: "1" where it has none.
        derivative_by: the argument that it is a derivative with respect to, with a column for each of its entries;
            empty where it is no derivative.
    """

    name: str
    unit: str = "1"
    derivative_by: str = ""


@dataclass(frozen=True)
class Expressions:
    """Discretisation, owner and symbols for the expressions of a function.

    Attributes:
        discrete: the scene.
        owner: name of the rod, the actuator, the body or the joint; empty for a function of the scene.
        symbols: the arguments by name.
        known: equations in these arguments, shared by the functions of all owners.
    """

    discrete: DiscreteScene
    owner: str
    symbols: Mapping[str, ca.MX]
    known: dict[Any, Any] = field(default_factory=dict)

    def __getitem__(self, argument: str) -> Matrix:
        """The symbol of an argument."""
        return self.symbols[argument]

    @property
    def arguments(self) -> Arguments:
        """Unknowns, inputs and load factor of the system; the ones that are arguments of the function."""
        motion = self._motion if "v" in self.symbols else None
        return Arguments(self.symbols["x"], self.symbols["inputs"], self.symbols.get("load_factor"), motion)

    @cached_property
    def at_rest(self) -> System:
        """The equations of motion in these arguments where nothing moves."""
        unknowns = ca.DM(self.discrete.size, 1)
        inputs = ca.DM(self.discrete.layout.size, 1)
        still = MotionArguments(v=unknowns, a=unknowns, inputs_rate=inputs, inputs_acceleration=inputs)
        return System(self.discrete, Arguments(self.symbols["x"], self.symbols["inputs"], None, still))

    @property
    def _motion(self) -> MotionArguments:
        """Rates of unknowns and inputs; a rate that is no argument is zero."""
        unknowns = ca.DM(self.discrete.size, 1)
        inputs = ca.DM(self.discrete.layout.size, 1)
        return MotionArguments(
            v=self.symbols["v"],
            a=self.symbols.get("a", unknowns),
            inputs_rate=self.symbols.get("inputs_rate", inputs),
            inputs_acceleration=self.symbols.get("inputs_acceleration", inputs),
        )

    @property
    def system(self) -> System:
        """The equations in these arguments."""
        if System not in self.known:
            self.known[System] = System(self.discrete, self.arguments)
        known: System = self.known[System]
        return known

    def equations(self, kind: Callable[[System], Result]) -> Result:
        """Equations or energies of the system, written once for all functions of these arguments."""
        if kind not in self.known:
            self.known[kind] = kind(self.system)
        known: Result = self.known[kind]
        return known


Outputs = tuple[Output, ...] | Callable[[DiscreteScene, str], tuple[Output, ...]]
Write = Callable[[Any, Expressions], Sequence[Matrix] | None]


@dataclass(frozen=True)
class FunctionSpec:
    """One entry of the table.

    Attributes:
        name: member of the model.
        owner: family of its owners; the table has one function for each member.
        arguments: names of the arguments, without the parameters that a scene names.
        outputs: its results, or a function from a discrete scene and an owner to them.
        write: method that returns the expressions, or None in a scene without such a function.
        kernel: name of its kernel in C; empty where it stays in Python.
        kernel_outputs: number of outputs of the kernel, the first ones; None for all.
        header: sentence for the header in C, with ``{owner}``; empty for a kernel that only the solver calls.
        differentiable: whether a loaded folder offers its derivatives.
        judges_answers: whether its kernel serves only to estimate the error of an answer.
        doc: the function in one sentence.
    """

    name: str
    owner: Owner
    arguments: tuple[str, ...]
    outputs: Outputs
    write: Write
    kernel: str = ""
    kernel_outputs: int | None = None
    header: str = ""
    differentiable: bool = False
    judges_answers: bool = False
    doc: str = ""

    def __reduce__(self) -> tuple[Callable[..., FunctionSpec], tuple[str, str]]:
        """Pickle and copy find the entry by the name of the method that it has replaced."""
        return _entry_of, (self.write.__module__, self.write.__qualname__)

    def arguments_of(self, discrete: DiscreteScene) -> list[str]:
        """Names of the arguments; with parameters in the scene, p follows the inputs."""
        arguments = list(self.arguments)
        if discrete.parameters.size:
            arguments.insert(arguments.index("inputs") + 1, PARAMETERS)
        return arguments

    @property
    def name_in_c(self) -> str:
        """Name of the function in C symbols."""
        return self.kernel or self.name

    @property
    def public(self) -> bool:
        """Whether the function is one of the header in C."""
        return bool(self.header)

    def outputs_of(self, discrete: DiscreteScene, owner: str) -> tuple[Output, ...]:
        """Names of the results for one owner."""
        return self.outputs(discrete, owner) if callable(self.outputs) else self.outputs

    def function_of(self, model: Any, owner: str = "") -> ca.Function:
        """The function of one owner, as the model keeps it."""
        member = getattr(model, self.name)
        return member[owner] if owner else member

    def function_in_c(self, model: Any, owner: str = "") -> ca.Function:
        """The function of one owner with the outputs of its kernel."""
        function = self.function_of(model, owner)
        if self.kernel_outputs is None:
            return function
        symbols = function.mx_in()
        results = function.call(symbols)[: self.kernel_outputs]
        names = function.name_out()[: self.kernel_outputs]
        return ca.Function(self.name, symbols, results, function.name_in(), names)

    def build(self, model: Any, owner: str = "") -> ca.Function | None:
        """The function of one owner; None where the scene has none.

        Args:
            model: model of the function, with a member ``discrete``.
            owner: name of the rod, the actuator, the body or the joint.
        """
        discrete: DiscreteScene = model.discrete
        arguments = self.arguments_of(discrete)
        written = expressions_of(model, tuple(arguments), owner)
        symbols = written.symbols
        results = self.write(model, written)
        if results is None:
            return None
        names = [output.name for output in self.outputs_of(discrete, owner)]
        # CasADi refuses two underscores in a row, and brackets, which names of disks in a row have.
        name = re.sub("[^A-Za-z0-9]+", "_", f"{self.name}_{owner}").strip("_") if owner else self.name
        return ca.Function(name, list(symbols.values()), list(results), arguments, names)


def expressions_of(model: Any, arguments: tuple[str, ...], owner: str) -> Expressions:
    """Expressions in some arguments, shared by the functions of a model."""
    discrete: DiscreteScene = model.discrete
    kept: dict[Any, Expressions] = model.__dict__.setdefault("_expressions", {})
    # A function of q alone is written for the coordinates of one rod.
    place = (arguments, owner if "q" in arguments else "")
    if place not in kept:
        kept[place] = Expressions(discrete, owner, {name: _symbol(discrete, name, owner) for name in arguments})
    return replace(kept[place], owner=owner)


def _entry_of(module: str, method: str) -> FunctionSpec:
    """The entry of a method, such as "ModelFunctions.residual" of a module."""
    function: NamedFunction = attrgetter(method)(import_module(module))
    return function.spec


def _symbol(discrete: DiscreteScene, name: str, owner: str) -> ca.MX:
    """The symbol of an argument."""
    # Constants of the scene are expressions of one p already.
    if name == PARAMETERS:
        return discrete.parameters.symbol
    return ca.MX.sym(name, argument_size(discrete, name, owner))


def argument_size(discrete: DiscreteScene, name: str, owner: str) -> int:
    """Number of entries of an argument."""
    if name in SCALAR_ARGUMENTS:
        return 1
    if name == "q":
        return discrete.rods[owner].size
    sizes = {
        "x": discrete.size,
        "inputs": discrete.layout.size,
        PARAMETERS: discrete.parameters.size,
        "v": discrete.size,
        "a": discrete.size,
        "inputs_rate": discrete.layout.size,
        "inputs_acceleration": discrete.layout.size,
        "base_position": 3,
        "base_quaternion": 4,
        "correction": discrete.size,
    }
    if name == "missing":
        return discrete.richer.missing_size
    return sizes[name]


def owners(discrete: DiscreteScene, owner: Owner) -> list[str]:
    """Names of all owners in a family: rods, actuators, bodies or joints; one empty name for the scene."""
    scene = discrete.scene
    named: dict[Owner, Sequence[Any]] = {
        Owner.ROD: scene.rods,
        Owner.ACTUATOR: scene.actuators,
        Owner.BODY: scene.bodies,
        Owner.JOINT: scene.joints_with_coordinate,
    }
    return [record.name for record in named[owner]] if owner in named else [""]


SHARED = "_shared"
"""Key, in the dictionary of a model, of the other model that writes the functions of both."""


def share_functions(model: Any, kept: Any) -> None:
    """Make a model take its functions from another model with equal equations, which writes and keeps them."""
    model.__dict__[SHARED] = kept


def kept_with(model: Any, name: str, make: Callable[[], Result]) -> Result:
    """A value that depends on the equations of a model alone, made once for all models that share its functions.

    Args:
        model: the model.
        name: name of the value.
        make: function that makes the value.
    """
    kept = model.__dict__.get(SHARED, model).__dict__
    if name not in kept:
        kept[name] = make()
    value: Result = kept[name]
    return value


@dataclass
class NamedFunction:
    """A member of a model that is built on first use, and kept.

    It is one function of the scene, or a function for each rod, actuator, body or joint, by name.
    """

    spec: FunctionSpec = field(init=False)
    options: dict[str, Any]
    write: Write

    def __set_name__(self, model_class: type, name: str) -> None:
        doc = (self.write.__doc__ or "").strip()
        self.spec = FunctionSpec(name=name, write=self.write, doc=doc, **self.options)
        self.__doc__ = doc

    def __get__(self, model: Any, model_class: type | None = None) -> Any:
        if model is None:
            return self
        built: ca.Function | dict[str, ca.Function] | None
        if SHARED in model.__dict__:
            built = getattr(model.__dict__[SHARED], self.spec.name)
        elif self.spec.owner is Owner.SCENE:
            built = self.spec.build(model)
        else:
            built = {name: self.spec.build(model, name) for name in owners(model.discrete, self.spec.owner)}
        model.__dict__[self.spec.name] = built
        return built


def scene_function(*outputs: Output, **options: Any) -> Callable[[Write], NamedFunction]:
    """Make a method one named function of the scene.

    Args:
        outputs: names of its results.
        options: keywords of :func:`owned_functions`.
    """
    return owned_functions(Owner.SCENE, outputs, **options)


def owned_functions(
    owner: Owner, outputs: Outputs, *, arguments: tuple[str, ...] = ("x", "inputs"), **options: Any
) -> Callable[[Write], NamedFunction]:
    """Make a method one named function for each rod, actuator, body or joint.

    Args:
        owner: family of its owners; each member has one function.
        outputs: results of each, or a function from a discrete scene and an owner to them.
        arguments: names of its arguments.
        options: further attributes of :class:`FunctionSpec`.
    """
    of_entry = {"owner": owner, "arguments": arguments, "outputs": outputs, **options}
    return lambda write: NamedFunction(of_entry, write)


def table(model_class: type) -> list[FunctionSpec]:
    """The functions of a class of models, in the order of their methods."""
    members = [vars(base) for base in reversed(model_class.__mro__)]
    return [member.spec for names in members for member in names.values() if isinstance(member, NamedFunction)]
