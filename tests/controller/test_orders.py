import pytest

from controller.orders import (
    Criterion,
    CriterionTo,
    EventKind,
    LoopEvent,
    MotorPowerTo,
    OverrideAtMost,
    SwitchTo,
)


def test_orders_of_the_same_wish_are_equal() -> None:
    assert SwitchTo(is_on=True) == SwitchTo(is_on=True)
    assert CriterionTo(criterion=Criterion.TC) != CriterionTo(criterion=Criterion.QC)
    assert MotorPowerTo(factor=0.5).factor == 0.5


def test_an_event_says_when_what_and_why() -> None:
    event = LoopEvent(
        time=1.5, kind=EventKind.HOLD, text="force 900 N exceeds 600 N: feed held"
    )
    assert (event.time, event.kind.value) == (1.5, "hold")


@pytest.mark.parametrize("factor", [0.0, -1.0, float("nan"), float("inf")])
def test_a_share_of_the_power_must_be_positive(factor: float) -> None:
    with pytest.raises(ValueError, match="must be positive"):
        MotorPowerTo(factor=factor)


@pytest.mark.parametrize("most", [0.0, -1.0, float("nan"), float("inf")])
def test_a_bound_of_the_override_must_be_positive(most: float) -> None:
    with pytest.raises(ValueError, match="must be positive"):
        OverrideAtMost(most=most)
