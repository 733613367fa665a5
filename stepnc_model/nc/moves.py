"""Executed moves of an NC program, in columns.

A row is one straight or circular move that the control executes: a block in a subprogram gives
one row for each call, a canned cycle one row for each of its moves. Switches, comments and
stops between the moves are rows that stay where the tool is. Coordinates are those of
the program in mm, in the frame of the row; on a lathe x is a radius. Unknown coordinates are
NaN. Rows name their block, so that advice finds its way back into the file.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from enum import IntEnum, IntFlag, StrEnum
from functools import cache, cached_property
from math import inf, nan, pi
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from stepnc_model.post.blocks import Block
from stepnc_model.toolpath.arc_columns import arms, lengths
from stepnc_model.toolpath.path import Arc, ArcPlane, Point

Floats = NDArray[np.float64]


class MoveKind(IntEnum):
    """Kinds of executed moves."""

    RAPID = 0
    LINE = 1
    ARC = 2
    """Arc or helix."""
    THREAD = 3
    """Move synchronised with the spindle: its feed is a lead, not to be changed."""
    UNKNOWN = 4
    """Block that may move the machine in a way that is not understood."""
    DWELL = 5
    """Pause; its word is the time, s."""
    SWITCH = 6
    """What a block does between moves; its word is an index in :attr:`NcMoves.switches`."""


class FeedMode(StrEnum):
    """Reference of an F word."""

    PER_MINUTE = "per minute"
    PER_REVOLUTION = "per revolution"
    INVERSE_TIME = "inverse time"
    """F is the number of such moves in a minute (G93)."""


class MoveFlag(IntFlag):
    """Properties of a move that bound what may be done to its block."""

    COMPENSATED = 1 << 0
    """Cutter radius compensation is on: the path is as commanded, not that of the tool."""
    ROUNDED = 1 << 1
    """The block carries a chamfer or rounding at its end."""
    MACRO = 1 << 2
    """The block takes a value from a variable or an expression."""
    TARGET = 1 << 3
    """The block is a target of jumps or repeats."""
    CYCLE = 1 << 4
    """Part of a canned cycle."""
    TRANSFORMED = 1 << 5
    """Coordinates are rotated, scaled, mirrored, polar or tilted."""
    ROTARY = 1 << 6
    """A rotary or second linear axis moves in this block."""
    CONDITIONAL = 1 << 7
    """Whether and how often the block is executed depends on values that are not known."""
    NO_FEED = 1 << 8
    """No feed is in force, or it is 0."""
    MACRO_FEED = 1 << 9
    """The feed in force is that of a variable or an expression whose value is not known."""
    OWN_FEED = 1 << 10
    """The block holds an F word."""
    FRESH_FEED = 1 << 11
    """An F word was executed since the previous row."""
    MACHINE = 1 << 12
    """Move in coordinates of the machine, such as G28 or G53."""
    FIXED = 1 << 14
    """The block holds words that act once at a time that is not known."""
    POLAR = 1 << 15
    """End given as angle and radius, or in another form that cannot be split."""
    SKIPPABLE = 1 << 16
    """Block delete: executed here, but the operator may skip it."""
    EXACT = 1 << 17
    """Exact stop at the end of the block."""
    OFFSET = 1 << 18
    """The block changes an offset or a frame."""
    UNPOINTED = 1 << 19
    """A coordinate has no decimal point: some controls count it in µm."""
    BESIDE = 1 << 20
    """The path is that of the tool beside a contour with cutter radius compensation."""


UNADVISED = (
    MoveFlag.MACRO_FEED
    | MoveFlag.CONDITIONAL
    | MoveFlag.TRANSFORMED
    | MoveFlag.ROTARY
    | MoveFlag.MACHINE
    | MoveFlag.NO_FEED
)
"""Flags of moves whose feed is left alone."""

UNSPLIT = (
    UNADVISED
    | MoveFlag.COMPENSATED
    | MoveFlag.BESIDE
    | MoveFlag.ROUNDED
    | MoveFlag.MACRO
    | MoveFlag.TARGET
    | MoveFlag.CYCLE
    | MoveFlag.FIXED
    | MoveFlag.POLAR
    | MoveFlag.OFFSET
    | MoveFlag.UNPOINTED
)
"""Flags of moves whose block stays in one piece."""

REASONS = {
    MoveFlag.COMPENSATED: "cutter radius compensation",
    MoveFlag.BESIDE: "cutter radius compensation",
    MoveFlag.ROUNDED: "a chamfer or rounding",
    MoveFlag.MACRO: "a value from a variable",
    MoveFlag.TARGET: "a target of jumps",
    MoveFlag.CYCLE: "a canned cycle",
    MoveFlag.TRANSFORMED: "rotated, scaled or tilted coordinates",
    MoveFlag.ROTARY: "another axis than X, Y and Z",
    MoveFlag.CONDITIONAL: "a conditional part of the program",
    MoveFlag.NO_FEED: "no feed in force",
    MoveFlag.MACRO_FEED: "a feed from a variable that is not known",
    MoveFlag.MACHINE: "coordinates of the machine",
    MoveFlag.FIXED: "words that act once",
    MoveFlag.POLAR: "polar or other ends",
    MoveFlag.OFFSET: "a change of offset",
    MoveFlag.UNPOINTED: "coordinates without a decimal point",
}
"""Reasons for which a block is left alone or in one piece, as messages name them."""


@dataclass(frozen=True, slots=True, kw_only=True)
class CompensationSide:
    """Side of a contour on which the tool goes (G41, G42)."""

    is_left: bool
    plane: ArcPlane = ArcPlane.XY
    number: int | None = None
    """D word that names the tool or its offset; None without one."""
    diameter: float | None = None
    """Diameter that the program gives, mm (G41.1, G42.1); None: that of a table."""

    @property
    def sign(self) -> float:
        """1 to the left of the contour, -1 to the right."""
        return 1.0 if self.is_left else -1.0


@dataclass(frozen=True, slots=True, kw_only=True)
class ModalSetting:
    """Modal state that consecutive moves share."""

    tool: int | None = None
    """Number of the tool in the spindle; None if none was called, or one by its name."""
    tool_name: str = ""
    """Name of a tool that is called by its name."""
    spindle: float | None = None
    """Spindle speed, rev/s, negative counter-clockwise (M4); None if not known."""
    surface: float | None = None
    """Constant surface speed, mm/s; None at constant spindle speed."""
    limit: float | None = None
    """Greatest spindle speed at constant surface speed, rev/s."""
    mode: FeedMode = FeedMode.PER_MINUTE
    frame: int = 0
    """Index of the frame in :attr:`NcMoves.frames`."""
    unit: float = 1.0
    """Length of one unit of the program, mm."""
    is_diameter: bool = False
    """Whether X words are diameters."""
    is_relative: bool = False
    """Whether axis words are distances from the last position (G91)."""
    is_centre_absolute: bool = False
    """Whether I, J and K are coordinates rather than distances from the start (G90.1)."""
    side: CompensationSide | None = None
    """Side of the contour on which the tool goes; None without compensation."""
    radius_wear: float = 0.0
    """Radius beyond that of the tool table by which contours are offset (DR), mm."""
    length_wear: float = 0.0
    """Distance along Z of the tip from the programmed place (DL), mm."""


class NcMove(NamedTuple):
    """One executed move, for readers that go through them one by one.

    A tuple and not a dataclass, as a long program has one for each block.
    """

    kind: MoveKind
    start: Point
    end: Point
    arc: Arc | None
    """Arc, or None for a line; its turn is NaN where it is not known."""
    feed: float
    """Feed, mm/s; NaN for rapids and where it is not known."""
    word: float
    """Feed in force, mm/s, mm per revolution or 1/s by mode; of a thread its lead, mm."""
    seconds: float
    """Time of a dwell, s; 0 for moves."""
    block: int
    call: int
    flags: MoveFlag
    setting: ModalSetting


ROW = np.dtype([
    ("start", np.float64, (3,)),
    ("end", np.float64, (3,)),
    ("word", np.float64),
    ("block", np.int32),
    ("fed_by", np.int32),
    ("call", np.int32),
    ("arc", np.int32),
    ("setting", np.int32),
    ("flags", np.int32),
    ("kind", np.int8),
])
KINDS = tuple(MoveKind)
"""Kinds of moves by their values."""

CHUNK = 1 << 14
"""Rows that become values together."""

ARC_NUMBERS = 5
"""Columns of :attr:`NcMoves.arcs`."""
PLANES = tuple(ArcPlane)
"""Planes by the index in :attr:`NcMoves.arcs`."""


@dataclass(frozen=True, kw_only=True)
class NcMoves:
    """Executed moves as columns; views of one compact table, N rows."""

    rows: NDArray[np.void]
    """(N,) structured array of the dtype :data:`ROW`."""
    arcs: Floats
    """(M, 5) array: centre x, y, z, mm, turn, rad, and index of the plane, of each arc."""
    settings: tuple[ModalSetting, ...]
    frames: tuple[str, ...]
    """Names of the frames, such as ``G54``."""
    calls: tuple[tuple[int, int], ...]
    """Call each call was made from, and the calling block; the main program is call 0."""
    switches: tuple[Block, ...] = ()
    """Tools, switches, comments and stops between the moves, each once."""

    def __len__(self) -> int:
        return len(self.rows)

    @property
    def start(self) -> Floats:
        """(N, 3) array: start points, mm; NaN where unknown."""
        return self.rows["start"]

    @property
    def end(self) -> Floats:
        """(N, 3) array: end points, mm; NaN where unknown."""
        return self.rows["end"]

    @property
    def kind(self) -> NDArray[np.int8]:
        """(N,) array: values of :class:`MoveKind`."""
        return self.rows["kind"]

    @cached_property
    def is_switch(self) -> NDArray[np.bool_]:
        """(N,) array: whether a row is a switch, a comment or a stop between moves."""
        return np.equal(self.kind, MoveKind.SWITCH)

    @cached_property
    def moving(self) -> "NcMoves":
        """The same without the switches between the moves."""
        return replace(self, rows=self.rows[~self.is_switch]) if self.switches else self

    @property
    def block(self) -> NDArray[np.int32]:
        """(N,) array: index of the block in the file."""
        return self.rows["block"]

    @property
    def call(self) -> NDArray[np.int32]:
        """(N,) array: index of the call or repeat in :attr:`calls`; 0 in the main program."""
        return self.rows["call"]

    @property
    def flags(self) -> NDArray[np.int32]:
        """(N,) array: values of :class:`MoveFlag`."""
        return self.rows["flags"]

    @property
    def fed_by(self) -> NDArray[np.int32]:
        """(N,) array: block whose F word is in force; -1 if none."""
        return self.rows["fed_by"]

    @property
    def word(self) -> Floats:
        """(N,) array: feed in force, mm/s, mm per revolution or 1/s by mode; NaN if none.

        Of a thread it is the lead along the axis that moves most, mm, in all modes.
        """
        return self.rows["word"]

    @cached_property
    def tool(self) -> NDArray[np.int32]:
        """(N,) array: number of the tool; -1 if none was called."""
        numbers = [-1 if each.tool is None else each.tool for each in self.settings]
        return np.array(numbers or [-1], np.int32)[self.rows["setting"]]

    @cached_property
    def has_tool(self) -> NDArray[np.bool_]:
        """(N,) array: whether a tool was called, by its number or its name."""
        called = [each.tool is not None or each.tool_name != "" for each in self.settings]
        return np.array(called or [False])[self.rows["setting"]]

    @cached_property
    def frame(self) -> NDArray[np.int32]:
        """(N,) array: index of the frame in :attr:`frames`."""
        numbers = [each.frame for each in self.settings]
        return np.array(numbers or [0], np.int32)[self.rows["setting"]]

    @cached_property
    def mode(self) -> NDArray[np.int32]:
        """(N,) array: index of the feed mode in the order of :class:`FeedMode`."""
        order = list(FeedMode)
        numbers = [order.index(each.mode) for each in self.settings]
        return np.array(numbers or [0], np.int32)[self.rows["setting"]]

    @cached_property
    def centre(self) -> Floats:
        """(N, 3) array: centres of arcs, mm; NaN for lines."""
        return self._of_arcs(slice(0, 3), nan)

    @cached_property
    def turn(self) -> Floats:
        """(N,) array: angles of arcs, rad, positive counter-clockwise; 0 for lines."""
        return self._of_arcs(3, 0.0)

    @cached_property
    def normal(self) -> NDArray[np.int64]:
        """(N,) array: axis along the normal of an arc's plane; 2 for lines."""
        index = self._of_arcs(4, 0.0).astype(np.int64)
        return np.array([plane.axes[2] for plane in PLANES], np.int64)[index]

    @cached_property
    def length(self) -> Floats:
        """(N,) array: lengths of the moves, mm; NaN where unknown."""
        radius = np.hypot(*arms(self.start, self.centre, self.normal))
        return lengths(self.start, self.end, radius=radius, turn=self.turn, normal=self.normal)

    @cached_property
    def spindle(self) -> Floats:
        """(N,) array: spindle speed at the end of each move, rev/s, signed; NaN if unknown.

        At constant surface speed it follows from x, up to its limit.
        """
        speeds = [nan if each.spindle is None else each.spindle for each in self.settings]
        surfaces = [nan if each.surface is None else each.surface for each in self.settings]
        limits = [np.inf if each.limit is None else each.limit for each in self.settings]
        index = self.rows["setting"]
        speed = np.array(speeds or [nan])[index]
        surface = np.array(surfaces or [nan])[index]
        limit = np.array(limits or [np.inf])[index]
        with np.errstate(divide="ignore", invalid="ignore"):
            turning = np.minimum(surface / (2.0 * pi * np.abs(self.end[:, 0])), limit)
        sign = np.where(np.signbit(speed), -1.0, 1.0)
        return np.where(np.isnan(surface), speed, sign * turning)

    @cached_property
    def feed(self) -> Floats:
        """(N,) array: feed, mm/s; NaN for rapids, threads and where it is not known."""
        per_minute, per_revolution, inverse = range(3)
        mode, word = self.mode, self.word
        has_inverse = any(each.mode is FeedMode.INVERSE_TIME for each in self.settings)
        length = self.length if has_inverse else word
        with np.errstate(invalid="ignore"):
            feed = np.select(
                [mode == per_minute, mode == per_revolution, mode == inverse],
                [word, word * np.abs(self.spindle), word * length],
                nan,
            )
        is_fed = np.isin(self.kind, (MoveKind.LINE, MoveKind.ARC))
        return np.where(is_fed & (feed > 0.0), feed, nan)

    @cached_property
    def has_rate(self) -> NDArray[np.bool_]:
        """(N,) array: whether a move at a feed knows it, or a thread its lead and speed."""
        is_turning = np.nan_to_num(self.spindle) != 0.0
        is_cut = (self.kind == MoveKind.THREAD) & (self.word > 0.0) & is_turning
        return is_cut | (self.feed > 0.0)

    @cached_property
    def is_known(self) -> NDArray[np.bool_]:
        """(N,) array: whether start, end and, of arcs, the centre are known."""
        known = ~(np.isnan(self.start).any(axis=1) | np.isnan(self.end).any(axis=1))
        return known & ~np.isnan(self.turn) & (self.kind != MoveKind.UNKNOWN)

    @cached_property
    def is_advisable(self) -> NDArray[np.bool_]:
        """(N,) array: whether the feed of the move may be advised."""
        is_fed = np.isin(self.kind, (MoveKind.LINE, MoveKind.ARC))
        return self.is_known & is_fed & ((self.flags & int(UNADVISED)) == 0)

    @cached_property
    def is_splittable(self) -> NDArray[np.bool_]:
        """(N,) array: whether the block of the move may be split."""
        return self.is_advisable & ((self.flags & int(UNSPLIT)) == 0)

    def fastest(self, rows: NDArray[np.int64]) -> float:
        """Greatest spindle speed in some rows, rev/s; 0 if not known.

        At constant surface speed it is that of the least distance from the axis; infinite at
        the axis without a limit.
        """
        fastest = 0.0
        for row in rows.tolist():
            setting = self.settings[int(self.rows["setting"][row])]
            if setting.surface is None:
                fastest = max(fastest, abs(setting.spindle or 0.0))
                continue
            one, other = float(self.start[row][0]), float(self.end[row][0])
            radius = 0.0 if one * other <= 0.0 else min(abs(one), abs(other))
            speed = setting.surface / (2.0 * pi * radius) if radius else inf
            fastest = max(fastest, min(speed, setting.limit or inf))
        return fastest

    def part(self, begin: int, end: int) -> "NcMoves":
        """Return some consecutive rows, whose derived columns need little memory."""
        return replace(self, rows=self.rows[begin:end])

    def move(self, index: int) -> NcMove:
        """Return one row as a value; rows near to each other are the quickest."""
        row = index % len(self)
        begin = row - row % CHUNK
        if begin not in self._latest:
            self._latest.clear()
            self._latest[begin] = self.part(begin, begin + CHUNK)
        part, at = self._latest[begin], row - begin
        return self._value(next(_numbers(part.rows[at : at + 1])), float(part.feed[at]))

    @cached_property
    def _latest(self) -> dict[int, "NcMoves"]:
        """Rows around the last one that was asked for: derived columns of all are large."""
        return {}

    def each(self) -> Iterator[NcMove]:
        """Yield all rows as values, in bounded memory."""
        for begin in range(0, len(self), CHUNK):
            part = self.part(begin, begin + CHUNK)
            yield from map(self._value, _numbers(part.rows), part.feed.tolist())

    def _value(self, row: tuple[Any, ...], feed: float) -> NcMove:
        """Value of a row by its :func:`_numbers`."""
        start, end, word, block, call, arc, setting, flags, kind = row
        return NcMove(
            KINDS[kind],
            start,
            end,
            None if arc < 0 else _arc(self.arcs[arc].tolist()),
            feed,
            word,
            word if kind == MoveKind.DWELL else 0.0,
            block,
            call,
            _flag(flags),
            self.settings[setting],
        )

    def _of_arcs(self, column: int | slice, filled: float) -> Floats:
        """Spread a column of the arcs over all rows."""
        index = self.rows["arc"]
        values = self.arcs[:, column]
        spread = np.full((len(index), *values.shape[1:]), filled)
        found = index >= 0
        spread[found] = values[index[found]]
        return spread


def _numbers(rows: NDArray[np.void]) -> Iterator[tuple[Any, ...]]:
    """Numbers of rows as :meth:`NcMoves._value` takes them; points are tuples."""
    points = (map(tuple, rows[name].tolist()) for name in ("start", "end"))
    names = ("word", "block", "call", "arc", "setting", "flags", "kind")
    return zip(*points, *(rows[name].tolist() for name in names), strict=True)


_flag = cache(MoveFlag)  # a program has few different ones


def _arc(numbers: Sequence[float]) -> Arc:
    x, y, z, turn, plane = numbers
    return Arc(centre=(x, y, z), turn=turn, plane=PLANES[int(plane)])
