"""Finished rows of a sweep, on disc in a file that only grows, so that a killed sweep loses only the last entry.

The results of chunks are only there until all are finished, so that memory does not grow with them. A sweep without an
output file keeps them in memory.
"""

from __future__ import annotations

import json
import os
import struct
import zlib
from collections.abc import Collection, Iterator, Mapping
from contextlib import AbstractContextManager
from io import FileIO
from pathlib import Path
from types import TracebackType
from typing import Any, BinaryIO

import numpy as np

from cosserat_casadi.errors import CosseratError
from cosserat_casadi.files import write_errors, write_whole
from cosserat_casadi.maths.typing import FloatArray

CHECKSUM = "checksum"
"""Key of the checksum of the first line."""

ENTRY = struct.Struct("<qqI")
"""Index of a chunk, bytes of its results, their checksum."""


class StoreChangedError(CosseratError):
    """Another program has changed the stored rows of a sweep while it ran."""

    page = "sweeps"

    def __init__(self, path: Path) -> None:
        super().__init__(f"{path} was changed while the sweep ran: the same command goes on with its sound rows")


class Memory:
    """The results of a sweep without an output file."""

    def __init__(self) -> None:
        self._results: dict[int, FloatArray] = {}

    @property
    def done(self) -> Collection[int]:
        """Indices of the finished chunks."""
        return self._results.keys()

    def add(self, number: int, results: FloatArray) -> None:
        """Store the results of a chunk."""
        self._results[number] = results

    def results(self) -> Iterator[tuple[int, FloatArray]]:
        """Every chunk with its results, which are released, since there may be millions of rows."""
        while self._results:
            yield self._results.popitem()


class Store(AbstractContextManager["Store"]):
    """The unfinished results of one sweep.

    The first line identifies the sweep, in JSON with a checksum; every chunk follows with its index and a checksum. An
    incomplete entry of a killed process is cut off.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self._file: FileIO | None = None
        self._places: dict[int, tuple[int, int, int]] = {}
        """Place of each chunk's entry, by the number of the chunk: where it begins, rows of its results, and bytes."""

    @property
    def done(self) -> Collection[int]:
        """Indices of the finished chunks."""
        return self._places.keys()

    def head(self) -> dict[str, Any] | None:
        """Identity of the sweep that the file belongs to; None without a file, or for a damaged one."""
        # Opening a pipe would wait for its writer.
        if not self.path.is_file():
            return None
        try:
            with self.path.open("rb") as file:
                head = json.loads(file.readline())
        except (OSError, ValueError, RecursionError):
            return None
        if not isinstance(head, dict) or head.pop(CHECKSUM, None) != _checksum(head):
            return None
        return head

    def start(self, head: Mapping[str, Any]) -> None:
        """Begin a sweep, overwriting the file.

        Raises:
            WriteError: it cannot be written; nothing is left of it.
        """
        line = json.dumps({**head, CHECKSUM: _checksum(head)}).encode() + b"\n"
        with write_errors(self.path):
            try:
                # Unbuffered: out of this process at once, so that a kill does not lose it.
                self._file = self.path.open("w+b", buffering=0)
                write_whole(self._file, line)
            except OSError:
                self.remove()
                raise

    def resume(self, rows: Mapping[int, int], width: int) -> None:
        """Read the finished rows and prepare the file for further rows.

        Args:
            rows: rows of each chunk of the sweep, by its index.
            width: count of numbers in the results of a row.
        """
        with self.path.open("rb") as file:
            end = len(file.readline())
            for number, content in _entries(file, {chunk: 8 * width * count for chunk, count in rows.items()}):
                self._places[number] = (end, rows[number], len(content))
                end += ENTRY.size + len(content)
        # An incomplete entry of a killed process is cut off.
        self._file = self.path.open("r+b", buffering=0)
        self._file.truncate(end)

    def add(self, number: int, results: FloatArray) -> None:
        """Store the results of a chunk.

        Raises:
            WriteError: it cannot be written; the rows that were kept before stay.
        """
        content = np.ascontiguousarray(results, dtype="<f8").tobytes()
        if self._file is None:
            raise ValueError("the store is not open")
        header = ENTRY.pack(number, len(content), zlib.crc32(content))
        with write_errors(self.path):
            end = self._file.seek(0, os.SEEK_END)
            write_whole(self._file, header + content)
        self._places[number] = (end, len(results), len(content))

    def results(self) -> Iterator[tuple[int, FloatArray]]:
        """Every finished chunk with its results, one at a time.

        Raises:
            StoreChangedError: the file does not have the stored rows any more.
        """
        if self._file is None:
            raise ValueError("the store is not open")
        for number, (start, rows, size) in self._places.items():
            self._file.seek(start)
            entry = next(_entries(self._file, {number: size}), None)
            if entry is None:
                raise StoreChangedError(self.path)
            _, content = entry
            yield number, np.frombuffer(content, dtype="<f8").reshape(rows, -1)

    def remove(self) -> None:
        """The sweep is finished and written."""
        self.close()
        self.path.unlink(missing_ok=True)

    def close(self) -> None:
        """Leave the file for a later run."""
        if self._file is not None:
            self._file.close()

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self.close()


def _checksum(head: Mapping[str, Any]) -> int:
    return zlib.crc32(json.dumps(head, sort_keys=True).encode())


def _entries(file: BinaryIO, sizes: Mapping[int, int]) -> Iterator[tuple[int, bytes]]:
    """Complete entries, up to the first one that is damaged or does not belong to the sweep.

    Args:
        file: the file, positioned after its first line.
        sizes: bytes of the results of each chunk, by its index.
    """
    while len(header := file.read(ENTRY.size)) == ENTRY.size:
        number, size, checksum = ENTRY.unpack(header)
        # A file system may leave zeros after a failure of power: no chunk is empty.
        if size <= 0 or sizes.get(number) != size:
            return
        content = file.read(size)
        if len(content) != size or zlib.crc32(content) != checksum:
            return
        yield number, content
