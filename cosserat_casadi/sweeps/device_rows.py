"""Rows of a sweep on a GPU, which is experimental, or from this source on a processor."""

from __future__ import annotations

import json
import threading
from dataclasses import dataclass

import numpy as np

from cosserat_casadi.codegen.device_batch import CUDA, FLAGS, HOST, DeviceBatch, batch_of, check_gpu, find_nvcc
from cosserat_casadi.codegen.export import folder_files
from cosserat_casadi.codegen.manifest import MANIFEST
from cosserat_casadi.codegen.rows import JUDGED, NAME, row_results
from cosserat_casadi.errors import Problem
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.scene import Scene

DEVICE_ROWS = 65_536
"""Number of rows of a chunk for a GPU: some for each of its threads."""

_LOCK = threading.Lock()
"""Lock by which threads take turns on the device: they share its workspaces."""


@dataclass(frozen=True)
class DeviceRows:
    """The solver of rows of one scene.

    Attributes:
        batch: the compiled source.
        inputs: numbers in a row of inputs, which parameters follow.
        results: numbers in a row of results.
    """

    batch: DeviceBatch
    inputs: int
    results: int

    def solve(self, inputs: FloatArray) -> FloatArray:
        """Rows of results for rows of inputs followed by parameters.

        Raises:
            ExportError: the device refuses.
        """
        split = self.inputs
        with _LOCK:
            found = self.batch.rows(inputs[:, :split], inputs[:, split:] if inputs.shape[1] > split else None)
        rows = np.full((len(inputs), self.results), np.nan)
        judged = len(JUDGED)
        rows[:, :judged] = np.array([found["status"], found["iterations"], found["residual_norm"]]).T
        behind = judged + len(found["results"])
        rows[:, judged:behind] = found["results"].T
        if behind < self.results:
            # Rows that were not solved have no error.
            rows[:, behind] = np.where(found["status"] == 0, found["error_estimate"], np.nan)
        return rows


def device_rows(model: Model, device: str, *, estimate_errors: bool) -> DeviceRows:
    """The solver of rows of a model on a device.

    Args:
        model: of rods.
        device: ``cuda`` or ``host``.
        estimate_errors: whether rows have :data:`cosserat_casadi.codegen.rows.ERRORS`.

    Raises:
        ExportError: it cannot be compiled for the device.
    """
    files = folder_files(model, NAME, cuda=True, estimate_errors=estimate_errors)
    texts = {name: text for name, text in files.items() if name.endswith((".c", ".h", ".cu"))}
    batch = batch_of(json.loads(files[MANIFEST]), texts, device)
    columns = len(row_results(model.scene, estimate_errors=estimate_errors))
    return DeviceRows(batch, model.inputs.size, columns)


def device_problems(scene: Scene, device: str, *, stability: bool) -> list[Problem]:
    """Problems of a scene whose rows cannot be solved on a device.

    Raises:
        ExportError: it is a GPU, and there is none, or no compiler for it.
    """
    if device not in FLAGS:
        return [Problem("--device", f"must be {CUDA} or {HOST}, got {device!r}")]
    problems = []
    if scene.tubes or scene.touches_exactly:
        problem = "is for rods without exact contact, and the scene has contact or concentric tubes"
        problems.append(Problem("--device", problem, "leave it out"))
    if stability:
        problems.append(Problem("--device", "tells nothing of stability", "leave one of the two out"))
    if not problems and device == CUDA:
        find_nvcc()
        check_gpu()
    return problems
