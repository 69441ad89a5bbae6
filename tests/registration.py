"""Kinds that tests register are forgotten when they are done."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from cosserat_casadi.scene.families import Kind, register


def forget(member: type[Kind]) -> None:
    """Undo the registration of a kind."""
    member.kinds.pop(member.kind, None)
    member.family.records.pop(member.kind, None)


@contextmanager
def registered(*members: type[Kind]) -> Iterator[None]:
    """Kinds that are known within this context alone."""
    for member in members:
        register(member)
    try:
        yield
    finally:
        for member in members:
            forget(member)
