"""Small scenes as exported folders, and those compiled: what the tests of the generated C share."""

from __future__ import annotations

import ctypes
import hashlib
import json
import os
import re
import shutil
import subprocess
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from cosserat_casadi import Compiled, Model, Scene, Solution, build, discretise, export, solve
from cosserat_casadi.codegen.names import Names, scene_names
from tests.conftest import c_flags
from tests.once import once
from tests.scenes import WEIGHT, push, rod, scene, three_cables

HARNESS = Path(__file__).parent / "harness"

C99 = ("-std=c99", "-Wall", "-Wextra", "-Wpedantic")
"""What hand-readable sources compile with, without a word from the compiler."""

GENERATED = (*C99, "-Wno-unused-parameter", "-Wno-unused-function")
"""The same for generated sources: their signatures are CasADi's, and so is what they may leave unused."""

QUICK = (*c_flags(), "-fPIC")
"""Flags of libraries that are run for what they compute."""

ARCH = {"rods": [rod("planar", intrinsic={"curvature": [0.0, 1.2, 0.0]})]}
PIN = {"rod": "rod", "kind": "pinned", "position": [np.sin(0.48) ** 2 / 0.6, 0.0, np.sin(0.96) / 1.2]}
KEYSTONE = {"name": "keystone", "kind": "point_wrench", "rod": "rod", "at": 0.6, "force": [4.0, 0.0, -2.0]}
PULL = {"name": "pull", "kind": "tip_wrench", "rod": "left", "force": [0.0, -0.8, 0.3], "moment": [0.2, 0.0, 0.0]}
PAIR = [
    rod("planar", name="left", length=0.5, base={"position": [1.0, 0.0, 0.0], "quaternion": [0.5, 0.5, 0.5, 0.5]}),
    rod(["bending_x", "extension"], name="right"),
]


TENDON = {"name": "pull", "kind": "tendon", "rod": "rod", "tension": 0.6, "offset": [0.02, 0.0]}
HELD = {"name": "held", "kind": "tendon", "rod": "rod", "length": 0.79, "offset": [-0.03, 0.0], "span": [0.0, 0.5]}
CHAMBER = {"name": "gas", "kind": "chamber", "rod": "rod", "pressure": 500.0, "area": 1e-4, "offset": [0.0, 0.02]}

ARMS = [
    rod("planar", name="left", base={"position": [0.1, 0.0, 0.0]}),
    rod("planar", name="right", base={"position": [-0.1, 0.0, 0.0]}),
    rod("planar", name="finger", length=0.3, base={"rod": "right", "at": 0.5}),
]
HAND = {"name": "hand", "mass": 0.1}
WRISTS = [
    {"body": "hand", "rod": "left", "kind": "fixed", "position": [0.1, 0.0, 0.0]},
    {"body": "hand", "rod": "right", "kind": "fixed", "position": [-0.1, 0.0, 0.0]},
]
LEGS = [
    rod("reissner", name="left", base={"position": [0.1, 0.0, 0.0]}),
    rod("reissner", name="right", base={"position": [-0.1, 0.0, 0.0]}),
]
LOAD = {"name": "load", "kind": "body_wrench", "body": "hand", "force": [0.2, 0.0, -0.3]}


@dataclass(frozen=True)
class Recipe:
    """A scene with a small discretisation."""

    scene: Scene
    modes: int
    nodes: int
    transport: str = "magnus4"
    dynamics: bool = False

    def model(self) -> Model:
        return build(self.scene, discretise(self.scene, self.modes, self.nodes, self.transport))


