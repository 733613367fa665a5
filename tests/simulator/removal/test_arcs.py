"""Exact arcs of contact against distances from everything that was cut before."""

import itertools
from math import pi

import numpy as np
import pytest

from simulator.motion.segments import Floats, lines
from simulator.removal.cutter import Cutter
from simulator.removal.engage import MillingStock
from stepnc_model.programs.program import Stock

BOX = Stock(low=(0.0, 0.0, -12.0), high=(60.0, 40.0, 0.0))
RADIUS = 5.0


def contact(points: Floats, row: int, at: Floats) -> float:
    """Contact of the tool at a place of a row, by 20 000 points of its front."""
    ahead = (points[row + 1] - points[row]) / np.hypot(*(points[row + 1] - points[row]))
    angle = (np.arange(20_000) + 0.5) * pi / 20_000
    left = np.array([-ahead[1], ahead[0]])
    rim = at + RADIUS * (np.cos(angle)[:, None] * left + np.sin(angle)[:, None] * ahead)
    solid = ((rim > 0.0) & (rim < (60.0, 40.0))).all(axis=1)
    for start, end in itertools.pairwise(points[: row + 1]):
        way = end - start
        part = np.clip((rim - start) @ way / (way @ way), 0.0, 1.0)
        away = np.hypot(*(rim - start - part[:, None] * way).T)
        solid &= away >= RADIUS
    return float(solid.mean() * pi)


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_contact_is_what_the_moves_before_left(seed: int) -> None:
    random = np.random.default_rng(seed)
    points = random.uniform((-3.0, -3.0), (63.0, 43.0), (9, 2))
    work = MillingStock(BOX, cell=0.2)
    path = np.column_stack([points, np.full(9, -2.0)])
    segments = lines(list(path), speed=1.0)
    found = work.cut(segments, Cutter(diameter=2.0 * RADIUS))
    places = segments.position(found.segment, found.station)[:, :2]
    misses = []
    for index in range(1, len(found), 5):
        row = int(found.segment[index])
        if found.segment[index - 1] != row or found.contact_angle[index] == 0.0:
            continue
        ends = [contact(points, row, places[each]) for each in (index - 1, index)]
        near = min(abs(each - found.contact_angle[index]) for each in ends)
        misses.append(near > 2e-4)
    # The map names who freed a place: what is thinner than a cell may be overlooked for a step.
    assert len(misses) > 15
    assert np.mean(misses) <= 0.05
