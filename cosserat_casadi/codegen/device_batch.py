"""Batches of an exported folder on a GPU, experimental: the source that ``--cuda`` writes, compiled and called.

Arrays of CuPy, JAX, NumPy, PyTorch and other libraries are used in place, by DLPack. Compiled for a processor, the
device ``host``, the source computes the rows in equal order, which tests everything except the speed.
"""

from __future__ import annotations

import ctypes
import os
import shlex
import shutil
import sysconfig
import weakref
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from cosserat_casadi.codegen.library import device_files
from cosserat_casadi.codegen.manifest import EXPORT_FIRST, MANIFEST, read_manifest
from cosserat_casadi.compiling.compiler import EXPORT_ANEW, compiled_texts, find_compiler
from cosserat_casadi.errors import ExportError, Problem

HOST, CUDA = "host", "cuda"
"""Devices: a processor, one row after the other, and a GPU of NVIDIA."""

FLAGS = {
    HOST: ("-O2", "-std=c++20", "-fPIC"),
    CUDA: ("-O2", "-std=c++20", "-arch=native", "-Xcompiler", "-fPIC"),
}
"""Flags of compilers by device; an architecture in a command, such as ``nvcc -arch=sm_90``, comes after them."""

NVCC_OF_WHEELS = "nvidia/*/bin/nvcc"
"""Path of the compiler in NVIDIA's wheels, relative to the folder of packages."""

DLPACK_DEVICES = {HOST: (1, 3), CUDA: (2, 13)}
"""Kinds of memory that each device reads, by their numbers in DLPack: processor and pinned; GPU and managed."""

KINDS = {0: "int", 2: "float"}
"""Types of numbers by their code in DLPack."""

THREADS, ROOM = 16_384, 4e9
"""Default number of rows that a GPU solves at once, and largest size of their workspaces, bytes."""

SOLVE_TABLE = {
    "inputs": "inputs",
    "parameters": "parameters",
    "x": "x",
    "status": "status",
    "iterations": "whole",
    "jacobians": "whole",
    "residual_norm": "number",
    "load_factor": "number",
    "error_estimate": "number",
    "results": "results",
    "d_x_d_inputs": "d_x_d_inputs",
    "d_poses_d_inputs": "d_poses_d_inputs",
}
"""Pointers in the table of a solve, in their order in C, and the kind of shape of each."""

STEP_TABLE = {
    "inputs": "inputs",
    "parameters": "parameters",
    "inputs_rate": "inputs",
    "inputs_acceleration": "inputs",
    "state": "state",
    "memory": "memory",
    "status": "status",
    "iterations": "whole",
    "jacobians": "whole",
    "parts": "whole",
    "residual": "number",
    "error_left": "number",
    "d_end_d_start": "d_end_d_start",
    "d_end_d_inputs": "d_end_d_inputs",
    "d_end_d_inputs_rate": "d_end_d_inputs",
    "d_end_d_inputs_acceleration": "d_end_d_inputs",
}
"""Pointers in the table of a step, in their order in C, and the kind of shape of each."""

NEEDED = frozenset({"inputs", "parameters", "x", "status", "state", "memory"})
"""Pointers that may not be null."""


class Array(Protocol):
    """An array with the DLPack protocol."""

    def __dlpack__(self, *, stream: Any = None) -> Any:
        """Return a capsule with a ``DLTensor``."""
        ...


class _Tensor(ctypes.Structure):
    """A ``DLTensor``."""

    _fields_ = (
        ("data", ctypes.c_void_p),
        ("device", ctypes.c_int32),
        ("device_number", ctypes.c_int32),
        ("axes", ctypes.c_int32),
        ("code", ctypes.c_uint8),
        ("bits", ctypes.c_uint8),
        ("lanes", ctypes.c_uint16),
        ("shape", ctypes.POINTER(ctypes.c_int64)),
        ("strides", ctypes.POINTER(ctypes.c_int64)),
        ("offset", ctypes.c_uint64),
    )


