"""A sweep from start to end: table ↦ scenes ↦ one discretisation ↦ chunks ↦ results, checked and written."""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from cosserat_casadi.codegen.contact.rows import contact_row_library
from cosserat_casadi.codegen.names import scene_names
from cosserat_casadi.codegen.rows import ERRORS, JUDGED, NAME, POSE, STABILITY, RowLibrary, row_library, row_results
from cosserat_casadi.compiling.compiler import find_compiler
from cosserat_casadi.equilibrium.smooth_passage import has_barriers
from cosserat_casadi.errors import ExportError, Problem, SceneError, collect_problems, refuse
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model, build
from cosserat_casadi.model.discretise import with_discretisation
from cosserat_casadi.model.obstacle_checks import refuse_held_by_contact
from cosserat_casadi.model.tube_checks import refuse_tubes
from cosserat_casadi.numerics.progress import StageProgress, not_told
from cosserat_casadi.scene import Scene
from cosserat_casadi.scene.writing import scene_text
from cosserat_casadi.spelling import named
from cosserat_casadi.sweeps.arguments import COMPILED_FROM, IN_CONTACT_FROM
from cosserat_casadi.sweeps.choice import Choice, check, choose
from cosserat_casadi.sweeps.cluster import Cluster
from cosserat_casadi.sweeps.device_rows import DEVICE_ROWS, DeviceRows, device_problems, device_rows
from cosserat_casadi.sweeps.local import Cores
from cosserat_casadi.sweeps.outcome_file import check_output, read_record, read_sweep, record_file, write_sweep
from cosserat_casadi.sweeps.outcome_table import Sweep
from cosserat_casadi.sweeps.row_model import RowModel
from cosserat_casadi.sweeps.sampling import representative_rows
from cosserat_casadi.sweeps.scratch import Scratch
from cosserat_casadi.sweeps.store import Memory, Store, StoreChangedError
from cosserat_casadi.sweeps.table import Table, read_table, table_of
from cosserat_casadi.sweeps.variants import Variants, variants_of
from cosserat_casadi.sweeps.work import (
    COMPILED_ROWS,
    MODELLED_ROWS,
    TOLD,
    Answer,
    Chunk,
    LibraryWithPython,
    Part,
    Shard,
    chunks,
    shard_files,
)

IN_LANES_FROM = 1_250_000
"""Least rows of one scene that are solved side by side: fewer save less time than their compilation takes. For
a wire with 12 unknowns gcc takes 4.0 s longer, and a row takes 3.4 µs less (``benchmarks/row_cost.py``)."""

LET_GO = 64
"""Chunks whose inputs or results are in memory at once."""

SAMPLES = 12
"""Default number of rows on which the discretisation is chosen."""


