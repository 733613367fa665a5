"""Position of the program zero on the machine, and checks of axis travel.

Units mm.
"""

from math import isfinite

import numpy as np

from simulator.errors import OutOfTravel, ProgramFault
from simulator.motion.segments import AXES, Floats, Ints, Segments
from simulator.spec import Machine, MachineKind
from stepnc_model.programs.program import Stock
from stepnc_model.toolpath.arc_columns import to_quadrants

Zero = tuple[float, float, float]
"""Position of the program zero on the axes X, Y, Z, mm."""

ROUNDING = 1e-6
"""Distance by which a position may exceed the travel because of rounding, mm."""


def zero_of(machine: Machine, stock: Stock) -> Zero:
    """Choose a position of the program zero that suits a stock.

    On a mill the stock lies in the middle of the travel; on a lathe the spindle axis is zero,
    and the stock begins where the travel along Z begins.
    """
    places = [0.0, 0.0, 0.0]
    for axis in machine.axes:
        row = AXES.index(axis.name)
        low, high = axis.travel
        if not isfinite(low) or not isfinite(high):
            continue
        if machine.kind is MachineKind.MILL:
            places[row] = 0.5 * (low + high - stock.low[row] - stock.high[row])
        elif axis.name == "Z":
            places[row] = low - stock.low[row]
    return places[0], places[1], places[2]


def require_travel(machine: Machine, segments: Segments, zero: Zero) -> None:
    """Raise an error if a path leaves the travel of an axis.

    Raises
    ------
    OutOfTravel
        With axis, position and line.
    """
    turned, station = _farthest(segments)
    on_arcs = segments.position(turned, station)
    points = np.concatenate((segments.start[:1], segments.end, on_arcs))
    lines = np.concatenate((segments.block[:1], segments.block, segments.block[turned]))
    for axis in machine.axes:
        row = AXES.index(axis.name)
        low, high = axis.travel[0] - zero[row], axis.travel[1] - zero[row]
        at = points[:, row]
        beyond = np.flatnonzero((at < low - ROUNDING) | (at > high + ROUNDING))
        if len(beyond):
            position, line = float(at[beyond[0]]), int(lines[beyond[0]])
            raise OutOfTravel(axis.name, position, travel=(low, high), line=line)


def require_axes(machine: Machine, segments: Segments) -> None:
    """Raise an error if a path moves along an axis that the machine does not have.

    Raises
    ------
    ProgramFault
        With axis and line.
    """
    known = {axis.name for axis in machine.axes}
    for row, name in enumerate(AXES):
        way = np.abs(segments.end[:, row] - segments.start[:, row])
        moves = np.flatnonzero((way > ROUNDING) & (name not in known))
        if len(moves):
            message = f"move along {name}, but machine '{machine.name}' has no such axis"
            raise ProgramFault(message, int(segments.block[moves[0]]))


def _farthest(segments: Segments) -> tuple[Ints, Floats]:
    """Rows of arcs, and the stations at which they are farthest out along an axis, mm."""
    rows = np.flatnonzero(segments.turn)
    turn = segments.turn[rows]
    ways = to_quadrants(segments.start_angle[rows], turn)
    part = np.minimum(ways / np.abs(turn)[:, None], 1.0)
    return np.repeat(rows, part.shape[1]), (part * segments.length[rows][:, None]).ravel()
