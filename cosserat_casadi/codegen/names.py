"""Names of exported symbols, and checks of the name of a library, their prefix."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from cosserat_casadi.compiling.texts import files_in_c
from cosserat_casadi.errors import ExportError, Problem, refuse
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.function_table import FunctionSpec, Owner, table
from cosserat_casadi.model.model_functions import ModelFunctions
from cosserat_casadi.scene import Scene
from cosserat_casadi.scene.faults import shown

LONGEST = 48
"""Characters of the longest name: C99 guarantees 31 significant ones of a symbol, compilers take far more."""

_C = """auto break case char const continue default do double else enum extern float for goto if inline int long
register restrict return short signed sizeof static struct switch typedef union unsigned void volatile while"""

_CPP = """alignas alignof and asm bool catch class concept constexpr delete explicit export false friend main module
mutable namespace new noexcept not nullptr operator or private protected public requires template this throw true try
typeid typename using virtual xor casadi"""

_HEADERS = """assert complex ctype errno fenv inttypes iso646 limits locale math setjmp signal stdarg stdbool
stddef stdint stdio stdlib string tgmath threads time"""

_BUILD = "all c clean edit_cache help install m package rebuild_cache test"

KEYWORDS = frozenset(_C.split()) | frozenset(_CPP.split())
"""Words of C and C++, and of linked libraries, that a library cannot have as its name."""

TAKEN = frozenset(_HEADERS.split()) | frozenset(_BUILD.split())
"""Names of C headers, which the library's header would hide, and names known to CMake and the linker."""

FILES = frozenset(file.split(".")[0] for file in files_in_c())
"""Stems of the files of the solver, which files of a library with that name would overwrite."""

FUNCTIONS = tuple(table(ModelFunctions))
"""The named functions of every model."""

QUERIES = """SZ_ARG SZ_IW SZ_RES SZ_W checkout decref default_in incref n_in n_out name_in name_out release sparsity_in
sparsity_out work work_bytes"""
"""Suffixes that CasADi appends to the name of a function."""

TABLES = {Owner.ROD: "rods", Owner.ACTUATOR: "actuators", Owner.BODY: "bodies", Owner.JOINT: "joints"}
"""Tables of a scene whose names become part of symbols."""


@dataclass(frozen=True)
class Names:
    """Names of an exported library and of its parts.

    Attributes:
        name: the library, a C identifier.
        rods: names of the rods, in the order of the scene.
        actuators: names of the actuators.
        bodies: names of the rigid bodies.
        joints: names of the joints with a coordinate.
        functions: the named functions of the model.
    """

    name: str
    rods: tuple[str, ...]
    actuators: tuple[str, ...] = ()
    bodies: tuple[str, ...] = ()
    joints: tuple[str, ...] = ()
    functions: tuple[FunctionSpec, ...] = FUNCTIONS

    @property
    def macro(self) -> str:
        """Prefix of macros and enumerators."""
        return self.name.upper()

    def function(self, word: str, owner: str | None = None) -> str:
        """Symbol of a function of a rod, an actuator or a body; a rod is named only if there are several."""
        return self._symbol(word, word, owner)

    def kernel(self, word: str, owner: str | None = None) -> str:
        """Symbol of a generated kernel."""
        return self._symbol(f"k_{word}", word, owner)

    def differentiable(self, word: str, owner: str | None = None) -> str:
        """Symbol of a function for ``casadi.external``."""
        return self._symbol(f"f_{word}", word, owner)

    def words(self, kind: Owner) -> list[str]:
        """Words in the symbols of the functions in C that exist once for each owner of a kind."""
        return [spec.name_in_c for spec in self.functions if spec.kernel and spec.owner is kind]

    def _symbol(self, shown: str, word: str, owner: str | None) -> str:
        only_rod = len(self.rods) <= 1 and word in self.words(Owner.ROD)
        if owner is None or only_rod:
            return f"{self.name}_{shown}"
        return f"{self.name}_{shown}_{identifier(owner)}"


def model_names(name: str, model: Model, *, dynamics: bool = False, estimate_errors: bool = False) -> Names:
    """Make the names of the exported library of a model, with the functions of its class.

    Args:
        name: the library.
        model: the exported model.
        dynamics: whether functions of motion are included.
        estimate_errors: whether functions that estimate errors of answers are included.

    Raises:
        ExportError: as :func:`library_names`.
    """
    functions = tuple(
        spec
        for spec in table(type(model))
        if (dynamics or "v" not in spec.arguments) and (estimate_errors or not spec.judges_answers)
    )
    return scene_names(name, model.scene, functions)