@dataclass(frozen=True)
class Plan:
    """A sweep with valid inputs, before anything is computed or written.

    Attributes:
        scene: the given scene.
        table: the rows of the sweep.
        variants: the scenes and inputs of the rows.
        output: file of the results, if one is wanted.
        samples: number of rows on which the discretisation is chosen.
        stability: whether each row says whether its equilibrium is stable.
        estimate_errors: whether each row says how large its error is, and whether it is within the tolerance.
        device: device for compiled rows, see :func:`device_problems`; None for the cores.
    """

    scene: Scene
    table: Table
    variants: Variants
    output: Path | None
    samples: int
    stability: bool = False
    estimate_errors: bool = True
    device: str | None = None

    @property
    def identity(self) -> str:
        """Identity of the sweep: equal identities give equal results."""
        words = [
            version("cosserat-casadi"),
            scene_text(self.scene),
            self.table.columns,
            self.samples,
            # They decide which rows are solved in C, whose results are equal to the tolerance, but not to the last
            # digit.
            [COMPILED_FROM, COMPILED_ROWS, IN_CONTACT_FROM, MODELLED_ROWS],
            self.stability,
            self.table.factors,
            self.estimate_errors,
            *([] if self.device is None else [self.device]),
        ]
        digest = hashlib.sha256(json.dumps(words).encode())
        # Block by block, since the bytes of all would be a copy of the table.
        for block in self.scratch.blocks(len(self.table.values)):
            digest.update(np.ascontiguousarray(self.table.values[block], dtype="<f8").data)
        return digest.hexdigest()

    @property
    def scratch(self) -> Scratch:
        """Storage of arrays with an entry for each row."""
        return self.table.scratch

    @property
    def columns(self) -> tuple[str, ...]:
        """Columns of numbers of the results."""
        # A quantity that is both given and a result, such as a tension, is in the table already; for a slack cable its
        # length. The outcome, which comes first, is not a number.
        results = [name for name in self.results[1:] if name not in self.table.columns]
        return (*self.table.columns, *results)

    @property
    def results(self) -> tuple[str, ...]:
        """Names of the numbers in the results of a row."""
        return row_results(self.scene, estimate_errors=self.estimate_errors, stability=self.stability)

    @property
    def work(self) -> list[Chunk]:
        """All rows in chunks."""
        if self.device is not None:
            return chunks(self.variants, compiled_rows=DEVICE_ROWS)
        return chunks(self.variants)

    @property
    def part(self) -> Path | None:
        """The file of the finished rows, until all are finished."""
        if self.output is None:
            return None
        return self.output.with_name(f"{self.output.name}.part")

    @property
    def finished(self) -> bool:
        """Whether the file of results exists already and belongs to this sweep."""
        if self.output is None or not self.output.exists():
            return False
        record = read_record(self.output)
        return record is not None and record["sweep"] == self.identity


def plan_sweep(
    scene: Scene,
    table: Table,
    output: Path | None = None,
    samples: int = SAMPLES,
    *,
    stability: bool = False,
    estimate_errors: bool = True,
    device: str | None = None,
) -> Plan:
    """The plan of a sweep with the arguments of :func:`sweep`; faults are refused before anything is computed.

    Raises:
        SceneError: with every fault of scene, table and output.
        ExportError: there is no compiler or no GPU, or two things of the scene would have one name in C.
    """
    # Rows differ in the columns of the table alone.
    scene = scene.baked()
    rods = {rod.name for rod in scene.rods}
    problems = [
        Problem(
            f"bodies[{i}].name",
            f"{body.name!r} is the name of a rod too: their columns could not be told apart",
            "rename one",
        )
        for i, body in enumerate(scene.bodies)
        if body.name in rods
    ]
    plan = None
    if samples < 1:
        problems.append(Problem("--samples", f"must be at least 1, got {samples}"))
    if device is not None:
        problems += device_problems(scene, device, stability=stability)
    with collect_problems(problems):
        refuse_held_by_contact(scene)
        plan = Plan(scene, table, variants_of(scene, table), output, samples, stability, estimate_errors, device)
    problems += output_problems(output, plan)
    if problems or plan is None:
        raise SceneError(*problems)
    # Rows in exact contact, and rows of tubes, are solved in Python if C does not solve them.
    if not scene.touches_exactly and not scene.tubes:
        # Both raise if a library could not be generated or compiled.
        scene_names(NAME, scene)
        find_compiler()
    return plan


