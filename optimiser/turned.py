"""What a turning path makes of its bar: for its bending, and how fast it turns meanwhile."""

from collections.abc import Iterator
from math import ceil, inf

from optimiser.cut import Cut, Turned
from optimiser.hardest import Met
from simulator.motion.surface_speed import PIECE
from simulator.motion.tool_path import Run
from simulator.physics.slender_bar import BarSection
from simulator.removal.lathe import Bar, TurningStock

SAME_SPEED = 1e-6
"""share by which speeds differ that are one"""

MOST_SECTIONS = 200
"""that a bar is told by; each is as thin as it is anywhere within"""


def turned_of(cut: Cut, met: Met, run: Run, stock: TurningStock, after: Bar) -> Turned | None:
    """The bar after a path, and where the path cuts it; None where it cuts nothing.

    Parameters
    ----------
    cut : Cut
        With the programmed speed where the bar is widest.
    met : Met
        What its path met.
    run : Run
        The path as programmed.
    stock : TurningStock
        What it found.
    after : Bar
        What it left.
    """
    stations = met.stations
    rows = stations.section > 0.0
    if not rows.any():
        return None
    z = run.segments.position(stations.segment[rows], stations.station[rows])[:, 2]
    speeds = run.spindle[stations.segment[rows]]
    fastest = float(speeds.max())
    ratio = 1.0
    if fastest > (1.0 + SAME_SPEED) * float(speeds.min()):
        ratio = cut.diameter / max(float(stations.diameter[rows].min()), met.cell)
    is_clamped = fastest < (1.0 - PIECE) * ratio * cut.programmed.speed
    return Turned(
        sections=tuple(_sections(stock.cell, after)),
        back=float(stock.z[0]) - 0.5 * stock.cell,
        low=float(z.min()),
        high=float(z.max()),
        speed_ratio=ratio,
        greatest_speed=fastest if is_clamped else inf,
    )


def _sections(cell: float, bar: Bar) -> Iterator[BarSection]:
    """Stretches of a bar up to where nothing is left of it, mm from its first end."""
    is_left = bar.outer > bar.inner
    count = len(is_left) if is_left.all() else int(is_left.argmin())
    step = max(1, ceil(count / MOST_SECTIONS))
    for first in range(0, count, step):
        last = min(first + step, count)
        yield BarSection(
            start=first * cell,
            end=last * cell,
            outer=2.0 * float(bar.outer[first:last].min()),
            inner=2.0 * float(bar.inner[first:last].max()),
        )
