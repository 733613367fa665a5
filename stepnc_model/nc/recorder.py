"""Collector of executed moves: a control goes through a program and records what it does."""

import struct
from array import array
from collections.abc import Sequence
from math import isnan, nan
from sys import maxsize

import numpy as np

from stepnc_model.errors import PostError
from stepnc_model.nc.drilling import cycle_moves
from stepnc_model.nc.moves import (
    ARC_NUMBERS,
    PLANES,
    ROW,
    ModalSetting,
    MoveFlag,
    MoveKind,
    NcMoves,
)
from stepnc_model.nc.spindle import spindle_block
from stepnc_model.nc.text import NcText
from stepnc_model.nc.thread import NcThread
from stepnc_model.post.blocks import Block, DrillingCycle, Pause
from stepnc_model.toolpath.path import ArcPlane, Point

RAISED = "--most-repeats N allows more"
"""What to do where a program exceeds its bound."""

_PACKED = struct.Struct("<7d6ib")
_FLAGS_AT = 7 * 8 + 5 * 4
"""Offset of the flags in a row."""
_ROUNDED = MoveFlag.ROUNDED.value


def frame_name(base: str, shift: Sequence[float], block: int) -> str:
    """Name of a frame that a block shifts from another, mm.

    Two shifts by unknown distances have different names.

    Examples
    --------
    >>> frame_name("G54", (10.0, 0.0, float("nan")), 4)
    'G54 shifted by X 10, Z by an unknown distance in block 5'
    """
    shifted = ", ".join(
        f"{axis} by an unknown distance" if isnan(value) else f"{axis} {value:g}"
        for axis, value in zip("XYZ", shift, strict=True)
        if value != 0.0
    )
    if any(map(isnan, shift)):
        shifted += f" in block {block + 1}"
    return f"{base} shifted by {shifted}" if shifted else base


