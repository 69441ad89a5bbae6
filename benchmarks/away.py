"""What estimates of errors are worth where inputs go: random inputs of many scenes, modes chosen for the scene's own.

The true error is the distance to the equilibrium on many more modes and intervals, on the same branch. Each answer is
judged in Python and, where it has an estimate, in compiled C. `--write` puts the table into docs/accuracy.md; `--log
FILE` keeps one line a scene, and goes on from there; `--folder` names scenes beside the examples.
"""

from __future__ import annotations

import json
import sys
import tempfile
import time
from collections.abc import Iterator
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer
from doc_tables import put, table

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from cosserat_casadi import (  # noqa: E402
    Compiled,
    Model,
    Scene,
    Solution,
    build,
    discretise,
    export,
    load,
    read_scene,
    scene_from_dict,
    solve,
)
from cosserat_casadi.accuracy.refine import solve_rods  # noqa: E402
from cosserat_casadi.codegen.contact.compiled import CompiledContact  # noqa: E402
from cosserat_casadi.equilibrium.answer_error import (  # noqa: E402
    UNKNOWN,
    believed_correction,
    richer_unknowns,
    with_error_estimate,
)
from cosserat_casadi.equilibrium.metrics import cable_distance, pose_distance, prolong  # noqa: E402
from cosserat_casadi.errors import CosseratError, ExportError  # noqa: E402
from cosserat_casadi.maths.typing import FloatArray  # noqa: E402
from cosserat_casadi.model.watched import SAMPLES  # noqa: E402
from cosserat_casadi.page.slider_ranges import sliders  # noqa: E402
from tests.reference.assembled_scenes import assembled_scene  # noqa: E402
from tests.reference.random_scenes import random_scene  # noqa: E402

PAGE = ROOT / "docs" / "accuracy.md"
BEGIN, END = "<!-- away: written by benchmarks/away.py -->", "<!-- end of away -->"
EXAMPLES = ROOT / "examples"
TEMPLATES = ROOT / "cosserat_casadi" / "cli" / "templates"
SINGLE_RODS = range(4)
"""Seeds of random rods without tendons."""
ROBOTS = range(10)
"""Seeds of random assemblies with tendons."""
WITH_PARAMETERS = range(4)
"""Of these the bending stiffnesses of all rods about x are parameters."""
SOFTEST, STIFFEST = 0.8, 1.25
"""Factors on parameters."""
TOLERANCE = 1e-4
"""Of random scenes."""
MORE_MODES, MORE_NODES = 8, 16
"""What the reference has more than the answer."""
FARTHEST = 2.0
"""Outside, inputs lie up to as many times as far from the middle of the range as its ends."""
LEAST, MOST = 0.7, 3.0
"""Ratios of estimate and true error that are wanted."""
SEEN = 0.1
"""Share of the tolerance above which a ratio of estimate and true error counts."""
SAME = 1e-6
"""Relative distance of unknowns within which two equilibria are one."""
KNOWN = 0.2
"""Largest error of a reference, relative to the true error, that still decides."""


@dataclass(frozen=True)
class Case:
    """One answer at random inputs.

    Attributes:
        inside: whether the inputs are in the range.
        tolerance: of the scene.
        true: error of the answer.
        estimate: of that error.
        told: whether the estimate is above the tolerance.
        in_c: the estimate in C of the equilibrium that C finds; None where it finds another one, or has no estimate.
        cost: time of the estimate over that of the solve; NaN where they are not apart.
        inputs: stacked.
        decided: whether the reference is exact enough; asked only where the answer is silent or the estimate far off.
    """

    inside: bool
    tolerance: float
    true: float
    estimate: float
    told: bool
    cost: float
    inputs: list[float]
    in_c: float | None = None
    decided: bool = True

    @property
    def is_silent(self) -> bool:
        """Whether the error is beyond the tolerance, and not told."""
        return self.decided and self.true > self.tolerance and not self.told

    @property
    def is_silent_in_c(self) -> bool:
        """Whether C does not tell an error beyond the tolerance."""
        told = self.in_c is None or not self.in_c <= self.tolerance
        return self.decided and self.true > self.tolerance and not told

    @property
    def ratio(self) -> float | None:
        """Estimate over true error; None where the error hardly counts, or the estimate says that it is not known."""
        if not self.decided or self.true < SEEN * self.tolerance or self.estimate >= UNKNOWN:
            return None
        return self.estimate / self.true


