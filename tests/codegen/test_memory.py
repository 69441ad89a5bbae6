"""Stack and workspace are what header and README say: measured on a painted stack."""

from __future__ import annotations

import re
from collections.abc import Callable

import pytest

from tests.codegen.libraries import QUICK, RECIPES, Exported, run
from tests.families import mostly_slow

Library = Callable[[str], Exported]

MARGIN, ROUNDING = 1.7, 1000
"""How much more than it needs a library may ask for: a factor, and bytes."""


def measured(made: Exported, *flags: str) -> tuple[int, int]:
    """Bytes of stack that any function needs, bytes of the workspace."""
    # Symbols are bound before the program begins: the loader's own stack is none of the library's.
    stack, workspace = run(made.program("stack.c", *flags, "-std=gnu99", "-pthread", "-Wl,-z,now")).split()
    return int(stack), int(workspace)


def stated(made: Exported) -> tuple[float, float]:
    """The same as README and header say."""
    readme = (made.folder / "README.md").read_text()
    found = re.search(r"workspace takes ([\d.]+) kB .* at\s+most ([\d.]+) kB of stack", readme, re.DOTALL)
    assert found is not None
    assert f"Functions need at most {found[2]} kB of stack." in (made.folder / f"{made.name}.h").read_text()
    return 1000 * float(found[2]), 1000 * float(found[1])


@pytest.mark.parametrize("name", mostly_slow(RECIPES, quick=["planar", "tendons", "robot", "loops", "pinned"]))
def test_stack_and_workspace(library: Library, name: str) -> None:
    made = library(name)
    stack, workspace = measured(made, *QUICK)
    said, said_workspace = stated(made)
    assert stack <= said <= MARGIN * stack + ROUNDING
    # A few bytes of padding, and the rounding of what is printed.
    assert abs(workspace - said_workspace) <= 100


@pytest.mark.parametrize("name", ["tiny", "robot"])
@pytest.mark.parametrize("optimised", mostly_slow(["-Os", "-O2", "-O3"], quick=["-O2"]))
def test_stack_of_optimised_code(library: Library, name: str, optimised: str) -> None:
    stack, _ = measured(library(name), optimised, "-fPIC")
    assert stack <= stated(library(name))[0]


def test_no_function_of_the_solver_has_a_large_frame(library: Library) -> None:
    """As the compiler counts it: what lies on the stack does not grow with the unknowns."""
    made = library("robot")
    target = made.scratch / "frames.o"
    run("gcc", "-std=c99", "-O2", "-fstack-usage", "-c", made.folder / "robot.c", "-o", target)
    frames = {
        line.split(":")[3].split()[0]: int(line.split()[1])
        for line in target.with_suffix(".su").read_text().splitlines()
    }
    solver = {name: size for name, size in frames.items() if not re.search("_(tip|shape|igm|body|evaluate)", name)}
    assert "robot_solve" in solver
    assert max(solver.values()) <= 600, solver