def sweep(
    subject: Scene | Model,
    table: Table | Mapping[str, npt.ArrayLike] | str | os.PathLike[str],
    output: str | os.PathLike[str] | None = None,
    *,
    scheduler: str | None = None,
    cores: int | None = None,
    samples: int = SAMPLES,
    stability: bool = False,
    estimate_errors: bool = True,
    device: str | None = None,
    progress: StageProgress | None = None,
) -> Sweep:
    """Solve a scene for every row of a table of inputs and parameters.

    Args:
        subject: a validated scene, or a model of rods, of which modes and nodes are kept.
        table: arrays by column, such as ``{"push.force.x": [0.0, 0.1]}``; a CSV file with a header; or a grid in TOML.
        output: file to write, ``.csv`` or ``.parquet``, or folder of Parquet files, ``.dataset``, with a record of the
            computation beside it. Finished rows of a killed or interrupted run of this sweep are not computed again.
        scheduler: address of a dask.distributed scheduler; by default the cores of this machine work.
        cores: number of working cores, at least 1; all by default.
        samples: number of rows on which the discretisation is chosen.
        stability: whether each row has its stability: the columns ``smallest_eigenvalue``, in units of EI/ℓ of the
            given scene, and ``stable``, 1 or 0; NaN if the loads of a row have no potential.
        estimate_errors: whether each row has its error: the columns ``error_estimate``, 1 for an unknown error, and
            ``within_tolerance``, 1 or 0; NaN if the scene fixes its modes and has no given tolerance.
        device: ``cuda`` for a GPU, which is experimental and was never run on one, or ``host`` for this source on a
            processor; the cores by default.
        progress: receives the work under way, its finished part, and its total.

    Raises:
        SceneError: with every fault of table and output.
        ExportError: there is no C compiler, or it fails.
        ClusterError: the cluster cannot be used.
    """
    if not isinstance(subject, Scene):
        refuse_tubes(subject)
        subject = with_discretisation(subject.scene, subject.discretisation)
    file = None if output is None else Path(output)
    scratch = Scratch.beside(file)
    if isinstance(table, Mapping):
        table = table_of(table, scratch)
    elif not isinstance(table, Table):
        table = read_table(Path(table), scratch=scratch)
    plan = plan_sweep(
        subject, table, file, samples, stability=stability, estimate_errors=estimate_errors, device=device
    )
    return run_sweep(plan, scheduler=scheduler, cores=cores, progress=progress)


def run_sweep(
    plan: Plan,
    *,
    scheduler: str | None = None,
    cores: int | None = None,
    progress: StageProgress | None = None,
) -> Sweep:
    """Do the work of a plan, or the rest of it; if it is finished, read the results.

    Args:
        plan: plan by :func:`plan_sweep`.
        scheduler: as in :func:`sweep`.
        cores: as there.
        progress: as there.
    """
    if plan.finished and plan.output is not None and plan.part is not None:
        # It is left over if a run was killed between its last two steps.
        plan.part.unlink(missing_ok=True)
        return read_sweep(plan.output)
    progress = progress or not_told
    # A cluster that does not answer is reported before the discretisation is chosen.
    with _machine(scheduler, cores, plan.device) as machine:
        work = plan.work
        if plan.output is None or plan.part is None:
            memory = Memory()
            run = _Run(plan, work, _choice(plan, progress), progress)
            run.solve_rest(machine, memory)
            return run.sweep(memory.results())
        with Store(plan.part) as store:
            run = _Run(plan, work, _begun(plan, work, store, progress), progress)
            run.solve_rest(machine, store)
            sweep = run.sweep(store.results())
            write_sweep(sweep, plan.output)
            store.remove()
    return sweep


def run_shard(
    plan: Plan,
    shard: Shard,
    *,
    scheduler: str | None = None,
    cores: int | None = None,
    progress: StageProgress | None = None,
) -> int:
    """Do the rest of one shard of a sweep, store it beside the file of results, and return its number of rows.

    If the file of results already has the whole sweep nothing is done.

    Args:
        plan: plan by :func:`plan_sweep`, with an output.
        shard: the part of the sweep.
        scheduler: as in :func:`sweep`.
        cores: as there.
        progress: as there.

    Raises:
        SceneError: the file of the shard belongs to another sweep.
    """
    assert plan.output is not None, "a shard is kept in a file"
    work = [chunk for chunk in plan.work if shard.has(chunk)]
    count = sum(len(chunk.rows) for chunk in work)
    if plan.finished:
        return count
    told = progress or not_told
    file = shard.file(plan.output)
    begun = Store(file).head()
    if begun is not None and begun["sweep"] != plan.identity:
        problem = f"{file} belongs to another sweep"
        raise SceneError(Problem("--shard", problem, "remove it, or choose another --output"))
    with _machine(scheduler, cores, plan.device) as machine, Store(file) as store:
        choice = _begun(plan, work, store, told, _choice_of_others(plan, shard))
        _Run(plan, work, choice, told).solve_rest(machine, store)
    return count


