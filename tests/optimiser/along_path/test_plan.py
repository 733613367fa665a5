"""Plans of whole programs: few feeds, repeated blocks, rounding, and what stays."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from optimiser.along_path.pieces import PieceRules
from optimiser.along_path.plan import (
    FeedPlanner,
    FeedTask,
    block_feeds,
    lowered,
    rounded_down,
)
from optimiser.along_path.stretch import PathStretch
from stepnc_model.post.block_feeds import BlockPart
from tests.optimiser.along_path.stretches import FIR, straight, stretch_of

TASK = FeedTask(machine=FIR, rules=PieceRules())


def fed(lengths: list[float], feeds: list[float]) -> PathStretch:
    """Stretch in air whose blocks have programmed feeds."""
    segments = straight(lengths)
    return stretch_of(replace(segments, speed=np.array(feeds)))


def test_air_gets_the_greatest_feed_that_pays() -> None:
    planner = FeedPlanner(TASK)
    planner.add(fed([400.0], [10.0]))
    (part,) = planner.plan().parts
    assert part.time + part.window_change < 0.2 * part.programmed_time
    assert part.bound <= part.time
    assert part.free.bound <= part.free.time * (1.0 + 1e-12)


def test_a_part_that_hardly_gains_stays_as_programmed() -> None:
    first = FeedPlanner(TASK)
    first.add(fed([30.0, 60.0, 30.0], [5.0, 10.0, 5.0]))
    plan = first.plan()
    planned = {block: parts[0].rate for block, parts in block_feeds(plan)}
    again = FeedPlanner(TASK)
    again.add(fed([30.0, 60.0, 30.0], [planned[block] for block in range(3)]))
    assert dict(block_feeds(again.plan())) == {}


def test_a_block_that_runs_twice_has_the_feed_of_the_slower_run() -> None:
    planner = FeedPlanner(TASK)
    planner.add(fed([200.0], [10.0]))
    planner.add(fed([2.0], [10.0]))
    plan = planner.plan()
    assert len(set(plan.pieces.rate.tolist())) == 1
    assert [block for block, _ in block_feeds(plan)] == [0]


@given(st.lists(st.floats(5.0, 60.0), min_size=3, max_size=8), st.integers(1, 3))
def test_no_more_feeds_than_asked_for(lengths: list[float], levels: int) -> None:
    planner = FeedPlanner(replace(TASK, levels=levels))
    for length in lengths:
        planner.add(fed([length], [1.0]))
    (part,) = planner.plan().parts
    assert part.feeds <= levels
    assert part.levels_gap >= -1e-12


@given(st.floats(1e-3, 500.0), st.booleans())
def test_feeds_are_rounded_down_by_little(rate: float, is_per_revolution: bool) -> None:
    found = rounded_down(np.array([rate]), np.zeros(1), np.array([is_per_revolution]))[0]
    assert 0.0 < found <= rate * (1.0 + 1e-9)
    assert found >= 0.98 * rate


def test_parts_that_are_too_fast_are_lowered() -> None:
    feeds = {4: (BlockPart(end=0.5, rate=10.0), BlockPart(end=1.0, rate=20.0))}
    found = lowered(feeds, {(4, 1): 1.25}, keeps_levels=False)
    assert [part.rate for part in found[4]] == [10.0, pytest.approx(16.0, rel=0.01)]


def test_parts_of_one_feed_are_lowered_together_where_their_number_is_bound() -> None:
    feeds = {
        1: (BlockPart(end=1.0, rate=20.0),),
        2: (BlockPart(end=1.0, rate=20.0),),
    }
    found = lowered(feeds, {(1, 0): 1.1}, keeps_levels=True)
    assert found[1][0].rate == found[2][0].rate < 20.0 / 1.09
