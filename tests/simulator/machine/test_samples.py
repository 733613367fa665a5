"""Samples and what follows from them."""

from collections.abc import Callable
from dataclasses import fields

import numpy as np
import pytest

from simulator.machine.samples import Rotation, Samples, TravelDirection, joined

Made = Callable[..., Samples]


def test_path_speed_is_that_of_all_axes(samples_of: Made) -> None:
    samples = samples_of(2, velocity=np.array([[3.0, 4.0, 0.0], [-1.0, 2.0, -2.0]]))
    assert samples.path_speed.tolist() == [5.0, 3.0]


def test_total_is_the_sum_of_all_components(samples_of: Made) -> None:
    samples = samples_of(
        1,
        axis_power=np.array([[1.0, 2.0, 4.0]]),
        spindle_power=np.array([8.0]),
        coolant_power=np.array([16.0]),
        base_power=np.array([32.0]),
        cutting_power=np.array([5.0]),
    )
    assert samples.total_power.tolist() == [63.0]


@pytest.mark.parametrize("cut", [0, 3, 10])
def test_joined_parts_are_the_whole(samples_of: Made, cut: int) -> None:
    random = np.random.default_rng(3)
    whole = samples_of(10, position=random.normal(size=(10, 3)), line=np.arange(10))
    parts = [
        Samples(**{each.name: getattr(whole, each.name)[rows] for each in fields(Samples)})
        for rows in (slice(cut), slice(cut, None))
    ]
    again = joined(parts)
    assert len(again) == 10
    for each in fields(Samples):
        np.testing.assert_array_equal(getattr(again, each.name), getattr(whole, each.name))


def test_directions_are_signs_of_speeds(samples_of: Made) -> None:
    samples = samples_of(
        1, velocity=np.array([[-2.0, 0.0, 0.5]]), spindle_speed=np.array([-10.0])
    )
    assert samples.direction.tolist() == [
        [TravelDirection.NEGATIVE, TravelDirection.NONE, TravelDirection.POSITIVE]
    ]
    assert samples.rotation.tolist() == [Rotation.COUNTER_CLOCKWISE]
