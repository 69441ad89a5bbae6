"""The folders in generated/ are what this version writes: drift of the generated C shows in a diff.

`make generated` writes them anew. By default each is rebuilt from its own scene and discretisation, without solving,
and every file is compared. Large files of large folders are held by their hashes, in hashes.json, beside the tip that
their C computes. Constants in the kernels carry the rounding of the linear algebra that made them, which another
processor does differently: there, and with another CasADi, the kernels are compared by what they compute.
"""

from __future__ import annotations

import hashlib
import json
import os
import re
import shutil
import subprocess
from collections.abc import Collection
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import (
    Compiled,
    Discretisation,
    Model,
    Solution,
    build,
    export,
    load,
    parse_scene,
    read_scene,
    solve,
)
from cosserat_casadi.codegen.export import folder_files
from cosserat_casadi.codegen.folder import check_folder, write_folder
from cosserat_casadi.codegen.manifest import MANIFEST
from cosserat_casadi.model.discretise import with_discretisation
from tests.conftest import ROOT, quickest_compiler
from tests.families import mostly_slow

FOLDER = ROOT / "generated"

ARITHMETIC = "arithmetic.txt"
"""Name of the file that tells which rounding the constants in the kernels have."""

HASHES = "hashes.json"
"""Name of the file with the hashes of what is not kept, and with the tips of those folders."""

LARGEST = 50_000
"""Bytes of the largest file that is kept of a folder in HASHED."""

COARSE = ("accuracy.tolerance=1e-4",)
"""Small enough to be kept and read."""

LEGS = (
    "accuracy.tolerance=1e-3",
    "inputs=" + str(["hand.force", "hand.moment", *(f"leg_{i}.length" for i in range(1, 7))]).replace("'", '"'),
)
"""A parallel robot is driven by the lengths of its legs."""

GENERATED = {
    "planar_strip": ("planar_strip.toml", COARSE),
    "nitinol_wire": ("nitinol_wire.toml", COARSE),
    "follower_reissner": ("follower_reissner.toml", COARSE),
    "precurved_tube": ("precurved_tube.toml", COARSE),
    "tendon_robot": ("two_section_robot.toml", COARSE),
    "six_rod_platform": ("six_rod_platform.toml", LEGS),
}
"""Scene file and overrides of each folder."""

HASHED = {"tendon_robot", "six_rod_platform"}
"""Folders whose large files are held by hashes."""

WITH_DERIVATIVES = {"nitinol_wire"}
"""Folders that can be loaded with derivatives."""

ANEW = "run `make generated` and commit what it writes"

COMPILER = shutil.which(quickest_compiler())


