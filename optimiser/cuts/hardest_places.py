"""Find the places where a tool cuts hardest, from its contacts along the path.

The loads are those of the virtual machine: the mean force follows from the section of the cut
and the mean chip thickness, forces along the helix from the contact arc and the depth that the
section fills there. Every station is tried, because the place of the greatest mean force need
not be the place of the greatest shank load. Units: mm, rad.

For a turning path, the shape of the bar (for its bending) and the spindle speeds are found too.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, fields, replace
from math import ceil, inf, pi, sin

import numpy as np

from optimiser.cuts.cut import CriticalPlace, Cut, CutKind, TurnedBar
from simulator.motion.segments import Bools, Floats, Ints
from simulator.motion.tool_path import PIECE, ToolPathRun
from simulator.physics import drilling
from simulator.physics.engagement import Engagement
from simulator.physics.flutes import CuttingEdges, ForceLaw
from simulator.physics.force_cache import DIGITS, peak_at, wall_at
from simulator.physics.slender_bar import BarSection
from simulator.physics.tooth_forces import Places, peak_resultant, wall_force
from simulator.removal.lathe import BarRadii, TurningStock
from simulator.removal.stations import SingleArcs, StationKind, Stations
from simulator.spec import Kienzle, ToolKind

LEAST_RATIO = 0.01
"""Least mean chip thickness over feed; the power of thinner chips is not reliable."""

LIKELY = 0.65
"""Share of the greatest rough force above which a station is evaluated exactly.

A rough force is always above 0.7 of the exact one.
"""

KINDS = {
    CutKind.MILLING: StationKind.MILLING,
    CutKind.TURNING: StationKind.TURNING,
    CutKind.GROOVING: StationKind.TURNING,
    CutKind.DRILLING: StationKind.DRILLING,
}
"""Kind of stations that determine each process; plunges have a module of their own."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PathContacts:
    """Simulated contacts of a tool with the stock along a path."""

    stations: Stations
    length: Floats
    """Length of the stretch for which each station holds, (M,), mm."""
    cell: float
    """Cell size of the stock map, mm; sections of shorter stretches are noise."""

    @property
    def volume(self) -> float:
        """Removed volume, mm³."""
        return float((self.stations.section * self.length).sum())

    def where(self, rows: Bools) -> "PathContacts":
        """Contacts at the selected stations only."""
        kept = {each.name: getattr(self.stations, each.name)[rows] for each in fields(Stations)}
        return replace(self, stations=Stations(**kept), length=self.length[rows])

    def on(self, run: ToolPathRun, other: ToolPathRun) -> "PathContacts":
        """Contacts of another path, transferred to a run of the same way in other segments."""
        length = other.segments.length
        before = (np.cumsum(length) - length)[self.stations.segment]
        middle = before + self.stations.station - 0.5 * self.length
        piece = np.searchsorted(np.cumsum(run.segments.length)[:-1], middle)
        return replace(self, stations=replace(self.stations, segment=piece))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Bending:
    """Bending forces at the milling stations, over ``K·k_c1.1·f_z^q``, mm."""

    at: Ints
    """Row numbers of the milling stations, (K,)."""
    shank: Floats
    """Greatest force across the tool axis, (K,), mm."""
    wall: Floats
    """Greatest force normal to the wall, (K,), mm."""


def bending(
    cut: Cut, stations: Stations, kienzle: Kienzle, *, is_exact: bool = False
) -> Bending:
    """Bending forces of an end mill along a path; empty for other tools.

    They are exact where they may be among the greatest, and elsewhere only if asked for.
    """
    at = _milled_rows(stations)
    if cut.tool_kind is not ToolKind.ENDMILL or not len(at):
        return Bending(at=at[:0], shank=np.empty(0), wall=np.empty(0))
    arcs = stations.arcs
    columns = np.stack((arcs.entry_angle[at], arcs.exit_angle[at], arcs.depth[at]))
    law = ForceLaw(exponent=1.0 - kienzle.m_c)
    if is_exact:
        peak, walled = peak_at(cut.edges, law, columns), wall_at(cut.edges, law, columns)
        return Bending(at=at, shank=arcs.fill[at] * peak, wall=arcs.fill[at] * walled)
    told, row = np.unique(np.round(columns, DIGITS), axis=1, return_inverse=True)
    places = Places(entry_angle=told[0], exit_angle=told[1], axial_depth=told[2])
    fill = np.zeros(told.shape[1])
    np.maximum.at(fill, row.ravel(), arcs.fill[at])
    forces = (
        _where_hard(each, cut.edges, places, law, fill)[row.ravel()]
        for each in (peak_resultant, wall_force)
    )
    shank, wall = (arcs.fill[at] * force for force in forces)
    return Bending(at=at, shank=shank, wall=wall)