def _choice_of_others(plan: Plan, shard: Shard) -> Choice | None:
    """The discretisation that another shard of this sweep has chosen; None if none has begun."""
    assert plan.output is not None
    for other, file in shard_files(plan.output).items():
        head = Store(file).head()
        if other != shard and head is not None and head["sweep"] == plan.identity:
            return Choice.read(head["choice"])
    return None


def merge_shards(plan: Plan, *, progress: StageProgress | None = None) -> Sweep:
    """Write the results of a sweep from its shards, and remove these.

    Args:
        plan: plan by :func:`plan_sweep`, with an output.
        progress: as in :func:`sweep`.

    Raises:
        SceneError: shards are missing, not finished, of another sweep, or of different discretisations.
    """
    assert plan.output is not None, "shards lie beside their output"
    files = shard_files(plan.output)
    if plan.finished:
        # Some are left over if a merge was killed between its last two steps.
        for file in files.values():
            head = Store(file).head()
            if head is not None and head["sweep"] == plan.identity:
                file.unlink()
        return read_sweep(plan.output)
    work = plan.work
    heads = {shard: Store(file).head() for shard, file in files.items()}
    _check_shards(plan, work, heads)
    done: dict[Path, set[int]] = {}
    for file in files.values():
        with Store(file) as store:
            store.resume(*_sizes(plan, work))
            done[file] = set(store.done)
    known = set[int]().union(*done.values())
    missing = [chunk for chunk in work if chunk.number not in known]
    if missing:
        unfinished = [shard for shard in files if any(shard.has(chunk) for chunk in missing)]
        raise SceneError(Problem("--merge", f"not finished: {named(unfinished, TOLD)}", "run these shards again"))
    choice = Choice.read(_known(heads)[0]["choice"])
    sweep = _Run(plan, work, choice, progress or not_told).sweep(_results_of(done, *_sizes(plan, work)))
    write_sweep(sweep, plan.output)
    for file in files.values():
        file.unlink(missing_ok=True)
    return sweep


def _results_of(done: Mapping[Path, set[int]], rows: Mapping[int, int], width: int) -> Iterator[tuple[int, FloatArray]]:
    """The chunks of shards with their results; one file is open at a time, since there may be thousands.

    Args:
        done: indices of the chunks in each file when all were checked.
        rows: rows of each chunk, by its index.
        width: count of numbers in the results of a row.

    Raises:
        StoreChangedError: a file does not have them any more.
    """
    for file, numbers in done.items():
        with Store(file) as store:
            store.resume(rows, width)
            if set(store.done) != numbers:
                raise StoreChangedError(file)
            yield from store.results()


def _known(heads: Mapping[Shard, dict[str, Any] | None]) -> list[dict[str, Any]]:
    return [head for head in heads.values() if head is not None]