RECIPES = {
    "planar": Recipe(scene(push(force=[0.9, 0.0, -0.4]), strain="planar", title="Planar rod"), 3, 8),
    "tiny": Recipe(scene(push(force=[0.9, 0.0, -0.4], moment=[0.0, 0.3, 0.0]), strain="planar"), 2, 4),
    "spatial": Recipe(scene(push(frame="body", moment=[0.1, 0.2, 0.0]), WEIGHT), 3, 5),
    "thick": Recipe(scene(push(), WEIGHT, strain="reissner"), 2, 4),
    "pinned": Recipe(scene(WEIGHT, supports=[{**PIN, "position": [0.2, 0.15, 0.6]}]), 2, 5),
    "arch": Recipe(scene(KEYSTONE, supports=[PIN], **ARCH), 2, 5),
    "pair": Recipe(scene(PULL, WEIGHT, rods=PAIR), 2, 4),
    "fixed": Recipe(scene(push(force=[0.9, 0.0, -0.4]), strain="planar", inputs=[]), 2, 4),
    "tendons": Recipe(scene(push(), strain="reissner", actuators=[TENDON, HELD, CHAMBER]), 2, 4),
    "robot": Recipe(scene(LOAD, rods=ARMS, bodies=[HAND], joints=WRISTS), 2, 4),
    "gripper": Recipe(scene(LOAD, rods=LEGS, bodies=[HAND], joints=WRISTS), 2, 4),
    "cables": Recipe(three_cables(), 2, 4),
    "loops": Recipe(scene(push(force=[0.9, 0.0, -0.4]), strain="planar"), 2, 4, "permuted"),
}
"""Scenes by the name of their library: every strain model, supports, several rods, no inputs, loops in the kernels."""


@dataclass(frozen=True)
class Exported:
    """A model and the folder it was exported to.

    Attributes:
        name: the library.
        model: what was exported.
        folder: the sources.
        scratch: where objects and programs go.
    """

    name: str
    model: Model
    folder: Path
    scratch: Path

    @property
    def names(self) -> Names:
        return scene_names(self.name, self.model.scene)

    @property
    def length(self) -> float:
        return max(rod.length for rod in self.model.scene.rods)

    @cached_property
    def compiled(self) -> Compiled:
        """The solver in this process, without the derivatives, which take the compiler longest."""
        library = self.link([], "-shared", *QUICK)
        return Compiled(library, self.manifest)

    @cached_property
    def manifest(self) -> dict[str, Any]:
        found: dict[str, Any] = json.loads((self.folder / "manifest.json").read_text())
        return found

    @cached_property
    def handle(self) -> ctypes.CDLL:
        return ctypes.CDLL(str(self.compiled.library))

    @cached_property
    def demo(self) -> Path:
        """The demo program."""
        return self.link([self.folder / f"{self.name}_demo.c"], *QUICK)

    def objects(self, *flags: str) -> list[Path]:
        """The library's two sources, compiled."""
        made = []
        for stem in (self.name, f"{self.name}_kernels"):
            source, target = self.folder / f"{stem}.c", self.scratch / f"{stem}-{_digest(flags)}.o"
            once(target, lambda *files: _compile(*files, *flags), source)
            made.append(target)
        return made

    def warnings(self, *flags: str) -> str:
        """What gcc says of the library's two sources as it reads them; it writes no object."""
        said = []
        for stem in (self.name, f"{self.name}_kernels"):
            done = attempt("gcc", *GENERATED, *flags, "-fsyntax-only", self.folder / f"{stem}.c")
            assert done.returncode == 0, done.stderr
            said.append(done.stderr)
        return "".join(said)

    def link(self, sources: Sequence[Path | str], *flags: str, others: Sequence[Exported] = ()) -> Path:
        """A program of these sources and the library, or with ``-shared`` the library alone."""
        # Warnings are asked for of the sources: objects of the library are the same with and without.
        compiled = [flag for flag in flags if flag != "-shared" and not flag.startswith("-W")]
        objects = [path for one in (self, *others) for path in one.objects(*compiled)]
        target = self.scratch / f"{self.name}-{_digest([*flags, *map(str, [*sources, *objects])])}"
        include = [f"-I{one.folder}" for one in (self, *others)]
        once(target, lambda path: gcc("-std=c99", *flags, *include, *sources, *objects, "-lm", "-o", path))
        return target

    def program(self, harness: str, *flags: str) -> Path:
        """A program of the folder ``harness``, with the names of this library filled in."""
        return self.link([self.source(harness)], *flags)

    def source(self, harness: str) -> Path:
        """A source of the folder ``harness``, with the names of this library filled in."""
        words = {"name": self.name, "MACRO": self.names.macro}
        text = re.sub(r"@\{(\w+)\}", lambda match: words[match[1]], (HARNESS / harness).read_text())
        source = self.scratch / f"{self.name}_{harness}"
        once(source, lambda path: path.write_text(text))
        return source

    def whole_program(self, harness: str, *flags: str) -> Path:
        """A program of the folder ``harness`` that includes the library's own source, and so sees what is static."""
        kernels = self.objects(*QUICK)[1]
        target = self.scratch / f"{self.name}-{_digest([harness, *flags])}"
        source = self.source(harness)
        words = ("-std=c99", *flags, f"-I{self.folder}", source, kernels, "-lm", "-o")
        once(target, lambda path: gcc(*words, path))
        return target

    def solve(self, inputs: np.ndarray, start: np.ndarray | None = None) -> Solution:
        """Equilibrium by the solver in Python, without an estimate of its error."""
        return solve(self.model, self.model.inputs.unpack(inputs), start=start, estimate_error=False)

    def tips(self, q: np.ndarray, inputs: np.ndarray) -> np.ndarray:
        """Tip positions of all rods, shape (rods, 3)."""
        return np.array([tip(q, inputs)[0].full()[:, 0] for tip in self.model.tip.values()])

    def loads(self, count: int, seed: int, scale: float = 1.0) -> np.ndarray:
        """Random inputs about the scene's own, shape (count, size)."""
        rng = np.random.default_rng(seed)
        return scale * rng.uniform(-2.0, 2.0, (count, self.model.inputs.size))