@dataclass(frozen=True)
class DeviceBatch:
    """Batches of one scene on one device.

    Attributes:
        library: the shared object.
        manifest: manifest of the folder.
        device: ``cuda`` or ``host``.
        single: whether numbers are float instead of double.
        threads: number of rows that are solved at once.
    """

    library: Path
    manifest: Mapping[str, Any]
    device: str
    single: bool = False
    threads: int = 1

    def solve(self, *, stream: int = 0, **arrays: Array | None) -> None:
        """Solve for equilibria of many load cases from the unloaded scene; the arrays of the call receive them.

        For m inputs, p parameters, n unknowns and k rows, the arrays are ``inputs`` (m, k), ``parameters`` (p, k) if
        the scene has some, ``x`` (n, k) and ``status`` (k), whose values the header lists. Optional arrays are
        ``iterations``, ``jacobians``, ``residual_norm``, ``load_factor``, ``error_estimate`` (k); ``results`` (r, k),
        poses of tips and bodies, efforts and conjugates of actuators; ``d_x_d_inputs`` (k, m, n); ``d_poses_d_inputs``
        (k, poses, m, 7). On a GPU the call returns before the arrays are written.

        Args:
            stream: address of a CUDA stream; the default one by default.
            **arrays: arrays by these names, contiguous and on the device.

        Raises:
            ValueError: an array is missing, unknown, or of the wrong type, shape or place.
            ExportError: the device reports an error; there may be no GPU.
        """
        self._run("solve", SOLVE_TABLE, [], arrays, stream)

    def step(
        self,
        dt: float,
        *,
        tolerance: float = 0.0,
        max_iterations: int = 0,
        max_parts: int = 0,
        stream: int = 0,
        **arrays: Array | None,
    ) -> None:
        """Take one step of many motions; the arrays of the call receive the results.

        The arrays are ``inputs`` (m, k), ``parameters`` (p, k); ``state`` (3 n, k), with x, v and a, updated in place;
        ``memory`` (k, :attr:`memory_size`), bytes, zeros before the first step; ``status`` (k). Optional arrays are
        ``inputs_rate``, ``inputs_acceleration`` (m, k); ``iterations``, ``jacobians``, ``parts``, ``residual``,
        ``error_left`` (k); ``d_end_d_start`` (k, 2 n, 2 n), transposed, as columns are contiguous; ``d_end_d_inputs``,
        ``d_end_d_inputs_rate``, ``d_end_d_inputs_acceleration`` (k, m, 2 n).

        Args:
            dt: size of the step, s.
            tolerance: tolerance of Newton's method in C; set all three options, or none for the defaults.
            max_iterations: most iterations of one attempt.
            max_parts: most parts into which a step may be cut.
            stream: address of a CUDA stream.
            **arrays: arrays by these names.

        Raises:
            AttributeError: the folder has no motions.
            ValueError: an array is missing, unknown, or of the wrong type, shape or place; or a setting is missing.
            ExportError: the device refuses.
        """
        if not max_parts and (tolerance or max_iterations):
            raise ValueError("with max_parts 0 the defaults hold: give max_parts beside tolerance and max_iterations")
        real = self._real
        settings = [("dt", real, dt), ("tolerance", real, tolerance)]
        settings += [("max_iterations", ctypes.c_int, max_iterations), ("max_parts", ctypes.c_int, max_parts)]
        self._run("step", STEP_TABLE, settings, arrays, stream)

    @property
    def size(self) -> int:
        """Number of unknowns."""
        return sum(int(entry["count"]) for entry in self.manifest["unknowns"])

    @property
    def workspace_size(self) -> int:
        """Size of the workspace of a thread, bytes."""
        return self._sizes[0]

    @property
    def memory_size(self) -> int:
        """Size of the memory of a motion between its steps, bytes; 0 if the folder has no motions."""
        return self._sizes[2]

    def rows(self, inputs: np.ndarray[Any, Any], parameters: np.ndarray[Any, Any] | None = None) -> dict[str, Any]:
        """Solve load cases in NumPy arrays, copied through device memory; results by the names of :meth:`solve`.

        Args:
            inputs: shape (k, m).
            parameters: shape (k, p); None for a scene without parameters.

        Raises:
            ValueError: a table is missing, or of the wrong shape.
            ExportError: the device refuses.
        """
        count = len(inputs)
        given = {"inputs": inputs, "parameters": np.empty((count, 0)) if parameters is None else parameters}
        for name, table in given.items():
            wanted_shape = self._shape(name, count)[::-1]
            if np.shape(table) != wanted_shape:
                raise ValueError(f"{name} must be of shape {wanted_shape}, got {np.shape(table)}")
        given = {name: table for name, table in given.items() if name == "inputs" or table.size}
        tables = {name: np.array(table.T, self.dtype, order="C") for name, table in given.items()}
        wanted = ("x", "status", "iterations", "residual_norm", "error_estimate", "results")
        for name in wanted:
            tables[name] = np.empty(self._shape(SOLVE_TABLE[name], count), self._type(SOLVE_TABLE[name]))
        addresses: dict[str, int] = {}
        try:
            for name, table in tables.items():
                addresses[name] = self._allocate(table.nbytes)
            for name in given:
                self._check(self._function("device_copy")(addresses[name], *_bytes_of(tables[name])))
            self._call("solve", SOLVE_TABLE, [], addresses, count, 0)
            for name in wanted:
                address, size = _bytes_of(tables[name])
                self._check(self._function("device_copy")(address, addresses[name], size))
        finally:
            for address in addresses.values():
                self._function("device_release")(address)
        return {name: tables[name] for name in wanted}

    @property
    def dtype(self) -> Any:
        """NumPy type of the numbers in arrays."""
        return np.float32 if self.single else np.float64

    @property
    def _real(self) -> Any:
        return ctypes.c_float if self.single else ctypes.c_double

    @cached_property
    def _handle(self) -> ctypes.CDLL:
        return ctypes.CDLL(str(self.library))

    def _function(self, word: str) -> Any:
        function = getattr(self._handle, f"{self.manifest['name']}_{word}")
        if word == "device_copy":
            function.argtypes = [ctypes.c_void_p, ctypes.c_void_p, ctypes.c_size_t]
        elif word == "device_release":
            function.argtypes = [ctypes.c_void_p]
        elif word == "device_error_text":
            function.restype = ctypes.c_char_p
        return function

    @cached_property
    def _sizes(self) -> list[int]:
        """Bytes of a workspace, count of numbers in a row of results, bytes of the memory of a motion."""
        sizes = (ctypes.c_size_t * 3)()
        self._function("device_sizes")(sizes)
        return list(sizes)

    @cached_property
    def _workspaces(self) -> int:
        """Address of the workspaces of all threads, which stay as long as the batch."""
        address = self._allocate(self.threads * self.workspace_size)
        # The process gives back at its end, and the device may be gone by then.
        weakref.finalize(self, self._function("device_release"), address).atexit = False
        return address

    def _allocate(self, size: int) -> int:
        address = ctypes.c_void_p()
        self._check(self._function("device_allocate")(ctypes.byref(address), ctypes.c_size_t(size)))
        return address.value or 0

    def _check(self, error: int) -> None:
        if error:
            told = self._function("device_error_text")(error).decode()
            remedy = "try fewer threads where memory lacks; the device 'host' needs no GPU"
            raise ExportError(Problem(f"the device {self.device}", f"refuses: {told}", remedy))

    def _shape(self, kind: str, count: int) -> tuple[int, ...]:
        """Shape of an array of a table."""
        described = self.manifest
        inputs, parameters = (_length(described.get(key, [])) for key in ("inputs", "parameters"))
        unknowns = self.size
        rods = len({entry["rod"] for entry in described["unknowns"]})
        poses = rods + len(described.get("bodies", []))
        shapes = {
            "inputs": (inputs, count),
            "parameters": (parameters, count),
            "x": (unknowns, count),
            "state": (3 * unknowns, count),
            "memory": (count, self.memory_size),
            "results": (self._sizes[1], count),
            "d_x_d_inputs": (count, inputs, unknowns),
            "d_poses_d_inputs": (count, poses, inputs, 7),
            "d_end_d_start": (count, 2 * unknowns, 2 * unknowns),
            "d_end_d_inputs": (count, inputs, 2 * unknowns),
        }
        return shapes.get(kind, (count,))

    def _type(self, kind: str) -> Any:
        return np.int32 if kind in ("status", "whole") else self.dtype

    def _run(
        self,
        word: str,
        members: Mapping[str, str],
        settings: list[tuple[str, Any, Any]],
        arrays: Mapping[str, Array | None],
        stream: int,
    ) -> None:
        """Call a function on arrays, after a check of each array."""
        if word == "step" and not self.memory_size:
            raise AttributeError("export the folder with motions: export(..., dynamics=True)")
        given = {name: array for name, array in arrays.items() if array is not None}
        unknown = sorted(set(given) - set(members))
        own = [name for name in members if name != "parameters" or self.manifest.get("parameters")]
        missing = [name for name in own if name in NEEDED and name not in given]
        if unknown or missing:
            raise ValueError(f"arrays that are unknown: {unknown}; that are missing: {missing}")
        # Capsules keep the memory until the call.
        capsules = {name: self._capsule(name, array, stream) for name, array in given.items()}
        tensors = {name: _tensor_of(capsule) for name, capsule in capsules.items()}
        count = int(tensors["status"].shape[0]) if tensors["status"].axes else 0
        addresses = {name: self._address(name, tensor, members[name], count) for name, tensor in tensors.items()}
        self._call(word, members, settings, addresses, count, stream)

    def _capsule(self, name: str, array: Array, stream: int) -> Any:
        """Return the capsule of an array, ordered after earlier work on its memory by the stream.

        Raises:
            ValueError: the array has no such protocol, or is read-only.
        """
        if not hasattr(array, "__dlpack__"):
            raise ValueError(f"{name} must be an array with __dlpack__, got {type(array).__name__}")
        try:
            return array.__dlpack__() if self.device == HOST else array.__dlpack__(stream=stream or 1)
        except (BufferError, RuntimeError) as error:
            raise ValueError(f"{name} gives no memory: {error}") from None

    def _address(self, name: str, tensor: _Tensor, kind: str, count: int) -> int:
        """Return the address of the numbers of an array.

        Raises:
            ValueError: the type, the shape or the memory of the array is wrong.
        """
        shape = tuple(tensor.shape[i] for i in range(tensor.axes))
        wanted = self._shape(kind, count)
        if tensor.device not in DLPACK_DEVICES[self.device]:
            raise ValueError(f"{name} must lie in memory of the device {self.device}")
        if kind == "memory":
            typed = tensor.bits == 8
        else:
            dtype = np.dtype(self._type(kind))
            typed = KINDS.get(tensor.code) == dtype.name.rstrip("0123456789") and tensor.bits == 8 * dtype.itemsize
        if not typed or shape != wanted:
            described = "bytes" if kind == "memory" else np.dtype(self._type(kind)).name
            raise ValueError(f"{name} must be {described} of shape {wanted}, got shape {shape} of {tensor.bits} bits")
        if tensor.strides and not _contiguous(shape, [tensor.strides[i] for i in range(tensor.axes)]):
            raise ValueError(f"{name} must be contiguous, its last axis first")
        return int(tensor.data or 0) + int(tensor.offset)

    def _call(
        self,
        word: str,
        members: Mapping[str, str],
        settings: list[tuple[str, Any, Any]],
        addresses: Mapping[str, int],
        count: int,
        stream: int,
    ) -> None:
        pointers = [name for name in members if name != "parameters" or self.manifest.get("parameters")]

        class Table(ctypes.Structure):
            _fields_ = [
                ("count", ctypes.c_int),
                *((name, kind) for name, kind, _ in settings),
                *((name, ctypes.c_void_p) for name in pointers),
            ]

        values = {name: value for name, _, value in settings}
        table = Table(count=count, **values, **{name: address or None for name, address in addresses.items()})
        workspaces = ctypes.c_void_p(self._workspaces)
        call = self._function(f"{word}_on_device")
        self._check(call(ctypes.byref(table), workspaces, self.threads, ctypes.c_void_p(stream)))


