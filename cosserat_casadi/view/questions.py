"""Questions of a browser, read from its bytes: whatever the bytes are, the outcome is a question or a refusal."""

from __future__ import annotations

import json
import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import Any

POSE_KINDS = ("rod", "body")
"""Owners of a point that is led: the tip of a rod, or a body."""


class QuestionError(Exception):
    """The bytes are no question that is answered here."""


@dataclass(frozen=True)
class Question:
    """Parts of a question, each checked when it is taken."""

    parts: Mapping[str, Any]

    @classmethod
    def read(cls, content: bytes) -> Question:
        """A question from the JSON that was sent; one without content has no parts.

        Raises:
            QuestionError: it is no JSON, or no object.
        """
        try:
            parts = json.loads(content or b"{}")
        except (ValueError, RecursionError):
            raise QuestionError("the question is not JSON that can be read") from None
        if not isinstance(parts, dict):
            raise QuestionError("the question is no JSON object")
        return cls(parts)

    def inputs(self, count: int) -> list[float | None]:
        """So many stacked inputs; None for null, which JSON has in place of a number.

        Raises:
            QuestionError: they are missing, or are not so many numbers.
        """
        values = self._list("inputs", count)
        return [None if value is None else _number("inputs", value) for value in values]

    def position(self) -> list[float]:
        """A point in world axes, shape (3,), m.

        Raises:
            QuestionError: it is missing, or is no point.
        """
        position = [_number("position", value) for value in self._list("position", 3)]
        if not all(map(math.isfinite, position)):
            raise QuestionError("position must be finite")
        return position

    def pose(self, names: Mapping[str, Collection[str]]) -> dict[str, str]:
        """The tip or the body that is led: {"rod": name} or {"body": name}.

        Args:
            names: of the rods and the bodies of the scene, by kind.

        Raises:
            QuestionError: it is missing, or the scene does not have it.
        """
        pose = self.parts.get("pose")
        if not isinstance(pose, dict) or len(pose) != 1:
            raise QuestionError("pose must name one rod or one body")
        ((kind, name),) = pose.items()
        if kind not in POSE_KINDS or not isinstance(name, str) or name not in names[kind]:
            raise QuestionError("pose names no rod and no body of the scene")
        return {kind: name}

    def _list(self, name: str, count: int) -> list[Any]:
        values = self.parts.get(name)
        if not isinstance(values, list) or len(values) != count:
            raise QuestionError(f"{name} must be a list of {count}")
        return values


def _number(name: str, value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise QuestionError(f"{name} must hold numbers")
    try:
        return float(value)
    except OverflowError:
        raise QuestionError(f"{name} has a number beyond all range") from None
