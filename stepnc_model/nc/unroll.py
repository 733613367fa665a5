"""NC programs without calls and repeats: each block stands as often as it is executed.

A block of a subprogram has one feed for all of its calls. In an unrolled program each call has
blocks, and feeds, of its own. The blocks are those that the control executes, in this order;
what only steers (calls, labels, loops, conditions) is left out. The unrolled program is read
again, and refused if it makes other moves.
"""

import re
from dataclasses import dataclass

import numpy as np

from stepnc_model.errors import PostError
from stepnc_model.nc.moves import NcMoves
from stepnc_model.nc.program import NcProgram, control_of, read_program
from stepnc_model.post.dialect import Dialect

END = re.compile(r"\s*(?:%|\d*\s*END PGM\b.*)\s*", re.IGNORECASE)
"""Line that closes a file behind the last executed block."""

HEAD = re.compile(
    r"\s*(?:%.*|[O:]\d+\s*(?:\([^)]*\)\s*)*|\d*\s*BEGIN PGM\b.*)\s*", re.IGNORECASE
)
"""Line that opens a file, or names its program."""

LABEL = re.compile(r"^(\s*(?:N\d+\s*)?)[A-Z_][A-Z_]\w*:(?!=)\s*", re.IGNORECASE)
"""Label of Sinumerik before a block."""

NUMBER = re.compile(r"^(\s*)N\d+ ?", re.IGNORECASE)
COUNT = re.compile(r"^\s*\d+")
"""Number of a block of Heidenhain."""


@dataclass(frozen=True, slots=True, kw_only=True)
class UnrolledProgram:
    """Program without calls and repeats."""

    program: NcProgram
    blocks: int
    """Number of its blocks."""
    before: int
    """Number of blocks of the file that it was made from."""


def unrolled(program: NcProgram) -> UnrolledProgram:
    """Unroll the calls and repeats of a program.

    Parameters
    ----------
    program : NcProgram

    Raises
    ------
    PostError
        When the unrolled program would make other moves, as where a subprogram has variables
        of its own.
    """
    most = program.most_repeats
    control = control_of(
        program.text,
        program.dialect,
        program.machine,
        most_repeats=most,
        keeps_state=program.keeps_state,
    )
    trace: list[int] = []
    control.flow.trace = trace
    control.run()
    text = program.text
    first, last = (trace[0], trace[-1]) if trace else (len(text), -1)
    opening = [at for at in range(first) if HEAD.fullmatch(text.block(at))]
    closing = [at for at in range(last + 1, len(text)) if END.fullmatch(text.block(at))]
    lines = _lines(program, [*opening, *trace, *closing[-1:]])
    again = read_program(
        "".join(lines).encode("latin-1"),
        dialect=program.dialect,
        machine=program.machine,
        most_repeats=most,
        keeps_state=program.keeps_state,
    )
    if not _are_same(program.moves, again.moves):
        raise PostError(
            "the program cannot be unrolled: without its calls and labels it makes other "
            "moves, as where a subprogram has variables of its own"
        )
    return UnrolledProgram(program=again, blocks=len(lines), before=len(text))


def _lines(program: NcProgram, blocks: list[int]) -> list[str]:
    """Texts of some blocks, without numbers and labels that would be there twice."""
    found: list[str] = []
    seen: set[int] = set()
    is_klartext = program.dialect is Dialect.HEIDENHAIN
    for block in blocks:
        line = program.text.block(block)
        if not line.endswith(("\n", "\r")):
            line += "\n"
        if is_klartext:
            line = COUNT.sub(str(len(found)), line, count=1)
        else:
            if program.dialect is Dialect.SINUMERIK:
                line = LABEL.sub(r"\1", line)
            if block in seen:
                line = NUMBER.sub(r"\1", line)
        seen.add(block)
        found.append(line)
    return found


def _are_same(one: NcMoves, other: NcMoves) -> bool:
    """True if two programs make the same moves with the same settings."""
    if len(one) != len(other) or not np.array_equal(one.arcs, other.arcs, equal_nan=True):
        return False
    for name in ("start", "end", "word", "kind"):
        is_number = name != "kind"
        if not np.array_equal(one.rows[name], other.rows[name], equal_nan=is_number):
            return False
    mine, its = (
        [each.settings[at] for at in each.rows["setting"].tolist()] for each in (one, other)
    )
    return mine == its
