"""NC programs of any origin, read without loss and executed once.

:func:`read_program` keeps the bytes, executes them on a tolerant control, and gives the moves
with remarks on what was not understood. :mod:`stepnc_model.nc.rewrite` changes the feeds.
"""

import re
from codecs import BOM_UTF16_BE, BOM_UTF16_LE
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from stepnc_model.errors import Finding, PostError
from stepnc_model.nc.control_guess import recognise
from stepnc_model.nc.heidenhain_control import HeidenhainControl
from stepnc_model.nc.iso_control import IsoControl
from stepnc_model.nc.moves import UNADVISED, FeedMode, MoveFlag, MoveKind, NcMoves
from stepnc_model.nc.remarks import Remarks
from stepnc_model.nc.sinumerik_control import SinumerikControl
from stepnc_model.nc.text import NcText, text_of
from stepnc_model.post.blocks import MachineType
from stepnc_model.post.dialect import Dialect
from stepnc_model.toolpath.path import Point

WHOLE_FEED = re.compile(r"^[^(;]*F *[0-9]+(?![0-9.])", re.I)
"""Block with a feed that has no decimal point, outside comments."""

MOST_FEEDS = 10_000
"""Greatest number of F words that are looked at for their decimal point."""

CHUNK = 1 << 16
"""Rows that are looked at together."""

Control = IsoControl | HeidenhainControl


@dataclass(frozen=True, kw_only=True)
class NcProgram:
    """NC program with its bytes, its executed moves, and remarks on it."""

    text: NcText
    dialect: Dialect
    machine: MachineType
    hints: tuple[str, ...]
    """Pieces of the program that speak for the control; empty if it was named."""
    stream: NcMoves
    """Executed moves, with the switches, comments and stops between them."""
    unit: float
    """Length of one unit of the program at its end, mm."""
    findings: tuple[Finding, ...]
    """What was not understood, and what is missing, by line."""
    most_repeats: int | None = None
    """Blocks and moves beyond those of the file that were allowed; None: as usual."""
    keeps_state: frozenset[int] = frozenset()
    """Programs outside the file that were said to keep the modal state."""
    first_unread: Finding | None = None
    """First word that the stream does not show; None if it shows all."""

    @cached_property
    def moves(self) -> NcMoves:
        """Executed moves alone."""
        return self.stream.moving


def read_program(
    data: bytes,
    *,
    dialect: Dialect | None = None,
    machine: MachineType | None = None,
    most_repeats: int | None = None,
    start: Point | None = None,
    keeps_state: frozenset[int] = frozenset(),
) -> NcProgram:
    r"""Read an NC program and execute it.

    Parameters
    ----------
    data : bytes
        Content of the file; any bytes are accepted.
    dialect : Dialect, optional
        Control; guessed from the program if it is not given.
    machine : MachineType, optional
        Kind of machine; guessed as well.
    most_repeats : int, optional
        Greatest number of executed blocks, and of moves, beyond those of the file; by default
        ``MOST_REPEATED`` of :mod:`stepnc_model.nc.flow`.
    start : Point, optional
        Place where the program begins, in its coordinates, mm; changes of the tool keep the
        place then. None: the program has to say where the tool is.
    keeps_state : frozenset of int
        Numbers of programs outside the file, called by M98 or G65, behind which the modal state
        is as before; the position is open all the same.

    Raises
    ------
    PostError
        If the program repeats or nests blocks without end, with the line, or if the dialect
        has no NC code.

    Examples
    --------
    >>> program = read_program(b"G21 G90\nG0 X0 Y0 Z5\nG1 Z-1 F60\nX10\n")
    >>> program.moves.feed
    array([nan,  1.,  1.])
    """
    guess = recognise(data)
    chosen = guess.dialect if dialect is None else dialect
    if chosen is Dialect.CANONICAL:
        raise PostError("canonical commands are no NC code: name the control of the program")
    kind = guess.machine if machine is None else machine
    text = text_of(data, chosen)
    control = control_of(text, chosen, kind, most_repeats=most_repeats, keeps_state=keeps_state)
    if data.startswith((BOM_UTF16_LE, BOM_UTF16_BE)):
        control.remarks.warn(0, "the file is UTF-16 text: save it as ASCII or UTF-8")
    if start is not None:
        control.recorder.begin(start)
    control.run()
    stream = control.recorder.moves()
    moves = stream.moving
    _remark_whole_feeds(control.remarks, moves, text, chosen)
    for begin in range(0, len(moves), CHUNK):
        _remark(control.remarks, moves.part(begin, begin + CHUNK))
    return NcProgram(
        text=text,
        dialect=chosen,
        machine=kind,
        hints=guess.hints if dialect is None else (),
        stream=stream,
        unit=control.scale,
        findings=control.remarks.all(),
        most_repeats=most_repeats,
        first_unread=control.remarks.first_unread,
        keeps_state=keeps_state,
    )


