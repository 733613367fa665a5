"""Blocks at other feeds: their parts lie on the block and end where it ends."""

from math import dist, hypot, pi

import pytest
from hypothesis import given
from hypothesis import strategies as st

from stepnc_model.errors import PostError
from stepnc_model.post.block_feeds import BlockPart, FedBlock, with_feeds
from stepnc_model.post.blocks import (
    Block,
    Circular,
    Comment,
    DrillingCycle,
    Linear,
    Rapid,
    Rate,
    expanded,
)
from stepnc_model.toolpath.path import Arc, CycleKind

START = Rapid(end=(0.0, 0.0, 5.0))
LINE = Linear(end=(30.0, 40.0, 5.0), rate=Rate(value=2.0))
ARC = Circular(
    end=(0.0, 20.0, 15.0), arc=Arc(centre=(0.0, 10.0, 0.0), turn=pi), rate=Rate(value=2.0)
)
SHARES = st.lists(st.floats(0.01, 0.99), max_size=4, unique=True).map(sorted)


def parts(shares: list[float]) -> tuple[BlockPart, ...]:
    """Parts that end at the given shares, each faster than the one before."""
    return tuple(BlockPart(end=end, rate=3.0 + row) for row, end in enumerate([*shares, 1.0]))


def fed(block: Linear | Circular, shares: list[float]) -> list[FedBlock]:
    return list(with_feeds([(1, START), (2, block)], {2: parts(shares)}))[1:]


@given(SHARES)
def test_parts_of_a_line_lie_on_it(shares: list[float]) -> None:
    found = fed(LINE, shares)
    assert [each.part for each in found] == list(range(len(shares) + 1))
    assert found[-1].block == Linear(end=LINE.end, rate=Rate(value=3.0 + len(shares)))
    for each, share in zip(found, shares, strict=False):
        assert isinstance(each.block, Linear)
        assert dist(START.end, each.block.end) == pytest.approx(50.0 * share)


@given(SHARES)
def test_parts_of_a_helix_lie_on_it(shares: list[float]) -> None:
    found = fed(ARC, shares)
    blocks = [each.block for each in found if isinstance(each.block, Circular)]
    assert sum(block.arc.turn for block in blocks) == pytest.approx(pi)
    assert blocks[-1].end == ARC.end
    for block, share in zip(blocks, shares, strict=False):
        x, y, z = block.end
        assert hypot(x, y - 10.0) == pytest.approx(10.0)
        assert z == pytest.approx(5.0 + 10.0 * share)


def test_blocks_without_an_entry_stay() -> None:
    blocks: list[tuple[int, Block]] = [(1, START), (2, LINE), (3, Comment(text="NEXT"))]
    found = list(with_feeds(blocks, {}))
    assert [each.block for each in found] == [block for _, block in blocks]


def test_a_cycle_has_one_feed() -> None:
    cycle = expanded(
        DrillingCycle(
            kind=CycleKind.PECK,
            at=(0.0, 0.0),
            retract_z=2.0,
            bottom_z=-10.0,
            step_depth=4.0,
            rate=Rate(value=1.0),
        )
    )
    (found,) = with_feeds([(1, cycle)], {1: (BlockPart(end=1.0, rate=3.0),)})
    assert isinstance(found.block, DrillingCycle)
    assert found.block.rate.value == 3.0
    feeds = {each.rate.value for each in found.block.expansion if isinstance(each, Linear)}
    assert feeds == {3.0}


def test_a_block_whose_start_is_unknown_is_not_split() -> None:
    with pytest.raises(PostError, match="start is unknown"):
        list(with_feeds([(1, LINE)], {1: parts([0.5])}))