def _where_hard(
    greatest: Callable[..., Floats],
    edges: CuttingEdges,
    places: Places,
    law: ForceLaw,
    fill: Floats,
) -> Floats:
    """Forces at many places, exact where they may be among the greatest, rough elsewhere."""
    found = greatest(edges, places, law, is_rough=True)
    rows = np.flatnonzero(fill * found >= LIKELY * (fill * found).max())
    found[rows] = greatest(edges, places.rows(rows), law)
    return found


def with_hardest(
    cut: Cut, met: PathContacts, kienzle: Kienzle, *, depth: float, bent: Bending
) -> Cut:
    """Return the cut with the hardest engagement that its passes met, if they met any."""
    rows = met.stations.kind == KINDS[cut.kind]
    if cut.kind is not CutKind.MILLING:
        is_long = rows & (met.length >= met.cell)
        rows = is_long if is_long.any() else rows
    if not rows.any():
        return cut
    if cut.kind is CutKind.MILLING:
        return _milled(cut, met, kienzle, nominal=depth, bent=bent)
    if cut.kind is CutKind.DRILLING:
        return _drilled(cut, met.stations, np.flatnonzero(rows))
    return _turned(cut, met.stations, np.flatnonzero(rows), kienzle, nominal=depth)


def weighted_volume(met: PathContacts, exponent: float) -> float:
    """Volume weighted by the chip ratio χ, ``Σ V·χ^(−m)``, proportional to the energy."""
    rows = met.stations.section > 0.0
    volume = met.stations.section[rows] * met.length[rows]
    ratio = met.stations.chip_ratio[rows].clip(LEAST_RATIO)
    return float((volume * ratio**-exponent).sum())


def greatest_section(cut: Cut, *, depth: float) -> tuple[float, float]:
    """Section at the hardest place, mm², and its chip ratio, for a nominal depth of pass."""
    tool = cut.tool
    if cut.kind is CutKind.MILLING:
        if cut.engagement is None:
            raise ValueError("the milling cut has no engagement")
        width = 0.5 * cut.diameter * cut.engagement.cosine_difference * cut.fill
        return depth * cut.depth_share * width, cut.mean_chip_ratio
    if cut.kind is CutKind.DRILLING:
        point = drilling.edge_angle(cut.tool_kind, tool.point_angle)
        return 0.25 * pi * (cut.drilled_diameter**2 - cut.previous_diameter**2), sin(point)
    if cut.kind is CutKind.GROOVING:
        return pi * cut.diameter * cut.radial_width, 1.0
    return pi * cut.diameter * depth * cut.depth_share, sin(cut.turning_edge_angle)


def _share(cut: Cut, share: float) -> float:
    """Real depth over the nominal one; at least 1 where the depth may be chosen.

    A pass may have met less material only because no more was left; a pass of a different
    depth would not. The levels of a mill are equal, whatever depth was requested: 13 mm in
    passes of 2 mm are seven of 1.857 mm.
    """
    if not cut.is_depth_free:
        return share
    given = cut.programmed
    is_equal = cut.kind is CutKind.MILLING
    least = cut.total_depth / (given.passes * given.depth) if is_equal else 1.0
    return max(min(least, 1.0), share)


def _drilled(cut: Cut, stations: Stations, at: Ints) -> Cut:
    """Drilled cut at the greatest section that the lips met along the path."""
    row = at[stations.peak_section[at].argmax()]
    # Here the axial depth is the width of a lip, and the diameter twice its mid-radius.
    middle, width = float(stations.diameter[row]), float(stations.axial_depth[row])
    return replace(cut, widest_drilled=middle + width, previous_diameter=middle - width)


def _turned(cut: Cut, stations: Stations, at: Ints, kienzle: Kienzle, *, nominal: float) -> Cut:
    """Turned cut at its greatest force; at a small depth the nose radius thins the chip."""
    ratio = stations.chip_ratio[at].clip(LEAST_RATIO)
    row = (stations.axial_depth[at] * ratio**-kienzle.m_c).argmax()
    deepest = float(stations.axial_depth[at][row])
    if cut.kind is CutKind.GROOVING:
        return replace(cut, radial_width=min(cut.radial_width, deepest))
    share = _share(cut, deepest / nominal)
    most = _share(cut, float(stations.axial_depth[at].max()) / nominal)
    return replace(cut, depth_share=share, deepest_share=most, chip_ratio=float(ratio[row]))


