"""The shared object of an exported folder: its functions by name, and memory for their calls."""

from __future__ import annotations

import ctypes
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any


@dataclass(frozen=True)
class LoadedLibrary:
    """An exported folder, compiled.

    Attributes:
        library: the shared object.
        manifest: what the folder says of itself.
    """

    library: Path
    manifest: dict[str, Any]

    @cached_property
    def _handle(self) -> ctypes.CDLL:
        return ctypes.CDLL(str(self.library))

    def _function(self, word: str) -> Any:
        """A function in C: its symbol begins with the name of the library."""
        return getattr(self._handle, f"{self.manifest['name']}_{word}")

    def _workspace(self) -> Any:
        """Memory for one call, so that several threads may call at once."""
        return room(self._function("workspace_size")())


def room(size: int) -> Any:
    """Zeroed memory of so many bytes, aligned for numbers."""
    return (ctypes.c_double * -(-size // ctypes.sizeof(ctypes.c_double)))()
