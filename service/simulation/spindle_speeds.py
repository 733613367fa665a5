"""Spindle speeds of NC code that states none, as programs of routers with a dial do."""

from collections.abc import Mapping
from dataclasses import replace
from math import copysign, pi

import numpy as np

from simulator.removal.cutter import Cutter
from simulator.tools.tool_table import TableTool
from stepnc_model.errors import StepNcError
from stepnc_model.nc.moves import ModalSetting, MoveKind, NcMoves
from stepnc_model.nc.program import NcProgram
from stepnc_model.units import rev_s_from_rpm

MOST_RPM = 500_000.0
"""Greatest speed of a spindle, rpm; larger ones are typing errors."""

ALL = -1
"""Key of the speed of all tools that have none of their own."""


def speeds_in(words: tuple[str, ...]) -> dict[int, float]:
    """Speeds given as ``T1=18000``, or as a number for all tools, rev/s.

    Raises
    ------
    StepNcError
        When a word is no speed, or a tool has two.

    Examples
    --------
    >>> speeds_in(("T1=18000",))
    {1: 300.0}
    """
    found: dict[int, float] = {}
    for word in words:
        name, _, text = word.rpartition("=")
        number = name.strip().upper().removeprefix("T")
        try:
            rpm = float(text)
        except ValueError:
            rpm = 0.0
        if not 0.0 < rpm <= MOST_RPM or not (number.isdecimal() or not name):
            raise StepNcError(
                f"spindle speed '{word}': expected T1=18000, 0 to {MOST_RPM:g} rpm"
            )
        tool = int(number) if number else ALL
        if found.get(tool, rev_s_from_rpm(rpm)) != rev_s_from_rpm(rpm):
            raise StepNcError(f"spindle speed '{word}': {name or 'all tools'} has another one")
        found[tool] = rev_s_from_rpm(rpm)
    return found


def with_spindles(program: NcProgram, speeds: Mapping[int, float]) -> NcProgram:
    """Return the program with speeds where its spindle turns at one that is not known."""
    if not speeds:
        return program
    stream = program.stream
    settings = tuple(_turning(each, speeds) for each in stream.settings)
    return replace(program, stream=replace(stream, settings=settings))


def lacks_speed(moves: NcMoves, tool: int) -> bool:
    """True if no speed of the spindle is known while a tool moves at a feed."""
    is_fed = np.isin(moves.kind, (MoveKind.LINE, MoveKind.ARC)) & (moves.tool == tool)
    return bool(np.isnan(moves.spindle[is_fed]).all())


def least_cutting_speed(moves: NcMoves, number: int, tool: TableTool) -> float:
    """Least cutting speed of a rotating tool, mm/s; 0 if it is not known."""
    is_fed = np.isin(moves.kind, (MoveKind.LINE, MoveKind.ARC)) & (moves.tool == number)
    speeds = np.abs(moves.spindle[is_fed])
    if not isinstance(tool.shape, Cutter) or not speeds.size or np.isnan(speeds).any():
        return 0.0
    return pi * tool.shape.diameter * float(speeds.min())


def _turning(setting: ModalSetting, speeds: Mapping[int, float]) -> ModalSetting:
    if setting.spindle is not None or setting.surface is not None:
        return setting
    speed = speeds.get(ALL if setting.tool is None else setting.tool, speeds.get(ALL))
    return setting if speed is None else replace(setting, spindle=copysign(speed, 1.0))
