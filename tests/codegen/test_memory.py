"""Stack and workspace are what header and README say: measured on a painted stack."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import pytest

from cosserat_casadi import export
from cosserat_casadi.codegen.memory import FRAMES, stack_bytes
from tests.codegen.libraries import HARNESS, QUICK, RECIPES, Exported, run
from tests.families import mostly_slow

Library = Callable[[str], Exported]

MARGIN, ROUNDING = 1.6, 1000
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


@pytest.mark.parametrize("name", mostly_slow(RECIPES, quick=["planar"]))
def test_stack_and_workspace(library: Library, name: str) -> None:
    made = library(name)
    stack, workspace = measured(made, *QUICK)
    said, said_workspace = stated(made)
    assert stack <= said <= MARGIN * stack + ROUNDING
    # A few bytes of padding, and the rounding of what is printed.
    assert abs(workspace - said_workspace) <= 100


@pytest.mark.slow
@pytest.mark.parametrize("name", ["tiny", "robot"])
@pytest.mark.parametrize("optimised", ["-Os", "-O2", "-O3"])
def test_stack_of_optimised_code(library: Library, name: str, optimised: str) -> None:
    stack, _ = measured(library(name), optimised, "-fPIC")
    assert stack <= stated(library(name))[0]


@pytest.mark.slow
@pytest.mark.parametrize("name", ["planar", "tiny", "spatial", "thick"])
def test_stack_of_batches(name: str, tmp_path: Path) -> None:
    """Each number of a kernel in lanes is four; the stack that lanes need is that of no other function."""
    model = RECIPES[name].model()
    made = Exported(name, model, export(model, tmp_path / name, name, batches=True), tmp_path)
    words = {"name": name, "MACRO": made.names.macro}
    harness = (HARNESS / "stack.c").read_text()
    program = tmp_path / "stack.c"
    program.write_text(re.sub(r"@\{(\w+)\}", lambda match: words[match[1]], harness))
    sources = [made.folder / f"{name}{part}.c" for part in ("", "_kernels", "_lanes")]
    flags = ("-O0", "-std=gnu99", "-pthread", "-Wl,-z,now", "-DBATCHES", f"-I{made.folder}")
    run("gcc", *flags, program, *sources, "-lm", "-o", tmp_path / "stack")
    stack = int(run(tmp_path / "stack").split()[0])
    found = re.search(r"at a time\. It needs up to\s+([\d.]+) kB of stack", (made.folder / f"{name}.h").read_text())
    assert found is not None
    said = 1000 * float(found[1])
    assert f"{name}_solve_batch {found[1]} kB" in (made.folder / "README.md").read_text()
    assert stack <= said <= MARGIN * stack + ROUNDING


@pytest.mark.slow
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


def test_only_the_deepest_call_counts() -> None:
    """Of one kernel 2 + 4 numbers lie on the stack, of the other 1 and its room; frames of two calls do not add."""
    source = """
static int casadi_f1(const casadi_real** arg, casadi_real* w) {
  casadi_real a0, a1, a2, a3;
  return 0;
}
static int casadi_f2(const casadi_real** arg, casadi_real* w) {
  casadi_real a0, a1, a2;
  return 0;
}
static int casadi_f0(const casadi_real** arg, casadi_real* w) {
  casadi_real a0, a1;
  if (casadi_f1(arg, w)) return 1;
  if (casadi_f2(arg, w)) return 1;
  return 0;
}
CASADI_SYMBOL_EXPORT int rod_k_residual_0(const casadi_real** arg, casadi_real* w) {
  return casadi_f0(arg, w);
}
CASADI_SYMBOL_EXPORT int rod_k_tip(const casadi_real** arg, casadi_real* w) {
  casadi_real a0;
  return 0;
}
KERNEL(casadi_f0)
"""
    header = "#define rod_k_residual_0_SZ_W 100\n#define rod_k_tip_SZ_W 7\n"
    generated = {"rod_kernels.c": source, "rod_kernels.h": header}
    assert stack_bytes(generated) == FRAMES + 8 * 6
    assert stack_bytes(generated, {"rod_k_tip"}) == FRAMES + 8 * 8
