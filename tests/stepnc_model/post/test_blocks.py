"""Neutral blocks."""

from dataclasses import FrozenInstanceError

import pytest

from stepnc_model.post.blocks import Coolant, Linear, Rate, RateMode, SpindleDirection


def test_the_opposite_of_the_opposite_is_the_same() -> None:
    assert SpindleDirection.CLOCKWISE.opposite is SpindleDirection.COUNTERCLOCKWISE
    assert SpindleDirection.COUNTERCLOCKWISE.opposite is SpindleDirection.CLOCKWISE


def test_a_feed_counts_time_unless_said() -> None:
    assert Rate(value=1.0).mode is RateMode.PER_MINUTE


def test_coolant_is_off_unless_said() -> None:
    assert not Coolant().kinds


def test_a_block_never_changes() -> None:
    block = Linear(end=(0.0, 0.0, 0.0), rate=Rate(value=1.0))
    with pytest.raises(FrozenInstanceError):
        block.end = (1.0, 0.0, 0.0)  # type: ignore[misc]
