"""Heights on a ring around a step in the map, and the slices that they make."""

from math import pi
from typing import Any

import numpy as np
import pytest

from simulator.removal.arcs import ToolCircle
from simulator.removal.ring import (
    BLURRED_SLICES,
    CORNER_SLICES,
    MOST_LEVELS,
    SAMPLES,
    Pose,
    RimBuffers,
    Ring,
    cell_at,
    circle_of,
    levels,
    read_ring,
    turns_of,
)
from simulator.removal.zmap import OUTSIDE, UNCUT, HeightGrid

BOTTOM, LOW, HIGH = -9.0, -5.0, -1.0
RADIUS, GAP = 4.0, 0.01


def step() -> HeightGrid:
    """40 mm square about the origin, low where x < 0, high elsewhere."""
    heights = np.full((80, 80), HIGH)
    heights[:40] = LOW
    owner = np.full((80, 80), UNCUT, dtype=np.int32)
    owner[:40] = 7
    return HeightGrid(heights, owner, -20.0, -20.0, 0.5, 0.5, BOTTOM, 0.0, 0.0)


def samples() -> Ring:
    return Ring(np.empty(SAMPLES), np.empty(SAMPLES, dtype=np.int64))


def ring_at(circle: ToolCircle) -> Ring:
    found = samples()
    read_ring(step(), found, turns_of(SAMPLES), circle, GAP)
    return found


def room() -> RimBuffers:
    empty: Any = None
    return RimBuffers(
        arcs=empty,
        total=empty,
        turns=empty,
        wide=samples(),
        inner=empty,
        solid=np.empty(SAMPLES, dtype=np.int64),
        bounds=np.empty(MOST_LEVELS + CORNER_SLICES + 3),
        areas=np.zeros(MOST_LEVELS + CORNER_SLICES + 3),
        candidates=np.empty(1, dtype=np.int64),
    )


@pytest.mark.parametrize(("side", "first"), [(1.0, LOW), (-1.0, HIGH)])
def test_the_ring_begins_on_the_side_that_the_spindle_turns_from(
    side: float, first: float
) -> None:
    """Ahead is +Y, so the left is −X: the low half."""
    ring = ring_at(ToolCircle(0.0, 0.0, RADIUS, 0.0, 1.0, side))
    half = SAMPLES // 2
    assert (ring.heights[:half] == first).all()
    assert (ring.heights[half:] == LOW + HIGH - first).all()
    assert ((ring.owner == 7) == (ring.heights == LOW)).all()


@pytest.mark.parametrize("distance", [-3.0, -1.0, 0.5, 2.5])
def test_the_step_shares_the_ring_by_its_angle(distance: float) -> None:
    """A chord at a distance from the axis, across the feed: acos(d/r) of either side."""
    ring = ring_at(ToolCircle(-distance, 0.0, RADIUS, 1.0, 0.0, 1.0))
    angle = pi * float((ring.heights == HIGH).mean())
    beyond = max(0.0, distance) / (RADIUS + GAP)
    # Only the front half counts: a step behind the axis leaves all of it high.
    exact = pi if distance <= 0.0 else 2.0 * float(np.arccos(beyond))
    assert angle == pytest.approx(exact, abs=2.0 * pi / SAMPLES)


def test_beside_the_stock_the_ring_is_at_the_bottom_and_nobodys() -> None:
    ring = ring_at(ToolCircle(100.0, 0.0, RADIUS, 1.0, 0.0, 1.0))
    assert (ring.heights == BOTTOM).all()
    assert (ring.owner == OUTSIDE).all()


@pytest.mark.parametrize("ahead", [(0.6, 0.8), (-1.0, 0.0)])
def test_each_sample_is_the_cell_at_its_angle(ahead: tuple[float, float]) -> None:
    circle = ToolCircle(-0.37, 1.13, RADIUS, *ahead, -1.0)
    ring = ring_at(circle)
    for index, angle in enumerate((np.arange(SAMPLES) + 0.5) * pi / SAMPLES):
        expected = cell_at(step(), circle, RADIUS + GAP, float(angle))
        assert (ring.heights[index], ring.owner[index]) == expected


def test_the_height_at_an_angle_is_that_of_its_cell() -> None:
    """0 is left of the feed, half π ahead."""
    circle = ToolCircle(0.0, 0.0, RADIUS, 0.0, 1.0, 1.0)
    assert cell_at(step(), circle, 3.0, 0.2)[0] == LOW
    assert cell_at(step(), circle, 3.0, pi - 0.2)[0] == HIGH
    assert cell_at(step(), circle, 30.0, 0.2)[0] == BOTTOM


def test_slices_lie_between_the_heights_in_order() -> None:
    work = room()
    work.wide.heights[:] = np.resize([-2.0, -6.0, -4.0, -8.0], SAMPLES)
    assert levels(work, -7.0) == 3
    assert work.bounds[:4] == pytest.approx([-7.0, -6.0, -4.0, -2.0])


def test_many_heights_are_blurred_into_equal_slices() -> None:
    work = room()
    work.wide.heights[:] = np.linspace(-4.0, 0.0, SAMPLES)
    count = levels(work, -4.0)
    assert count == BLURRED_SLICES
    assert work.bounds[: count + 1] == pytest.approx(np.linspace(-4.0, 0.0, count + 1))


def test_a_section_is_where_the_tool_is() -> None:
    pose = Pose(1.0, 2.0, 3.0, 0.6, 0.8, 0.0)
    assert circle_of(pose, RADIUS, -1.0) == (1.0, 2.0, RADIUS, 0.6, 0.8, -1.0)
