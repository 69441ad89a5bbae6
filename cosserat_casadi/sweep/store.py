"""What is done of a sweep, on disc: one file that only grows, so that a kill loses no more than its last entry."""

from __future__ import annotations

import json
import struct
import zlib
from collections.abc import Iterator, Mapping
from io import FileIO
from pathlib import Path
from types import TracebackType
from typing import Any, BinaryIO

import numpy as np

from cosserat_casadi.files import write_errors, write_whole
from cosserat_casadi.maths.typing import FloatArray

CHECKSUM = "checksum"
"""Key of the checksum of the first line."""

ENTRY = struct.Struct("<qqI")
"""Number of a chunk, bytes of its results, their checksum."""


class Store:
    """The unfinished results of one sweep.

    The first line says what sweep it is, in JSON with a checksum; every chunk follows with its number and a checksum.
    An entry that was being written when the process was killed is cut off.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self._file: FileIO | None = None

    def head(self) -> dict[str, Any] | None:
        """What sweep the file is of; None where there is none, or where it is damaged."""
        # Opening a pipe would wait for who writes into it.
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
        """Begin a sweep, over whatever the file held.

        Raises:
            WriteError: it cannot be written; nothing is left of it.
        """
        line = json.dumps({**head, CHECKSUM: _checksum(head)}).encode() + b"\n"
        with write_errors(self.path):
            try:
                # Unbuffered: out of this process at once, so that a kill does not lose it.
                self._file = self.path.open("wb", buffering=0)
                write_whole(self._file, line)
            except OSError:
                self.remove()
                raise

    def resume(self, rows: Mapping[int, int], width: int) -> dict[int, FloatArray]:
        """What is done, by number of chunk; the file is ready for more.

        Args:
            rows: of each chunk of the sweep, by its number.
            width: numbers that a row is answered with.
        """
        done = {}
        with self.path.open("rb") as file:
            end = len(file.readline())
            for number, content in _entries(file, {chunk: 8 * width * count for chunk, count in rows.items()}):
                results = np.frombuffer(content, dtype="<f8")
                done[number] = results.reshape(-1, width)
                end += ENTRY.size + len(content)
        # What was being written when the process was killed is cut off.
        self._file = self.path.open("r+b", buffering=0)
        self._file.truncate(end)
        self._file.seek(end)
        return done

    def add(self, number: int, results: FloatArray) -> None:
        """Keep the results of a chunk.

        Raises:
            WriteError: it cannot be written; what was kept before stays.
        """
        content = np.ascontiguousarray(results, dtype="<f8").tobytes()
        if self._file is None:
            raise ValueError("the store is not open")
        header = ENTRY.pack(number, len(content), zlib.crc32(content))
        with write_errors(self.path):
            write_whole(self._file, header + content)

    def remove(self) -> None:
        """The sweep is finished and written."""
        self.close()
        self.path.unlink(missing_ok=True)

    def close(self) -> None:
        """Leave the file for a later run."""
        if self._file is not None:
            self._file.close()

    def __enter__(self) -> Store:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self.close()


def _checksum(head: Mapping[str, Any]) -> int:
    return zlib.crc32(json.dumps(head, sort_keys=True).encode())


def _entries(file: BinaryIO, sizes: Mapping[int, int]) -> Iterator[tuple[int, bytes]]:
    """Whole entries; what follows a damaged one, or one that the sweep does not have, is not trusted.

    Args:
        file: behind its first line.
        sizes: bytes of the results of each chunk, by its number.
    """
    while len(header := file.read(ENTRY.size)) == ENTRY.size:
        number, size, checksum = ENTRY.unpack(header)
        # Zeros are what a file system may leave after a failure of power: no chunk is empty.
        if size <= 0 or sizes.get(number) != size:
            return
        content = file.read(size)
        if len(content) != size or zlib.crc32(content) != checksum:
            return
        yield number, content
