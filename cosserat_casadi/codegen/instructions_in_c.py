"""What CasADi writes for an MX function, instruction by instruction, and which columns each reads and makes.

CasADi writes one instruction after another, each behind a comment with its number. It works in columns ``w01``,
``w02``, …: pieces of the work vector ``w`` that do not overlap, each for one value after another.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, field

WRITTEN_FUNCTION = re.compile(r"^static int casadi_f\d+\([^\n]*\) \{\n(?:[^}\n][^\n]*\n)*\}\n", flags=re.M)
"""A function of a source that CasADi has written."""

COMMENT = re.compile(r"^  /\* #\d+: [^\n]*\n", flags=re.M)
"""What an instruction begins with."""

DECLARATION = re.compile(r"^  ((?:const )?casadi_(?:real|int)) (.*);\n", flags=re.M)
"""A line at the head of a function, with all names of one type."""

LAST = "  return 0;\n}\n"
"""What a function ends with."""

COLUMN_NAME = re.compile(r"\bw\d+\b")
"""Name of a column."""

PLACE = re.compile(r"\*(w\d+)=w(?:\+(\d+))?(?=[,;])")
"""Where a column begins in the work vector, as a function says at its head."""

COLUMN = r"(?:w\d+|\(w\d+\+\d+\))"
"""A column, or what stands behind some entries of one."""

SLICE = rf"  for \(rr=(?P<to>w\d+), cs=(?P<of>{COLUMN})\+(?P<begin>\d+); cs!=[^;]*; cs\+=1\) \*rr\+\+ = \*cs;"
COPY = rf"  casadi_copy\((?P<of>{COLUMN}), \d+, (?P<to>w\d+)\);"
GATHER = (
    rf"  for \(cii=(?P<table>casadi_s\d+), rr=(?P<to>w\d+), cs=(?P<of>{COLUMN}); cii!=[^;]*; \+\+cii\) "
    r"\*rr\+\+ = cs\[\*cii\];"
)
STACK = r"  rr=(?P<to>w\d+);(?:\n  (?:for \(i=0, cs=[^;]*; i<\d+; \+\+i\) )?\*rr\+\+ = [^;]*;)+"
PIECE = rf"  for \(i=0, cs=({COLUMN}); i<(\d+); \+\+i\) \*rr\+\+ = \*cs\+\+;"
CLEAR = r"  casadi_clear\((?P<to>w\d+), \d+\);"
DENSE_PRODUCT = r"  (?P<routine>casadi_mtimes_dense(?:_sparse)?)\([^;]*, (?P<to>w\d+)(?:, 0)?\);"

RUNS_CALL = rf"  casadi_runs\((?:w|{COLUMN}), casadi_r\d+, \d+, \d+, (?P<to>w\d+)\);"
"""Not CasADi's own: moves.py writes it."""

MAKE = [
    RUNS_CALL,
    SLICE,
    COPY,
    GATHER,
    STACK,
    CLEAR,
    r"  casadi_copy\(arg\[\d+\], \d+, (?P<to>w\d+)\);",
    r"  casadi_fill\((?P<to>w\d+), \d+, [^;]*\);",
    r"  for \(rr=(?P<to>w\d+), cs=[^;]*; [^;]*; cs\+=\d+\) (?:for \(ct=[^;]*;[^;]*;[^;]*\) )?\*rr\+\+ = \*c[st];",
    r"  for \(i=0, rr=(?P<to>w\d+), c[^;]*; i<\d+; \+\+i\) (?:\(\*rr\+\+\) |\*rr\+\+) ?= [^;]*;",
    r"  (?P<to>w\d+) = (?:arg\[\d+\] \? arg\[\d+\]\[\d+\] : 0|[-0-9.e+]*);",
]
"""Instructions that make a column, whatever was in it."""

CHANGE = [
    DENSE_PRODUCT,
    rf"  casadi_mtimes\({COLUMN}, casadi_s\d+, {COLUMN}, casadi_s\d+, (?P<to>w\d+), casadi_s\d+, w, 0\);",
    r"  for \(i=0, rr=(?P<to>w\d+), c[^;]*; i<\d+; \+\+i\) \(\*rr\+\+\) [+*-]= [^;]*;",
]
"""Instructions that change a column."""

