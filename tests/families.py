"""Families of cases that tell the same thing: a few run every time, the others with the slow tests."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from typing import Any

import pytest


def mostly_slow(cases: Iterable[Any], quick: Collection[Any]) -> list[Any]:
    """Parameters of a test: the cases named in `quick` as they are, the others marked slow.

    Raises:
        ValueError: a name in `quick` is no case, so a family would lose its quick case unseen.
    """
    everything = list(cases)
    unknown = [case for case in quick if case not in everything]
    if unknown:
        raise ValueError(f"these are no cases: {unknown}")
    return [case if case in quick else _slow(case) for case in everything]


def _slow(case: Any) -> Any:
    """One case marked slow; a tuple has one value for each argument of the test."""
    values = case if isinstance(case, tuple) else (case,)
    return pytest.param(*values, marks=pytest.mark.slow)