def scenes(folder: Path | None = None) -> Iterator[tuple[str, Scene]]:
    """Names and scenes: examples, templates, random rods and robots; scenes that do not rest under loads left out.

    Args:
        folder: of scenes beside these.
    """
    beside = [] if folder is None else sorted(folder.glob("*.toml"))
    for path in (*sorted(EXAMPLES.glob("*.toml")), *sorted(TEMPLATES.glob("*.toml")), *beside):
        scene = read_scene(path)
        if isinstance(scene, Scene) and scene.simulation is None:
            yield path.stem, scene
    accuracy = {"accuracy": {"tolerance": TOLERANCE}}
    for seed in SINGLE_RODS:
        yield f"random rod {seed}", scene_from_dict({**random_scene(seed), **accuracy})
    for seed in ROBOTS:
        tables = {**assembled_scene(seed, tendons=True), **accuracy}
        if seed in WITH_PARAMETERS:
            tables["parameters"] = [f"{rod['name']}.stiffness.bending_x" for rod in tables["rods"]]
        yield f"random robot {seed}", scene_from_dict(tables)


@dataclass(frozen=True)
class Subject:
    """A model whose answers are judged.

    Attributes:
        model: on the modes of the scene's own inputs.
        finer: that gives the reference.
        in_c: the model in C; None where there is none.
        parameters: that are bound in the models; none where the scene has none.
    """

    model: Model
    finer: Model
    in_c: Compiled | CompiledContact | None
    parameters: FloatArray

    def at_random_parameters(self, rng: np.random.Generator) -> Subject:
        """The same at parameters next to those of the scene; itself where it has none."""
        own = self.model.parameters.pack()
        if not own.size:
            return self
        parameters = own * rng.uniform(SOFTEST, STIFFEST, own.size)
        model = self.model.at(parameters)
        return Subject(model, _finer(model), self.in_c, parameters)


def cases_of(scene: Scene, points: int) -> list[Case]:
    """Answers of a scene at random inputs, of which one in six lies outside of the range."""
    first = solve_rods(scene)
    if not first.converged:
        return []
    model = build(scene, first.model.discretisation)
    if not model.inputs.size:
        return []
    rng = np.random.default_rng(len(model.pack()))
    with tempfile.TemporaryDirectory() as folder:
        in_c = _in_c(model, Path(folder) / "robot")
        subject = Subject(model, _finer(model), in_c, model.parameters.pack())
        found = [_case(subject, rng, inside=k % 6 != 5) for k in range(points)]
    return [case for case in found if case is not None]


def _in_c(model: Model, folder: Path) -> Compiled | CompiledContact | None:
    """The model in C; None where C does not have its exact contact."""
    try:
        in_c = load(export(model, folder, "robot"))
    except ExportError:
        return None
    assert isinstance(in_c, (Compiled, CompiledContact))
    return in_c


def _finer(model: Model) -> Model:
    modes = max(max(chosen.modes) for chosen in model.discretisation.values())
    nodes = max(chosen.nodes for chosen in model.discretisation.values())
    scene = model.scene.baked()
    return build(scene, discretise(scene, modes + MORE_MODES, nodes + MORE_NODES, "magnus8"))