class HasModel(Protocol):
    """What a library is made from."""

    @property
    def dynamics(self) -> bool: ...

    def model(self) -> Model: ...


def exported(name: str, recipe: HasModel, folder: Path, *, estimates: bool = True) -> Exported:
    """Export a recipe below a folder; processes that share the folder share the work.

    Libraries with motions have no estimates of errors, which are those of statics and take as long again.
    """
    estimated = estimates and not recipe.dynamics
    model, scratch = recipe.model(), folder / f"{name}-build"
    scratch.mkdir(parents=True, exist_ok=True)
    options = {"dynamics": recipe.dynamics, "estimate_errors": estimated}
    once(folder / name, lambda path: export(model, path, name, **options))
    return Exported(name, model, folder / name, scratch)


def _compile(source: Path, target: Path, *flags: str) -> None:
    # Flags of one compiler may be none of another; definitions of macros are those of both.
    own = [flag for flag in flags if not flag.startswith("-D")]
    compiler = os.environ["CC"] if tuple(own) == QUICK else "gcc"
    run(compiler, "-std=c99", "-w", *flags, "-c", source, "-o", target)


def _digest(words: Sequence[str]) -> str:
    return hashlib.sha256("\0".join(words).encode()).hexdigest()[:12]


def gcc(*words: str | Path) -> None:
    """Run the compiler; what it says is the message of a failure."""
    run("gcc", *words)


def compile_quickly(*words: str | Path) -> None:
    """Run the compiler that takes least time over C that is run for its digits."""
    run(os.environ["CC"], *words)


def run(*words: str | Path, expect: int = 0, cwd: Path | None = None, timeout: float = 300) -> str:
    """Run a program; what it prints, once it ended as expected."""
    done = attempt(*words, cwd=cwd, timeout=timeout)
    shown = " ".join(map(str, words))
    assert done.returncode == expect, (
        f"{shown}\nended with {done.returncode}:\n{done.stdout[-3000:]}{done.stderr[-5000:]}"
    )
    return done.stdout


def attempt(*words: str | Path, cwd: Path | None = None, timeout: float = 300) -> subprocess.CompletedProcess[str]:
    """Run a program, however it ends."""
    missing = f"these tests need {words[0]} on the path"
    assert shutil.which(str(words[0])), missing
    return subprocess.run([*map(str, words)], capture_output=True, text=True, check=False, cwd=cwd, timeout=timeout)