CALL = [r"(?:  (?:arg|res)1\[\d+\]=[^;]*;\n)+  if \(casadi_f\d+\(arg1, res1, iw, w, 0\)\) return 1;"]
"""Calls of a function, which makes some columns of others."""

MAKE_NONE = [
    rf"  (?:if \(res\[\d+\]\) )?casadi_copy\({COLUMN}, \d+, res\[\d+\](?:\+\d+)?\);",
    r"  wr\d+ = (?:casadi_c\d+|wr\d+(?:\+\d+)?|arg\[\d+\] \? arg\[\d+\](?:\+\d+)? : casadi_zeros);",
    "",
]
"""Instructions that make no column: results, and names for constants and arguments."""


def matched(patterns: Sequence[str], code: str) -> re.Match[str] | None:
    """How some lines are like the first of some patterns that they are like."""
    for pattern in patterns:
        found = re.fullmatch(pattern, code)
        if found is not None:
            return found
    return None


@dataclass
class Instruction:
    """One instruction.

    Attributes:
        comment: the line before it.
        code: its lines, without the end of the last.
        reads: columns that it reads.
        makes: columns that it makes or changes.
        anew: whether it makes them, whatever was in them.
    """

    comment: str
    code: str
    reads: set[str] = field(init=False)
    makes: set[str] = field(init=False)
    anew: bool = field(init=False)

    def __post_init__(self) -> None:
        self.reads = set(COLUMN_NAME.findall(self.code))
        # Of code that is like nothing above: all that it names.
        self.makes = self.reads
        self.anew = False
        made = matched(MAKE, self.code)
        changed = matched(CHANGE, self.code)
        if made is not None:
            without = self.code[: made.start("to")] + self.code[made.end("to") :]
            self.reads = set(COLUMN_NAME.findall(without))
            self.makes = {made["to"]}
            self.anew = True
        elif changed is not None:
            self.makes = {changed["to"]}
        elif matched(CALL, self.code) is not None:
            self.reads = set(re.findall(r"arg1\[\d+\]=\W*(w\d+)", self.code))
            self.makes = set(re.findall(r"res1\[\d+\]=\W*(w\d+)", self.code))
            self.anew = True
        elif matched(MAKE_NONE, self.code) is not None:
            self.makes = set()

    @property
    def text(self) -> str:
        """Comment and code."""
        return f"{self.comment}{self.code}\n" if self.code else self.comment


@dataclass
class Instructions:
    """A function of instructions.

    Attributes:
        head: its lines before the first instruction.
        listed: the instructions.
    """

    head: str
    listed: list[Instruction]

    @classmethod
    def of(cls, function: str) -> Instructions | None:
        """The instructions of a function; None of one that has no comments, as those of scalars have none."""
        starts = [found.start() for found in COMMENT.finditer(function)]
        if not starts or not function.endswith(LAST):
            return None
        body = function.removesuffix(LAST)
        listed = []
        for start, end in zip(starts, [*starts[1:], len(body)], strict=True):
            comment, _, code = body[start:end].partition("\n")
            listed.append(Instruction(f"{comment}\n", code.removesuffix("\n")))
        return cls(function[: starts[0]], listed)

    @property
    def places(self) -> dict[str, int]:
        """Where each column begins in the work vector."""
        return {name: int(place or 0) for name, place in PLACE.findall(self.head)}

    @property
    def text(self) -> str:
        """The function, which declares what it names."""
        body = "".join(instruction.text for instruction in self.listed)
        named = set(re.findall(r"\w+", "".join(instruction.code for instruction in self.listed)))

        def of_named(line: re.Match[str]) -> str:
            declared = [one for one in line[2].split(", ") if _name_of(one) in named]
            return f"  {line[1]} {', '.join(declared)};\n" if declared else ""

        return DECLARATION.sub(of_named, self.head) + body + LAST


def _name_of(declared: str) -> str:
    """The name in ``*w01=w+3`` and its like."""
    return declared.partition("=")[0].lstrip("*")
