"""A sweep on an existing cluster of dask.distributed, which is an extra and is imported inside functions only.

Sources go to the workers as text and are compiled there, once on each machine. A worker that dies loses its present
chunks, and the scheduler gives them to another one: every chunk comes back, and the store keeps each only once.
"""

from __future__ import annotations

import gc
from collections.abc import Iterable, Iterator, Sequence
from contextlib import AbstractContextManager
from importlib.metadata import version
from types import TracebackType
from typing import Any

from cosserat_casadi.errors import CosseratError, Problem, SceneError
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.sweeps.work import Answer, Chunk, Part, solve_parts

AHEAD = 256
"""Chunks that the scheduler has at once: enough for many workers, few enough for its memory."""

TRIES = 3
"""Attempts to make a client, whose thread in dask may not begin in time."""

PATIENCE = 15
"""Time in which a scheduler has to answer, s."""


class ClusterError(CosseratError):
    """The cluster cannot be used."""

    page = "sweeps"


class Cluster(AbstractContextManager["Cluster"]):
    """A scheduler with its workers; results come as they are ready."""

    def __init__(self, address: str) -> None:
        self._client = _client(address)
        self._shared: dict[int, Any] = {}

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self._shared.clear()
        self._client.close()

    def run(self, tasks: Iterable[tuple[Chunk, Sequence[Part]]]) -> Iterator[tuple[Chunk, FloatArray]]:
        """Every chunk with its results, in the order in which they are ready."""
        from distributed import as_completed

        waiting: dict[str, Chunk] = {}
        finished = as_completed(loop=self._client.loop)
        for chunk, parts in tasks:
            # Pure tasks would be cached by a hash of their arguments, which costs more than it saves.
            future = self._client.submit(_solve, *self._arguments(chunk, parts), pure=False)
            waiting[future.key] = chunk
            finished.add(future)
            if len(waiting) >= AHEAD:
                yield _taken(next(finished), waiting)
        while waiting:
            yield _taken(next(finished), waiting)

    def _arguments(self, chunk: Chunk, parts: Sequence[Part]) -> tuple[Any, ...]:
        """Solver and inputs of a chunk; a compiled library is the result of a task, which every worker can repeat."""
        if not chunk.compiled:
            return tuple(parts), None
        # A compiled chunk has one part.
        answer, inputs = parts[0]
        variant, _ = chunk.pieces[0]
        if variant not in self._shared:
            # Chunks come variant by variant: the library of the last one is not needed any more.
            self._shared = {variant: self._client.submit(_same, answer, pure=False)}
        return self._shared[variant], inputs


def _client(address: str) -> Any:
    try:
        from distributed import Client
    except ImportError:
        message = "--scheduler needs dask.distributed: install it with  pip install 'cosserat-casadi[sweep]'"
        raise ClusterError(message) from None
    try:
        client = _connected(Client, address)
    except (OSError, ValueError) as error:
        remedy = "start one with dask scheduler, and workers with dask worker"
        raise SceneError(Problem("--scheduler", f"no scheduler answers at {address}: {error}", remedy)) from None
    _check_workers(client)
    return client


def _connected(make_client: Any, address: str) -> Any:
    """A client of a scheduler; dask gives its own thread ten seconds to begin, which a busy machine may take."""
    for _ in range(TRIES):
        # A client that never was connected closes itself where it is collected. Were that in the middle of making
        # another one, both would wait for one lock of dask's for ever.
        gc.collect()
        try:
            return make_client(address, timeout=PATIENCE, set_as_default=False)
        except AssertionError:
            continue
    raise ClusterError("dask's own thread did not begin to run: this machine is too busy")


def _check_workers(client: Any) -> None:
    """Refuse a scheduler without workers, and workers without this package or with another version."""
    try:
        client.wait_for_workers(1, timeout=PATIENCE)
        versions = client.run(_version)
    except TimeoutError:
        client.close()
        raise ClusterError("the scheduler has no workers: start some with  dask worker ADDRESS") from None
    except ImportError as error:
        client.close()
        raise ClusterError(f"the workers lack this package: {error}") from None
    own = _version()
    differing = sorted({f"{address} has {theirs}" for address, theirs in versions.items() if theirs != own})
    if differing:
        client.close()
        message = f"the workers' versions of cosserat-casadi differ from {own} here: {'; '.join(differing)}"
        raise ClusterError(message)


def _version() -> str:
    return version("cosserat-casadi")


def _same(answer: Answer) -> Answer:
    return answer


def _solve(answer: Answer | tuple[Part, ...], inputs: FloatArray | None) -> FloatArray:
    if isinstance(answer, tuple):
        return solve_parts(answer)
    return answer.solve(inputs)  # type: ignore[arg-type]


def _taken(future: Any, waiting: dict[str, Chunk]) -> tuple[Chunk, FloatArray]:
    from distributed import CancelledError, KilledWorker

    try:
        results: FloatArray = future.result()
    except (CancelledError, KilledWorker, OSError) as error:
        message = f"the cluster gave a chunk up: {error}; the same command goes on with the other rows"
        raise ClusterError(message) from None
    chunk = waiting.pop(future.key)
    return chunk, results
