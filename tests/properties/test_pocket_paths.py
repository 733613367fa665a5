"""Random pockets with islands: everything that the cutter can reach is swept, and no more.

The judge is not the offset under test: points are sampled, and distances from the walls and
from the passes are taken by shapely between finely divided polygons.
"""

from cmath import rect
from math import pi

import numpy as np
import pytest
import shapely
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from shapely import LineString, Polygon

from stepnc_model.toolpath.milling.contour import (
    Loop,
    circle,
    clockwise,
    polygon,
    shape,
    vertices,
)
from stepnc_model.toolpath.milling.cover import MillingPass, area_of, rings, swept
from stepnc_model.toolpath.milling.offset import erode, rounded
from stepnc_model.toolpath.milling.strokes import scan, zigzags

FINE = 1e-4
"""mm, chord tolerance of the judge"""

CLOSE = 1e-3
"""mm"""

SAMPLES = 600
"""points looked at in each pocket"""


@st.composite
def outlines(draw: st.DrawFn) -> Loop:
    """A star-shaped polygon, its inner corners perhaps rounded."""
    count = draw(st.integers(3, 9))
    radii = draw(st.lists(st.floats(20.0, 60.0), min_size=count, max_size=count))
    shift = draw(st.floats(0.0, 1.0))
    corners = [rect(r, 2.0 * pi * (k + shift) / count) for k, r in enumerate(radii)]
    outline = polygon(corners)
    radius = draw(st.sampled_from([0.0, 2.0, 5.0]))
    if radius:
        loops = rounded(outline, radius)
        assume(len(loops) == 1)
        return loops[0]
    return outline


@st.composite
def pockets(draw: st.DrawFn) -> list[Loop]:
    """An outline with up to three islands well inside it."""
    outline = draw(outlines())
    area = shape(outline, tolerance=FINE)
    walls = [outline]
    for _ in range(draw(st.integers(0, 3))):
        at = rect(draw(st.floats(0.0, 40.0)), draw(st.floats(0.0, 6.28)))
        size = draw(st.floats(1.0, 8.0))
        sides = draw(st.sampled_from([0, 3, 4, 6]))
        island = (
            circle(at, size)
            if sides == 0
            else polygon([at + rect(size, 2.0 * pi * k / sides) for k in range(sides)])
        )
        solid = shape(island, tolerance=FINE)
        free = area.exterior.distance(solid) > 0.5 and area.covers(solid)
        apart = all(shape(other, tolerance=FINE).disjoint(solid) for other in walls[1:])
        if free and apart:
            walls.append(clockwise(island))
    return walls


def lines(passes: tuple[MillingPass, ...]) -> shapely.MultiLineString:
    found = []
    for each in passes:
        points = [*vertices(each.chain, tolerance=FINE), each.chain[-1].end]
        found.append(LineString([(p.real, p.imag) for p in points]))
    return shapely.MultiLineString(found)


def solid_of(walls: list[Loop]) -> Polygon:
    holes = [shape(wall, tolerance=FINE).exterior.coords for wall in walls[1:]]
    return Polygon(shape(walls[0], tolerance=FINE).exterior.coords, holes)


def check_swept(walls: list[Loop], passes: tuple[MillingPass, ...], radius: float) -> None:
    """Every centre that keeps clear of the walls is covered to its rim; no pass gouges."""
    area = solid_of(walls)
    trace = lines(passes)
    vertices_of = shapely.points(shapely.get_coordinates(trace))
    walls_of = area.boundary
    shapely.prepare([area, trace, walls_of])
    assert not shapely.dwithin(vertices_of, walls_of, radius - CLOSE).any()
    assert shapely.covers(area, vertices_of).all()
    rng = np.random.default_rng(1)
    x0, y0, x1, y1 = area.bounds
    centres = shapely.points(rng.uniform((x0, y0), (x1, y1), (SAMPLES, 2)))
    keeps = shapely.contains(area, centres)
    keeps &= ~shapely.dwithin(centres, walls_of, radius + CLOSE)
    angles = rng.uniform(0.0, 2.0 * pi, keeps.sum())
    reach = radius * np.sqrt(rng.uniform(0.0, 1.0, keeps.sum()))
    at = shapely.get_coordinates(centres[keeps])
    at += np.stack([reach * np.cos(angles), reach * np.sin(angles)], axis=1)
    assert shapely.dwithin(shapely.points(at), trace, radius + CLOSE).all()


def check_arcs(passes: tuple[MillingPass, ...]) -> None:
    """At least nine tenths of the length along which a pass bends is made of arcs."""
    curved = in_arcs = 0.0
    for each in passes:
        edges = list(each.chain)
        for before, edge, after in zip(
            [edges[-1], *edges[:-1]], edges, [*edges[1:], edges[0]], strict=True
        ):
            bends = [
                abs(np.angle(edge.along(0.0) / before.along(1.0))),
                abs(np.angle(after.along(0.0) / edge.along(1.0))),
            ]
            is_chord = edge.length < 2.0 and all(1e-6 < bend < 0.35 for bend in bends)
            if edge.centre is not None:
                in_arcs += edge.length
            if edge.centre is not None or is_chord:
                curved += edge.length
    assert in_arcs >= 0.9 * curved


@given(walls=pockets(), diameter=st.floats(2.0, 20.0), overlap=st.floats(0.05, 0.95))
@settings(max_examples=300, deadline=None)
def test_rings_sweep_all_that_the_cutter_can_reach_and_stay_arcs(
    walls: list[Loop], diameter: float, overlap: float
) -> None:
    radius = 0.5 * diameter
    step = max(diameter * (1.0 - overlap), 0.5)
    passes = rings(walls, distance=radius, radius=radius, step=step)
    assume(passes)
    check_swept(walls, passes, radius)
    check_arcs(passes)
    # Slivers that points miss: what the outermost passes enclose, less what is swept.
    left = area_of(erode(walls, radius)).difference(swept(passes, radius))
    assert left.buffer(-0.005).is_empty


@given(
    walls=pockets(),
    diameter=st.floats(2.0, 20.0),
    overlap=st.floats(0.05, 0.95),
    angle=st.floats(0.0, 2.0 * pi),
)
@settings(max_examples=100, deadline=None)
def test_strokes_with_a_pass_along_the_wall_sweep_it_too(
    walls: list[Loop], diameter: float, overlap: float, angle: float
) -> None:
    radius = 0.5 * diameter
    step = max(diameter * (1.0 - overlap), 0.5)
    loops = erode(walls, radius)
    assume(loops)
    strokes = zigzags(scan(loops, along=rect(1.0, angle), step=step), loops)
    walled = tuple(MillingPass(loop, is_closed=True) for loop in loops)
    check_swept(walls, (*strokes, *walled), radius)


def test_rows_of_strokes_are_no_further_apart_than_the_step() -> None:
    loops = erode([polygon([0j, 50 + 0j, 50 + 30j, 30j])], 5.0)
    rows = scan(loops, along=1 + 0j, step=7.0)
    heights = [row[0].low.imag for row in rows]
    assert heights[0] == pytest.approx(5.0, abs=1e-5)
    assert heights[-1] == pytest.approx(25.0, abs=1e-5)
    assert max(np.diff(heights)) <= 7.0
