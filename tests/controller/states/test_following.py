"""Axes that do not run what was commanded, and those that are only slow."""

import pytest

from controller.states.following import PATIENCE, Following, followed
from tests.controller.plugged import reading

PERIOD = 0.02
LAG = 0.06


def after(overrides: list[float], commanded: float, begin: float = 1.0) -> Following:
    """State after the axes ran these overrides under one command."""
    now = Following(modelled=begin)
    for override in overrides:
        told = reading(100.0)._replace(period=PERIOD, override=override)
        now = followed(now, told, commanded, lag=LAG)
    return now


@pytest.mark.parametrize(
    ("override", "is_astray"), [(0.76, False), (0.8, False), (0.84, False), (0.9, True)]
)
def test_more_than_a_twentieth_for_a_second_is_astray(override: float, is_astray: bool) -> None:
    count = round(PATIENCE / PERIOD) + 30
    assert after([override] * count, 0.8).is_astray is is_astray
    assert not after([override] * (count // 3), 0.8).is_astray


def test_on_the_way_between_model_and_command_nothing_is_wrong() -> None:
    assert after([0.5] * 40, 0.5).astray == 0.0
    assert after([1.0], 0.5).astray == PERIOD
    assert after([0.9], 0.5).astray == 0.0


def test_where_the_override_does_not_act_nothing_counts() -> None:
    rapid = reading(0.0, can_override=False, override=3.0)
    now = followed(Following(modelled=1.0, astray=0.9), rapid, 0.7, lag=LAG)
    assert now == Following(modelled=0.7)


def test_axes_that_should_stand_may_creep() -> None:
    assert after([0.015] * 100, 0.0, begin=0.0).astray == 0.0
    assert after([0.2] * 100, 0.0, begin=0.0).is_astray