def _milled(
    cut: Cut, met: PathContacts, kienzle: Kienzle, *, nominal: float, bent: Bending
) -> Cut:
    """Milling cut with the places of its greatest mean, cross and wall forces."""
    stations = met.stations
    at = _milled_rows(stations)
    if not len(at):
        return cut
    arcs = stations.arcs
    mean = stations.peak_section[at] * stations.chip_ratio[at].clip(LEAST_RATIO) ** -kienzle.m_c
    hardest = at[(mean / stations.diameter[at]).argmax()]

    def place(row: np.int64) -> CriticalPlace:
        return CriticalPlace(
            engagement=Engagement(
                entry_angle=max(float(arcs.entry_angle[row]), 0.0),
                exit_angle=min(float(arcs.exit_angle[row]), pi),
            ),
            depth_share=_share(cut, float(arcs.depth[row]) / nominal),
            fill=float(arcs.fill[row]),
        )

    shank = wall = None
    if len(bent.at):
        shank, wall = (place(bent.at[each.argmax()]) for each in (bent.shank, bent.wall))
    greatest = place(hardest)
    return replace(
        cut,
        engagement=greatest.engagement,
        depth_share=greatest.depth_share,
        fill=greatest.fill,
        chip_ratio=max(float(stations.chip_ratio[hardest]), LEAST_RATIO),
        width_ratio=float(width_ratios(arcs, at).max()),
        chip_sine=float(chip_sines(arcs, at).max()),
        shank=shank,
        wall=wall,
        radial_width=0.5 * cut.diameter * greatest.engagement.cosine_difference * greatest.fill,
    )


def _milled_rows(stations: Stations) -> Ints:
    """Rows of the stations that mill along a known arc."""
    has_arc = stations.exit_angle > stations.entry_angle
    return np.flatnonzero((stations.kind == StationKind.MILLING) & has_arc)


def width_ratios(arcs: SingleArcs, at: Ints) -> Floats:
    """Radial width over diameter, a_e/D, at the stations."""
    entry, exit_ = _within(arcs, at)
    ratio: Floats = 0.5 * (np.cos(entry) - np.cos(exit_))
    return ratio


def chip_sines(arcs: SingleArcs, at: Ints) -> Floats:
    """Greatest sin φ on the contact arcs of the stations."""
    entry, exit_ = _within(arcs, at)
    holds_top = (entry <= 0.5 * pi) & (exit_ >= 0.5 * pi)
    sine: Floats = np.where(holds_top, 1.0, np.maximum(np.sin(entry), np.sin(exit_)))
    return sine


def _within(arcs: SingleArcs, at: Ints) -> tuple[Floats, Floats]:
    """Entry and exit angles of stations, clipped to the side where chips are formed, rad."""
    return arcs.entry_angle[at].clip(0.0, pi), arcs.exit_angle[at].clip(0.0, pi)


SAME_SPEED = 1e-6
"""Relative difference below which spindle speeds count as equal."""

MOST_SECTIONS = 200
"""Greatest number of sections that describe a bar; each has its least thickness."""


def turned_of(
    cut: Cut, met: PathContacts, run: ToolPathRun, stock: TurningStock, after: BarRadii
) -> TurnedBar | None:
    """Shape of the bar after a path, and where the path cuts it; None if it cuts nothing.

    Parameters
    ----------
    cut : Cut
        Cut with the programmed speed at the widest place of the bar.
    met : PathContacts
        Contacts along its path.
    run : ToolPathRun
        The path as programmed.
    stock : TurningStock
        Stock before the path.
    after : BarRadii
        Bar radii after the path.
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
    return TurnedBar(
        sections=tuple(_sections(stock.cell, after)),
        back=float(stock.z[0]) - 0.5 * stock.cell,
        low=float(z.min()),
        high=float(z.max()),
        speed_ratio=ratio,
        greatest_speed=fastest if is_clamped else inf,
    )


def _sections(cell: float, bar: BarRadii) -> Iterator[BarSection]:
    """Sections of a bar up to where nothing is left of it, mm from its first end."""
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
