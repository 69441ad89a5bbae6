"""The name that every exported symbol begins with."""

from __future__ import annotations

import re
from dataclasses import dataclass

from cosserat_casadi.errors import ExportError, Problem

LONGEST = 48
"""Characters of the longest name: C99 promises to tell apart 31 of an external symbol, compilers take far more."""

_C = """auto break case char const continue default do double else enum extern float for goto if inline int long
register restrict return short signed sizeof static struct switch typedef union unsigned void volatile while"""

_CPP = """alignas alignof and asm bool catch class concept constexpr delete explicit export false friend main module
mutable namespace new noexcept not nullptr operator or private protected public requires template this throw true try
typeid typename using virtual xor casadi"""

KEYWORDS = frozenset(_C.split()) | frozenset(_CPP.split())
"""Words of C and C++, and of what is linked with them, that a library may not be called."""

_HEADERS = """assert complex ctype dlfcn errno fcntl fenv features float inttypes iso646 limits locale malloc math
memory memory_resource omp pthread sched setjmp signal stdalign stdarg stdatomic stdbool stddef stdint stdio stdlib
stdnoreturn string strings tgmath threads time uchar unistd values wchar wctype"""

_TARGETS = "all clean depend edit_cache help install list_install_components package preinstall rebuild_cache test"

_LIBRARIES = "c dl gcc gomp m rt"

TAKEN = frozenset(_HEADERS.split()) | frozenset(_TARGETS.split()) | frozenset(_LIBRARIES.split())
"""Headers that NAME.h would hide, targets of the build that CMake keeps, libraries that libNAME would hide."""

ROD_FUNCTIONS = ("igm", "tip", "tip_jacobian", "shape")
"""Functions that each rod has."""

_QUERIES = """SZ_ARG SZ_IW SZ_RES SZ_W checkout decref default_in incref n_in n_out name_in name_out release sparsity_in
sparsity_out work work_bytes"""
"""What CasADi appends to the name of a function."""


@dataclass(frozen=True)
class Names:
    """How an exported library and what is in it are called.

    Attributes:
        name: the library, a C identifier.
        rods: names of the rods, in the order of the scene.
    """

    name: str
    rods: tuple[str, ...]

    @property
    def macro(self) -> str:
        """What macros and enumerators begin with."""
        return self.name.upper()

    def function(self, word: str, rod: str | None = None) -> str:
        """Symbol of a function; the rod is named only where there are several."""
        suffix = f"_{rod}" if rod is not None and len(self.rods) > 1 else ""
        return f"{self.name}_{word}{suffix}"

    def kernel(self, word: str, rod: str | None = None) -> str:
        """Symbol of a generated kernel."""
        return self.function(f"k_{word}", rod)

    def differentiable(self, word: str, rod: str | None = None) -> str:
        """Symbol of a function for ``casadi.external``."""
        return self.function(f"f_{word}", rod)


def library_names(name: str, rods: tuple[str, ...]) -> Names:
    """Names of an exported library.

    Raises:
        ExportError: the name is no C identifier that two languages and a linker agree on, or hides what builds need,
            or two rods would have functions of the same name.
    """
    remedy = "use letters, digits and underscores, a letter first, such as --name finger"
    if not re.fullmatch(r"[A-Za-z][A-Za-z0-9_]*", name) or "__" in name or len(name) > LONGEST:
        raise ExportError(Problem("--name", f"{name!r} is no name for a C library", remedy))
    if name.lower() in KEYWORDS:
        raise ExportError(Problem("--name", f"{name!r} is a word of C or C++", remedy))
    if name.lower() in TAKEN:
        raise ExportError(Problem("--name", f"{name!r} is a standard header, a library or a target of CMake", remedy))
    _check_rods(rods)
    return Names(name, rods)


def _check_rods(rods: tuple[str, ...]) -> None:
    """Refuse rods such as B and jacobian_B: the tip_jacobian of one is named as the tip of the other."""
    owner: dict[str, str] = {}
    for rod in rods:
        functions = [f"{word}_{rod}" for word in ROD_FUNCTIONS]
        for symbol in [*functions, *(f"{function}_{query}" for function in functions for query in _QUERIES.split())]:
            if symbol in owner:
                problem = f"{owner[symbol]!r} and {rod!r} would both have a C function {symbol}"
                raise ExportError(Problem("rods", problem, "rename one of them"))
            owner[symbol] = rod
