"""Rules of motions: each moves an input of the scene, with its number of entries, on a path that it can follow."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import NamedTuple

import numpy as np

from cosserat_casadi.maths.splines import least_norm, table_values
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.scene.faults import Fault, SceneTables, Table, below, listing, numbers_of, shown, table_of
from cosserat_casadi.scene.input_fields import InputField
from cosserat_casadi.scene.input_rules import field_faults, owners_of
from cosserat_casadi.scene.motion_records import InputMotion
from cosserat_casadi.scene.records import Entry, sound

LEAST_NORM = 0.1
"""Norm of a quaternion, over the largest one at the times of its tables, below which it has no direction."""

DIGITS = 3
"""Decimal places of the norm of a quaternion in a sentence."""


class _Moving(NamedTuple):
    """An input that a motion names: its declaration, and its owner's record and table."""

    declared: InputField
    record: type[Entry]
    field: str
    table: Table


def motions_of_no_input(scene: SceneTables) -> Iterator[Fault]:
    """Faults of motions of names that are no inputs or cannot be free, or of inputs that cannot follow them."""
    motions = scene.tables("motions")
    names = [motion.get("input") for _, motion in motions]
    # Motions of each input that must not be zero, by index; only for inputs without faulty motions.
    turns: dict[str, dict[int, InputMotion]] = {}
    for i, table in motions:
        name = table.get("input")
        if not isinstance(name, str) or _is_of_unknown_kind(name, scene):
            continue
        moving = _input_of(name, scene)
        if moving is None:
            remedy = listing(_names(scene), "inputs")
            yield Fault(("motions", i, "input"), f"{shown(name)} is no input of this scene", remedy)
            continue
        yield from below(("motions", i, "input"), field_faults(moving.field, moving.record, moving.table, scene))
        motion = sound(InputMotion, table)
        # A faulty motion has no values to test.
        if motion is None:
            continue
        faults = list(_count_faults(motion, moving))
        if not faults:
            faults += _path_faults(motion, moving.declared, _duration(scene))
            # Several motions of an input may leave its range one by one, while their sum does not.
            if names.count(name) == 1:
                faults += _range_faults(motion, moving)
        if not faults and moving.declared.nonzero:
            turns.setdefault(name, {})[i] = motion
        yield from below(("motions", i), faults)
    for name, of_input in turns.items():
        if len(of_input) == names.count(name):
            yield from _zero_faults(of_input, _duration(scene))


def _is_of_unknown_kind(name: str, scene: SceneTables) -> bool:
    """Whether the owner of an input has an unknown kind, which is another fault."""
    owner, _, _ = name.partition(".")
    record, table = owners_of(scene).get(owner, (None, {}))
    return record is None and bool(table)


def _input_of(name: str, scene: SceneTables) -> _Moving | None:
    """The input with a name; None if there is none."""
    owner, _, field = name.partition(".")
    record, table = owners_of(scene).get(owner, (None, {}))
    if record is None or field not in record.free_fields(table):
        return None
    return _Moving(record.inputs[field], record, field, table)


def _names(scene: SceneTables) -> Iterator[str]:
    """Names of all inputs that may be free in a scene."""
    for owner, (record, table) in owners_of(scene).items():
        if record is None:
            continue
        for field in record.free_fields(table):
            if not list(record.input_conflicts(field, table, scene)):
                yield f"{owner}.{field}"


def _duration(scene: SceneTables) -> float:
    """Simulated time, s; infinite if the scene does not give it."""
    return next(iter(numbers_of(table_of(scene.get("simulation")).get("duration"))), np.inf)


def _count_faults(motion: InputMotion, moving: _Moving) -> Iterator[Fault]:
    """Faults of a motion with another number of entries than its input."""
    wanted = moving.declared.entry_count(moving.table.get(moving.field))
    if motion.travels:
        yield from _wave_faults(motion, moving, wanted)
        return
    if motion.entry_count == wanted:
        return
    key = "values" if motion.is_table else "amplitude"
    numbers = "1 number" if wanted == 1 else f"{wanted} numbers"
    remedy = "those of each Legendre coefficient in turn" if wanted > moving.declared.components else ""
    problem = f"must have {numbers} at each time, got {motion.entry_count}"
    yield Fault((key,), problem, remedy)


def _wave_faults(motion: InputMotion, moving: _Moving, entries: int) -> Iterator[Fault]:
    """Faults of a travelling wave of an input that does not vary along a rod, or has other components."""
    components = moving.declared.components
    if not moving.declared.polynomial:
        problem = f"travels along a rod, and {motion.input} has one value"
        yield Fault(("wave",), problem, "move an input of Legendre coefficients, such as the profile of a muscle")
    elif "knots" in moving.table:
        problem = f"has Legendre coefficients, and {motion.input} has values at knots"
        yield Fault(("wave",), problem, "leave the knots out, or move the values by a table of times and values")
    elif motion.entry_count != components:
        yield Fault(("amplitude",), f"must have a number for each of {components} components")
    elif entries < components * motion.degrees:
        problem = f"has {motion.degrees} Legendre coefficients, and {motion.input} has {entries // components}"
        yield Fault(("wave",), problem, "fill the value of the input up with zeros")


