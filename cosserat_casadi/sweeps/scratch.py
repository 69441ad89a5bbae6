"""Arrays with an entry for each row of a table, on disc, so that the memory of a sweep does not grow with its rows.

An array is in an unnamed file, which is deleted with it. Its pages are loaded as they are used; loops over blocks of
rows release the pages of each block. A sweep without an output file keeps its arrays in memory.
"""

from __future__ import annotations

import math
import mmap
import os
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
import numpy.typing as npt

from cosserat_casadi.files import write_errors

BLOCK = 16_384
"""Number of rows of a block."""

ZEROS = bytes(1 << 16)
"""Zeros that allocate the space of a file."""

Array = npt.NDArray[Any]


class Scratch:
    """Storage of the arrays of a sweep.

    Attributes:
        folder: folder of their files; None for arrays in memory.
    """

    def __init__(self, folder: Path | None = None) -> None:
        self.folder = folder
        self._maps: list[mmap.mmap] = []

    @classmethod
    def beside(cls, output: Path | None) -> Scratch:
        """Storage of a sweep beside its output file; in memory without one, or if no file can be made there."""
        folder = None if output is None else output.absolute().parent
        if folder is None or not folder.is_dir() or not os.access(folder, os.W_OK | os.X_OK):
            return cls()
        return cls(folder)

    def array(self, shape: tuple[int, ...], dtype: npt.DTypeLike = np.float64) -> Array:
        """A new array of zeros.

        Raises:
            WriteError: the disc has no space for it.
        """
        size = math.prod(shape) * np.dtype(dtype).itemsize
        if self.folder is None or not size:
            return np.zeros(shape, dtype)
        with write_errors(self.folder), tempfile.TemporaryFile(dir=self.folder) as file:
            # Allocated now, since a full disc at the writing of a page would end the process.
            for first in range(0, size, len(ZEROS)):
                file.write(ZEROS[: size - first])
            return self._mapped(file, size, dtype).reshape(shape)

    def joined(self, blocks: Iterator[Array], columns: int) -> Array:
        """Blocks of rows of numbers, one after the other, as one array, shape (rows, columns).

        Raises:
            WriteError: the disc has no space for it.
        """
        if self.folder is None:
            return np.concatenate([np.zeros((0, columns)), *blocks])
        with write_errors(self.folder), tempfile.TemporaryFile(dir=self.folder) as file:
            for block in blocks:
                file.write(np.ascontiguousarray(block, dtype=np.float64).data)
            size = file.tell()
            if not size:
                return np.zeros((0, columns))
            return self._mapped(file, size, np.float64).reshape(-1, columns)

    def blocks(self, count: int) -> Iterator[slice]:
        """Rows in blocks; each block is released from memory before the next one."""
        for first in range(0, count, BLOCK):
            yield slice(first, min(first + BLOCK, count))
            self.let_go()

    def let_go(self) -> None:
        """Release all pages from the memory of this process; their numbers stay on disc."""
        # A system without this advice takes pages when memory is short.
        if hasattr(mmap, "MADV_DONTNEED"):
            for mapped in self._maps:
                mapped.madvise(mmap.MADV_DONTNEED)

    def _mapped(self, file: BinaryIO, size: int, dtype: npt.DTypeLike) -> Array:
        file.flush()
        mapped = mmap.mmap(file.fileno(), size)
        self._maps.append(mapped)
        return np.frombuffer(mapped, dtype)

    def __reduce__(self) -> tuple[type[Scratch], tuple[Path | None]]:
        # Another process gets the numbers of arrays that are sent to it, not their files.
        return Scratch, (self.folder,)


MEMORY = Scratch()
"""Scratch with its arrays in memory."""
