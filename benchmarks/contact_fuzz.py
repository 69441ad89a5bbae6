"""Random rods in contact: how many are solved, and does an independent solver agree with each that is solved?

Families of scenes are those of tests/reference/contact_scenes.py. Exact contact is judged by gaps on a dense grid, by
signs of the forces and by the balance of all forces. The places of all sections, and what each obstacle presses with,
are compared with discrete rods that IPOPT minimises, with gaps as constraints (tests/reference/discrete_rods.py). Rods
with friction go along a path of their weight, and so do the discrete rods, in the same increments. Each scene has a
process of its own, which is ended at a limit: what was solved by then is told as not compared.
"""

from __future__ import annotations

import sys
import time
import tomllib
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, replace
from multiprocessing import get_context
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Annotated

import numpy as np
import typer

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT))

from cosserat_casadi import SceneError, Solution, build, discretise, follow, parse_scene, solve  # noqa: E402
from cosserat_casadi.maths.typing import FloatArray  # noqa: E402
from cosserat_casadi.paths.friction_path import FrictionPath  # noqa: E402
from tests.contact.verdict import compared, faults  # noqa: E402
from tests.reference.contact_scenes import COMPOSED, FAMILIES, contact_scene, placed_scene  # noqa: E402


def place(text: str, X: float) -> tuple[FloatArray, FloatArray]:
    """Position and normal of a section where nothing touches, in x and z, m."""
    pose = solve(build(parse_scene(text))).pose(X)
    # The tangent turned by a right angle, upwards.
    x, _, z = pose.rotation[:, 2]
    return pose.position[[0, 2]], np.array([-z, x])


def text_of(seed: int, family: str) -> str:
    """The scene of a seed."""
    if family in COMPOSED:
        return COMPOSED[family](seed)
    return placed_scene(seed, family, place) if family else contact_scene(seed)


@dataclass(frozen=True)
class Judgement:
    """What is said of a scene.

    Attributes:
        outcome: of the solve, or of the path; "refused" for a scene that is none.
        touches: whether anything touches at its end.
        faults: what is wrong, a sentence each.
        seconds: processor time of the solve, or of the path.
        compared: whether the discrete rods were computed within the limit.
    """

    outcome: str
    touches: bool
    faults: list[str]
    seconds: float
    compared: bool = True

    @property
    def said(self) -> str:
        """One line for a terminal."""
        words = [f"{self.outcome}, {self.seconds:.1f} s", *self.faults]
        return "; ".join([*words, *([] if self.compared else ["not compared"])])


def judgements(text: str, modes: int) -> Iterator[Judgement]:
    """Solve a scene, or follow its weight where there is friction: what that says, then what comparing adds."""
    begun = time.process_time()
    try:
        scene = parse_scene(text)
        model = build(scene, discretise(scene, modes))
    except SceneError:
        yield Judgement("refused", False, [], time.process_time() - begun)
        return
    if not scene.rubs:
        solution = solve(model)
        first = Judgement(solution.outcome.label, bool(solution.contacts), [], time.process_time() - begun, False)
        yield first
        yield replace(first, faults=list(_faults(text, solution)), compared=True)
        return
    still = {"weight.acceleration": [0.0, 0.0, 0.0]}
    path = follow(model, "weight.acceleration", [0.0, 0.0, -9.81], still)
    assert isinstance(path, FrictionPath), "a model with memory"
    touches = len(path.factor) > 0 and bool(path.rubbing(-1))
    first = Judgement(path.outcome.label, touches, [], time.process_time() - begun, False)
    yield first
    found = list(compared(text, path.solution(0), path)) if path.converged else []
    yield replace(first, faults=found, compared=True)


def judged(text: str, modes: int, limit: float) -> Judgement:
    """The last judgement that a process of its own comes to within a limit, s."""
    receiver, sender = get_context("fork").Pipe(duplex=False)
    process = get_context("fork").Process(target=_send, args=(sender, text, modes))
    process.start()
    sender.close()
    until = time.monotonic() + limit
    last = Judgement("no answer", False, [], limit, False)
    try:
        while receiver.poll(max(until - time.monotonic(), 0.0)):
            last = receiver.recv()
    except EOFError:
        pass
    process.kill()
    process.join()
    return last


def _send(sender: Connection, text: str, modes: int) -> None:
    for judgement in judgements(text, modes):
        sender.send(judgement)
    sender.close()


def _faults(text: str, solution: Solution) -> Iterator[str]:
    if not solution.converged:
        return
    tables = tomllib.loads(text)
    if all("width" not in obstacle for obstacle in tables.get("obstacles", [{"width": 1}])):
        yield from faults(solution)
    # A minimum lies next to what is stable alone.
    if solution.stable is not False:
        yield from compared(text, solution)


def main(
    count: Annotated[int, typer.Option(help="Scenes.")] = 100,
    first: Annotated[int, typer.Option(help="Seed of the first.")] = 0,
    modes: Annotated[int, typer.Option(help="Polynomials per strain and element.")] = 7,
    limit: Annotated[float, typer.Option(help="Time for a scene and its comparison, s.")] = 300.0,
    family: Annotated[str, typer.Option(help=f"One of {', '.join(FAMILIES)}.")] = "",
) -> None:
    """Solve and judge scenes, print the figures; exit code 1 if one that converged is wrong."""
    verdicts = []
    for seed in range(first, first + count):
        verdict = judged(text_of(seed, family), modes, limit)
        verdicts.append(verdict)
        print(f"seed {seed}: {verdict.said}", flush=True)
    outcomes = Counter(verdict.outcome for verdict in verdicts)
    touching = sum(verdict.touches for verdict in verdicts)
    wrong = sum(bool(verdict.faults) for verdict in verdicts)
    left = sum(not verdict.compared for verdict in verdicts)
    seconds = [verdict.seconds for verdict in verdicts]
    cost = f"processor time: median {np.median(seconds):.1f} s, {max(seconds):.1f} s"
    print(f"{dict(outcomes)}, {touching} touch, {wrong} wrong, {left} not compared; {cost}")
    raise typer.Exit(int(wrong > 0))


if __name__ == "__main__":
    typer.run(main)