def _check_shards(plan: Plan, work: Sequence[Chunk], heads: Mapping[Shard, dict[str, Any] | None]) -> None:
    """Refuse shards that do not make a whole sweep.

    Raises:
        SceneError: the shards are refused; it lists every reason.
    """
    if not heads:
        remedy = "run the sweep with --shard 1/4 to 4/4, say, and the same --output"
        raise SceneError(Problem("--merge", f"there is no shard beside {plan.output}", remedy))
    problems = []
    others = [shard for shard, head in heads.items() if head is None or head["sweep"] != plan.identity]
    if others:
        problem = f"from another sweep, or damaged: {named(others, TOLD)}"
        problems.append(Problem("--merge", problem, "remove their files; scene, table and options must be the same"))
    counts = sorted({shard.count for shard in heads})
    if len(counts) > 1:
        words = " and ".join(str(count) for count in counts)
        problems.append(Problem("--merge", f"the sweep was cut into {words} shards", "remove those of one cut"))
    elif not others:
        wanted = [Shard(number, counts[0]) for number in range(1, counts[0] + 1)]
        absent = [shard for shard in wanted if shard not in heads and any(shard.has(chunk) for chunk in work)]
        if absent:
            problems.append(Problem("--merge", f"missing: {named(absent, TOLD)}", "run these shards first"))
    choices = {json.dumps(head["choice"], sort_keys=True) for head in _known(heads)}
    if len(choices) > 1 and not others:
        remedy = "tune the scene first, and sweep that, so that modes and nodes are fixed"
        problems.append(Problem("--merge", "shards have chosen different discretisations", remedy))
    refuse(problems)


def _machine(scheduler: str | None, cores: int | None, device: str | None) -> Cores | Cluster:
    """The workers: cores of this machine, or a cluster."""
    if scheduler is None:
        return Cores(cores)
    if device is not None:
        raise SceneError(Problem("--device", "is of this machine", "leave it out beside --scheduler"))
    if cores is not None:
        remedy = "leave it out beside --scheduler: a cluster has its own"
        raise SceneError(Problem("--cores", "are those of this machine", remedy))
    return Cluster(scheduler)


def _begun(
    plan: Plan, work: Sequence[Chunk], store: Store, progress: StageProgress, choice: Choice | None = None
) -> Choice:
    """Prepare a store for results and return its discretisation, for a new sweep ``choice`` or one chosen now."""
    head = store.head()
    if head is not None:
        store.resume(*_sizes(plan, work))
        return Choice.read(head["choice"])
    if choice is None:
        choice = _choice(plan, progress)
    store.start({"sweep": plan.identity, "choice": choice.plain()})
    return choice


def _sizes(plan: Plan, work: Sequence[Chunk]) -> tuple[dict[int, int], int]:
    """Rows of each chunk, by its index, and count of numbers in the results of a row."""
    return {chunk.number: len(chunk.rows) for chunk in work}, len(plan.results)


def _choice(plan: Plan, progress: StageProgress) -> Choice:
    """The discretisation of all rows."""
    if plan.scene.tubes:
        # Each row of tubes has the steps that its own tolerance needs.
        return Choice(None)
    return choose(plan.variants, plan.table, plan.samples, progress)


