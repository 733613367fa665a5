"""Passes beside a wall: outside profiles, bosses and steps, one level at a time."""

from math import ceil

import numpy as np

from stepnc_model.toolpath.job import Job
from stepnc_model.toolpath.milling.area import Flank, extra
from stepnc_model.toolpath.milling.arrays import Edges, distances
from stepnc_model.toolpath.milling.clip import inside
from stepnc_model.toolpath.milling.contour import (
    Loop,
    polygon,
    reversed_chain,
    rotated_to,
    stretched,
)
from stepnc_model.toolpath.milling.cover import Pass
from stepnc_model.toolpath.milling.cutter import Cutter, run_out
from stepnc_model.toolpath.milling.layer import Layer, Level
from stepnc_model.toolpath.milling.offset import beside, erode
from stepnc_model.toolpath.milling.room import Room
from stepnc_model.toolpath.milling.room import beside as clearance
from stepnc_model.toolpath.milling.way import Way

MOST_PASSES = 1000


def flank_layer(
    job: Job, flank: Flank, level: Level, way: Way, *, is_single: bool
) -> Layer | None:
    """Passes at one level, from the outside in; None when the cutter cannot follow the wall.

    ``is_single``: only what an earlier operation left on the wall is taken off.
    """
    cutter = level.cutter
    lean = extra(flank.inset, cutter, bottom=level.z - flank.bottom, top=flank.depth)
    near = level.distance + lean
    count = 1 if is_single else _count(job, flank, way, level.allowance + lean)
    stock = _stock(job)
    near_stock = level.touching(stock)
    passes: list[Pass] = []
    for index in reversed(range(count)):
        for cut in _at(job, flank, cutter, near + index * way.step):
            # The last pass follows the whole wall; those before it only where there is stock.
            passes += [cut] if index == 0 or not near_stock else inside(cut, near_stock)
    if not passes:
        return None
    if not way.has_wall_on_right:
        passes = [Pass(reversed_chain(cut.chain), cut.is_closed) for cut in passes]
    return Layer(
        z=level.z,
        above=level.above,
        passes=tuple(passes),
        solid=near_stock,
        room=Room(
            clearance=clearance(flank.chain, near),
            side=1j if way.has_wall_on_right else -1j,
        ),
    )


def _at(job: Job, flank: Flank, cutter: Cutter, distance: float) -> list[Pass]:
    """The wall at a distance; a closed one starts in the middle of its longest line."""
    if flank.is_closed:
        return [
            Pass(rotated_to(loop, _start(loop)), is_closed=True)
            for loop in erode([flank.chain], distance)
        ]
    run = cutter.radius + run_out(job)
    longer = stretched(flank.chain, run, run)
    return [Pass(chain, is_closed=False) for chain in beside(longer, distance)]


def _start(loop: Loop) -> complex:
    """Middle of the longest line, or of the longest arc."""
    lines = [edge for edge in loop if edge.centre is None] or list(loop)
    return max(lines, key=lambda edge: edge.length).at(0.5)


def _count(job: Job, flank: Flank, way: Way, left: float) -> int:
    """Passes side by side that remove everything up to the side of the stock."""
    width = flank.width
    if width is None:
        stock = _stock(job)
        if stock is None:
            return 1
        corners = np.array([edge.start for edge in stock], dtype=complex)
        width = float(distances(corners, Edges.of(flank.chain)).max())
    count = max(1, ceil((width - left) / way.step - 1e-6))
    if count > MOST_PASSES:
        raise job.fault(
            f"{count} passes of {way.step:g} mm beside its wall: {MOST_PASSES} are enough",
            flank.ref,
        )
    return count


def _stock(job: Job) -> Loop | None:
    """The stock seen along z: a rectangle; a bar by the square about it."""
    if job.stock is None:
        return None
    (x0, y0, _), (x1, y1, _) = job.stock.low, job.stock.high
    return polygon([complex(x0, y0), complex(x1, y0), complex(x1, y1), complex(x0, y1)])
