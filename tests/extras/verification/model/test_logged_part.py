"""What a log can resolve, and the part that it leaves."""

from dataclasses import replace

import numpy as np
import pytest

from extras.verification.model.logged_part import joined, rounding_of
from tests.extras.verification.model.block import (
    SLOT,
    logged,
    part_of,
    sampled,
    samples_at,
    slot_path,
)


@pytest.mark.parametrize(
    ("position", "step"), [([[1.23, 0.5, 2.0]], 0.01), ([[1.0, 2.0, 3.0]], 1.0)]
)
def test_rounding_is_seen(position: list[list[float]], step: float) -> None:
    assert rounding_of(np.array(position)) == step


def test_positions_that_are_not_rounded_say_so() -> None:
    assert rounding_of(np.array([[np.pi, 0.0, 0.0]])) == 0.0


def test_a_log_in_pieces_leaves_the_same_part() -> None:
    part = part_of(slot_path())
    samples = samples_at(sampled(SLOT, 0.7))
    whole, pieces = logged(part, samples), logged(part, samples[:20])
    pieces.add(samples[20:31])
    pieces.add(samples[31:])
    assert np.array_equal(whole.map.grid.heights, pieces.map.grid.heights)
    assert np.array_equal(whole.targets.away, pieces.targets.away)
    assert pieces.facts.samples == len(samples)


def test_the_way_between_samples_is_known() -> None:
    facts = logged(part_of(slot_path()), samples_at(sampled(SLOT, 0.7))).facts
    assert facts.step == pytest.approx(0.7)
    assert facts.interval == pytest.approx(0.01)
    assert facts.gaps == 0
    assert facts.tools == {1}


def test_a_gap_counts_with_the_way_that_the_tool_may_have_gone() -> None:
    samples = samples_at(sampled(SLOT, 0.5))
    part = part_of(slot_path())
    left = logged(part, joined([samples[:30], samples[50:]]))
    assert left.facts.gaps == 1
    assert left.facts.longest_gap == pytest.approx(0.21)
    assert left.walls.step.max() == pytest.approx(10.5)


def test_a_tool_that_is_not_known_removes_nothing() -> None:
    samples = samples_at(sampled(SLOT, 0.7))
    other = replace(samples, tool=np.full(len(samples), 9))
    left = logged(part_of(slot_path()), other)
    assert left.map.grid.heights.min() == 0.0
    assert np.isnan(left.walls.time).all()
