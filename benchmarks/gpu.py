"""What a compiler makes of batches on a GPU: registers, memory of a thread, spills.

    python benchmarks/gpu.py --compile-only [--arch sm_90]

Without a GPU this is all that can be told; rows a second have to be measured on one, and nothing here does that.
"""

from __future__ import annotations

import argparse
import re
import shlex
import subprocess
import tempfile
import time
from pathlib import Path

from cosserat_casadi import export, read_scene, solve
from cosserat_casadi.codegen.device_batch import find_nvcc, load_batch
from cosserat_casadi.errors import ExportError
from cosserat_casadi.model.build import Model

EXAMPLES = Path(__file__).resolve().parents[1] / "examples"

SCENES = {
    "wire": ("nitinol_wire", False),
    "robot": ("two_section_robot", False),
    "platform": ("six_rod_platform", False),
    "wire, steps too": ("nitinol_wire", True),
}
"""Examples, and whether they are exported with motions."""

ENTRY = re.compile(r"Compiling entry function '_Z\d+(\w+?_rows)\w*'")
FRAME = re.compile(r"(\d+) bytes stack frame, (\d+) bytes spill stores, (\d+) bytes spill loads")
USED = re.compile(r"Used (\d+) registers")
SHARED = re.compile(r"(\d+) bytes smem")
CUMULATIVE = re.compile(r"(\d+) bytes cumulative stack size")

HEAD = ("scene", "kernel", "registers", "local B", "spill st. B", "spill ld. B", "shared B", "workspace kB", "nvcc s")


def resources(told: str) -> dict[str, list[int]]:
    """Registers, local memory, spilled stores and loads, shared memory of each kernel, as ptxas tells them."""
    found: dict[str, list[int]] = {}
    parts = re.split(r"(?=ptxas info\s+: Compiling entry function)", told)
    for part in parts:
        entry, frame, used = ENTRY.search(part), FRAME.search(part), USED.search(part)
        if entry is None or frame is None or used is None:
            continue
        shared, cumulative = SHARED.search(part), CUMULATIVE.search(part)
        local = int((cumulative or frame)[1])
        found[entry[1]] = [int(used[1]), local, int(frame[2]), int(frame[3]), int(shared[1]) if shared else 0]
    return found


def compiled(word: str, arch: str) -> list[tuple[str, ...]]:
    """Rows of the table of one scene."""
    example, moving = SCENES[word]
    solution = solve(read_scene(EXAMPLES / f"{example}.toml"))
    model = solution.model
    assert isinstance(model, Model)
    with tempfile.TemporaryDirectory() as made:
        folder = Path(made) / example
        export(model, folder, cuda=True, dynamics=moving)
        workspace = load_batch(folder, "host").workspace_size
        command = [*shlex.split(find_nvcc()), "-std=c++20", "-O2", f"-arch={arch}", "-Xptxas", "-v", "-cubin"]
        begun = time.perf_counter()
        done = subprocess.run(
            [*command, str(folder / f"{example}_batch.cu"), "-o", str(folder / "out")],
            capture_output=True,
            text=True,
            check=False,
        )
        took = time.perf_counter() - begun
    if done.returncode:
        raise SystemExit(done.stderr[-3000:])
    numbers = resources(done.stdout + done.stderr)
    return [(word, name, *map(str, own), f"{workspace / 1e3:.1f}", f"{took:.0f}") for name, own in numbers.items()]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--compile-only", action="store_true", required=True, help="compile, and run nothing")
    parser.add_argument("--arch", default="sm_90", help="of the GPU")
    parser.add_argument("scenes", nargs="*", choices=[*SCENES, []], help="by default all")
    arguments = parser.parse_args()
    try:
        find_nvcc()
    except ExportError as error:
        raise SystemExit(str(error)) from None
    print(" | ".join(HEAD))
    for word in arguments.scenes or SCENES:
        for row in compiled(word, arguments.arch):
            print(" | ".join(row), flush=True)


if __name__ == "__main__":
    main()
