"""Records that Python shares with C: they point at arrays, at other records, and at functions of Python."""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from typing import Any

import numpy as np

POINTER = ctypes.c_void_p

_RAISED: list[BaseException] = []
"""Exceptions of functions of Python that C has called."""


def raise_what_was_raised() -> None:
    """Raise what Python raised first where C called it; C may have called more before it ended."""
    if _RAISED:
        first = _RAISED[0]
        _RAISED.clear()
        raise first


def address_of(function: Any) -> int:
    """Where a function of a library is in memory."""
    address = ctypes.cast(function, POINTER).value
    assert address is not None, "a function has an address"
    return address


class Held:
    """A record that C reads, and the arrays and functions that it points at.

    Args:
        record: the record.

    Attributes:
        record: the record.
        address: of it.
    """

    def __init__(self, record: Any) -> None:
        self.record = record
        self.address = ctypes.addressof(record)
        self._kept: list[Any] = []

    def share(self, name: str, array: np.ndarray[Any, Any]) -> None:
        """Have a member of the record point at an array."""
        self._kept.append(array)
        setattr(self.record, name, array.ctypes.data)

    def point(self, name: str, held: Held) -> None:
        """Have a member of the record point at another record."""
        self._kept.append(held)
        setattr(self.record, name, held.address)

    def call_back(self, name: str, kind: Callable[..., Any], function: Callable[..., None]) -> None:
        """Have a member of the record be a function of Python, whose exception :func:`raise_what_was_raised` raises.

        Args:
            name: of the member.
            kind: prototype of the function in C, which returns zero unless Python has raised something.
            function: in Python.
        """

        def guarded(*arguments: Any) -> int:
            try:
                function(*arguments)
            except BaseException as raised:
                _RAISED.append(raised)
                return 1
            return 0

        wrapped = kind(guarded)
        self._kept.append(wrapped)
        setattr(self.record, name, wrapped)

    def keep(self, held: Any) -> None:
        """Keep what the record has the address of."""
        self._kept.append(held)
