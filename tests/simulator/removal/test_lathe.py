"""Stock on a lathe: volumes in closed form, identity of removal rate, one stock for all."""

from itertools import pairwise
from math import cos, pi, radians, sin, sqrt, tan

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely import affinity
from shapely.geometry import MultiPoint, Point, Polygon, box
from shapely.ops import unary_union

from simulator.errors import SimulationError
from simulator.motion.segments import Floats, Segments, lines
from simulator.removal.cutter import Cutter, Insert
from simulator.removal.lathe import TurningStock
from simulator.removal.stations import StationKind, Stations
from stepnc_model.entities.enums import HandOfToolType
from stepnc_model.programs.program import Stock

RADIUS, LENGTH = 25.0, 100.0
BAR = Stock(low=(-RADIUS, -RADIUS, 0.0), high=(RADIUS, RADIUS, LENGTH), radius=RADIUS)
ROUGHING = Insert(nose_radius=0.8, cutting_edge_angle=radians(95.0))
SHARP = Insert(cutting_edge_angle=radians(95.0))
BLADE = Insert(width=3.0)


def path(*points: tuple[float, float]) -> Segments:
    """Feed through points (x, z)."""
    return lines([(x, 0.0, z) for x, z in points], speed=1.0)


def arc(start: tuple[float, float], centre: tuple[float, float], turn: float) -> Segments:
    """One arc in plane ZX from (x, z) about (x, z)."""
    z, x = start[1] - centre[1], start[0] - centre[0]
    end_z = centre[1] + z * cos(turn) - x * sin(turn)
    end_x = centre[0] + z * sin(turn) + x * cos(turn)
    return Segments(
        start=np.array([[start[0], 0.0, start[1]]]),
        end=np.array([[end_x, 0.0, end_z]]),
        speed=np.ones(1),
        is_rapid=np.zeros(1, dtype=np.bool_),
        centre=np.array([[centre[0], 0.0, centre[1]]]),
        turn=np.array([turn]),
        normal=np.array([1]),
        block=np.array([1]),
    )


def lengths(stations: Stations) -> Floats:
    """Stretch of each station."""
    is_first = np.diff(stations.segment, prepend=-1) != 0
    before = np.where(is_first, 0.0, np.roll(stations.station, 1))
    return stations.station - before


def removed(stations: Stations) -> float:
    """Volume by the sections."""
    return float(stations.section @ lengths(stations))


def ring(outer: float, inner: float) -> float:
    return pi * (outer**2 - inner**2)


@pytest.mark.parametrize("cell", [None, 0.05, 0.0317])
def test_a_cylinder_turned_off_has_the_volume_of_the_closed_form(cell: float | None) -> None:
    bar = TurningStock(BAR, cell)
    bar.cut(path((22.5, 103.0), (22.5, -3.0)), ROUGHING)
    assert bar.volume == pytest.approx(pi * 22.5**2 * LENGTH, rel=2e-7)


def test_a_cone_has_the_volume_of_the_frustum() -> None:
    bar = TurningStock(BAR)
    bar.cut(path((10.0, LENGTH), (20.0, 0.0)), SHARP)
    frustum = pi * LENGTH / 3.0 * (10.0**2 + 10.0 * 20.0 + 20.0**2)
    assert bar.volume == pytest.approx(frustum, rel=2e-7)


@pytest.mark.parametrize("nose", [0.0, 0.4, 1.2])
def test_an_arc_around_the_end_leaves_half_a_ball(nose: float) -> None:
    bar = TurningStock(Stock(low=(-20.0, -20.0, 0.0), high=(20.0, 20.0, 40.0), radius=20.0))
    insert = Insert(nose_radius=nose, cutting_edge_angle=radians(95.0))
    around = 20.0 + nose
    bar.cut(arc((-nose, 20.0 + around - nose), (-nose, 20.0 - nose), 0.5 * pi), insert)
    ball = np.sqrt(np.maximum(0.0, 400.0 - np.maximum(0.0, bar.z - 20.0) ** 2))
    np.testing.assert_allclose(bar.outer, ball, atol=1e-7)
    volume = pi * 400.0 * 20.0 + 2.0 / 3.0 * pi * 8000.0
    assert bar.volume == pytest.approx(volume, rel=2e-7)


