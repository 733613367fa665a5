"""Exact reading of NC code, as blocks and canonical commands, if every word is understood.

Here a word that is not understood ends the reading, where :func:`read_program` goes on and
remarks on it: programs that differ in a word left out would compare as equal.
"""

from collections.abc import Iterable, Iterator

import numpy as np

from stepnc_model.errors import PostError
from stepnc_model.nc.moves import REASONS, MoveFlag, MoveKind, NcMoves
from stepnc_model.nc.neutral_blocks import FED, stream_blocks
from stepnc_model.nc.program import NcProgram, read_program
from stepnc_model.nc.remarks import NOT_UNDERSTOOD
from stepnc_model.post import canonical
from stepnc_model.post.blocks import Block, MachineType
from stepnc_model.post.canonical import Canonical, commands
from stepnc_model.post.dialect import Dialect
from stepnc_model.toolpath.path import Point

ZERO: Point = (0.0, 0.0, 0.0)
"""Place of the tool before the first move, mm."""

UNSAID = (
    MoveFlag.COMPENSATED
    | MoveFlag.ROUNDED
    | MoveFlag.TRANSFORMED
    | MoveFlag.ROTARY
    | MoveFlag.CONDITIONAL
    | MoveFlag.NO_FEED
    | MoveFlag.MACHINE
    | MoveFlag.SKIPPABLE
)
"""Flags of moves that neutral blocks do not show as the control makes them."""

SKIPPED = "a block that the operator may skip"


def read_exactly(
    data: bytes, control: Dialect, *, machine: MachineType, start: Point = ZERO
) -> NcProgram:
    """Read NC code whose every word is understood.

    Parameters
    ----------
    data : bytes
    control : Dialect
    machine : MachineType
        Machine that the code is for.
    start : Point, mm
        Place of the tool before the first move; NaN where it is not known.

    Raises
    ------
    PostError
        With the line, if a word is not understood, or if a move is not one in the plain
        coordinates of one frame.
    """
    if control is Dialect.HEIDENHAIN and machine is MachineType.LATHE:
        raise PostError("Klartext is supported for mills only")
    program = read_program(data, dialect=control, machine=machine, start=start)
    fault = min(_faults(program), key=lambda each: each[0], default=None)
    if fault is not None:
        raise PostError(fault[1], line=fault[0])
    return program


def read_blocks(
    lines: Iterable[str], control: Dialect, *, machine: MachineType = MachineType.MILL
) -> Iterator[Block]:
    """Read NC code exactly, as neutral blocks; see :func:`read_exactly`."""
    data = "\n".join(line.rstrip("\r\n") for line in lines).encode()
    program = read_exactly(data, control, machine=machine)
    return (block for _, block in stream_blocks(program, at=ZERO))


def read(
    lines: Iterable[str], control: Dialect, *, machine: MachineType = MachineType.MILL
) -> tuple[Canonical, ...]:
    """Read NC code exactly, or canonical commands, as canonical commands."""
    if control is Dialect.CANONICAL:
        return tuple(canonical.read(lines))
    return tuple(commands(read_blocks(lines, control, machine=machine)))


def _faults(program: NcProgram) -> Iterator[tuple[int, str]]:
    """Lines and reasons of what the blocks of a program would not show."""
    for each in program.findings:
        if each.message.startswith(NOT_UNDERSTOOD):
            yield each.line, each.message.removeprefix(NOT_UNDERSTOOD)
    if program.first_unread is not None:
        yield program.first_unread.line, program.first_unread.message
    moves = program.stream
    for is_so, why in _unsaid(moves):
        rows = np.flatnonzero(is_so)
        if len(rows):
            yield program.text.line(int(moves.block[rows[0]])), why


def _unsaid(moves: NcMoves) -> Iterator[tuple[np.ndarray, str]]:
    """Rows that neutral blocks would not show, with the reasons."""
    for flag in UNSAID:
        yield (moves.flags & int(flag)) != 0, REASONS.get(flag, SKIPPED)
    yield moves.kind == MoveKind.UNKNOWN, "a move that is not known"
    is_fed = np.isin(moves.kind, list(FED))
    # The first rapids lead to the places that are not known before.
    yield is_fed & ~moves.is_known, "a move whose start or end is not known"
    is_thread = moves.kind == MoveKind.THREAD
    yield is_thread & ~moves.has_rate, "a thread whose lead is not known, or without a spindle"
    yield is_fed & ~moves.has_rate, "a feed that the spindle's speed does not give"
    yield moves.frame != 0, f"coordinates of another frame than {moves.frames[0]}"
    wears = np.array([each.length_wear for each in moves.settings])
    yield wears[moves.rows["setting"]] != 0.0, "a wear of the tool's length (DL)"