def _case(subject: Subject, rng: np.random.Generator, *, inside: bool) -> Case | None:
    """An answer at random inputs; None where there is none."""
    here = subject.at_random_parameters(rng)
    model, finer = here.model, here.finer
    inputs = _random_inputs(model, rng, inside=inside)
    began = time.process_time()
    answer = solve(model, inputs, estimate_error=model.scene.touches_exactly)
    solved = time.process_time()
    if not answer.converged:
        return None
    answer = with_error_estimate(answer)
    estimated = time.process_time()
    # Of contact a solution alone is a start: unknowns name no contacts.
    start = answer if model.scene.touches_exactly else prolong(answer, finer)
    reference = solve(finer, inputs, start=start, estimate_error=False)
    if not reference.converged:
        return None
    shape = model.scene.accuracy.shape
    true = _distance(answer, reference, shape=shape)
    estimate = answer.shape_error_estimate if shape else answer.error_estimate
    if estimate is None:
        return None
    if true > estimate and not model.scene.touches_exactly:
        # The reference may be another equilibrium: that on the branch of the answer is looked for from its correction.
        beside = solve(finer, inputs, start=_corrected(answer, finer), estimate_error=False)
        if beside.converged and _distance(answer, beside, shape=shape) < true:
            reference = beside
            true = _distance(answer, reference, shape=shape)
    tolerance = model.scene.accuracy.tolerance
    told = not estimate <= tolerance
    cost = np.nan if model.scene.touches_exactly else (estimated - solved) / (solved - began)
    in_c = None if here.in_c is None else _estimate_in_c(here, here.in_c, answer, inputs)
    case = Case(inside, tolerance, true, float(estimate), told, cost, inputs.tolist(), in_c)
    wanted = case.ratio is None or LEAST <= case.ratio <= MOST
    if wanted and not (case.is_silent or case.is_silent_in_c):
        return case
    own = with_error_estimate(reference)
    own_error = own.shape_error_estimate if shape else own.error_estimate
    decided = own_error is not None and own_error <= KNOWN * true
    return replace(case, decided=decided)


def _corrected(answer: Solution, finer: Model) -> FloatArray:
    """Unknowns of the finer model at the equilibrium of the richer model that the answer's correction leads to.

    From the correction itself Newton's method on so many more modes may reach another equilibrium.
    """
    _, correction = believed_correction(answer)
    unknowns = richer_unknowns(answer, correction.known, correction.missing)
    corrected = replace(answer, model=answer.model.richer, x=unknowns)
    settled = solve(corrected.model, answer.inputs, start=unknowns, estimate_error=False)
    return prolong(settled if settled.converged else corrected, finer)


def _estimate_in_c(
    here: Subject, compiled: Compiled | CompiledContact, answer: Solution, inputs: FloatArray
) -> float | None:
    """What the C says of the error where it finds the same equilibrium: from the unloaded rods, or the own contacts."""
    if isinstance(compiled, CompiledContact):
        touching = compiled.solve(inputs)
        if not touching.converged:
            return None
        ways = [np.linalg.norm(tip[:3] - answer.tip(rod).position) for rod, tip in touching.tips.items()]
        return touching.error_estimate if max(ways) <= SAME * min(rod.length for rod in here.model.scene.rods) else None
    parameters = here.parameters if here.parameters.size else None
    solved = compiled.solve(inputs, parameters=parameters)
    same = np.linalg.norm(solved.x - answer.x) <= SAME * (1 + np.linalg.norm(answer.x))
    return solved.error_estimate if solved.converged and same else None


def _distance(answer: Solution, reference: Solution, *, shape: bool) -> float:
    errors = [pose_distance(answer, reference), cable_distance(answer, reference)]
    if shape:
        errors.append(pose_distance(answer, reference, SAMPLES))
    return max(errors)


def _random_inputs(model: Model, rng: np.random.Generator, *, inside: bool) -> FloatArray:
    """Stacked inputs within the ends of sliders, or up to twice as far from their middle."""
    ends = sliders(model)
    least = np.array([slider.least for slider in ends])
    most = np.array([slider.most for slider in ends])
    share = rng.uniform(-1.0, 1.0, len(ends))
    if not inside:
        share = np.sign(share) * rng.uniform(1.0, FARTHEST, len(ends))
    inputs = (least + most) / 2 + share * (most - least) / 2
    for entry, span in model.inputs:
        inputs[span] = np.maximum(inputs[span], entry.lower)
        if entry.field == "base.quaternion":
            inputs[span] = entry.default.ravel()
    return np.asarray(inputs)


def known(log: Path | None) -> dict[str, list[Case]]:
    """Cases that a log holds, by scene."""
    if log is None or not log.exists():
        return {}
    lines = (json.loads(line) for line in log.read_text().splitlines())
    return {line["scene"]: [Case(**case) for case in line["cases"]] for line in lines}


