"""Neutral blocks of a foreign NC program, as the virtual machine runs them.

Moves whose start or end is not known are left out; a rapid with ``is_way`` bridges the gap to
the next known move. Coolant, messages and stops have no effect on the cut and are left out as
well. All frames are laid over each other.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from math import isnan, nan

from stepnc_model.nc.moves import FeedMode, ModalSetting, MoveKind, NcMove
from stepnc_model.nc.program import NcProgram
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
    SpindleDirection,
    SpindleOff,
    SpindleOn,
    SurfaceSpeed,
    ToolChange,
)
from stepnc_model.toolpath.path import Point

NumberedBlock = tuple[int, Block]
"""Line of the file, counted from 1, and a neutral block."""

APART = 1e-6
"""Distance above which a move does not start where the last one ended, mm."""


FED = frozenset({MoveKind.LINE, MoveKind.ARC, MoveKind.THREAD})
"""Kinds of moves at a feed."""

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
        Blocks to be put before moves, by the row of the move.
    """
    yield 1, ProgramStart(name=name, machine=program.machine)
    moves, text = program.moves, program.text
    state = _State(setting=ModalSetting(), at=(nan, nan, nan))
    line = 1
    for index, move in enumerate(moves.each()):
        line = text.line(move.block)
        if index in before:
            yield line, before[index]
        # Moves share their setting: mostly it is the same object.
        if move.setting is not state.setting:
            for block in _set(state.setting, move.setting):
                yield line, block
            state.setting = move.setting
        for block in _moved(state, move):
            yield line, block
    yield line, ProgramEnd()


@dataclass(slots=True)
class _State:
    """Setting and position that the blocks so far have brought about."""

    setting: ModalSetting
    at: Point


def _set(old: ModalSetting, new: ModalSetting) -> Iterator[Block]:
    """Blocks for a change of tool and spindle."""
    if new.tool != old.tool and new.tool is not None:
        yield ToolChange(number=new.tool)
    before = old.spindle, old.surface, old.limit
    if (new.spindle, new.surface, new.limit) == before or new.spindle is None:
        return
    is_clockwise = new.spindle > 0.0
    sense = SpindleDirection.CLOCKWISE if is_clockwise else SpindleDirection.COUNTERCLOCKWISE
    if new.spindle == 0.0:
        yield SpindleOff()
    elif new.surface is not None:
        yield SurfaceSpeed(speed=new.surface, limit=new.limit, sense=sense)
    else:
        yield SpindleOn(speed=abs(new.spindle), sense=sense)


def _moved(state: _State, move: NcMove) -> Iterator[Block]:
    """Blocks of one move."""
    if move.kind is MoveKind.DWELL:
        yield Pause(seconds=move.seconds)
        return
    if isnan(sum(move.end)):
        if move.kind is MoveKind.RAPID and not isnan(move.end[2]) and isnan(sum(state.at)):
            yield Retract(z=move.end[2])
        return
    is_fed = move.kind in FED and move.feed > 0.0
    is_begun = isnan(sum(move.start))
    if not is_begun and _is_apart(state.at, move.start) and (is_fed or not isnan(state.at[0])):
        yield Rapid(end=move.start, is_way=True)
    if not is_fed or is_begun or isnan(move.turn):
        yield Rapid(end=move.end, is_way=is_begun and not isnan(state.at[0]))
    elif move.centre is not None:
        yield Circular(
            end=move.end,
            centre=move.centre,
            turn=move.turn,
            plane=move.plane,
            rate=_rate(move),
        )
    else:
        yield Linear(end=move.end, rate=_rate(move))
    state.at = move.end


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