def test_the_nose_leaves_its_fillet_at_a_shoulder() -> None:
    bar = TurningStock(BAR)
    bar.cut(path((20.0, 103.0), (20.0, 50.0)), ROUGHING)
    beside = np.clip(50.0 + 0.8 - bar.z, 0.0, 0.8)
    fillet = 20.0 + 0.8 - np.sqrt(np.maximum(0.0, 0.64 - beside**2))
    expected = np.where(bar.z < 50.0, RADIUS, fillet)
    np.testing.assert_allclose(bar.outer, expected, atol=1e-9)


def test_an_arc_of_a_fillet_is_as_large_as_drawn() -> None:
    """Path of the nose about the fillet's centre, radius 5 mm less that of the nose."""
    bar = TurningStock(BAR)
    tip = (15.0, 50.0 + 5.0 - 0.8)
    bar.cut(path((15.0, 103.0), tip), ROUGHING)
    bar.cut(arc(tip, (15.0 + 5.0 - 0.8, 50.0 + 5.0 - 0.8), -0.5 * pi), ROUGHING)
    bar.cut(path((20.0 - 0.8, 50.0), (27.0, 50.0)), ROUGHING)
    within = (bar.z > 50.0) & (bar.z < 55.0)
    expected = 20.0 - np.sqrt(25.0 - (55.0 - bar.z[within]) ** 2)
    np.testing.assert_allclose(bar.outer[within], expected, atol=1e-7)


def test_facing_takes_a_disc_and_its_depth_is_axial() -> None:
    bar = TurningStock(BAR)
    stations = bar.cut(path((27.0, 98.0), (-1.0, 98.0)), ROUGHING)
    assert bar.volume == pytest.approx(pi * RADIUS**2 * 98.0, rel=2e-7)
    cut = stations.section > 0.0
    middle = cut & (stations.diameter > 10.0) & (stations.diameter < 40.0)
    np.testing.assert_allclose(stations.axial_depth[middle], 2.0, rtol=1e-3)
    # The minor edge leads at 95° as well.
    np.testing.assert_allclose(stations.chip_ratio[middle], 0.8125, rtol=1e-3)


def test_a_blade_takes_its_width_and_the_chip_is_as_thick_as_the_feed() -> None:
    bar = TurningStock(BAR)
    stations = bar.cut(path((26.0, 40.0), (20.0, 40.0), (26.0, 40.0)), BLADE)
    assert bar.volume == pytest.approx(pi * RADIUS**2 * LENGTH - 3.0 * ring(25.0, 20.0))
    cut = np.flatnonzero(stations.section)
    np.testing.assert_allclose(stations.axial_depth[cut], 3.0)
    np.testing.assert_allclose(stations.radial_width[cut], 3.0)
    np.testing.assert_allclose(stations.chip_ratio[cut], 1.0)
    assert (np.diff(stations.diameter[cut]) < 0.0).all()
    assert stations.diameter[cut[0]] > 49.0
    assert stations.diameter[cut[-1]] < 41.0
    groove = bar.z[bar.outer < 22.0]
    assert (groove.min(), groove.max()) == pytest.approx((40.005, 42.995))


def test_a_drill_leaves_its_cylinder_and_its_cone() -> None:
    bar = TurningStock(BAR)
    drill = Cutter(diameter=10.0, point_angle=radians(118.0), is_drill=True)
    stations = bar.cut(path((0.0, 105.0), (0.0, 60.0), (0.0, 105.0)), drill)
    point = 5.0 / tan(radians(59.0))
    hole = pi * 25.0 * (40.0 - point) + pi * 25.0 * point / 3.0
    assert bar.volume == pytest.approx(pi * RADIUS**2 * LENGTH - hole, rel=2e-7)
    assert removed(stations) == pytest.approx(hole, rel=1e-4)
    full = stations.section > 78.0
    assert (stations.kind[full] == StationKind.DRILLING).all()
    np.testing.assert_allclose(stations.section[full], 25.0 * pi, rtol=0.01)
    np.testing.assert_allclose(stations.diameter[full], 5.0, rtol=0.01)
    np.testing.assert_allclose(stations.chip_ratio[full], sin(radians(59.0)))
    assert stations.section[-1] == 0.0


