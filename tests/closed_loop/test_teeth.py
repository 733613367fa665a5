"""Runout and lost teeth on the bracket: a small sample of ``python -m benchmarks.breakage``."""

import numpy as np
import pytest

from benchmarks.breakage import KINDS, MOST_ECCENTRIC, ROUGHING, Bracket, bracket, lost_tooth
from tests.closed_loop.teeth import CUTTING, Loss, healthy, lost, taken

CELLS = 300
"""3 s of each workingstep"""


@pytest.fixture(scope="module")
def part() -> Bracket:
    return bracket()


@pytest.mark.parametrize("name", ROUGHING)
@pytest.mark.parametrize("eccentricity", [0.01, MOST_ECCENTRIC])
def test_a_healthy_cutter_with_runout_is_never_broken(
    part: Bracket, name: str, eccentricity: float
) -> None:
    """10 µm stopped ROUGH POCKET while thresholds were on shares of the feed."""
    rows, course = part.rough[name], part.job.course
    first = int(np.random.default_rng(1).choice(rows[course.force[rows] > 0.0]))
    done = healthy(part.job.stretch(first, first + CELLS), eccentricity=eccentricity, seed=1)
    assert done.revolutions > 10
    assert done.stopped_by == ""


def test_teeth_that_are_lost_at_any_time_are_found_within_three_revolutions() -> None:
    found = [lost_tooth(seed, KINDS[0]) for seed in range(1, 9)]
    cutting = [each for each in found if each.is_decidable]
    assert len(cutting) >= 6
    assert all(each.is_in_time for each in cutting)


def test_a_loss_that_holds_the_feed_is_found_during_the_hold(part: Bracket) -> None:
    """The tooth after it takes two chips in a full slot, and runout adds to them."""
    rows, course = part.rough["MILL SLOT"], part.job.course
    deep = rows[course.force[rows] > 0.95 * course.force[rows].max()]
    first = int(deep[len(deep) // 2])
    found = [
        lost(
            Loss(
                job=part.job.stretch(first, first + 200),
                time=1.0,
                tooth=3,
                eccentricity=eccentricity,
                seed=1,
            )
        )
        for eccentricity in (0.014, 0.016, 0.018)
    ]
    assert all(each.is_decidable and each.is_in_time for each in found)


def test_a_tooth_that_runout_keeps_out_of_the_work_is_undecidable(part: Bracket) -> None:
    """With 30 µm at a small feed the highest tooth takes nearly all, the lowest nothing."""
    rows, course = part.rough["MILL SLOT"], part.job.course
    cell = int(rows[course.force[rows].argmax()])
    shares = [
        taken(
            course,
            cell,
            Loss(job=part.job, time=0.0, tooth=tooth, eccentricity=MOST_ECCENTRIC, seed=0),
            override=0.4,
        )
        for tooth in range(4)
    ]
    assert sum(shares) == pytest.approx(4.0, rel=1e-3)
    assert shares[2] < CUTTING < shares[0]