def row_of(words: str, found: list[Case], scene_count: int) -> tuple[str, ...]:
    """A row of the table."""
    ratios = np.array([case.ratio for case in found if case.ratio is not None])
    costs = np.array([case.cost for case in found])
    beyond = sum(case.true > case.tolerance for case in found)
    silent = sum(case.is_silent for case in found)
    asked_c = [case for case in found if case.in_c is not None]
    silent_in_c = sum(case.is_silent_in_c for case in asked_c)
    unknown = sum(case.estimate >= UNKNOWN for case in found)
    unknown_in_c = sum(case.in_c >= UNKNOWN for case in asked_c if case.in_c is not None)
    undecided = sum(not case.decided for case in found)
    few, half, many = np.percentile(ratios, [1, 50, 99])
    outside = f"{100 * np.mean(ratios < LEAST):.1f} %, {100 * np.mean(ratios > MOST):.1f} %"
    return (
        words,
        f"{scene_count}",
        f"{len(found)}",
        f"{beyond}",
        f"{silent}",
        f"{silent_in_c} of {len(asked_c)}",
        f"{unknown}",
        f"{unknown_in_c}",
        f"{undecided}",
        f"{few:.2f}, {half:.2f}, {many:.2f}",
        outside,
        f"{np.nanmedian(costs):.2f}",
    )


HEADINGS = (
    "inputs",
    "scenes",
    "answers",
    "beyond the tolerance",
    "of these not reported",
    "not reported in C",
    "error not known",
    "not known in C",
    "reference not exact enough",
    "estimate / true error: 1, 50, 99 %",
    f"below {LEAST}, above {MOST:g}",
    "estimate / solve, time",
)


def report(found: dict[str, list[Case]]) -> str:
    """The table."""
    every = [case for cases in found.values() for case in cases]
    rows = []
    for words, inside in (("within the range", True), ("outside", False)):
        chosen = [case for case in every if case.inside is inside]
        count = sum(any(case.inside is inside for case in cases) for cases in found.values())
        rows.append(row_of(words, chosen, count))
    return table(HEADINGS, rows)


def _tell(name: str, found: list[Case]) -> None:
    """One line for each answer that is silent or whose estimate is far off."""
    for case in found:
        far_off = case.ratio is not None and not LEAST <= case.ratio <= MOST
        silent = case.is_silent or case.is_silent_in_c
        if silent or far_off:
            kind = "NOT TOLD" if silent else "far off"
            numbers = " ".join(f"{value:.4g}" for value in case.inputs)
            print(
                f"{name}: {kind}, error {case.true:.2e}, estimate {case.estimate:.2e}, "
                f"tolerance {case.tolerance:.0e}, inputs {numbers}"
            )


def main(
    chosen: Annotated[str, typer.Option("--scenes", help="Names of scenes, by commas; all when left out.")] = "",
    points: Annotated[int, typer.Option(help="Random inputs of each scene.")] = 60,
    write: Annotated[bool, typer.Option("--write", help="Put the table into docs/accuracy.md.")] = False,
    log: Annotated[Path | None, typer.Option(help="One line a scene; a second run goes on from it.")] = None,
    folder: Annotated[Path | None, typer.Option(help="Scenes that are judged beside the examples.")] = None,
) -> None:
    """Print how estimates compare with true errors at random inputs."""
    found = known(log)
    wanted = set(filter(None, chosen.split(",")))
    for name, scene in scenes(folder):
        if name in found or (wanted and name not in wanted):
            continue
        try:
            found[name] = cases_of(scene, points)
        except CosseratError as error:
            print(f"{name}: left out: {error}")
            found[name] = []
        print(f"{name}: {len(found[name])} answers", flush=True)
        if log is not None:
            line: dict[str, Any] = {"scene": name, "cases": [asdict(case) for case in found[name]]}
            with log.open("a") as file:
                file.write(json.dumps(line) + "\n")
    for name, cases in found.items():
        _tell(name, cases)
    text = report({name: cases for name, cases in found.items() if cases})
    print(text)
    if write:
        put(PAGE, BEGIN, END, text)


if __name__ == "__main__":
    typer.run(main)