def test_a_drill_opens_a_hole_and_a_boring_insert_widens_it() -> None:
    bar = TurningStock(BAR)
    bar.cut(path((0.0, 105.0), (0.0, -5.0)), Cutter(diameter=20.0, is_drill=True))
    wide = bar.cut(path((0.0, 105.0), (0.0, 50.0)), Cutter(diameter=24.0, is_drill=True))
    assert wide.axial_depth.max() == pytest.approx(2.0, rel=0.02)
    assert wide.diameter.max() == pytest.approx(22.0, rel=0.02)
    borer = Insert(nose_radius=0.4, cutting_edge_angle=radians(95.0), is_inside=True)
    stations = bar.cut(path((14.0, 102.0), (14.0, -2.0)), borer)
    assert bar.volume == pytest.approx(ring(25.0, 14.0) * LENGTH, rel=2e-7)
    assert removed(stations) == pytest.approx(
        50.0 * (ring(14.0, 10.0) + ring(14.0, 12.0)), rel=2e-7
    )


def test_what_is_turned_through_to_the_bore_is_empty() -> None:
    bar = TurningStock(BAR)
    bar.cut(path((0.0, 105.0), (0.0, -5.0)), Cutter(diameter=20.0, is_drill=True))
    stations = bar.cut(path((5.0, 103.0), (5.0, 50.0)), SHARP)
    assert bar.volume == pytest.approx(50.0 * ring(25.0, 10.0), rel=2e-7)
    assert removed(stations) == pytest.approx(50.0 * ring(25.0, 10.0), rel=2e-7)


@pytest.mark.parametrize(
    ("hand", "tip_z"),
    [
        (HandOfToolType.RIGHT, 0.0),
        (HandOfToolType.LEFT, 1.6),
        (HandOfToolType.NEUTRAL, 0.8),
    ],
)
def test_the_programmed_point_is_the_corner_that_its_hand_says(
    hand: HandOfToolType, tip_z: float
) -> None:
    """The same nose, plunged at the same place, is programmed by another corner."""
    bar = TurningStock(BAR)
    insert = Insert(nose_radius=0.8, cutting_edge_angle=0.5 * pi, hand=hand)
    bar.cut(path((26.0, 50.0 + tip_z), (24.0, 50.0 + tip_z)), insert)
    near = np.abs(bar.z - 50.8) < 0.7
    expected = 24.8 - np.sqrt(0.64 - (bar.z[near] - 50.8) ** 2)
    is_nose = bar.z[near] < 50.8 if hand is HandOfToolType.RIGHT else bar.z[near] > 50.8
    np.testing.assert_allclose(bar.outer[near][is_nose], expected[is_nose], atol=1e-9)
    assert bar.outer[near].min() == pytest.approx(24.0, abs=1e-4)


def test_the_flank_of_the_major_edge_stands_at_its_angle() -> None:
    bar = TurningStock(BAR)
    bar.cut(path((20.0, 103.0), (20.0, 50.0)), Insert(cutting_edge_angle=radians(45.0)))
    beside = (bar.z > 45.0) & (bar.z < 50.0)
    np.testing.assert_allclose(bar.outer[beside], 20.0 + 50.0 - bar.z[beside], atol=1e-9)


def test_depth_diameter_and_section_of_a_straight_cut() -> None:
    bar = TurningStock(BAR)
    stations = bar.cut(path((22.5, 103.0), (22.5, -3.0)), SHARP)
    row = int(stations.section.argmax())
    assert stations.kind[row] == StationKind.TURNING
    assert stations.axial_depth[row] == pytest.approx(2.5, rel=1e-4)
    assert stations.diameter[row] == pytest.approx(47.5, rel=1e-4)
    assert stations.section[row] == pytest.approx(ring(25.0, 22.5), rel=1e-4)
    assert stations.chip_ratio[row] == pytest.approx(sin(radians(95.0)))
    assert stations.radial_width[row] == pytest.approx(2.5 / sin(radians(95.0)), rel=1e-4)
    assert len(stations) <= 5