def control_of(
    text: NcText,
    dialect: Dialect,
    machine: MachineType,
    *,
    most_repeats: int | None = None,
    keeps_state: frozenset[int] = frozenset(),
) -> Control:
    """Control that executes a program, within a number of repeats."""
    control = _control(text, dialect, machine)
    if isinstance(control, IsoControl):
        control.steering.keeps_state = keeps_state
    if most_repeats is not None:
        control.flow.allow(most_repeats)
    return control


def _control(text: NcText, dialect: Dialect, machine: MachineType) -> Control:
    if dialect is Dialect.HEIDENHAIN:
        return HeidenhainControl(text)
    if dialect is Dialect.SINUMERIK:
        return SinumerikControl(text, dialect, machine)
    return IsoControl(text, dialect, machine)


def _remark(remarks: Remarks, moves: NcMoves) -> None:
    """Remark what the moves lack: a feed, a turning spindle, a tool."""
    is_fed = np.isin(moves.kind, (MoveKind.LINE, MoveKind.ARC))
    is_macro = (moves.flags & int(MoveFlag.MACRO_FEED)) != 0
    per_revolution = moves.mode == list(FeedMode).index(FeedMode.PER_REVOLUTION)
    is_zero = is_fed & (moves.word == 0.0)
    checks = (
        (is_zero, "the feed is 0"),
        (is_fed & np.isnan(moves.word) & ~is_macro, "no feed F is in force"),
        (
            is_fed & per_revolution & (moves.word > 0.0) & (moves.spindle == 0.0),
            "a feed per revolution while the spindle is stopped",
        ),
        (is_fed & ~moves.has_tool, "no tool was called before this cut"),
        (
            is_fed & ((moves.flags & int(MoveFlag.UNPOINTED)) != 0),
            "a coordinate without decimal point is read in whole units, "
            "which some controls count in µm",
        ),
    )
    for is_so, why in checks:
        for block in _first_of_runs(is_so, moves):
            remarks.warn(block, why)
    left = int(UNADVISED) & ~int(MoveFlag.NO_FEED)
    for flag in (MoveFlag.TRANSFORMED, MoveFlag.ROTARY):
        name = {
            MoveFlag.TRANSFORMED: "coordinates are rotated, scaled or tilted",
            MoveFlag.ROTARY: "a rotary or further axis is not at 0",
        }[flag]
        is_so = is_fed & ((moves.flags & int(flag) & left) != 0)
        for block in _first_of_runs(is_so, moves):
            remarks.warn(block, f"{name}: the feed is left alone")


def _remark_whole_feeds(
    remarks: Remarks, moves: NcMoves, text: NcText, dialect: Dialect
) -> None:
    """Remark the first feed without a point, where controls differ in its unit."""
    has_inches = any(each.unit > 1.0 for each in moves.settings)
    if dialect is not Dialect.HAAS and not (dialect is Dialect.FANUC and has_inches):
        return
    for block in np.unique(moves.fed_by)[:MOST_FEEDS]:
        if block >= 0 and WHOLE_FEED.search(text.block(int(block))):
            why = (
                "a feed without decimal point is read in whole units, which some settings of "
                "this control count in smaller ones"
            )
            remarks.warn(int(block), why)
            return


def _first_of_runs(is_so: np.ndarray, moves: NcMoves) -> Iterator[int]:
    """Blocks with which uninterrupted runs of such moves begin."""
    if not is_so.any():
        return
    before = np.concatenate((np.zeros(1, np.bool_), is_so[:-1]))
    for block in np.unique(moves.block[is_so & ~before]):
        yield int(block)
