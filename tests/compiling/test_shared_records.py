"""Records that Python shares with C: what a function of Python raises where C calls it."""

from __future__ import annotations

import ctypes

import pytest

from cosserat_casadi.compiling.shared_records import Held, raise_what_was_raised

CALL = ctypes.CFUNCTYPE(ctypes.c_int)


class Record(ctypes.Structure):
    _fields_ = [("evaluate", CALL)]


def test_what_python_raised_first_is_raised_once() -> None:
    """C may call a function several times before it ends; no later call of C raises what was left."""
    raised = iter([ValueError("first"), ValueError("second")])

    def evaluate() -> None:
        raise next(raised)

    held = Held(Record())
    held.call_back("evaluate", CALL, evaluate)
    assert [held.record.evaluate(), held.record.evaluate()] == [1, 1]
    with pytest.raises(ValueError, match="first"):
        raise_what_was_raised()
    raise_what_was_raised()