def test_the_diameter_falls_from_pass_to_pass_and_with_it_the_power() -> None:
    """At one spindle speed power is as section: as the mean diameter of the cut."""
    bar = TurningStock(BAR)
    sections = []
    for x in (22.5, 20.0, 17.5):
        stations = bar.cut(path((x, 102.0), (x, 20.0), (x + 9.0, 20.0)), ROUGHING)
        row = int(lengths(stations).argmax())
        sections.append(float(stations.section[row]))
        assert stations.diameter[row] == pytest.approx(2.0 * x + 2.5, rel=1e-3)
    ratios = np.array(sections) / sections[0]
    np.testing.assert_allclose(ratios, [1.0, 42.5 / 47.5, 37.5 / 47.5], rtol=1e-3)


spots = st.lists(
    st.tuples(st.floats(5.0, 30.0), st.floats(-5.0, 105.0)), min_size=2, max_size=8
)
inserts = st.sampled_from([
    ROUGHING,
    SHARP,
    BLADE,
    Insert(nose_radius=0.4, cutting_edge_angle=radians(60.0), trailing_angle=0.5),
    Insert(nose_radius=0.2, width=2.0),
    Insert(nose_radius=1.2, cutting_edge_angle=radians(93.0), hand=HandOfToolType.LEFT),
])


@settings(max_examples=25, deadline=None)
@given(points=spots, insert=inserts)
def test_section_times_length_is_the_volume_that_left_the_map(
    points: list[tuple[float, float]], insert: Insert
) -> None:
    bar = TurningStock(BAR, 0.1)
    before = bar.volume
    stations = bar.cut(path(*points), insert)
    stood = sum(collision.volume for collision in bar.collisions)
    taken = before - bar.volume - stood
    assert removed(stations) == pytest.approx(taken, rel=1e-9, abs=1e-6)
    np.testing.assert_allclose(
        stations.section, pi * stations.diameter * stations.axial_depth, atol=1e-9
    )


@settings(max_examples=25, deadline=None)
@given(points=spots, insert=inserts, parts=st.integers(2, 9))
def test_the_same_path_cut_finer_removes_the_same(
    points: list[tuple[float, float]], insert: Insert, parts: int
) -> None:
    whole, split = TurningStock(BAR, 0.1), TurningStock(BAR, 0.1)
    whole.cut(path(*points), insert)
    fine = [points[0]]
    for (x, z), (end_x, end_z) in pairwise(points):
        shares = np.linspace(0.0, 1.0, parts + 1)[1:]
        fine += [(x + s * (end_x - x), z + s * (end_z - z)) for s in shares.tolist()]
    split.cut(path(*fine), insert)
    np.testing.assert_allclose(whole.outer, split.outer, atol=1e-8)


def test_the_same_path_cut_finer_meets_the_same() -> None:
    whole, split = TurningStock(BAR), TurningStock(BAR)
    one = whole.cut(path((22.0, 103.0), (22.0, 20.0)), ROUGHING)
    corners = [(22.0, z) for z in np.linspace(103.0, 20.0, 1001).tolist()]
    many = split.cut(path(*corners), ROUGHING)
    assert one.section.max() == pytest.approx(ring(25.0, 22.0), rel=1e-3)
    # Chords of 0.083 mm are spread over windows of 50 cells, in which one cell is 2 %.
    inside = (many.segment > 60) & (many.segment < 990)
    np.testing.assert_allclose(many.section[inside], ring(25.0, 22.0), rtol=0.021)
    assert removed(many) == pytest.approx(removed(one), rel=1e-9)


def test_what_was_cut_stays_cut() -> None:
    bar = TurningStock(BAR)
    passes = path((22.0, 103.0), (22.0, 20.0), (30.0, 20.0))
    assert bar.cut(passes, ROUGHING).section.max() > 0.0
    again = bar.cut(passes, ROUGHING)
    assert (again.kind == StationKind.AIR).all()
    assert again.segment.tolist() == [0, 1]
    np.testing.assert_allclose(again.station, passes.length)


def test_a_rapid_through_material_is_told() -> None:
    bar = TurningStock(BAR)
    bar.cut(lines([(30.0, 0.0, 50.0), (20.0, 0.0, 50.0)]), BLADE)
    (contact,) = bar.collisions
    assert contact.block == 0
    assert contact.position == (20.0, 0.0, 50.0)
    assert contact.volume == pytest.approx(3.0 * ring(25.0, 20.0))


