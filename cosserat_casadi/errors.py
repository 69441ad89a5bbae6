"""The errors this package raises, each with the place, the fault and the remedy."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Problem:
    """One fault in an input.

    Attributes:
        where: path of the offending key, such as ``rods[0].section.radius``.
        problem: the fault in words, with the offending value.
        remedy: advice; empty if the problem implies it.
    """

    where: str
    problem: str
    remedy: str = ""

    def __str__(self) -> str:
        sentence = f"{self.where}: {self.problem}" if self.where else self.problem
        return f"{sentence} ({self.remedy})" if self.remedy else sentence


ARGUMENTS = ("SCENE", "NAME", "PAGE")
"""Names of the arguments of commands in ``--help`` and in problems."""


class CosseratError(Exception):
    """Root of the errors of this package.

    Attributes:
        page: the page of the documentation that helps, as ``cosserat docs`` names it.
    """

    page = "command-line"

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle and copy rebuild the error, for example on its way from another process."""
        # Python would call the class with ``args``, which holds the sentence and not its parts.
        return _with_sentence, (type(self), *self.args), self.__dict__


def _with_sentence(error_class: type[CosseratError], *sentence: str) -> CosseratError:
    """An error with this sentence, before its attributes are set."""
    error = error_class.__new__(error_class)
    error.args = sentence
    return error


class WriteError(CosseratError, OSError):
    """A file could not be written, as on a full disk; its former content is still there."""

    def __init__(self, file: str | os.PathLike[str], error: OSError) -> None:
        reason = error.strerror or str(error)
        super().__init__(f"{os.fspath(file)} could not be written: {reason}")


class SceneError(CosseratError):
    """A scene, or a value given for one of its inputs, was refused.

    Attributes:
        problems: every fault found, in the order of the file.
    """

    def __init__(self, *problems: Problem, page: str = "scene") -> None:
        self.problems = problems
        # A fault of an option or an argument does not concern the scene.
        if not all(problem.where.startswith("--") or problem.where in ARGUMENTS for problem in problems):
            self.page = page
        super().__init__("\n".join(str(problem) for problem in problems))


class SolveError(CosseratError):
    """No equilibrium was found and the caller asked for an exception."""

    page = "hard-cases"


class ExportError(CosseratError):
    """A model cannot be exported with these options, or an exported folder cannot be used.

    Attributes:
        problems: every fault found.
    """

    page = "c-interface"

    def __init__(self, *problems: Problem) -> None:
        self.problems = problems
        super().__init__("\n".join(str(problem) for problem in problems))


@contextmanager
def collect_problems(problems: list[Problem]) -> Iterator[None]:
    """Collect the problems of a refusal and let the checks continue, so that a user sees every fault at once."""
    try:
        yield
    except (SceneError, ExportError) as error:
        problems.extend(error.problems)


def refuse(problems: Iterable[Problem], kind: Callable[..., SceneError | ExportError] = SceneError) -> None:
    """Raise an error with all problems, if there are any."""
    found = tuple(problems)
    if found:
        raise kind(*found)