def _path_faults(motion: InputMotion, declared: InputField, duration: float) -> Iterator[Fault]:
    """Faults of the path of a base or a length: jumps, and kinks, at which it would have no velocity."""
    jumps = [time for time in motion.jumps if 0.0 < time <= duration]
    # A velocity at the beginning or the end of the motion is not a jump.
    kinks = [time for time in motion.kinks if 0.0 < time < duration]
    if jumps and declared.moves:
        problem = f"{motion.input} must not jump, and does at {jumps[0]:g} s"
        yield Fault(("interpolation",), problem, 'interpolation = "cubic"')
    elif kinks and declared.geometry:
        problem = f"the path of {motion.input} must have a velocity, and has a kink at {kinks[0]:g} s"
        yield Fault(("interpolation",), problem, 'interpolation = "cubic"')


def _range_faults(motion: InputMotion, moving: _Moving) -> Iterator[Fault]:
    """Faults of an input's only motion that leaves its range: a length of zero, a tension below it, a pull above 1."""
    declared = moving.declared
    key = "values" if motion.is_table else "amplitude"
    if declared.nonzero and motion.is_table and not np.all(np.any(motion.knot_values, axis=1)):
        yield Fault((key,), "must not be zero", "w, x, y, z; its norm does not matter")
    least, most = _extremes(motion, moving)
    unit = "" if declared.unit == "1" else f" {declared.unit}"
    if declared.positive and least <= 0.0:
        yield Fault((key,), f"{motion.input} must stay > 0, and goes to {least:g}{unit}")
    elif declared.lower is not None and least < declared.lower:
        yield Fault((key,), f"{motion.input} must stay >= {declared.lower:g}, and goes to {least:g}{unit}")
    if declared.upper is not None and most > declared.upper:
        yield Fault((key,), f"{motion.input} must stay <= {declared.upper:g}, and goes to {most:g}{unit}")


def _zero_faults(motions: Mapping[int, InputMotion], duration: float) -> Iterator[Fault]:
    """Faults of the tables of a quaternion whose sum comes so near to zero that it has no direction.

    Waves are not tested, since they are not polynomials.

    Args:
        motions: all motions of one input, by their index in the scene.
        duration: simulated time, s.
    """
    tables = list(motions.values())
    if not all(motion.is_table for motion in tables):
        return
    # The format bounds no number: numbers that overflow are not tested.
    with np.errstate(over="ignore", invalid="ignore"):
        paths = [table_values(motion.knots, motion.knot_values, motion.interpolation) for motion in tables]

        def total(times: FloatArray) -> FloatArray:
            return np.asarray(np.sum([of_table(times) for of_table in paths], axis=0))

        knots = np.unique(np.concatenate([motion.knots for motion in tables]))
        # Squares of very large or very small numbers would overflow or underflow.
        largest = float(np.hypot.reduce(total(knots), axis=1).max())
        end = min(duration, knots[-1])
        inside = knots[(knots > 0.0) & (knots < end)]
        cuts = np.concatenate([[min(0.0, end)], inside, [end]])
        if not np.all(np.isfinite(total(cuts))) or not np.isfinite(largest):
            return
        least, time = least_norm(total, cuts)
    if least > LEAST_NORM * largest:
        return
    # A norm that is rounding would otherwise be reported as small.
    norm = round(least / largest, DIGITS) if largest > 0.0 else 0.0
    first, motion = next(iter(motions.items()))
    problem = (
        f"{motion.input} must stay away from zero, and its norm falls to {norm:g} of the largest at {time:g} s: "
        "it is interpolated by component, and normalised"
    )
    remedy = "-q is the same rotation as q: change the sign of one of them; a longer turn needs times in between"
    yield Fault(("motions", first, "values"), problem, remedy)


def _extremes(motion: InputMotion, moving: _Moving) -> tuple[float, float]:
    """Least and largest value of a scalar input on its path, at the times of a table; infinite without any."""
    if motion.is_table:
        return float(motion.knot_values.min()), float(motion.knot_values.max())
    start = numbers_of(moving.table.get(moving.field))
    if len(start) != 1:
        return np.inf, -np.inf
    lowest = -abs(motion.amplitudes)
    highest = abs(motion.amplitudes)
    # 1 − cos goes from 0 to 2.
    if motion.wave == "one_minus_cosine":
        lowest = np.minimum(2 * motion.amplitudes, 0.0)
        highest = np.maximum(2 * motion.amplitudes, 0.0)
    return start[0] + float(lowest.min()), start[0] + float(highest.max())