def arithmetic() -> str:
    """Fingerprint of the rounding of NumPy's linear algebra and functions on this machine."""
    random, digest = np.random.default_rng(0), hashlib.sha256()
    for size in range(2, 41):
        a, b = random.standard_normal((2, size, size))
        wide = a[: size // 2 + 1]
        for result in (a @ b, a @ b[:, 0], wide @ b, wide @ wide.T, np.linalg.solve(a, b), np.cos(a), np.sin(a)):
            digest.update(result.tobytes())
    # Assemblies have systems in which a BLAS with several threads rounds differently.
    for size in (64, 100, 139, 200, 256):
        a, b = random.standard_normal((2, size, size))
        for result in (a @ b, np.linalg.solve(a, b[:, :13]), np.linalg.solve(a, b)):
            digest.update(result.tobytes())
    return digest.hexdigest()


def files_of(model: Model, name: str, error_estimate: float | None) -> dict[str, str]:
    """What this version writes of a folder, by name."""
    return folder_files(model, name, error_estimate, derivatives=name in WITH_DERIVATIVES)


def is_hashed(folder: str, text: str) -> bool:
    """Whether a file is held by its hash."""
    return folder in HASHED and len(text) > LARGEST


def hash_of(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()


def write() -> None:
    """Solve every scene for its discretisation and write its folder; remove those that are no longer wanted."""
    FOLDER.mkdir(exist_ok=True)
    hashed: dict[str, Any] = {}
    for name, (file, overrides) in GENERATED.items():
        solution = solve(read_scene(ROOT / "examples" / file, overrides))
        assert solution.converged, solution.message
        found = write_one(solution, name, solution.error_estimate)
        if name in HASHED:
            hashed[name] = found
    for stale in (path for path in FOLDER.iterdir() if path.is_dir() and path.name not in GENERATED):
        for file in check_folder(stale):
            (stale / file).unlink()
        stale.rmdir()
    (FOLDER / HASHES).write_text(json.dumps(hashed, indent=1) + "\n")
    (FOLDER / ARITHMETIC).write_text(arithmetic() + "\n")


def write_one(solution: Solution, name: str, error_estimate: float | None) -> dict[str, Any]:
    """Write one folder; hashes of the files that are not kept, and the tip of the first rod."""
    files = files_of(solution.model, name, error_estimate)
    kept = {file: text for file, text in files.items() if not is_hashed(name, text)}
    write_folder(FOLDER / name, kept, check_folder(FOLDER / name))
    hashes = {file: hash_of(text) for file, text in files.items() if file not in kept}
    tip = solution.tip(solution.model.scene.rods[0].name).position
    return {"sha256": hashes, "tip": [float(f"{value:.12g}") for value in tip]}


@pytest.fixture(scope="session")
def generated(pytestconfig: pytest.Config) -> Path:
    if pytestconfig.getoption("--update-generated"):
        write()
    if not FOLDER.is_dir():
        pytest.fail(f"the folder generated/ is missing: {ANEW}", pytrace=False)
    return FOLDER


LARGE = {"six_rod_platform", "follower_reissner"}
"""Folders that take seconds to write and compile, and are like others: `make test-slow` checks them."""


@pytest.fixture(params=[pytest.param(name, marks=[pytest.mark.slow] * (name in LARGE)) for name in GENERATED])
def folder(request: pytest.FixtureRequest, generated: Path) -> Path:
    found: Path = generated / request.param
    if not (found / MANIFEST).is_file():
        pytest.fail(f"generated/{request.param} is missing or has no {MANIFEST}: {ANEW}", pytrace=False)
    return found


def manifest(folder: Path) -> dict[str, Any]:
    described: dict[str, Any] = json.loads((folder / MANIFEST).read_text(encoding="utf-8"))
    return described


def rebuilt(folder: Path) -> Model:
    """The model of a folder, from its scene and the discretisation in its manifest."""
    chosen = {
        rod: Discretisation(**{**kept, "modes": tuple(kept["modes"]), "breaks": tuple(kept["breaks"])})
        for rod, kept in manifest(folder)["discretisation"].items()
    }
    return build(parse_scene((folder / "scene.toml").read_text(encoding="utf-8")), chosen)


def is_kernel(name: str) -> bool:
    """Whether a file holds constants that linear algebra made."""
    return name.endswith(("_kernels.c", "_derivatives.c", "_in_fours.h"))


COUNTS = re.compile(r"(?<=_SZ_W )\d+|(?<=kernel_reals\[)\d+|[\d.]+(?= kB)|(?<=\"instructions\": )\d+")
"""Numbers of instructions, and of the memory for what they leave to later ones.

CasADi computes equal expressions once. Constants that are equal but for their rounding, as in the sums of symmetric
rows, are equal on one machine and not on the next, so that a few instructions in a thousand come or go.
"""

COUNTS_AGREE = 0.04
"""Share that counts may differ by: twice the most that was met, 16 of 743 instructions on a processor of AMD."""

REALS = re.compile(r"(?<=\(real\))-?\d+\.\d+(?:e[-+]?\d+)?")
"""Constants of tables in C, such as the turns of the tip by each mode."""

REALS_AGREE = 1e-12
"""Share that these constants may differ by, some thousand times their rounding."""


def is_same_but_for_rounding(one: str, other: str) -> bool:
    """Whether texts differ in nothing but constants and numbers of instructions, and in those by little."""
    if COUNTS.sub("#", REALS.sub("#", one)) != COUNTS.sub("#", REALS.sub("#", other)):
        return False
    return all(
        np.allclose(*(np.array(numbers.findall(text), dtype=float) for text in (one, other)), rtol=share, atol=0)
        for numbers, share in ((COUNTS, COUNTS_AGREE), (REALS, REALS_AGREE))
    )


def differing(committed: dict[str, str], fresh: dict[str, str], exact: bool, hashes: Collection[str] = ()) -> list[str]:
    """What is wrong with the committed files, one line each.

    Args:
        committed: texts by name, or the hashes of some.
        fresh: the same, as this version writes it.
        exact: whether linear algebra rounds here as it did there.
        hashes: names of the files whose hashes are given.
    """
    lines = [f"{name} is missing" for name in sorted(fresh.keys() - committed.keys())]
    lines += [f"{name} is stale: this version does not write it" for name in sorted(committed.keys() - fresh.keys())]
    for name in sorted(fresh.keys() & committed.keys()):
        if not exact and (is_kernel(name) or name in hashes):
            continue
        one, other = committed[name], fresh[name]
        if one != other and (exact or not is_same_but_for_rounding(one, other)):
            lines.append(f"{name} differs from what this version writes")
    return lines


def test_every_folder_is_one_of_the_table(generated: Path) -> None:
    found = {path.name for path in generated.iterdir()}
    wrong = sorted(found ^ {*GENERATED, ARITHMETIC, HASHES})
    assert not wrong, f"missing or stale in generated/: {', '.join(wrong)}; {ANEW}"


def test_scene_is_that_of_the_example(folder: Path) -> None:
    file, overrides = GENERATED[folder.name]
    committed = parse_scene((folder / "scene.toml").read_text(encoding="utf-8"))
    example = read_scene(ROOT / "examples" / file, overrides)
    if committed != with_discretisation(example, rebuilt(folder).discretisation):
        pytest.fail(f"examples/{file} is not the scene in generated/{folder.name}: {ANEW}", pytrace=False)


def test_files_are_what_this_version_writes(folder: Path, generated: Path) -> None:
    described = manifest(folder)
    theirs, ours = described["versions"]["casadi"], ca.CasadiMeta.version()
    if theirs != ours:
        pytest.skip(f"generated/{folder.name} was written with CasADi {theirs}, this is {ours}")
    exact = (generated / ARITHMETIC).read_text().strip() == arithmetic()
    model = rebuilt(folder)
    fresh = files_of(model, described["name"], described["error_estimate"])
    committed = {path.name: path.read_text(encoding="utf-8") for path in folder.iterdir()}
    hashes = hashed(generated, folder.name)["sha256"]
    assert hashes.keys().isdisjoint(committed)
    # A hash stands for a text: the fresh one is hashed where a committed one is.
    compared = {name: hash_of(text) if is_hashed(folder.name, text) else text for name, text in fresh.items()}
    wrong = differing(committed | hashes, compared, exact, hashes)
    if wrong:
        pytest.fail("\n".join([f"generated/{folder.name}: {ANEW}", *wrong]), pytrace=False)
    if not exact and folder.name not in HASHED:
        assert_same_values(load(folder), model)


def assert_same_values(loaded: Compiled, model: Model) -> None:
    """Every function of a library gives what the model gives, at zero and at random; it may leave out last results."""
    random = np.random.default_rng(3)
    pairs = [(loaded.residual, model.residual, ())]
    for of_library, of_model, place in (
        (loaded.tip, model.tip, ()),
        (loaded.shape, model.shape, (0.4,)),
        (loaded.actuator, model.actuator, ()),
    ):
        assert of_library.keys() == of_model.keys()
        pairs += [(of_library[name], of_model[name], place) for name in of_model]
    for spread in (0.0, 0.5):
        x = spread * random.standard_normal(model.size)
        inputs = model.pack() * (1 + spread * random.standard_normal(model.inputs.size))
        for ours, theirs, place in pairs:
            found = np.concatenate([value.full().ravel() for value in ours.call([x, inputs, *place])])
            results = theirs.call([x, inputs, *place])[: ours.n_out()]
            wanted = np.concatenate([value.full().ravel() for value in results])
            assert_allclose(found, wanted, rtol=1e-11, atol=1e-12 * max(1.0, np.abs(wanted).max()))


def hashed(generated: Path, name: str) -> dict[str, Any]:
    """What is held of a folder by hashes, and its tip; nothing of most folders."""
    held: dict[str, dict[str, Any]] = json.loads((generated / HASHES).read_text())
    return held.get(name, {"sha256": {}, "tip": None})


@pytest.mark.skipif(COMPILER is None, reason="there is no C compiler")
@pytest.mark.parametrize("folder", mostly_slow(GENERATED, quick=["planar_strip"]), indirect=True)
def test_committed_sources_give_the_tip_of_this_version(folder: Path, generated: Path, tmp_path: Path) -> None:
    """Compiled as their README says but for the optimisation, which takes longer than the run.

    Of a folder that is held by hashes, what this version writes is compiled: its tip is that of the committed one.
    """
    solution, name = solve(rebuilt(folder)), manifest(folder)["name"]
    assert solution.converged
    if name in HASHED:
        held = hashed(generated, name)["tip"]
        tip = solution.tip(solution.model.scene.rods[0].name).position
        assert_allclose(tip, held, rtol=0, atol=1e-9 * solution.model.scene.rods[0].length)
        folder = export(solution.model, tmp_path / "whole", name)
    sources = [str(folder / f"{name}{part}.c") for part in ("_demo", "", "_kernels")]
    program = str(tmp_path / "program")
    subprocess.run([os.environ["CC"], *sources, "-lm", "-o", program], check=True, timeout=300)
    printed = subprocess.run([program, "--repeat", "1"], capture_output=True, text=True, check=True, timeout=60)
    result = json.loads(printed.stdout)
    assert result["status"] == "converged"
    length = solution.model.scene.rods[0].length
    assert_allclose(result["tip"], solution.tip(solution.model.scene.rods[0].name).position, rtol=0, atol=1e-9 * length)


def test_generated_folders_are_small(generated: Path) -> None:
    """What changes with every constant weighs on the history of the repository."""
    total = sum(path.stat().st_size for path in generated.rglob("*") if path.is_file())
    assert total <= 3_000_000


# The comparison itself


def test_missing_stale_and_changed_files_are_named() -> None:
    fresh = {"a.h": "1", "a_kernels.c": "x=0.1;", MANIFEST: '"instructions": 1000'}
    assert differing(fresh, fresh, True) == []
    assert differing({**fresh, "b.h": ""}, fresh, True) == ["b.h is stale: this version does not write it"]
    assert differing({"a.h": "1", MANIFEST: fresh[MANIFEST]}, fresh, False) == ["a_kernels.c is missing"]
    assert differing({**fresh, "a.h": "2"}, fresh, False) == ["a.h differs from what this version writes"]
    rounded = {**fresh, "a_kernels.c": "x=0.2;", MANIFEST: '"instructions": 1005'}
    assert differing(rounded, fresh, False) == []
    assert [line.split()[0] for line in differing(rounded, fresh, True)] == ["a_kernels.c", MANIFEST]


@pytest.mark.parametrize(
    ("one", "other"),
    [
        ('"instructions": 2238', '"instructions": 2235'),
        ("#define wire_k_igm_SZ_W 625", "#define wire_k_igm_SZ_W 621"),
        ("wire_real kernel_reals[2232];", "wire_real kernel_reals[2230];"),
        ("A workspace takes 31.7 kB in double precision", "A workspace takes 31.6 kB in double precision"),
    ],
)
def test_counts_that_hang_on_rounding_may_differ_by_little(one: str, other: str) -> None:
    assert is_same_but_for_rounding(one, other)
    ours, theirs = (COUNTS.findall(text) for text in (one, other))
    assert len(ours) == len(theirs) == 1
    twice = str(2 * float(ours[0])) if "." in ours[0] else str(2 * int(ours[0]))
    assert not is_same_but_for_rounding(one.replace(ours[0], twice), other)
    assert not is_same_but_for_rounding(one + " ", other)


def test_constants_may_differ_by_their_rounding() -> None:
    table = "table[] = {(real)0.8671099695241197, (real)-3.5e-06};"
    assert is_same_but_for_rounding(table, table.replace("241197", "2412"))
    assert not is_same_but_for_rounding(table, table.replace("241197", "3"))
    assert not is_same_but_for_rounding(table, table.replace("-3.5", "-3.6"))
    assert not is_same_but_for_rounding(table, table.replace("(real)-3.5e-06", "(real)-3.5e-06, (real)1.0"))


@pytest.mark.parametrize("text", ["_SZ_IW 4", "_SZ_ARG 3", '"first": 12', "double tension[10];", "CasADi 3.8.2"])
def test_other_numbers_are_no_counts(text: str) -> None:
    assert not COUNTS.findall(text)


def test_a_changed_hash_is_named() -> None:
    fresh = {"robot_kernels.c": hash_of("x=0.1;"), MANIFEST: json.dumps({"functions": []})}
    wrong = differing({**fresh, "robot_kernels.c": hash_of("x=0.2;")}, fresh, True)
    assert wrong == ["robot_kernels.c differs from what this version writes"]
    assert differing({**fresh, "robot.c": "1"}, {**fresh, "robot.c": "2"}, False, ["robot.c"]) == []
    assert is_hashed("six_rod_platform", "x" * (LARGEST + 1))
    assert not is_hashed("six_rod_platform", "x" * LARGEST)
    assert not is_hashed("planar_strip", "x" * (LARGEST + 1))


def test_arithmetic_is_the_same_every_time() -> None:
    assert arithmetic() == arithmetic()


@pytest.mark.slow
def test_six_legs_share_their_code(generated: Path) -> None:
    """The platform's sources stay within 1.5 MB: six legs that compute alike are one piece of code."""
    name = "six_rod_platform"
    files = files_of(rebuilt(generated / name), name, None)
    sources = [text for file, text in files.items() if file.endswith(".c")]
    assert sum(map(len, sources)) < 1_500_000
