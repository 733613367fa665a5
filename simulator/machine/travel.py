"""Where the program's zero lies on the machine, and moves that leave the travel of its axes.

Units mm.
"""

from math import isfinite

import numpy as np

from simulator.errors import OutOfTravel
from simulator.motion.motion import AXES
from simulator.motion.segments import Segments
from simulator.spec import Machine, MachineKind
from stepnc_model.toolpath.job import Stock

Zero = tuple[float, float, float]
"""place of the program's zero on the axes X, Y, Z, mm"""

ARC_POINTS = 8
"""places on an arc that are looked at"""


def zero_of(machine: Machine, stock: Stock) -> Zero:
    """Place of the program's zero that suits a stock.

    On a mill the stock lies in the middle of the travel; on a lathe the axis of the spindle is
    zero, and the stock begins where the travel along it does.
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
    """Refuse a path that leaves the travel of an axis.

    Raises
    ------
    OutOfTravel
        With axis, position and line.
    """
    turned = np.repeat(np.flatnonzero(segments.turn), ARC_POINTS)
    part = np.resize(np.arange(1, ARC_POINTS + 1) / ARC_POINTS, len(turned))
    on_arcs = segments.position(turned, part * segments.length[turned])
    points = np.concatenate((segments.start[:1], segments.end, on_arcs))
    lines = np.concatenate((segments.block[:1], segments.block, segments.block[turned]))
    for axis in machine.axes:
        row = AXES.index(axis.name)
        low, high = axis.travel[0] - zero[row], axis.travel[1] - zero[row]
        beyond = np.flatnonzero((points[:, row] < low) | (points[:, row] > high))
        if len(beyond):
            at = float(points[beyond[0], row])
            line = int(lines[beyond[0]])
            raise OutOfTravel(axis.name, at, travel=(low, high), line=line)
