"""Milling and drilling of a stock: what is removed, and what the tool meets."""

from math import acos, asin, degrees, pi, sin, sqrt, tan

import numpy as np
import pytest

from simulator.motion.segments import Floats, Segments, lines
from simulator.physics.edge import effective_edge_angle
from simulator.removal.cutter import Cutter, Holder
from simulator.removal.engage import MillingStock
from simulator.removal.stations import StationKind, Stations
from stepnc_model.programs.program import Stock
from tests.oracles.cutting import effective_diameter

BOX = Stock(low=(0.0, 0.0, -20.0), high=(60.0, 40.0, 0.0))
FLAT = Cutter(diameter=10.0)
BALL = Cutter(diameter=10.0, corner_radius=5.0)
BULL = Cutter(diameter=10.0, corner_radius=2.0)


def stock(cell: float = 0.1) -> MillingStock:
    return MillingStock(BOX, cell=cell)


def feed(*points: tuple[float, float, float]) -> Segments:
    return lines(list(points), speed=10.0)


def stretches(stations: Stations) -> Floats:
    is_first = np.diff(stations.segment, prepend=-1) != 0
    return stations.station - np.where(is_first, 0.0, np.roll(stations.station, 1))


def volume(stations: Stations) -> float:
    return float((stations.section * stretches(stations)).sum())


def turned(
    start: tuple[float, float, float],
    centre: tuple[float, float],
    turn: float,
    end: tuple[float, float, float],
    normal: int = 2,
) -> Segments:
    """One arc in XY, or with a normal of its own."""
    middle = np.array([[centre[0], centre[1], 0.0]])
    return Segments(
        start=np.array([start]),
        end=np.array([end]),
        speed=np.array([10.0]),
        is_rapid=np.array([False]),
        centre=middle,
        turn=np.array([turn]),
        normal=np.array([normal]),
        block=np.array([7]),
    )


def test_full_slot_has_half_a_turn_of_contact() -> None:
    work = stock()
    found = work.cut(feed((-6.0, 20.0, -2.0), (66.0, 20.0, -2.0)), FLAT)
    inside = (found.station > 12.0) & (found.station < 60.0)
    assert np.degrees(found.contact_angle[inside]) == pytest.approx(180.0, abs=1e-3)
    assert found.axial_depth[inside] == pytest.approx(2.0)
    assert found.radial_width[inside] == pytest.approx(10.0, rel=1e-9)
    assert found.chip_ratio[inside] == pytest.approx(2.0 / pi)
    assert work.volume == pytest.approx(10.0 * 60.0 * 2.0, rel=1e-4)
    assert volume(found) == pytest.approx(work.volume, rel=5e-4)
    assert found.kind[0] == StationKind.AIR
    assert found.kind[-1] == StationKind.AIR


@pytest.mark.parametrize(("y", "entry", "leave"), [(0.0, 0.0, 90.0), (40.0, 90.0, 180.0)])
def test_half_immersion_is_conventional_on_the_left_and_climb_on_the_right(
    y: float, entry: float, leave: float
) -> None:
    found = stock().cut(feed((10.0, y, -2.0), (50.0, y, -2.0)), FLAT)
    assert np.degrees(found.entry_angle) == pytest.approx(entry, abs=1e-3)
    assert np.degrees(found.exit_angle) == pytest.approx(leave, abs=1e-3)
    mirrored = stock().cut(feed((10.0, y, -2.0), (50.0, y, -2.0)), FLAT, is_clockwise=False)
    assert np.degrees(mirrored.entry_angle) == pytest.approx(180.0 - leave, abs=1e-3)
    assert found.radial_width == pytest.approx(5.0)


@pytest.mark.parametrize("width", [0.03, 0.25, 1.0, 3.3])
def test_narrow_cut_is_known_better_than_a_cell(width: float) -> None:
    work = stock()
    found = work.cut(feed((10.0, width - 5.0, -3.0), (50.0, width - 5.0, -3.0)), FLAT)
    assert found.contact_angle == pytest.approx(acos(1.0 - width / 5.0), abs=1e-6)
    assert found.radial_width == pytest.approx(width, rel=1e-6)


def test_peak_in_a_corner_of_a_pocket() -> None:
    # 142.41° where the ring before lies 0.39 radii inside: π − asin(1 − a/R).
    work, step = stock(), 0.39 * 5.0
    inner, outer = 15.0, 15.0 - step
    for low in (inner, outer):
        ring = [
            (low, low),
            (45.0 - low + 0.0, low),
            (45.0 - low, 40.0 - low),
            (low, 40.0 - low),
        ]
        ring = [(x + (7.5 if x > 20.0 else 0.0), y) for x, y in ring]
        found = work.cut(feed(*[(x, y, -1.0) for x, y in [*ring, ring[0]]]), FLAT)
    expected = degrees(pi - asin(1.0 - 0.39))
    assert expected == pytest.approx(142.41, abs=0.005)
    corner = found.station[found.segment == 0].size - 1
    assert degrees(found.contact_angle[corner]) == pytest.approx(expected, abs=1e-3)


