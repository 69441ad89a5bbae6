"""Files and folders that processes of one test run share: made by whoever needs them first."""

from __future__ import annotations

import fcntl
import shutil
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any


def once(target: Path, make: Callable[..., Any], *arguments: Any) -> None:
    """Make a file or a folder, unless another test or another process has."""
    with _locked(target.with_name(f"{target.name}.lock")):
        if not target.exists():
            unfinished = target.with_name(f"{target.name}.part{target.suffix}")
            if unfinished.is_dir():
                shutil.rmtree(unfinished)
            make(*arguments, unfinished)
            unfinished.replace(target)


@contextmanager
def _locked(path: Path) -> Iterator[None]:
    with path.open("w") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        yield
