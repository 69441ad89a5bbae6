"""A stack that a debugger shows can be read: how deep the calls of the package go, and how many modules they enter."""

from __future__ import annotations

import subprocess
import sys

from tests.conftest import ROOT

DEEPEST = 25
"""Most functions of the package that call one another while a scene is solved."""

MOST_MODULES = 89
"""Most modules of the package in which a function is called meanwhile."""

# In a new process, where first calls build what later calls use. Comprehensions are no calls from Python 3.12 on.
PROGRAM = """
import sys
from pathlib import Path
from cosserat_casadi import read_scene, solve

ROOT = str(Path("cosserat_casadi").resolve())
scene = read_scene("examples/nitinol_wire.toml")
stack, modules, deepest = [], set(), 0

def watch(frame, event, argument):
    global deepest
    if event == "call":
        code = frame.f_code
        inside = code.co_filename.startswith(ROOT) and code.co_name not in ("<listcomp>", "<dictcomp>", "<setcomp>")
        stack.append(inside)
        if inside:
            modules.add(code.co_filename)
            deepest = max(deepest, sum(stack))
    elif event == "return" and stack:
        stack.pop()

sys.setprofile(watch)
solve(scene)
sys.setprofile(None)
print(deepest, len(modules))
"""


def test_calls_of_a_solve_stay_readable() -> None:
    done = subprocess.run([sys.executable, "-c", PROGRAM], cwd=ROOT, capture_output=True, text=True, check=True)
    deepest, modules = map(int, done.stdout.split())
    assert deepest <= DEEPEST
    assert modules <= MOST_MODULES
