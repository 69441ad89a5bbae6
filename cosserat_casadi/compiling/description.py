"""Keys of texts in C by their origin, which are known before the texts are written.

Models, scenes and options are records of numbers and words. Equal records, read by equal sources with equal libraries,
lead to equal texts. Other values have no key: a record or a model whose class comes from outside the package, because
its mechanics are not known here, or an expression of CasADi.
"""

from __future__ import annotations

import hashlib
import platform
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from enum import Enum
from functools import cache
from typing import Any

import casadi as ca
import numpy as np

from cosserat_casadi.files import sources_hash
from cosserat_casadi.scene.records import Record

PACKAGE = "cosserat_casadi"

PLAIN = (type(None), bool, int, float, str, bytes)
"""Classes of values that are identified by their text representation."""

Tokens = tuple["str | Tokens", ...]
"""Words, and groups of words."""


class NoDataError(Exception):
    """A value without a complete text representation."""


def key_of(*made_from: Any) -> str | None:
    """Hash values and everything else on which texts depend: the package's sources, CasADi, NumPy and the machine.

    Returns:
        the key; None if a value is no data, or if the sources have changed since this process read them.
    """
    sources = hash_at_first_use()
    if sources is None:
        return None
    try:
        tokens = _tokens(made_from)
    except NoDataError:
        return None
    around = (sources, ca.__version__, np.__version__, platform.system(), platform.machine())
    # The text of a tuple of words and tuples can be read in one way alone.
    return hashlib.sha256(repr((around, tokens)).encode()).hexdigest()[:20]


@cache
def hash_at_first_use() -> str | None:
    """Return the hash of the sources that this process runs, taken once."""
    return sources_hash()


def _tokens(value: Any) -> Tokens:
    """Turn a value into the name of its class and its content.

    Raises:
        NoDataError: the value, or a value in it, is no data.
    """
    kind = type(value)
    if kind in PLAIN:
        return kind.__name__, repr(value)
    if kind in (tuple, list):
        return kind.__name__, *map(_tokens, value)
    if isinstance(value, Mapping):
        return "mapping", *[(_tokens(key), _tokens(entry)) for key, entry in value.items()]
    if isinstance(value, np.ndarray | np.generic):
        if value.dtype.hasobject:
            raise NoDataError
        return "array", str(value.dtype), repr(value.shape), value.tobytes().hex()
    if not _is_of_package(kind):
        raise NoDataError
    name = f"{kind.__module__}.{kind.__qualname__}"
    if isinstance(value, Enum):
        return name, value.name
    if any("__reduce__" in vars(base) for base in kind.__mro__[:-1]):
        # How a model is made anew from its description, which pickle takes too.
        made_by, arguments = value.__reduce__()
        if not _is_of_package(made_by):
            raise NoDataError
        return name, f"{made_by.__module__}.{made_by.__qualname__}", _tokens(arguments)
    return name, *[(field, _tokens(getattr(value, field))) for field in _fields(value)]


def _fields(record: Any) -> list[str]:
    """Names of the fields of a record.

    Raises:
        NoDataError: the value is no record.
    """
    if isinstance(record, Record):
        return [*type(record).model_fields, "__pydantic_private__"]
    if is_dataclass(record):
        return [field.name for field in fields(record)]
    raise NoDataError


def _is_of_package(named: Any) -> bool:
    """Whether a class or a function belongs to this package."""
    return str(named.__module__).partition(".")[0] == PACKAGE