def load_batch(
    directory: str | os.PathLike[str],
    device: str = CUDA,
    *,
    compiler: str | None = None,
    single: bool = False,
    threads: int | None = None,
) -> DeviceBatch:
    """Compile the batches of an exported folder for a device, once, and load them. Experimental.

    Args:
        directory: a folder that was exported with ``cuda=True``.
        device: ``cuda``, or ``host`` to run the source on a processor.
        compiler: a command, such as ``nvcc -arch=sm_90``; by default nvcc of the path or of the extra ``cuda``.
        single: whether to compute in float.
        threads: number of rows that are solved at once; each takes a workspace of the device. By default one on the
            host, and on a GPU a usual number that fits into a few gigabytes.

    Raises:
        ExportError: the folder has no batches on a GPU, there is no compiler, or it fails.
    """
    folder = Path(directory)
    described = read_manifest(folder)
    files = described.get("files", []) if isinstance(described, dict) else []
    if not isinstance(described, dict) or device_files(str(described.get("name")))[0] not in files:
        problem = "holds no batches on a GPU" if files else "is not the manifest of an exported folder"
        raise ExportError(Problem(str(folder / MANIFEST), problem, "export it with --cuda" if files else EXPORT_FIRST))
    texts = {}
    for file in files:
        if file.endswith((".c", ".h", ".cu")):
            try:
                texts[file] = (folder / file).read_text(encoding="utf-8")
            except OSError:
                raise ExportError(Problem(str(folder / file), "is missing", EXPORT_ANEW)) from None
    return batch_of(described, texts, device, compiler=compiler, single=single, threads=threads)


