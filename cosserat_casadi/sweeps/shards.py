"""Shards of a sweep: parts of its work that machines do for themselves, and that are merged into one file of results.

A shard keeps its finished rows in its file beside the results, as an unfinished sweep does. So a shard that was
killed goes on, and shards on one file system need no word between them.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

from cosserat_casadi.errors import Problem, SceneError
from cosserat_casadi.sweeps.work import Chunk

MOST = 100_000
"""Shards into which a sweep may be cut."""

TOLD = 5
"""Shards that a sentence names."""


@dataclass(frozen=True)
class Shard:
    """A part of a sweep that is cut into several.

    Attributes:
        number: from 1 to count.
        count: parts that the sweep is cut into.
    """

    number: int
    count: int

    @classmethod
    def read(cls, text: str) -> Shard:
        """The shard that a word such as ``3/64`` means.

        Raises:
            SceneError: it means none.
        """
        match = re.fullmatch(r"0*([0-9]{1,6})/0*([0-9]{1,6})", text.strip())
        number, count = (int(word) for word in match.groups()) if match else (0, 0)
        if not 1 <= number <= count <= MOST:
            problem = f"{text!r} is no shard"
            raise SceneError(Problem("--shard", problem, f"such as 3/64, the third of 64; at most {MOST} shards"))
        return cls(number, count)

    def __str__(self) -> str:
        return f"{self.number}/{self.count}"

    def has(self, chunk: Chunk) -> bool:
        """Whether a chunk of the sweep is of this shard: chunks are dealt out one by one, so that all take as long."""
        return chunk.number % self.count == self.number - 1

    def file(self, output: Path) -> Path:
        """File in which a shard keeps its finished rows, beside the file of the results."""
        width = len(str(self.count))
        return output.with_name(f"{output.name}.shard-{self.number:0{width}}-of-{self.count}")


def shard_files(output: Path) -> dict[Shard, Path]:
    """The files of all shards that have begun, in their order."""
    pattern = re.compile(re.escape(output.name) + r"\.shard-([0-9]{1,6})-of-([0-9]{1,6})")
    found: dict[Shard, Path] = {}
    for path in sorted(output.parent.iterdir()):
        match = pattern.fullmatch(path.name)
        if match is not None:
            found[Shard(int(match.group(1)), int(match.group(2)))] = path
    return found