@pytest.mark.parametrize("cell", [0.1, 0.25, 0.4])
def test_the_peak_of_a_corner_is_that_of_its_end_whatever_the_cells(cell: float) -> None:
    """0.3 mm head-on into a wall: a chord of ``2√(2Re − e²)``, however the stations fall.

    The volume of so short an entry is that of one or two stretches, as of trapezia.
    """
    chord = 2.0 * sqrt(2.0 * 5.0 * 0.3 - 0.3**2)
    found = stock(cell).cut(feed((-8.0, 20.0, -2.0), (-4.7, 20.0, -2.0)), FLAT)
    assert found.peak_section.max() == pytest.approx(2.0 * chord, rel=1e-3)
    assert volume(found) == pytest.approx(2.0 * segment_area(5.0, 0.3), rel=0.1)


@pytest.mark.parametrize("cell", [0.1, 0.3])
def test_a_ring_thinner_than_a_cell_is_told_by_the_hole_before(cell: float) -> None:
    work = stock(cell)
    down = feed((30.0, 20.0, 3.0), (30.0, 20.0, -15.0))
    work.cut(down, Cutter(diameter=9.8, point_angle=2.44, is_drill=True))
    found = work.cut(
        feed((30.0, 20.0, 3.0), (30.0, 20.0, -10.0)), Cutter(diameter=10.0, is_drill=True)
    )
    ring = 0.25 * pi * (10.0**2 - 9.8**2)
    # The first stretch begins above the stock.
    assert found.section[found.section > 0.0][1:] == pytest.approx(ring, rel=1e-9)


def test_second_pass_is_air() -> None:
    work = stock()
    path = feed((-6.0, 20.0, -2.0), (30.0, 20.0, -2.0), (40.0, 30.0, -4.0))
    for cutter in (FLAT, BALL, BULL):
        work.cut(path, cutter)
        before = work.volume
        found = work.cut(path, cutter)
        assert set(found.kind) == {StationKind.AIR}
        assert found.segment.tolist() == [0, 1]
        assert work.volume == before


@pytest.mark.parametrize("cutter", [FLAT, BALL, BULL])
def test_finer_path_meets_the_same(cutter: Cutter) -> None:
    corners = np.array([(5.0, 8.0, -2.0), (50.0, 12.0, -2.0), (45.0, 30.0, -2.0)])
    share = np.linspace(0.0, 1.0, 41)[:, None]
    fine = np.concatenate([
        corners[0] + share * (corners[1] - corners[0]),
        corners[1] + share[1:] * (corners[2] - corners[1]),
    ])
    coarse_stock, fine_stock = stock(), stock()
    coarse = coarse_stock.cut(lines(list(corners), speed=10.0), cutter)
    split = fine_stock.cut(lines(list(fine), speed=10.0), cutter)
    assert fine_stock.volume == pytest.approx(coarse_stock.volume, rel=1e-6)
    assert volume(split) == pytest.approx(volume(coarse), rel=2e-3)
    for name in ("contact_angle", "chip_ratio", "axial_depth"):
        means = [
            float((getattr(each, name) * stretches(each)).sum()) for each in (coarse, split)
        ]
        assert means[1] == pytest.approx(means[0], rel=0.02)


def test_section_holds_the_volume_of_the_map() -> None:
    path = feed((-6.0, 5.0, -2.0), (66.0, 9.0, -4.0), (66.0, 14.0, -4.0), (-6.0, 17.0, -1.0))
    for cutter in (FLAT, BALL, BULL, Cutter(diameter=6.0, taper_angle=0.1)):
        work = stock(0.2)
        found = work.cut(path, cutter)
        # Sloping moves take the map's volume; the level one, exact arcs.
        assert volume(found) == pytest.approx(work.volume, rel=1e-3)
    area = found.section - found.axial_depth * found.radial_width
    assert np.abs(area).max() < 1e-9


def segment_area(radius: float, depth: float) -> float:
    return radius**2 * acos(1.0 - depth / radius) - (radius - depth) * sqrt(
        2.0 * radius * depth - depth**2
    )


