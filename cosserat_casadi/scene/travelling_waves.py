"""Room for travelling waves: inputs that they move have as many Legendre coefficients as the waves need."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from cosserat_casadi.scene.faults import SceneTables
from cosserat_casadi.scene.input_fields import InputField
from cosserat_casadi.scene.input_rules import owners_of
from cosserat_casadi.scene.motion_records import InputMotion
from cosserat_casadi.scene.profiles import Notation, RefusedProfile, read_profile
from cosserat_casadi.scene.records import sound


def make_room_for_waves(tables: dict[str, Any]) -> None:
    """Fill inputs that travelling waves move up with zeros; an input that its table leaves out is zero.

    Faulty tables stay as they are; the rules refuse them.

    Args:
        tables: of a scene; they are changed.
    """
    scene = SceneTables(tables)
    for _, table in scene.tables("motions"):
        motion = sound(InputMotion, table) if table.get("wave") == "travelling" else None
        if motion is None:
            continue
        name, _, field = motion.input.partition(".")
        record, owner = owners_of(scene).get(name, (None, {}))
        declared = None if record is None else record.inputs.get(field)
        # Values at knots are no coefficients; the rules refuse waves of them.
        if declared is not None and declared.polynomial and isinstance(owner, dict) and "knots" not in owner:
            value = owner.get(field, [0.0] * declared.components)
            owner[field] = _filled_up(value, declared, motion.degrees)


def _filled_up(value: Any, declared: InputField, degrees: int) -> Any:
    """The value of an input with a list of at least so many coefficients for each component."""
    if declared.components == 1:
        return _component(value, degrees)
    if not isinstance(value, list):
        return value
    return [_component(component, degrees) for component in value]


def _component(value: Any, degrees: int) -> Any:
    if isinstance(value, Mapping):
        try:
            value = list(read_profile(value).converted(Notation.LEGENDRE).numbers)
        except RefusedProfile:
            return value
    listed = value if isinstance(value, list) else [value]
    return [*listed, *[0.0] * (degrees - len(listed))]
