"""Neutral blocks."""

from dataclasses import FrozenInstanceError

import pytest

from stepnc_model.post.blocks import Coolant, Linear, Rate, RateMode, Sense


def test_the_opposite_of_the_opposite_is_the_same() -> None:
    assert Sense.CLOCKWISE.opposite is Sense.COUNTERCLOCKWISE
    assert Sense.COUNTERCLOCKWISE.opposite is Sense.CLOCKWISE


def test_a_feed_counts_time_unless_said() -> None:
    assert Rate(value=1.0).mode is RateMode.PER_MINUTE


def test_coolant_is_off_unless_said() -> None:
    assert not Coolant().kinds


def test_a_block_never_changes() -> None:
    block = Linear(end=(0.0, 0.0, 0.0), rate=Rate(value=1.0))
    with pytest.raises(FrozenInstanceError):
        block.end = (1.0, 0.0, 0.0)  # type: ignore[misc]