@dataclass(frozen=True)
class _Run:
    """A sweep on its discretisation.

    Attributes:
        plan: plan of the sweep.
        work: its chunks, or the chunks of a shard.
        choice: the discretisation of all rows.
        progress: receives the work under way.
    """

    plan: Plan
    work: Sequence[Chunk]
    choice: Choice
    progress: StageProgress

    def solve_rest(self, machine: Cores | Cluster, store: Store | Memory) -> None:
        """Solve and store every unfinished chunk."""
        rest = [chunk for chunk in self.work if chunk.number not in store.done]
        total = sum(len(chunk.rows) for chunk in self.work)
        count = total - sum(len(chunk.rows) for chunk in rest)
        for chunk, results in machine.run(self._tasks(rest)):
            store.add(chunk.number, results)
            if chunk.number % LET_GO == 0:
                # Its inputs have been read into memory.
                self.plan.scratch.let_go()
            count += len(results)
            self.progress("Sweeping", count, total)

    def _tasks(self, rest: Sequence[Chunk]) -> Iterator[tuple[Chunk, list[Part]]]:
        """Chunks with their solvers; sources are generated for the first chunk that needs them."""
        answer: Answer | None = None
        answer_of: int | None = None
        given = self.plan.variants.given
        for chunk in rest:
            if not chunk.compiled and not chunk.in_contact:
                # A model in Python for each variant with rows in the chunk.
                yield chunk, [(self._in_python(variant), given(rows)) for variant, rows in chunk.pieces]
                continue
            # A compiled chunk has rows of one variant.
            ((variant, rows),) = chunk.pieces
            if answer is None or answer_of != variant:
                self.progress("Compiling", 0, 0)
                answer = self._compiled(variant)
                answer_of = variant
            yield chunk, [(answer, given(rows))]

    def _compiled(self, variant: int) -> Answer:
        """The library of a variant, with Python for rows in exact contact or rows that may stall in smooth contact.

        It is Python alone in exact contact that C does not support.
        """
        plan = self.plan
        entry = plan.variants.entries[variant]
        model = build(self.choice.scene(entry.scene))
        in_contact = entry.scene.touches_exactly
        library: RowLibrary | DeviceRows
        if in_contact:
            given = plan.variants.given(entry.rows)
            cases = given[representative_rows(given, plan.samples, plan.scratch)]
            options = {"estimate_errors": plan.estimate_errors, "stability": plan.stability}
            try:
                library = contact_row_library(model, cases, **options)
                library.compiled()
            except ExportError:
                return self._in_python(variant)
        elif plan.device is not None:
            library = device_rows(model, plan.device, estimate_errors=plan.estimate_errors)
        else:
            library = row_library(
                model,
                estimate_errors=plan.estimate_errors,
                stability=plan.stability,
                lanes=len(entry.rows) >= IN_LANES_FROM,
            )
        if not in_contact and not has_barriers(entry.scene):
            return library
        if isinstance(library, RowLibrary):
            # Compiled once, before many processes need it.
            library.compiled()
        return LibraryWithPython(library, self._in_python(variant), in_contact)

    def _in_python(self, variant: int) -> RowModel:
        """A variant in Python."""
        plan = self.plan
        # As text, since models of CasADi cannot be sent to other processes.
        measure = scene_text(self.choice.scene(plan.variants.nominal)) if plan.stability else ""
        scene = self.choice.scene(plan.variants.entries[variant].scene)
        return RowModel(scene_text(scene), plan.stability, measure, plan.estimate_errors)

    def sweep(self, answered: Iterable[tuple[int, FloatArray]]) -> Sweep:
        """All results in the order of the table, some results checked.

        Args:
            answered: index and results of each chunk, in any order.
        """
        plan = self.plan
        swept = len(plan.table.columns)
        scratch = plan.scratch
        values, outcomes = self._gathered(answered)
        judged = None
        if plan.stability and not plan.scene.tubes:
            # Chunks that Python solves are judged there.
            in_c = {variant for chunk in self.work if chunk.compiled or chunk.in_contact for variant, _ in chunk.pieces}
            judged = plan.variants.with_potential(in_c, scratch)
        estimate, verdict = (plan.columns.index(name) for name in ERRORS) if plan.estimate_errors else (None, None)
        for block in scratch.blocks(len(values)):
            values[block, :swept] = plan.table.values[block]
            if judged is not None:
                values[block, -len(STABILITY) :][~judged[block]] = np.nan
            if verdict is not None:
                # 1 or 0 for a solution; NaN if it is unknown or not defined.
                errors = values[block, estimate]
                within = np.where(np.isnan(errors), np.nan, errors <= plan.scene.accuracy.tolerance)
                within[outcomes[block] != 0] = 0.0
                values[block, verdict] = within if plan.scene.accuracy.binds else np.nan
        checked = []
        # Each row of tubes is within its tolerance, or does not converge.
        if not plan.scene.tubes:
            posed = len(plan.scene.rods) + len(plan.scene.bodies)
            # The outcome, first in a row of results, has no column of numbers; poses cannot be swept.
            first = swept + len(JUDGED) - 1
            poses = values[:, first : first + posed * len(POSE)]
            checked = check(plan.variants, self.choice, outcomes, poses, scratch, self.progress)
        sweep = Sweep(plan.table.columns, plan.columns[swept:], values, outcomes, {}, scratch)
        # The record counts the outcomes of its sweep.
        sweep.record.update(_record(plan, self.choice, sweep, checked))
        return sweep

    def _gathered(self, answered: Iterable[tuple[int, FloatArray]]) -> tuple[FloatArray, npt.NDArray[np.int64]]:
        """Results of all rows after the columns of the table, which are left empty, and the outcomes of the rows."""
        plan = self.plan
        swept = len(plan.table.columns)
        result_columns = [plan.results.index(name) for name in plan.columns[swept:]]
        count = len(plan.table.values)
        values = plan.scratch.array((count, len(plan.columns)))
        outcomes = plan.scratch.array((count,), np.int64)
        # Chunks have every row once; each is released as soon as it is copied, since there may be millions of rows.
        chunk_of = {chunk.number: chunk for chunk in self.work}
        for number, results in answered:
            rows = chunk_of[number].rows
            outcomes[rows] = results[:, 0]
            values[rows, swept:] = results[:, result_columns]
            if number % LET_GO == 0:
                plan.scratch.let_go()
        return values, outcomes


