"""Volumes that moves remove, against solids and closed forms."""

import itertools
from math import hypot, pi, sqrt

import manifold3d
import numpy as np
import pytest

from simulator.motion.segments import Floats, arc, lines
from simulator.removal import carve
from simulator.removal.cutter import Cutter, CutterProfile, profile_of, rise
from simulator.removal.engage import MillingStock
from simulator.removal.trial import rows_of
from stepnc_model.programs.program import Stock

BOX = Stock(low=(0.0, 0.0, -12.0), high=(40.0, 30.0, 0.0))


def tool(cutter: Cutter, sides: int) -> manifold3d.Manifold:
    """Solid of a cutter with its tip at zero, 20 mm high."""
    radius = 0.5 * cutter.diameter
    if cutter.corner_radius == 0.0:
        return manifold3d.Manifold.cylinder(20.0, radius, radius, sides)
    angle = np.linspace(-0.5 * pi, 0.0, sides // 4 + 1)
    corner, flat = cutter.corner_radius, radius - cutter.corner_radius
    arc = np.column_stack([flat + corner * np.cos(angle), corner + corner * np.sin(angle)])
    outline = np.vstack([[0.0, 0.0], arc, [radius, 20.0], [0.0, 20.0]])
    return manifold3d.CrossSection([outline]).revolve(sides)


def removed(cutter: Cutter, points: Floats, *, sides: int) -> float:
    """Volume by hulls of the tool at both ends of each move, taken from the box."""
    size = np.subtract(BOX.high, BOX.low)
    box = manifold3d.Manifold.cube(size.tolist()).translate(BOX.low)
    before = box.volume()
    body = tool(cutter, sides)
    for start, end in itertools.pairwise(points):
        swept = [body.translate(start.tolist()), body.translate(end.tolist())]
        box -= manifold3d.Manifold.batch_hull(swept)
    return float(before - box.volume())


@pytest.mark.parametrize(
    ("cutter", "sides"),
    [
        (Cutter(diameter=8.0), 256),
        (Cutter(diameter=8.0, corner_radius=4.0), 96),
        (Cutter(diameter=8.0, corner_radius=1.5), 96),
    ],
)
def test_random_moves_remove_what_solids_do(cutter: Cutter, sides: int) -> None:
    random = np.random.default_rng(14649)
    points = random.uniform((-5.0, -5.0, -6.0), (45.0, 35.0, -1.0), (8, 3))
    points[4] = points[3] + [0.0, 0.0, -3.0]
    work = MillingStock(BOX, cell=0.1)
    work.cut(lines(list(points), speed=1.0), cutter)
    assert work.volume == pytest.approx(removed(cutter, points, sides=sides), rel=2e-3)


@pytest.mark.parametrize("y", [15.0, 15.03, 15.05])
def test_slot_is_as_wide_as_the_tool(y: float) -> None:
    work = MillingStock(BOX, cell=0.1)
    work.cut(lines([(-6.0, y, -2.0), (46.0, y, -2.0)], speed=1.0), Cutter(diameter=8.0))
    assert work.volume == pytest.approx(8.0 * 40.0 * 2.0, rel=1e-4)


@pytest.mark.parametrize("turn", [2.0 * pi, -2.0 * pi])
@pytest.mark.parametrize("corner_radius", [0.0, 1.0])
def test_groove_along_a_circle_is_a_ring(turn: float, corner_radius: float) -> None:
    work = MillingStock(BOX, cell=0.1)
    circle = arc((30.0, 15.0, -2.0), (20.0, 15.0, -2.0), turn, speed=1.0)
    work.cut(circle, Cutter(diameter=6.0, corner_radius=corner_radius))
    # Pappus: the section of the tool, less its two corners, along the circle of its axis.
    section = 6.0 * 2.0 - 2.0 * (1.0 - 0.25 * pi) * corner_radius**2
    assert work.volume == pytest.approx(section * 2.0 * pi * 10.0, rel=1e-3)


def test_cutting_through_ends_at_the_bottom() -> None:
    work = MillingStock(BOX, cell=0.1)
    work.cut(lines([(20.0, 15.0, 5.0), (20.0, 15.0, -30.0)], speed=1.0), Cutter(diameter=8.0))
    assert work.volume == pytest.approx(16.0 * pi * 12.0, rel=3e-3)
    assert work.map.grid.heights.min() == -12.0
    assert work.map.volume + work.volume == pytest.approx(40.0 * 30.0 * 12.0)


def test_ball_on_a_slope_cuts_its_circle_across_the_slope() -> None:
    # Seen along the path the tool is a circle: a half circle deep, and upright walls.
    work = MillingStock(BOX, cell=0.1)
    cutter = Cutter(diameter=6.0, corner_radius=3.0)
    start, end = (-10.0, 15.0, -1.0), (50.0, 15.0, -10.0)
    work.cut(lines([start, end], speed=1.0), cutter)
    slope = 9.0 / 60.0
    x = np.linspace(0.0, 40.0, 4001)
    v = np.linspace(-3.0, 3.0, 601)
    half = np.sqrt(9.0 - v**2)
    bottom = -1.0 - slope * (x[:, None] + 10.0) + 3.0 - half * sqrt(1.0 + slope**2)
    # No lowest place lies beyond the end of the line here.
    depth = np.maximum(-bottom, 0.0)
    expected = np.trapezoid(np.trapezoid(depth, v, axis=1), x)
    assert work.volume == pytest.approx(float(expected), rel=2e-3)


def height_by_search(profile: CutterProfile, u: float, v: float, fall: float) -> float:
    """Lowest height over a cell of a line of 6 mm, by ternary search: it is convex along it."""
    low, high = 0.0, 6.0

    def height(along: float) -> float:
        away = hypot(u - along, v)
        if away > profile.radius:
            # Outside the tool, as steep as its flank would be.
            return 1e3 * (away - profile.radius) + 20.0
        return rise(profile, away) - fall * along

    for _ in range(120):
        one, other = (2.0 * low + high) / 3.0, (low + 2.0 * high) / 3.0
        if height(one) < height(other):
            high = other
        else:
            low = one
    return min(height(0.0), height(0.5 * (low + high)), height(6.0))


@pytest.mark.parametrize("corner", [0.02, 0.2, 1.0, 2.9])
@pytest.mark.parametrize("fall", [0.003, 0.05, 0.3, 0.9, 4.0])
def test_a_corner_on_a_slope_is_lowest_where_a_search_finds_it(
    corner: float, fall: float
) -> None:
    profile = profile_of(Cutter(diameter=6.0, corner_radius=corner), reach=20.0)
    random = np.random.default_rng(66)
    cells = random.uniform((-3.0, -3.0), (9.0, 3.0), (300, 2)).tolist()
    within = [(u, v) for u, v in cells if hypot(u - min(max(u, 0.0), 6.0), v) < 3.0]
    found = [carve.corner_lowest(profile, u, v, 6.0, fall) for u, v in within]
    assert found == pytest.approx(
        # Beside the flat a bisection ends within 0.1 µm along the line.
        [height_by_search(profile, u, v, fall) for u, v in within],
        abs=1e-4 * fall,
    )
    inside = [at for at, (_, v) in enumerate(within) if abs(v) < profile.flat - 0.1]
    for at in inside:
        searched = height_by_search(profile, *within[at], fall)
        assert found[at] == pytest.approx(searched, abs=2e-8)


@pytest.mark.parametrize("corner", [0.0, 0.2, 1.0])
def test_cells_under_the_flat_have_the_height_of_the_general_way(
    corner: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    cutter = Cutter(diameter=6.0, corner_radius=corner)
    ramp = lines(
        [
            (8.0, 8.0, 0.5),
            (30.0, 20.0, -1.0),
            (12.0, 21.0, -2.5),
            (25.0, 5.0, -2.5),
            (20.0, 25.0, -1.5),
        ],
        speed=1.0,
    )
    bend = arc((30.0, 15.0, -3.0), (20.0, 15.0, -3.0), -0.5 * pi, speed=1.0)
    found = []
    for under in (carve.UNDER, 0.0):
        monkeypatch.setattr(carve, "UNDER", under)
        grid = MillingStock(BOX, cell=0.5).map.grid
        volume = sum(
            carve.carve_part(grid, profile_of(cutter, reach=20.0), row, (0.0, 1.0), 0, on)[0]
            for row, on in zip(
                [*rows_of(ramp), *rows_of(bend)], (False, True, True, True, False), strict=True
            )
        )
        found.append((volume, grid.heights, grid.owner))
    assert found[0][0] == pytest.approx(found[1][0], rel=1e-12)
    assert found[0][0] > 100.0
    assert found[0][1] == pytest.approx(found[1][1], abs=1e-12)
    assert (found[0][2] == found[1][2]).all()
