"""Running sums of columns, which CasADi writes out entry by entry: here each is one step, and a loop in C.

CasADi knows no running sum: it adds row after row. Steps that add to the result of the step before are found again, and
become one function of the first column and of those that are added to it, one behind another.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, field

import casadi as ca
import numpy as np

from cosserat_casadi.codegen.numbered import Numbers, Origins, Step, column

FEWEST = 4
"""Sums of a chain from which on it is a running sum."""

SHORTEST = 6
"""Entries of a column from which on they are worth a loop."""

NAME = "running_sums"
"""What the functions are called that add."""

WRITTEN = re.compile(
    rf"^/\* {NAME}:\(first\[(\d+)\],added\[(\d+)\]\)[^\n]*\n(static int \w+\([^\n]*\) \{{\n).*?^\}}\n",
    flags=re.M | re.S,
)
"""Such a function as CasADi writes it."""

LOOP = """/* {name} of {columns} columns of {size} entries. */
{head}  const casadi_real *sum = arg[0], *added = arg[1];
  casadi_real* result = res[0];
  casadi_int i, k;
  for (i = 0; i < {size}; ++i) result[i] = sum[i];
  for (k = 1; k < {columns}; ++k, added += {size}, result += {size}) {{
    for (i = 0; i < {size}; ++i) result[{size} + i] = result[i] + added[i];
  }}
  return 0;
}}
"""
"""The same as a loop."""


@dataclass
class _Chain:
    """Steps each of which adds to the result of the one before.

    Attributes:
        first: entries that the first of them adds to.
        steps: their numbers.
        added: entries that each of them adds.
    """

    first: Numbers
    steps: list[int] = field(default_factory=list)
    added: list[Numbers] = field(default_factory=list)

    @property
    def size(self) -> tuple[int, int]:
        """Entries of a column, and how many columns are added to the first."""
        return len(self.first), len(self.steps)


def in_running_sums(steps: Sequence[Step], origins: Origins) -> list[Step]:
    """The same steps, with one in place of each chain that adds on to its own results.

    Args:
        steps: a program's.
        origins: what their numbers stand for.
    """
    made_by = {}
    for k, step in enumerate(steps):
        for result in step.results:
            if len(result.numbers):
                made_by[int(origins.owners(result.numbers[:1])[0])] = k
    chains = _chains(steps, origins, made_by)
    in_a_chain = {k for chain in chains for k in chain.steps[1:]}
    functions = {size: _function(*size) for size in dict.fromkeys(chain.size for chain in chains)}
    sums = {chain.steps[0]: _running_sum(chain, steps, functions[chain.size]) for chain in chains}
    return [sums.get(k, step) for k, step in enumerate(steps) if k not in in_a_chain]


def _chains(steps: Sequence[Step], origins: Origins, made_by: dict[int, int]) -> list[_Chain]:
    """Chains of steps, each of which adds to the result of the one before."""
    chains: list[_Chain] = []
    chain_of: dict[bytes, _Chain] = {}
    for k, step in enumerate(steps):
        if not _adds(step):
            continue
        first, second = (operand.numbers for operand in step.operands)
        chain = chain_of.pop(first.tobytes(), None)
        added = second
        if chain is None:
            chain = chain_of.pop(second.tobytes(), None)
            added = first
        if chain is None or _latest(added, origins, made_by) >= chain.steps[0]:
            chain = _Chain(first)
            chains.append(chain)
            added = second
        chain.steps.append(k)
        chain.added.append(added)
        chain_of[step.results[0].numbers.tobytes()] = chain
    return [chain for chain in chains if len(chain.steps) >= FEWEST and _is_computed(chain.first, origins)]


def _adds(step: Step) -> bool:
    """Whether a step adds two columns that are long enough."""
    if step.operation != ca.OP_ADD:
        return False
    sizes = {len(operand.numbers) for operand in step.operands}
    return sizes == {len(step.results[0].numbers)} and min(sizes) >= SHORTEST


def _latest(numbers: Numbers, origins: Origins, made_by: dict[int, int]) -> int:
    """Number of the last step that some entries need; −1 for arguments and constants."""
    return max(made_by.get(int(owner), -1) for owner in np.unique(origins.owners(numbers)))


def _is_computed(numbers: Numbers, origins: Origins) -> bool:
    """Whether these are no constants, which would be taken for computed once they are found in a running sum."""
    return not bool(np.any(origins.is_constant(numbers)))


def _running_sum(chain: _Chain, steps: Sequence[Step], function: ca.Function) -> Step:
    """A chain as one step, whose result begins with the column that it adds to."""
    sums = [steps[k].results[0].numbers for k in chain.steps]
    return Step(
        function=function,
        operands=[column(chain.first), column(np.concatenate(chain.added))],
        results=[column(np.concatenate([chain.first, *sums]))],
        instructions=np.inf,
        called=True,
    )


def _function(size: int, count: int) -> ca.Function:
    """The map (first, added) ↦ first and the sums with more and more of what is added, in one column."""
    first = ca.SX.sym("first", size)
    added = ca.SX.sym("added", size * count)
    sums = [first]
    for one in ca.vertsplit(added, size):
        sums.append(sums[-1] + one)
    return ca.Function(NAME, [first, added], [ca.vertcat(*sums)], ["first", "added"], ["sums"])


def with_loops(source: str) -> str:
    """A source of CasADi's in which running sums are loops."""

    def loop(function: re.Match[str]) -> str:
        size = int(function[1])
        columns = 1 + int(function[2]) // size
        return LOOP.format(name=NAME, head=function[3], size=size, columns=columns)

    return WRITTEN.sub(loop, source)