def batch_of(
    described: Mapping[str, Any],
    texts: Mapping[str, str],
    device: str,
    *,
    compiler: str | None = None,
    single: bool = False,
    threads: int | None = None,
) -> DeviceBatch:
    """A batch as :func:`load_batch` gives it, from a manifest, and texts of sources and headers by name."""
    if device not in FLAGS or (threads is not None and threads < 1):
        raise ValueError(f"a device is 'cuda' or 'host', with at least one thread, got {device!r} and {threads}")
    found = find_compiler(compiler) if device == HOST else find_nvcc(compiler)
    name = described["name"]
    source = device_files(name)[0]
    # Compilers tell languages by the ends of names.
    renamed = {(f"{name}_batch.cpp" if file == source and device == HOST else file): texts[file] for file in texts}
    included = [file for file in renamed if file.endswith(".c")]
    flags = (*FLAGS[device], *([f"-D{name.upper()}_SINGLE"] if single else []))
    library = compiled_texts(f"{name}_{device}", renamed, found, included, flags=flags)
    batch = DeviceBatch(library, described, device, single)
    usual = 1 if device == HOST else max(1, min(THREADS, int(ROOM // batch.workspace_size)))
    return replace(batch, threads=usual if threads is None else threads)


def find_nvcc(wanted: str | None = None) -> str:
    """Find the command of the compiler for GPUs: the wanted one, the one on the path, or the one in NVIDIA's wheels.

    Raises:
        ExportError: there is none.
    """
    if wanted is not None or shutil.which("nvcc"):
        return find_compiler(wanted or "nvcc")
    of_wheels = sorted(Path(sysconfig.get_path("purelib")).glob(NVCC_OF_WHEELS))
    if not of_wheels:
        remedy = "install the extra cuda, `pip install 'cosserat-casadi[cuda]'`, or the CUDA toolkit; or leave it out"
        raise ExportError(Problem("--device cuda", "there is no nvcc on the path, nor among the packages", remedy))
    return shlex.quote(str(of_wheels[-1]))


def check_gpu() -> None:
    """Refuse a machine whose driver finds no GPU.

    Raises:
        ExportError: there is none.
    """
    count = ctypes.c_int()
    try:
        driver = ctypes.CDLL("libcuda.so.1")
        usable = driver.cuInit(0) == 0 and driver.cuDeviceGetCount(ctypes.byref(count)) == 0 and count.value > 0
    except (OSError, AttributeError):
        usable = False
    if not usable:
        remedy = "run it on a machine with one and its driver, or leave it out"
        raise ExportError(Problem("--device cuda", "there is no GPU of NVIDIA that this machine can use", remedy))


def _length(entries: list[dict[str, Any]]) -> int:
    return sum(len(entry["value"]) for entry in entries)


def _bytes_of(array: np.ndarray[Any, Any]) -> tuple[int, int]:
    """Address and size of an array."""
    return array.ctypes.data, array.nbytes


def _contiguous(shape: tuple[int, ...], strides: list[int]) -> bool:
    """Whether numbers are contiguous; strides of axes with one entry have no meaning."""
    apart = [int(np.prod(shape[i + 1 :])) for i in range(len(shape))]
    is_placed = (own == wanted or size == 1 for own, wanted, size in zip(strides, apart, shape, strict=True))
    return 0 in shape or all(is_placed)


def _tensor_of(capsule: Any) -> _Tensor:
    """Read the tensor in a capsule of DLPack."""
    pointer = ctypes.pythonapi.PyCapsule_GetPointer
    pointer.restype = ctypes.c_void_p
    pointer.argtypes = [ctypes.py_object, ctypes.c_char_p]
    return _Tensor.from_address(pointer(capsule, b"dltensor"))