def _units(scene: Scene, columns: Sequence[str]) -> dict[str, str]:
    """Units of the columns that set inputs; "1" for a dimensionless number."""
    units: dict[str, str] = {}
    for entry in scene.free_inputs():
        of_entry = [column for column in columns if column == entry.name or column.startswith(f"{entry.name}.")]
        units |= dict.fromkeys(of_entry, entry.declared.unit)
    return units


def _record(plan: Plan, choice: Choice, sweep: Sweep, checked: list[dict[str, Any]]) -> dict[str, Any]:
    sobol = {"sobol": {"factors": list(plan.table.factors)}} if plan.table.factors else {}
    missed = {"missed": sweep.missed_count} if plan.estimate_errors else {}
    return {
        "schema": 1,
        "sweep": plan.identity,
        "cosserat_casadi": version("cosserat-casadi"),
        "title": plan.scene.title,
        "rows": len(sweep.values),
        "outcomes": sweep.counts,
        "tolerance": plan.scene.accuracy.tolerance,
        "tolerance_binds": plan.scene.accuracy.binds,
        **missed,
        "chosen": choice.plain(),
        "checked": checked,
        "swept": list(sweep.swept),
        "units": _units(plan.scene, sweep.swept),
        **({"tubes": [tube.name for tube in plan.scene.tubes]} if plan.scene.tubes else {}),
        "parameters": list(plan.variants.parameters),
        "arguments": list(plan.variants.arguments),
        **sobol,
        "scene": scene_text(plan.scene),
    }


def output_problems(output: Path | None, plan: Plan | None) -> list[Problem]:
    """Problems of an output to which the results cannot be written."""
    if output is None:
        return []
    try:
        check_output(output)
    except SceneError as error:
        return list(error.problems)
    if plan is None or plan.part is None:
        return []
    # Files of other sweeps that the results would overwrite.
    problems = []
    part, identity = plan.part, plan.identity
    head = Store(part).head() or {}
    # A run that was killed before its first line leaves an empty file.
    unfinished = part.exists() and (not part.is_file() or part.stat().st_size > 0)
    if unfinished and head.get("sweep") != identity:
        problem = f"{part} belongs to another sweep, which was not finished, or was changed"
        remedy = "finish that one, remove the file, or name another output"
        problems.append(Problem("--output", problem, remedy))
    record = read_record(output) or {}
    taken = [file for file in (output, record_file(output)) if file.exists()]
    if taken and record.get("sweep") != identity:
        problem = f"{taken[0]} exists, and does not belong to this sweep"
        problems.append(Problem("--output", problem, "name another file, or remove it"))
    return problems
