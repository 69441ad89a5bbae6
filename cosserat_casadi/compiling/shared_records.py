"""Records that Python shares with C, with pointers to arrays, to other records, and to Python functions."""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from typing import Any

import numpy as np

POINTER = ctypes.c_void_p

_RAISED: list[BaseException] = []
"""Exceptions of Python functions that C has called."""


def raise_what_was_raised() -> None:
    """Raise the first exception of a Python function that C called; C may have called more before it returned."""
    if _RAISED:
        first = _RAISED[0]
        _RAISED.clear()
        raise first


def address_of(function: Any) -> int:
    """Address of a function of a library."""
    address = ctypes.cast(function, POINTER).value
    assert address is not None, "a function has an address"
    return address


class Held:
    """A record that C reads, which keeps alive the arrays and functions to which it points.

    Args:
        record: the record.

    Attributes:
        record: the record.
        address: address of the record.
    """

    def __init__(self, record: Any) -> None:
        self.record = record
        self.address = ctypes.addressof(record)
        self._kept: list[Any] = []

    def share(self, name: str, array: np.ndarray[Any, Any]) -> None:
        """Make a member of the record point to an array."""
        self._kept.append(array)
        setattr(self.record, name, array.ctypes.data)

    def point(self, name: str, held: Held) -> None:
        """Make a member of the record point to another record."""
        self._kept.append(held)
        setattr(self.record, name, held.address)

    def call_back(self, name: str, kind: Callable[..., Any], function: Callable[..., object]) -> None:
        """Make a member of the record a Python function, whose exception :func:`raise_what_was_raised` raises.

        Args:
            name: name of the member.
            kind: prototype of the function in C, which returns zero unless Python has raised an exception.
            function: the Python function.
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
        """Keep an object alive whose address is in the record."""
        self._kept.append(held)