def scene_names(name: str, scene: Scene, functions: tuple[FunctionSpec, ...] = FUNCTIONS) -> Names:
    """Make the names of the exported library of a scene.

    Raises:
        ExportError: as :func:`library_names`.
    """
    tables = (scene.rods, scene.actuators, scene.bodies, scene.joints_with_coordinate)
    rods, actuators, bodies, joints = (tuple(entry.name or "" for entry in table) for table in tables)
    return library_names(
        name,
        rods,
        scene.input_names(),
        parameters=scene.parameter_names(),
        actuators=actuators,
        bodies=bodies,
        joints=joints,
        functions=functions,
    )


def library_names(
    name: str,
    rods: tuple[str, ...] = (),
    inputs: tuple[str, ...] = (),
    *,
    parameters: tuple[str, ...] = (),
    actuators: tuple[str, ...] = (),
    bodies: tuple[str, ...] = (),
    joints: tuple[str, ...] = (),
    functions: tuple[FunctionSpec, ...] = FUNCTIONS,
) -> Names:
    """Make the names of an exported library.

    Raises:
        ExportError: the name is not a C identifier valid for C, C++ and linkers, or two parts of the library would have
            one name.
    """
    names = Names(name, rods, actuators, bodies, joints, functions)
    problems = [
        *_name_problems(name),
        *_symbol_problems(names),
        *_macro_problems(inputs),
        *_parameter_problems(parameters),
    ]
    refuse(problems, ExportError)
    return names


def _name_problems(name: str) -> Iterator[Problem]:
    remedy = "use letters, digits and underscores, a letter first, such as --name finger"
    # A trailing underscore would become a double one, which C++ keeps for itself and CasADi refuses.
    sound = re.fullmatch(r"[A-Za-z](_?[A-Za-z0-9])*", name)
    if not sound or len(name) > LONGEST:
        yield Problem("--name", f"{shown(name)} is no name for a C library", remedy)
    elif name.lower() in KEYWORDS:
        yield Problem("--name", f"{name!r} is a word of C or C++", remedy)
    elif name.lower() in TAKEN:
        yield Problem("--name", f"{name!r} is taken by C or its tools", remedy)
    elif name.lower() in FILES:
        yield Problem("--name", f"{name!r} is what a file of the solver is called", remedy)


def _symbol_problems(names: Names) -> Iterator[Problem]:
    # The functions of a single rod clash with no other without a suffix.
    rods = names.rods if len(names.rods) > 1 else ()
    owners_by_kind = {
        Owner.ROD: rods,
        Owner.ACTUATOR: names.actuators,
        Owner.BODY: names.bodies,
        Owner.JOINT: names.joints,
    }
    for kind, owners in owners_by_kind.items():
        words = names.words(kind)
        yield from _clashes(kind, owners, [[f"{word}_{identifier(owner)}" for word in words] for owner in owners])


def _clashes(kind: Owner, owners: Sequence[str], functions: Sequence[list[str]]) -> Iterator[Problem]:
    """Problems of names in one table that cannot be part of a C symbol, or that give two functions one name."""
    entries = TABLES[kind]
    taken = dict[str, str]()
    for i, (owner, own) in enumerate(zip(owners, functions, strict=True)):
        where = f"{entries}[{i}].name"
        if "__" in owner:
            yield Problem(where, f"{owner!r} cannot be part of a C symbol", "without two underscores in a row")
        symbols = own + [f"{function}_{query}" for function in own for query in QUERIES.split()]
        clashing = [taken[symbol] for symbol in symbols if symbol in taken]
        if clashing:
            problem = f"{owner!r} gives a function the name that {kind.value} {clashing[0]!r} gives another"
            yield Problem(where, problem, f"rename one of the {entries}")
        taken.update(dict.fromkeys(symbols, owner))


def identifier(name: str) -> str:
    """Turn the name of an input, of a parameter or of a disk of a row into a C identifier."""
    return re.sub(r"\W+", "_", name.rstrip("]"))


def _parameter_problems(parameters: tuple[str, ...]) -> Iterator[Problem]:
    first: dict[str, str] = {}
    for i, name in enumerate(parameters):
        earlier = first.setdefault(identifier(name).upper(), name)
        if earlier != name:
            yield Problem(
                f"parameters[{i}]", f"{earlier!r} and {name!r} are one name in C", "rename one of the entries"
            )


def _macro_problems(inputs: tuple[str, ...]) -> Iterator[Problem]:
    first: dict[str, str] = {}
    for name in inputs:
        earlier = first.setdefault(name.upper(), name)
        if earlier != name:
            problem = f"{name!r} and {earlier!r} differ in case alone, macros in C do not"
            yield Problem("inputs", problem, "rename one of the loads")
