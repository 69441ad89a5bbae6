"""Facts of results, models and scenes for terminals and notebooks: a title, and pairs of a label and its words."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from cosserat_casadi.equilibrium.answer_error import UNKNOWN
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.results.presentation import facts_of

if TYPE_CHECKING:
    from cosserat_casadi.accuracy.choose import Choice
    from cosserat_casadi.control.inverse_result import Inverse
    from cosserat_casadi.equilibrium.solution import Equilibrium, Solution
    from cosserat_casadi.estimation import Estimate
    from cosserat_casadi.identification import Identification
    from cosserat_casadi.model.build import Model
    from cosserat_casadi.motion.linear_model import LinearModel
    from cosserat_casadi.motion.trajectory import Motion
    from cosserat_casadi.motion.vibration_modes import Modes
    from cosserat_casadi.paths.equilibrium_path import EquilibriumPath
    from cosserat_casadi.paths.tube_path import TubePath
    from cosserat_casadi.scene import Scene
    from cosserat_casadi.sweeps.outcome_table import Sweep
    from cosserat_casadi.sweeps.sobol import SobolIndices
    from cosserat_casadi.tubes.tube_equilibria import TubeEquilibria
    from cosserat_casadi.tubes.tube_functions import TubeFunctions
    from cosserat_casadi.tubes.tube_solution import TubeSolution

Facts = list[tuple[str, str]]
"""Pairs of label and text."""

Titled = tuple[str | None, Facts]
"""Title of the scene, or None, and facts."""

MOST_OF_A_KIND = 4
"""Largest number of listed tips, modes, unknowns or events; further ones are counted."""

ROUNDING = 1e-14
"""Threshold of entries that are shown as zero, over the largest entry of their vector."""

UNSOLVED = 1e-12
"""Threshold of entries that are shown as zero, over the size of the scene: the tolerance of the equations."""

SMALLEST = 1e-300
"""Least scale of a vector, against division by zero."""


def scene_facts(scene: Scene) -> Titled:
    """Rods or tubes, loads and actuators, and the inputs."""
    parts: dict[str, Sequence[Any]] = {
        "rods": scene.rods,
        "tubes": scene.tubes,
        "bodies": scene.listed_bodies,
        "joints": scene.joints,
        "supports": scene.supports,
        "disks": scene.disks,
        "loads": scene.loads,
        "actuators": scene.actuators,
        "obstacles": scene.obstacles,
    }
    facts = [
        (part, _listed(entry.name or "without name" for entry in entries)) for part, entries in parts.items() if entries
    ]
    return scene.title, [*facts, ("inputs", _listed(scene.input_names()))]


def model_facts(model: Model) -> Titled:
    """Unknowns, modes of each rod, inputs and parameters of a model."""
    facts = [("unknowns", str(model.size))]
    rods = [
        (f"rod {name}", f"modes {', '.join(map(str, chosen.modes))}, {chosen.nodes} intervals")
        for name, chosen in model.discretisation.items()
    ]
    facts += _first("rods", rods)
    return model.scene.title, [*facts, *_arguments(model)]


def tube_model_facts(model: TubeFunctions) -> Titled:
    """Tubes, steps, inputs and parameters of a model of concentric tubes."""
    facts = [("tubes", _listed(tube.name for tube in model.robot.scene.tubes)), ("steps", str(model.steps))]
    return model.robot.scene.title, [*facts, *_arguments(model)]


def _arguments(model: Model | TubeFunctions) -> Facts:
    """Names of inputs, and of parameters if the scene has any."""
    facts = [("inputs", _listed(model.inputs.names))]
    if model.parameters.size:
        facts.append(("parameters", _listed(model.parameters.names)))
    return facts


def linear_model_facts(model: LinearModel) -> Titled:
    """States, inputs and outputs of a linear model."""
    facts = [
        ("states", f"{len(model.states)}, of {model.modes} modes"),
        ("inputs", _listed(model.inputs)),
        ("outputs", _listed(model.outputs)),
    ]
    return None, facts


def choice_facts(choice: Choice) -> Titled:
    """Largest error of a discretisation, the input ranges of its choice, and its modes."""
    title, facts = model_facts(choice.model)
    of_choice = [
        ("largest error", _error(choice.error_estimate, choice.scene.accuracy.tolerance)),
        ("ranges", _listed(line.partition("=")[0] for line in choice.ranges.described)),
        ("solved", f"{choice.solves}, {len(choice.without_equilibrium)} without an equilibrium"),
    ]
    # The ranges name the inputs.
    return title, [*of_choice, *(fact for fact in facts if fact[0] != "inputs")]


def solution_facts(solution: Solution) -> Titled:
    """Outcome, tips, error and stability of an equilibrium."""
    title, facts = _equilibrium_facts(solution, solution.smallest_eigenvalue)
    if solution.model.scene.has_contact:
        facts.append(("contacts", str(len(solution.contacts))))
    return title, facts


def tube_facts(solution: TubeSolution) -> Titled:
    """Outcome, tips, error, stability and energy of an equilibrium of tubes."""
    title, facts = _equilibrium_facts(solution, None)
    return title, [*facts, ("energy", f"{solution.energy:.6g} J")]


def _equilibrium_facts(solution: Equilibrium[Any], smallest_eigenvalue: float | None) -> Titled:
    """Outcome, tips, error and stability of an equilibrium."""
    scene = solution.model.scene
    facts = [("outcome", _outcome(solution.converged, solution.outcome.label, solution.message))]
    tips = [(f"tip of {name}", _point(solution.tip(name).position)) for name in solution.model.lengths]
    facts += _first("tips", tips)
    facts.append(("error", told_error(solution.judged_error, solution.within_tolerance, scene.accuracy.tolerance)))
    facts.append(("stable", _stable(solution.stable, smallest_eigenvalue)))
    return scene.title, facts


def path_facts(path: EquilibriumPath) -> Titled:
    """Outcome, input, end, events and error of a path."""
    scene = path.model.scene
    facts = [("outcome", _outcome(path.converged, path.outcome.label, path.message)), ("input", path.name)]
    if len(path.factor):
        ends = [(f"tip of {name}", _point(path.tip(name).position[-1])) for name in path.model.discrete.rods]
        facts.append(("points", f"{len(path.factor)}, to {path.factor[-1]:.6g} of the way"))
        facts += _first("tips", ends)
    facts.append(("events", _listed(f"{event.kind} at {event.factor:.6g}" for event in path.events)))
    facts += _rubbing(path, len(path.factor))
    facts.append(("error", _error(path.error_estimate, scene.accuracy.tolerance)))
    return scene.title, facts


def motion_facts(motion: Motion) -> Titled:
    """Outcome, times, tips at the end, impacts and error of a motion."""
    scene = motion.model.scene
    facts = [("outcome", _outcome(motion.converged, motion.outcome.label, motion.message))]
    if len(motion.times):
        ends = [(f"tip of {name}", _point(motion.tip(name).position[-1])) for name in motion.model.discrete.rods]
        facts.append(("times", f"{motion.times[0]:g} to {motion.times[-1]:g} s, {len(motion.times)} rows"))
        facts += _first("tips", ends)
    facts.append(("steps", str(motion.statistics.steps)))
    if scene.has_contact:
        facts.append(("events", str(len(motion.events))))
    facts += _rubbing(motion, len(motion.times))
    facts.append(("error", told_error(motion.error_estimate, motion.within_tolerance, motion.tolerance)))
    return scene.title, facts


def _rubbing(result: EquilibriumPath | Motion, rows: int) -> Facts:
    """Intervals that stick or slip at the end; empty in a scene without friction."""
    if not rows or not result.model.scene.rubs:
        return []
    words = []
    for found in result.rubbing(rows - 1):
        does = "slips" if found.slips else "sticks"
        words.append(f"{found.rod} {does} on {found.obstacle} from {found.start:.3g} to {found.end:.3g}")
    return [("at the end", _listed(words))]


def modes_facts(modes: Modes) -> Titled:
    """Outcome and frequencies of modes."""
    scene = modes.model.scene
    facts = [("outcome", _outcome(modes.converged, modes.outcome.label, modes.message))]
    numbered = []
    for number, mode in enumerate(modes.modes, start=1):
        words = f"{mode.frequency:.6g} Hz, damping ratio {mode.damping_ratio:.3g}, {mode.words}"
        numbered.append((f"mode {number}", words))
    facts += _first("modes", numbered)
    known = [mode.error_estimate for mode in modes.modes if mode.error_estimate is not None]
    facts.append(("largest error", _error(max(known, default=None), None)))
    return scene.title, facts


def inverse_facts(inverse: Inverse) -> Titled:
    """Outcome, gaps to the targets, and inputs."""
    title, facts = facts_of(inverse.solution)
    gaps = []
    for gap in inverse.gaps:
        angle = "" if gap.angle is None else f", {gap.angle:.3g} rad"
        gaps.append((f"gap of {gap.what}", f"{gap.position:.3g} m{angle}"))
    met = ("targets met", _yes(inverse.met))
    inputs = [(name, _numbers(np.ravel(value, order="F"))) for name, value in inverse.values.items()]
    return title, [facts[0], met, *_first("gaps", gaps), *_first("inputs", inputs), *facts[1:]]


def identification_facts(found: Identification) -> Titled:
    """Outcome, values with their deviations, misfit and error of an identification."""
    scene = found.model.scene
    facts = [("outcome", _outcome(found.converged, found.outcome, found.message))]
    values = zip(found.labels, found.shared, found.sigma, strict=True)
    facts += _first("unknowns", [(label, f"{value:.6g} ± {sigma:.2g}") for label, value, sigma in values])
    facts.append(("data", f"{len(found.rows)} numbers of {len(found.cases)} cases"))
    rms = found.rms()
    if rms is not None:
        facts.append(("misfit", f"{rms:.3g} standard deviations"))
    facts.append(("error", told_error(found.error_estimate, found.within_tolerance, scene.accuracy.tolerance)))
    return scene.title, facts


def estimate_facts(found: Estimate) -> Titled:
    """Number of rows with an estimate, median deviations of the unknowns, and error."""
    facts = [("outcome", found.message)]
    values = np.where(found.found[:, None], found.sigma, np.nan)
    for label, unit, sigma in zip(found.labels[:MOST_OF_A_KIND], found.units, values.T, strict=False):
        typical = float(np.median(sigma[np.isfinite(sigma)])) if np.isfinite(sigma).any() else np.nan
        facts.append((label, f"standard deviation {typical:.2g} {unit}, median of the rows"))
    if len(found.labels) > MOST_OF_A_KIND:
        facts.append(("unknowns", f"{len(found.labels)} in all"))
    errors = [error for _, error in found.checked if error is not None]
    facts.append(("error", _error(max(errors, default=None), found.model.scene.accuracy.tolerance)))
    facts.append(("consistent", _yes(found.consistency.holds)))
    return found.model.scene.title, facts


def sweep_facts(sweep: Sweep) -> Titled:
    """Number of rows by outcome, columns, and largest error of a sweep."""
    known, largest, row = sweep.worst
    facts = [
        ("rows", f"{len(sweep.values)}: {_listed(f'{count} {word}' for word, count in sweep.counts.items())}"),
        ("inputs", _listed(sweep.swept)),
        ("results", f"{len(sweep.found)} columns, of {_listed(sweep.posed)}"),
        ("error", _error(largest if known else None, sweep.record.get("tolerance"))),
    ]
    if known:
        facts.append(("largest in", f"row {row}"))
    return sweep.record.get("title"), facts


def sobol_facts(indices: SobolIndices) -> Titled:
    """Number of draws, and the column with the largest total index for each result."""
    facts = [("draws", f"{indices.samples}, {indices.left_out} left out"), ("factors", _listed(indices.factors))]
    leading = []
    for name, estimates in indices.results.items():
        if np.isfinite(estimates.total).all():
            largest = int(np.argmax(estimates.total))
            leading.append((name, f"{indices.factors[largest]} with total index {estimates.total[largest]:.3g}"))
    return None, [*facts, *_first("results", leading)]


def tube_equilibria_facts(equilibria: TubeEquilibria) -> Titled:
    """Energies and stability of all equilibria."""
    numbered = []
    for number, solution in enumerate(equilibria.solutions, start=1):
        stable = _stable(solution.stable, None)
        words = f"{solution.energy:.6g} J, stable: {stable}, tip at {_point(solution.tip().position)}"
        numbered.append((f"equilibrium {number}", words))
    facts = [("complete", _yes(equilibria.complete)), *_first("equilibria", numbered)]
    errors = [solution.error_estimate for solution in equilibria.solutions if solution.error_estimate is not None]
    facts.append(("largest error", _error(max(errors, default=None), equilibria.robot.tolerance)))
    return equilibria.robot.scene.title, facts


def tube_path_facts(path: TubePath) -> Titled:
    """Outcome, input, end, events and error of a path of tubes."""
    facts = [("outcome", _outcome(path.converged, path.outcome.label, path.message)), ("input", path.name)]
    tolerance = None
    if path.solutions:
        last = path.solutions[-1]
        tolerance = last.robot.tolerance
        facts.append(("points", f"{len(path.values)}, to {path.values[-1]:.6g} {path.unit}"))
        facts += _first("tips", [(f"tip of {name}", _point(tip.position)) for name, tip in last.tips.items()])
    facts.append(("events", _listed(f"{event.kind} at {event.value:.6g} {path.unit}" for event in path.events)))
    facts.append(("error", _error(path.error_estimate, tolerance)))
    return path.model.scene.title, facts


def _outcome(converged: bool, label: str, message: str) -> str:
    """The outcome in a word; after a failure with its message."""
    words = label.replace("_", " ")
    return words if converged else f"{words}: {message}"


def _error(error: float | None, tolerance: float | None) -> str:
    """An estimated error in words, with the tolerance if there is one."""
    within = None if error is None or tolerance is None else error <= tolerance
    return told_error(error, within, tolerance)


def told_error(error: float | None, within: bool | None, tolerance: float | None) -> str:
    """An estimated error in words.

    Args:
        error: estimated error over the length; None or NaN without an estimate.
        within: whether the error is within the tolerance; None if no tolerance applies.
        tolerance: requested error over the length; None without a request.
    """
    if error is None or np.isnan(error):
        return "not estimated"
    known = error != UNKNOWN
    words = f"{error:.1e} of the length" if known else "not known"
    if within is None:
        return words
    above = "above" if known else "perhaps above"
    side = "within" if within else above
    return f"{words}, {side} the tolerance of {tolerance:g}"


def _stable(stable: bool | None, eigenvalue: float | None) -> str:
    """Stability in words, with the smallest eigenvalue of the second variation if known."""
    if stable is None:
        return "not judged"
    return _yes(stable) if eigenvalue is None else f"{_yes(stable)}, smallest eigenvalue {eigenvalue:.3g} EI/ℓ"


def _yes(value: bool) -> str:
    return "yes" if value else "no"


def _point(position: FloatArray) -> str:
    """A position with its unit."""
    return f"({', '.join(digits(position))}) m"


def digits(vector: FloatArray, size: float = 0.0) -> list[str]:
    """Entries with six digits; entries below the threshold are shown as zero.

    Args:
        vector: vector of any length.
        size: scale of the quantity, e.g. the length of a rod for positions; entries at its rounding are shown as zero
            too.
    """
    magnitudes = np.abs(vector)
    largest = max(float(magnitudes.max()), SMALLEST)
    # A cancellation error would look like a result.
    rounded = np.where(magnitudes <= max(ROUNDING * largest, UNSOLVED * size), 0.0, vector)
    return [f"{entry:.6g}" for entry in rounded]


def _numbers(values: FloatArray) -> str:
    """Numbers with six digits; in a long list further ones are counted."""
    shown = ", ".join(f"{value + 0.0:.6g}" for value in values[:MOST_OF_A_KIND])
    left_out = len(values) - MOST_OF_A_KIND
    return f"{shown} and {left_out} more" if left_out > 0 else shown


def _listed(words: Iterable[str]) -> str:
    """List of words; in a long list further ones are counted."""
    every = list(words)
    left_out = len(every) - MOST_OF_A_KIND
    shown = ", ".join(every[:MOST_OF_A_KIND]) or "none"
    return f"{shown} and {left_out} more" if left_out > 0 else shown


def _first(noun: str, facts: Facts) -> Facts:
    """The first facts of a list, and its length if some are left out."""
    if len(facts) <= MOST_OF_A_KIND:
        return facts
    return [*facts[: MOST_OF_A_KIND - 1], (noun, f"{len(facts)} in all")]
