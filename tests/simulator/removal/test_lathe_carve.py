"""The least height of an insert's sweep against many of its positions, one by one."""

from math import hypot, inf, pi, sin, tan

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from simulator.motion.segments import Floats
from simulator.removal.lathe_carve import BLOCK, AxialGrid, InsertOutline, bore, carve

CELLS = 300
GRID = AxialGrid(0.0, 0.1)
Z = (np.arange(CELLS) + 0.5) * 0.1
TOP = 20.0


def body(nose: float, flat: float, back: float, front: float) -> InsertOutline:
    """Insert with edges at angles from the axis; π/2: upright."""
    slopes = [inf if angle >= 0.5 * pi else tan(angle) for angle in (back, front)]
    feet = [nose * sin(angle) for angle in (back, front)]
    return InsertOutline(nose, flat, slopes[0], feet[0], slopes[1], feet[1])


def curve(shape: InsertOutline, t: Floats) -> Floats:
    """The insert as the highest of its tangents' half planes and its arcs, apart from ours."""
    height = np.full(t.shape, inf)
    beside = np.where(t < 0.0, t, np.maximum(t - shape.flat, 0.0))
    nose = np.abs(beside) <= shape.nose
    height[nose] = -np.sqrt(np.maximum(0.0, shape.nose**2 - beside[nose] ** 2))
    for slope, where in ((shape.back_slope, -t), (shape.front_slope, t - shape.flat)):
        if slope < inf:
            # Tangent of a circle: y = slope · t − nose · √(1 + slope²).
            touch = shape.nose * slope / hypot(1.0, slope)
            edge = slope * where - shape.nose * hypot(1.0, slope)
            height = np.where(where > touch, edge, height)
    return height


def least(shape: InsertOutline, z: Floats, x: Floats) -> Floats:
    """Least height over the cells of many positions of the nose."""
    reached = np.full(CELLS, inf)
    for one_z, one_x in zip(z.tolist(), x.tolist(), strict=True):
        reached = np.minimum(reached, one_x + curve(shape, Z - one_z))
    return np.asarray(np.clip(reached, 0.0, TOP))


def carved(shape: InsertOutline, way: list[float]) -> tuple[Floats, float, float]:
    """Surface after one way, area and volume."""
    surface = np.full(CELLS, TOP)
    areas, volumes = carve(surface, np.zeros(CELLS), GRID, shape, np.array([way]))
    return surface, float(areas[0]), float(volumes[0])


bodies = st.builds(
    body,
    nose=st.sampled_from([0.0, 0.4, 1.2]),
    flat=st.sampled_from([0.0, 3.0]),
    back=st.floats(0.2, 0.5 * pi),
    front=st.floats(0.02, 0.5 * pi),
)
places = st.tuples(st.floats(-5.0, 35.0), st.floats(-1.0, 22.0))
SAMPLES = np.linspace(0.0, 1.0, 2001)


@settings(max_examples=40, deadline=None)
@given(shape=bodies, start=places, end=places)
def test_a_line_reaches_as_low_as_the_lowest_of_its_positions(
    shape: InsertOutline, start: tuple[float, float], end: tuple[float, float]
) -> None:
    run, rise = end[0] - start[0], end[1] - start[1]
    # Steep ways need finer samples than these beside an upright edge.
    assume(abs(rise) < 3.0 * abs(run) or abs(run) < 1e-9)
    surface, area, volume = carved(shape, [*start, *end, 0.0, 0.0, 0.0, 0.0, 0.0])
    sampled = least(shape, start[0] + SAMPLES * run, start[1] + SAMPLES * rise)
    assert (surface <= sampled + 1e-6).all()
    np.testing.assert_allclose(surface, sampled, atol=0.08)
    assert area == pytest.approx(0.1 * (TOP - surface).sum(), abs=1e-6)
    assert volume == pytest.approx(0.1 * pi * (TOP**2 - surface**2).sum(), abs=1e-4)


@settings(max_examples=40, deadline=None)
@given(
    shape=bodies,
    centre=places,
    radius=st.floats(0.3, 8.0),
    begin=st.floats(-pi, pi),
    turn=st.floats(-6.0, 6.0),
)
def test_an_arc_reaches_as_low_as_the_lowest_of_its_positions(
    shape: InsertOutline, centre: tuple[float, float], radius: float, begin: float, turn: float
) -> None:
    z = centre[0] + radius * np.cos(begin + SAMPLES * turn)
    x = centre[1] + radius * np.sin(begin + SAMPLES * turn)
    way = [z[0], x[0], z[-1], x[-1], *centre, radius, min(begin, begin + turn), abs(turn)]
    surface, _, _ = carved(shape, way)
    sampled = least(shape, z, x)
    assert (surface <= sampled + 1e-6).all()
    # Between two samples a steep edge falls by its slope; where an upright edge stops beside a
    # cell the samples may miss the cell, and only there.
    steepest = max(s for s in (shape.back_slope, shape.front_slope, 0.0) if s < inf)
    between = radius * abs(turn) / (len(SAMPLES) - 1)
    far = np.abs(surface - sampled) > 0.05 + steepest * between
    assert far.sum() <= 4


def test_edges_pass_over_blocks_that_they_do_not_touch() -> None:
    """A flat minor edge far behind a low nose must still find a high collar."""
    surface = np.full(10 * BLOCK, 1.0)
    surface[-BLOCK:] = 5.0
    shape = body(0.0, 0.0, 0.5 * pi, 0.05)
    carve(
        surface,
        np.zeros(len(surface)),
        GRID,
        shape,
        np.array([[2.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0]]),
    )
    z = (np.arange(len(surface)) + 0.5) * 0.1
    edge = 1.0 + np.maximum(0.0, z - 2.0) * tan(0.05)
    np.testing.assert_allclose(surface[-BLOCK:], np.minimum(5.0, edge[-BLOCK:]))
    np.testing.assert_allclose(surface[:-BLOCK], 1.0)


@pytest.mark.parametrize("corner", [0.0, 2.0])
def test_a_bore_has_the_shape_of_the_tool(corner: float) -> None:
    surface = np.zeros(CELLS)
    profile = np.array([5.0, 0.0 if corner else 1.0, corner])
    bore(surface, np.full(CELLS, -TOP), GRID, profile, np.array([12.0, 10.0, 11.0]))
    above = Z - 10.0
    cone = np.clip(above, 0.0, 5.0)
    side = np.clip(above, 0.0, 2.0)
    round_end = np.where(above > 0.0, 3.0 + np.sqrt(side * (4.0 - side)), 0.0)
    np.testing.assert_allclose(-surface, round_end if corner else cone)


def test_the_bed_is_not_cut() -> None:
    surface, bed = np.full(CELLS, TOP), np.full(CELLS, 6.0)
    way = [0.0, 2.0, 30.0, 2.0, 0.0, 0.0, 0.0, 0.0, 0.0]
    areas, _ = carve(surface, bed, GRID, body(0.0, 0.0, 1.0, 1.0), np.array([way]))
    np.testing.assert_allclose(surface, 6.0)
    assert areas[0] == pytest.approx(14.0 * 30.0)