@pytest.mark.parametrize(
    ("cutter", "area"),
    [
        (BALL, segment_area(5.0, 3.0)),
        (BULL, 10.0 * 3.0 - 2.0 * (4.0 - pi)),
        (Cutter(diameter=4.0, taper_angle=0.2), 3.0 * (4.0 + 3.0 * tan(0.2))),
        (Cutter(diameter=12.0, point_angle=pi / 2.0), 9.0),
    ],
)
def test_slot_has_the_section_of_the_tool(cutter: Cutter, area: float) -> None:
    found = stock().cut(feed((-8.0, 20.0, -3.0), (50.0, 20.0, -3.0)), cutter)
    inside = (found.station > 18.0) & (found.station < 52.0)
    assert found.section[inside] == pytest.approx(area, rel=0.01)
    assert np.degrees(found.contact_angle[inside]) == pytest.approx(180.0, abs=0.01)
    assert found.axial_depth[inside] == pytest.approx(3.0)


@pytest.mark.parametrize("cutter", [BALL, BULL])
def test_rounded_tools_have_their_effective_diameter_and_edge_angle(cutter: Cutter) -> None:
    found = stock().cut(feed((10.0, 20.0, -1.0), (50.0, 20.0, -1.0)), cutter)
    inside = (found.station > 10.0) & (found.station < 34.0)
    radius = cutter.corner_radius
    assert found.diameter[inside] == pytest.approx(effective_diameter(10.0, 1.0, radius=radius))
    angle = effective_edge_angle(radius, 1.0)
    assert found.chip_ratio[inside] == pytest.approx(sin(angle) * 2.0 / pi, rel=0.01)


def test_a_skin_is_met_over_its_own_thickness() -> None:
    """The floor that roughing left, and a plate that a tool goes through: full sections."""
    work, mill = stock(), Cutter(diameter=10.0)
    deep = feed((20.0, 20.0, 5.0), (20.0, 20.0, -4.0))
    work.cut(deep, mill)
    skin = work.cut(feed((20.0, 20.0, 5.0), (20.0, 20.0, -4.2)), mill)
    (row,) = np.flatnonzero(skin.kind == StationKind.DRILLING)
    assert skin.section[row] == pytest.approx(25.0 * pi, rel=5e-3)
    assert skin.station[row] - skin.station[row - 1] == pytest.approx(0.2)
    assert skin.station[row] == pytest.approx(9.2)


def test_plunge_and_drill() -> None:
    work = stock()
    drill = Cutter(diameter=8.0, point_angle=2.0 * pi / 3.0, is_drill=True)
    tip = 4.0 / tan(pi / 3.0)
    found = work.cut(feed((20.0, 20.0, 5.0), (20.0, 20.0, -10.0)), drill)
    assert work.volume == pytest.approx(16.0 * pi * (10.0 - tip * 2.0 / 3.0), rel=3e-3)
    assert volume(found) == pytest.approx(work.volume, rel=1e-9)
    deep = found.station > 5.0 + tip + 1.0
    assert set(found.kind[deep]) == {StationKind.DRILLING}
    assert found.section[deep] == pytest.approx(16.0 * pi, rel=5e-3)
    assert found.chip_ratio[deep] == pytest.approx(sin(pi / 3.0))
    assert found.diameter[deep] == pytest.approx(4.0)
    wider = work.cut(feed((20.0, 20.0, 5.0), (20.0, 20.0, -5.0)), Cutter(diameter=16.0))
    middle = (wider.station > 6.0) & (wider.station < 9.0)
    assert wider.section[middle] == pytest.approx(48.0 * pi, rel=5e-3)
    assert wider.diameter[middle] == pytest.approx(12.0, abs=0.6)


def test_helix_of_a_flat_tool_clears_its_bore() -> None:
    work = stock()
    path = turned((24.0, 20.0, 0.0), (20.0, 20.0), 4.0 * pi, (24.0, 20.0, -4.0))
    found = work.cut(path, FLAT)
    work.cut(turned((24.0, 20.0, -4.0), (20.0, 20.0), 2.0 * pi, (24.0, 20.0, -4.0)), FLAT)
    assert work.volume == pytest.approx(81.0 * pi * 4.0, rel=5e-3)
    assert set(found.kind) <= {StationKind.MILLING, StationKind.AIR}


def test_level_circle_meets_its_own_beginning() -> None:
    work = stock()
    path = turned((24.0, 20.0, -2.0), (20.0, 20.0), 2.0 * pi, (24.0, 20.0, -2.0))
    found = work.cut(path, FLAT)
    assert volume(found) == pytest.approx(work.volume - 25.0 * pi * 2.0, rel=0.02)
    assert found.contact_angle[-1] < 0.2


def test_arc_out_of_plane_agrees_with_its_chords() -> None:
    arc = Segments(
        start=np.array([[10.0, 20.0, -1.0]]),
        end=np.array([[50.0, 20.0, -1.0]]),
        speed=np.array([10.0]),
        is_rapid=np.array([False]),
        centre=np.array([[30.0, 0.0, 49.0]]),
        turn=np.array([-2.0 * asin(20.0 / sqrt(400.0 + 2500.0))]),
        normal=np.array([1]),
        block=np.array([0]),
    )
    share = np.linspace(0.0, 1.0, 200)
    points = arc.position(np.zeros(200, dtype=np.int64), share * arc.length[0])
    bent, chords = stock(), stock()
    bent.cut(arc, BALL)
    chords.cut(lines(list(points), speed=10.0), BALL)
    assert bent.volume == pytest.approx(chords.volume, rel=3e-4)
    assert points[:, 2].min() < -4.0


