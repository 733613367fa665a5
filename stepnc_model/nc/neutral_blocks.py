"""Neutral blocks of a foreign NC program, as the virtual machine runs them.

Moves whose start or end is not known are left out, and moves at a feed or lead that is not
known; a rapid with ``is_way`` bridges the gap to the next known move. All frames are laid over
each other.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from math import isnan, nan

from stepnc_model.nc.moves import FeedMode, ModalSetting, MoveKind, NcMove
from stepnc_model.nc.program import NcProgram
from stepnc_model.nc.spindle import spindle_block
from stepnc_model.post.blocks import (
    Block,
    Circular,
    Linear,
    Pause,
    ProgramEnd,
    ProgramStart,
    Rapid,
    Rate,
    RateMode,
    Retract,
    RigidTap,
    SpindleOn,
    ThreadingMove,
    ToolChange,
)
from stepnc_model.toolpath.path import Point

NumberedBlock = tuple[int, Block]
"""Line of the file, counted from 1, and a neutral block."""

APART = 1e-6
"""Distance above which a move does not start where the last one ended, mm."""


FED = frozenset({MoveKind.LINE, MoveKind.ARC, MoveKind.THREAD})
"""Kinds of moves at a feed."""

UNKNOWN: Point = (nan, nan, nan)
"""Place that is not known."""

NOTHING: Mapping[int, Block] = {}


def neutral_blocks(
    program: NcProgram, *, name: str = "", before: Mapping[int, Block] = NOTHING
) -> Iterator[NumberedBlock]:
    """Convert the executed moves of a program to neutral blocks, with the lines of the file.

    Parameters
    ----------
    program : NcProgram
    name : str
    before : mapping of int to Block
        Blocks to be put before moves, by the row of the stream.
    """
    yield 1, ProgramStart(name=name, machine=program.machine)
    last: tuple[int, Block | None] = 1, None
    for numbered in stream_blocks(program, before=before):
        last = numbered
        yield numbered
    if not isinstance(last[1], ProgramEnd):
        yield last[0], ProgramEnd()


def stream_blocks(
    program: NcProgram, *, before: Mapping[int, Block] = NOTHING, at: Point = UNKNOWN
) -> Iterator[NumberedBlock]:
    """Convert the stream of a program to neutral blocks, without start and end of its own.

    Parameters
    ----------
    program : NcProgram
    before : mapping of int to Block
        Blocks to be put before moves, by the row of the stream.
    at : Point, mm
        Place of the tool before the first move.
    """
    stream, text = program.stream, program.text
    state = _State(setting=ModalSetting(spindle=0.0), at=at)
    tap: NcMove | None = None
    rate = Rate(value=nan)
    moves = stream.each()
    move = next(moves, None)
    index = 0
    while move is not None:
        following = next(moves, None)
        line = text.line(move.block)
        if index in before:
            yield line, before[index]
        if move.kind is MoveKind.SWITCH:
            switch = stream.switches[int(move.word)]
            state.take(switch, move.setting)
            yield line, switch
        elif tap is not None:
            # The way out of the hole belongs to the tap.
            tap = None
        elif _is_tap(move, following):
            tap = move
            yield from ((line, block) for block in _tapped(state, move))
        else:
            # Moves share their setting: mostly it is the same object.
            if move.setting is not state.setting:
                for block in _set(state.setting, move.setting):
                    yield line, block
                state.setting = move.setting
            if _goes_on(state, move):
                # The usual block of a long program; moves at one feed share their rate.
                if move.feed != rate.value:
                    rate = Rate(value=move.feed)
                state.at = move.end
                yield line, Linear(end=move.end, rate=rate)
            else:
                for block in _moved(state, move):
                    yield line, block
        move, index = following, index + 1


@dataclass(slots=True)
class _State:
    """Setting and position that the blocks so far have brought about."""

    setting: ModalSetting
    at: Point

    def take(self, block: Block, setting: ModalSetting) -> None:
        """Take in a block that changes the tool or the spindle, as it is in a setting."""
        if isinstance(block, ToolChange):
            self.setting = replace(self.setting, tool=block.number)
        elif block == spindle_block(setting):
            self.setting = replace(
                self.setting,
                spindle=setting.spindle,
                surface=setting.surface,
                limit=setting.limit,
            )


def _set(old: ModalSetting, new: ModalSetting) -> Iterator[Block]:
    """Blocks for a change of tool and spindle."""
    if new.tool != old.tool and new.tool is not None:
        yield ToolChange(number=new.tool)
    if (new.spindle, new.surface, new.limit) != (old.spindle, old.surface, old.limit):
        block = spindle_block(new)
        if block is not None:
            yield block


def _is_tap(move: NcMove, following: NcMove | None) -> bool:
    """True if two moves go into a hole and out again, where the spindle turns back."""
    return (
        move.kind is MoveKind.THREAD
        and following is not None
        and following.kind is MoveKind.THREAD
        and following.end == move.start
        and move.start[:2] == move.end[:2]
        and bool(move.setting.spindle)
        and following.setting.spindle == -(move.setting.spindle or 0.0)
        and move.word > 0.0
    )


def _tapped(state: _State, move: NcMove) -> Iterator[Block]:
    """Blocks of a rigid tap, after which the tool is where it began."""
    turning = spindle_block(move.setting)
    if not isinstance(turning, SpindleOn):
        return
    if _is_apart(state.at, move.start):
        yield Rapid(end=move.start, is_way=not isnan(state.at[0]))
    yield RigidTap(
        start=move.start,
        bottom_z=move.end[2],
        lead=move.word,
        speed=turning.speed,
        sense=turning.sense,
    )
    state.at = move.start


def _goes_on(state: _State, move: NcMove) -> bool:
    """True if a move is a line at a feed per time from the very place of the tool.

    No place that is not known equals another.
    """
    return (
        move.kind is MoveKind.LINE
        and move.arc is None
        and move.feed > 0.0
        and move.setting.mode is not FeedMode.PER_REVOLUTION
        and state.at == move.start
        and not isnan(sum(move.end))
    )


def _moved(state: _State, move: NcMove) -> Iterator[Block]:
    """Blocks of one move."""
    if move.kind is MoveKind.DWELL:
        yield Pause(seconds=move.seconds)
        return
    if isnan(sum(move.end)):
        if move.kind is MoveKind.RAPID and not isnan(move.end[2]) and isnan(sum(state.at)):
            yield Retract(z=move.end[2])
        return
    is_fed = move.kind in FED
    if is_fed and not _has_rate(move):
        return
    is_begun = isnan(sum(move.start))
    if not is_begun and _is_apart(state.at, move.start) and (is_fed or not isnan(state.at[0])):
        yield Rapid(end=move.start, is_way=True)
    is_bent = move.arc is not None and isnan(move.arc.turn)
    if not is_fed or is_begun or is_bent:
        yield Rapid(end=move.end, is_way=(is_begun or is_bent) and not isnan(state.at[0]))
    elif move.kind is MoveKind.THREAD:
        yield ThreadingMove(end=move.end, lead=move.word)
    elif move.arc is not None:
        yield Circular(end=move.end, arc=move.arc, rate=_rate(move))
    else:
        yield Linear(end=move.end, rate=_rate(move))
    state.at = move.end


def _has_rate(move: NcMove) -> bool:
    """True if the feed of a move is known, or the lead and the spindle speed of a thread."""
    if move.kind is MoveKind.THREAD:
        return move.word > 0.0 and bool(move.setting.spindle)
    return move.feed > 0.0


def _rate(move: NcMove) -> Rate:
    """Feed of a move; at constant surface speed it stays a feed per revolution."""
    if move.setting.mode is FeedMode.PER_REVOLUTION:
        return Rate(value=move.word, mode=RateMode.PER_REVOLUTION)
    return Rate(value=move.feed)


def _is_apart(one: Point, other: Point) -> bool:
    return not (
        abs(one[0] - other[0]) <= APART
        and abs(one[1] - other[1]) <= APART
        and abs(one[2] - other[2]) <= APART
    )
