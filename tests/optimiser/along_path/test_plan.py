"""Plans of whole programs: few feeds, repeated blocks, rounding, and what stays."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from optimiser.along_path.pieces import PieceRules
from optimiser.along_path.plan import (
    FeedPlanner,
    FeedTask,
    RunBlock,
    SlowerPart,
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


@settings(max_examples=30)
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


def slower(*parts: tuple[float, float], excess: float = 2.0) -> SlowerPart:
    """Slower feeds of a part, each with its end."""
    return SlowerPart(
        parts=tuple(BlockPart(end=end, rate=rate) for end, rate in parts), excess=excess
    )


def test_parts_that_are_too_fast_are_divided() -> None:
    feeds = {4: (BlockPart(end=0.5, rate=10.0), BlockPart(end=1.0, rate=20.0))}
    found = lowered(
        feeds,
        {(4, 1): slower((0.2, 4.0), (1.0, 20.0)), (7, 0): slower((1.0, 3.0))},
        blocks={},
        levels=None,
    )
    assert [part.rate for part in found[4]] == [10.0, 4.0, 20.0]
    assert [part.end for part in found[4]] == pytest.approx([0.5, 0.6, 1.0])
    assert [part.rate for part in found[7]] == [3.0]


def test_the_number_of_feeds_stays_where_it_is_bound() -> None:
    """A feed that is hardly too fast falls everywhere; a part far too fast gets another."""
    given = {
        block: (BlockPart(end=1.0, rate=rate),)
        for block, rate in ((1, 20.0), (2, 20.0), (3, 5.0), (4, 15.0))
    }
    blocks = {
        block: RunBlock(name="b" if block == 4 else "a", weight=10.0, rate=parts[0].rate)
        for block, parts in given.items()
    } | {5: RunBlock(name="a", weight=1.0, rate=5.0)}
    for rate, feeds in ((19.5, {5.0, 19.5}), (6.0, {5.0, 20.0})):
        slow = {(1, 0): slower((0.5, rate), (1.0, 20.0))}
        found = lowered(given, slow, blocks=blocks, levels=2)
        assert {part.rate for block in (1, 2, 3) for part in found[block]} == feeds
        assert found[1][0].rate <= rate
        assert found[4] == given[4]
        assert 5 not in found


def test_the_lowest_feed_falls_wherever_it_is_used() -> None:
    given = {1: (BlockPart(end=1.0, rate=5.0),), 2: (BlockPart(end=1.0, rate=5.0),)}
    blocks = {block: RunBlock(name="", weight=1.0, rate=5.0) for block in given}
    found = lowered(given, {(1, 0): slower((1.0, 2.0))}, blocks=blocks, levels=1)
    assert found[1][0].rate == found[2][0].rate == 2.0


def test_executions_of_a_block_weigh_together() -> None:
    one = RunBlock(name="a", weight=2.0, rate=5.0)
    assert one.plus(None) is one
    assert one.plus(RunBlock(name="a", weight=3.0, rate=5.0)).weight == 5.0


def test_two_executions_of_a_part_have_the_slower_feed_as_a_whole() -> None:
    one, other = slower((0.3, 7.0), (1.0, 9.0)), slower((1.0, 8.0), excess=3.0)
    assert one.or_slower(other) == slower((1.0, 7.0), excess=3.0)
    assert one.or_slower(None) is one