def test_a_tool_that_stands_in_the_bar_is_told_and_is_no_cut() -> None:
    bar = TurningStock(BAR)
    stations = bar.cut(path((20.0, 50.0), (26.0, 50.0)), BLADE)
    assert (stations.kind == StationKind.AIR).all()
    (contact,) = bar.collisions
    assert contact.position == (20.0, 0.0, 50.0)
    assert contact.volume == pytest.approx(3.0 * ring(25.0, 20.0))


def _outline(insert: Insert) -> Polygon:
    """Region of an insert about its programmed point in (z, x), with edges 200 mm long."""
    x, z = insert.centre
    nose = max(insert.nose_radius, 1e-7)
    corners = [Point(z, x).buffer(nose, 256), Point(z + insert.flat, x).buffer(nose, 256)]
    back, front = insert.edge_angles
    far = [
        affinity.translate(corners[0], 200.0 * cos(max(back, 0.5 * pi)), 200.0),
        affinity.translate(corners[0], -200.0 * cos(back), 200.0 * sin(back)),
        affinity.translate(corners[1], 200.0 * cos(front), 200.0 * sin(front)),
    ]
    spots = [spot for shape in [*corners, *far[1:]] for spot in shape.exterior.coords]
    return MultiPoint(spots).convex_hull


@settings(max_examples=15, deadline=None)
@given(points=spots)
def test_volume_as_of_polygons_swept_in_the_half_plane(
    points: list[tuple[float, float]],
) -> None:
    """Pappus: area of what is left times the way of its centroid."""
    insert = Insert(nose_radius=0.8, cutting_edge_angle=radians(75.0), trailing_angle=0.3)
    bar = TurningStock(BAR, 0.02)
    bar.cut(path(*points), insert)
    shape = _outline(insert)
    placed = [affinity.translate(shape, z, x) for x, z in points]
    swept = [a.union(b).convex_hull for a, b in pairwise(placed)]
    left = box(0.0, 0.0, LENGTH, RADIUS).difference(unary_union(swept))
    expected = 2.0 * pi * left.centroid.y * left.area if left.area else 0.0
    # Upright walls are right to half a cell, chords of the nose to 1e-5 of it.
    assert bar.volume == pytest.approx(expected, abs=0.02 * 2.0 * pi * RADIUS**2)


def test_a_box_is_the_cylinder_around_it() -> None:
    bar = TurningStock(Stock(low=(-3.0, -4.0, 0.0), high=(3.0, 4.0, 10.0)))
    assert bar.outer.max() == 5.0


def test_cells_are_bounded() -> None:
    assert len(TurningStock(BAR).outer) == 10_000
    with pytest.raises(ValueError, match=r"cell 1e-06 mm must be at least 0.0001 mm"):
        TurningStock(BAR, 1e-6)
    with pytest.raises(ValueError, match="length of the bar 0 mm"):
        TurningStock(Stock(low=(0.0, 0.0, 1.0), high=(1.0, 1.0, 1.0)))


def test_no_hole_beside_the_axis_and_no_arc_beside_the_plane() -> None:
    bar = TurningStock(BAR)
    with pytest.raises(SimulationError, match=r"block 0: .* beside its axis, at x = 10 mm"):
        bar.cut(path((10.0, 105.0), (10.0, 90.0)), Cutter(diameter=5.0, is_drill=True))
    bar.cut(path((27.0, 95.0), (-1.0, 95.0)), SHARP)
    beside_the_face = path((30.0, 96.0), (0.0, 96.0), (0.0, 90.0))
    assert bar.cut(beside_the_face, Cutter(diameter=5.0, is_drill=True)).section.max() > 19.0
    bent = arc((30.0, 50.0), (20.0, 50.0), 0.1)
    flat = Segments(**{**_columns(bent), "normal": np.array([2])})
    with pytest.raises(SimulationError, match="block 1: an arc of a turning tool"):
        bar.cut(flat, ROUGHING)


def _columns(segments: Segments) -> dict[str, Floats]:
    names = ("start", "end", "speed", "is_rapid", "centre", "turn", "normal", "block")
    return {name: getattr(segments, name) for name in names}


def test_nothing_programmed_cuts_nothing() -> None:
    bar = TurningStock(BAR)
    assert len(bar.cut(path((30.0, 10.0)), ROUGHING)) == 0
    assert bar.volume == pytest.approx(pi * RADIUS**2 * LENGTH)
    assert sqrt(bar.volume / pi / LENGTH) == pytest.approx(RADIUS)