class MoveRecorder:
    """Collector of executed moves; it keeps the position and the modal setting.

    Running state: a control moves it from block to block.
    """

    def __init__(self, *, has_y: bool = True) -> None:
        self._has_y = has_y
        self._at: list[float] = [nan, nan if has_y else 0.0, nan]
        self._keeps_place = False
        self.word = nan
        """Feed in force, mm/s, mm per revolution or 1/s; of a thread its lead, mm."""
        self.fed_by = -1
        self.block = 0
        self.call = 0
        self.flags = 0
        """Flags of all moves of the block."""
        self.standing = 0
        """Flags of all moves until they are taken away, such as compensation."""
        self.is_fresh = False
        """Whether an F word was executed since the last row."""
        self._carried = 0
        """Flags that a corner rounded by the last block gives to the next row."""
        self.frames: dict[str, int] = {"G54": 0}
        self.calls: list[tuple[int, int]] = [(0, -1)]
        self._setting = ModalSetting()
        self._settings: dict[ModalSetting, int] = {self._setting: 0}
        self._index = 0
        self._rows = bytearray()
        self._last = -1
        """Offset of the last move in the rows; -1 before the first."""
        self._switches: dict[Block, int] = {}
        self._switched = 0
        self._arcs = array("d")
        self._text: NcText | None = None
        self._most_bytes = maxsize

    def bound(self, text: NcText, most: int) -> None:
        """Refuse to record more moves of a program than a number."""
        self._text, self._most_bytes = text, most * _PACKED.size

    @property
    def at(self) -> list[float]:
        """Position of the tool, mm; NaN where unknown. On a lathe y is 0."""
        return self._at

    @at.setter
    def at(self, at: list[float]) -> None:
        self._at = at
        if not self._has_y:
            at[1] = 0.0

    def begin(self, at: Point) -> None:
        """Begin at a known place, which a change of the tool or of its length keeps."""
        self.at = list(at)
        self._keeps_place = True

    def lose(self, *axes: int) -> None:
        """Forget coordinates, as after a change of the tool or of its length."""
        if not self._keeps_place:
            self.at = [nan if axis in axes else old for axis, old in enumerate(self._at)]

    @property
    def setting(self) -> ModalSetting:
        """Modal setting in force."""
        return self._setting

    @setting.setter
    def setting(self, setting: ModalSetting) -> None:
        self._setting = setting
        self._index = self._settings.setdefault(setting, len(self._settings))

    @property
    def count(self) -> int:
        """Number of moves and pauses recorded so far."""
        return len(self._rows) // _PACKED.size - self._switched

    def frame(self, name: str) -> int:
        """Index of a frame by its name."""
        return self.frames.setdefault(name, len(self.frames))

    def move(self, kind: MoveKind, end: Sequence[float], *, flags: int = 0) -> None:
        """Record a straight move and go to its end."""
        self._add(kind, end, -1, flags)

    def arc(self, end: Sequence[float], centre: Point, *, turn: float, plane: ArcPlane) -> None:
        """Record an arc or helix and go to its end."""
        index = len(self._arcs) // ARC_NUMBERS
        self._arcs.extend((*centre, turn, float(PLANES.index(plane))))
        self._add(MoveKind.ARC, end, index, 0)

    def thread(self, end: Sequence[float], thread: NcThread) -> None:
        """Record a move synchronised with the spindle, whose word is its lead."""
        word, setting = self.word, self.setting
        self.word, self.setting = thread.lead, thread.setting(setting)
        self._add(MoveKind.THREAD, end, -1, 0)
        self.word, self.setting = word, setting

    def hole(self, cycle: DrillingCycle, tap: NcThread) -> None:
        """Record the moves of a drilling cycle from its retract plane and back to it.

        Parameters
        ----------
        cycle : DrillingCycle
        tap : NcThread
            Thread of a tapping cycle; others have none.
        """
        try:
            steps = list(cycle_moves(cycle, spindle_block(self.setting)))
        except PostError as error:
            line = 0 if self._text is None else self._text.line(self.block)
            raise PostError(str(error), line=line) from None
        for each in steps:
            if isinstance(each, Pause):
                self.dwell(each.seconds)
            elif not isinstance(each, tuple):
                self.switch(each)
            elif each[0] is MoveKind.THREAD:
                self.thread(each[1], tap)
                tap = tap.back
            else:
                self.move(*each)

    def dwell(self, seconds: float) -> None:
        """Record a pause."""
        kept, self.word = self.word, seconds
        self._add(MoveKind.DWELL, self.at, -1, 0)
        self.word = kept

    def unknown(self) -> None:
        """Record that a block may move all axes in a way that is not understood."""
        self._add(MoveKind.UNKNOWN, (nan, nan, nan), -1, 0)

    def switch(self, block: Block) -> None:
        """Record what a block does between moves: a tool, a switch, a comment or a stop."""
        index = self._switches.setdefault(block, len(self._switches))
        # The bound is one of moves.
        self._most_bytes += _PACKED.size
        self._switched += 1
        numbers = (*self._at, *self._at, float(index))
        self._pack(numbers, -1, self.flags | self.standing, MoveKind.SWITCH)

    def carry(self, flag: MoveFlag) -> None:
        """Give a flag to the next row alone."""
        self._carried |= flag.value

    def round_corner(self) -> None:
        """Record that the corner between the last row and the next one is rounded."""
        if self._last >= 0:
            at = self._last + _FLAGS_AT
            old = int.from_bytes(self._rows[at : at + 4], "little")
            self._rows[at : at + 4] = (old | _ROUNDED).to_bytes(4, "little")
        self._carried = _ROUNDED

    def _add(self, kind: MoveKind, end: Sequence[float], arc: int, flags: int) -> None:
        flags |= self.flags | self.standing
        carried, self._carried = self._carried, flags & _ROUNDED
        flags |= carried
        if self.is_fresh:
            flags |= MoveFlag.FRESH_FEED.value
            self.is_fresh = False
        is_unfed = not self.word > 0.0 and not flags & MoveFlag.MACRO_FEED
        if is_unfed and kind in {MoveKind.LINE, MoveKind.ARC}:
            flags |= MoveFlag.NO_FEED.value
        if len(self._rows) >= self._most_bytes:
            raise self._too_many()
        self._last = len(self._rows)
        here, there = self._at, list(end)
        self.at = there
        self._pack((*here, *there, self.word), arc, flags, kind)

    def _pack(self, numbers: Sequence[float], arc: int, flags: int, kind: MoveKind) -> None:
        self._rows += _PACKED.pack(
            *numbers,
            self.block,
            self.fed_by,
            self.call,
            arc,
            self._index,
            flags,
            kind,
        )

    def _too_many(self) -> PostError:
        """Error of a program with more moves than allowed, as of cycles that repeat."""
        most = self._most_bytes // _PACKED.size - self._switched
        return PostError(
            f"the program makes more than {most} moves: do its repeats have the right numbers? "
            f"{RAISED}",
            line=0 if self._text is None else self._text.line(self.block),
        )

    def moves(self) -> NcMoves:
        """All moves recorded so far."""
        return NcMoves(
            rows=np.frombuffer(self._rows, ROW),
            arcs=np.frombuffer(self._arcs, np.float64).reshape(-1, ARC_NUMBERS),
            settings=tuple(self._settings),
            frames=tuple(self.frames),
            calls=tuple(self.calls),
            switches=tuple(self._switches),
        )