def test_two_depths_and_an_island() -> None:
    work = stock()
    work.cut(feed((-6.0, 10.0, -3.0), (66.0, 10.0, -3.0)), FLAT)
    found = work.cut(feed((-6.0, 15.0, -5.0), (66.0, 15.0, -5.0)), FLAT)
    inside = (found.station > 12.0) & (found.station < 60.0)
    # 10 mm wide below, and above only the half that the first slot left.
    assert found.section[inside] == pytest.approx(10.0 * 2.0 + 5.0 * 3.0, rel=1e-6)
    assert found.contact_angle[inside] == pytest.approx(pi, abs=1e-4)
    assert found.chip_ratio[inside] == pytest.approx((2.0 * 2.0 + 3.0) / (pi * (2.0 + 1.5)))


def test_bar_is_round() -> None:
    bar = Stock(low=(-20.0, -20.0, 0.0), high=(20.0, 20.0, 10.0), radius=20.0)
    work = MillingStock(bar, cell=0.1)
    found = work.cut(feed((-30.0, 0.0, 8.0), (30.0, 0.0, 8.0)), FLAT)
    chord = 2.0 * (10.0 * sqrt(375.0) / 2.0 + 400.0 * asin(0.25))
    assert work.volume == pytest.approx(2.0 * chord, rel=2e-3)
    assert volume(found) == pytest.approx(work.volume, rel=3e-3)


def test_rapid_move_into_the_stock_is_told() -> None:
    work = stock()
    path = lines([(-10.0, 20.0, 5.0), (20.0, 20.0, 5.0), (20.0, 20.0, -1.0)])
    work.cut(path, FLAT)
    (collision,) = work.collisions
    assert (collision.segment, collision.block) == (1, 1)
    assert collision.volume == pytest.approx(25.0 * pi, rel=0.01)
    assert collision.depth == pytest.approx(1.0)
    assert collision.position[2] == pytest.approx(-1.0)


def test_holder_and_shank_are_watched() -> None:
    cutter = Cutter(diameter=10.0, edge_length=8.0, holder=Holder(diameter=30.0, overhang=10.0))
    work = stock()
    work.cut(feed((10.0, 20.0, -5.0), (50.0, 20.0, -5.0)), cutter)
    assert not work.holder_collisions
    assert not work.shank_collisions
    work.cut(feed((10.0, 20.0, -12.0), (50.0, 20.0, -12.0)), cutter)
    assert work.holder_collisions[0].depth == pytest.approx(2.0)
    assert not work.shank_collisions
    work.cut(feed((10.0, 32.0, -10.0), (50.0, 32.0, -10.0)), cutter)
    assert work.shank_collisions[0].depth == pytest.approx(2.0)


def test_memory_does_not_grow() -> None:
    work = stock(0.5)
    sizes = []
    for _ in range(2):
        sizes.append(work.map.grid.heights.nbytes + work._past.records.nbytes)
        angle = np.linspace(0.0, 40.0, 3000)
        points = np.column_stack([
            30.0 + 0.4 * angle * np.cos(angle),
            20.0 + 0.4 * angle * np.sin(angle),
            np.full(3000, -2.0),
        ])
        work.cut(lines(list(points), speed=1.0), FLAT)
    assert sizes[0] == sizes[1]


def test_impossible_stock_is_refused() -> None:
    with pytest.raises(ValueError, match="no volume"):
        MillingStock(Stock(low=(0.0, 0.0, 0.0), high=(1.0, 0.0, 1.0)), cell=0.1)
    with pytest.raises(ValueError, match="cell"):
        MillingStock(BOX, cell=0.0)


def test_no_moves_give_no_stations() -> None:
    assert len(stock(1.0).cut(lines([(0.0, 0.0, 0.0)]), FLAT)) == 0


def test_long_helix_fits_and_an_endless_one_is_refused() -> None:
    work = stock(0.5)
    path = turned((24.0, 20.0, 0.0), (20.0, 20.0), 180.0 * pi, (24.0, 20.0, -9.0))
    assert len(work.cut(path, FLAT)) < 20_000
    assert work.volume > 81.0 * pi * 8.5
    with pytest.raises(ValueError, match="turns"):
        work.cut(turned((24.0, 20.0, 0.0), (20.0, 20.0), 999.0, (24.0, 20.0, 0.0)), FLAT)
