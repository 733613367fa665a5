import pytest

from controller.hold import BELOW, FORGIVING, Hold


def test_a_hold_is_forgotten_after_a_hundred_revolutions() -> None:
    hold = Hold(count=2.0)
    for _ in range(100):
        hold.forgive()
    assert hold.count == pytest.approx(1.0)
    for _ in range(1000):
        hold.forgive()
    assert hold.count == 0.0


def test_holds_in_quick_succession_add_up() -> None:
    hold = Hold()
    for _ in range(4):
        hold.count += 1
        hold.forgive()
    assert hold.count == pytest.approx(4.0 - 4.0 * FORGIVING)


def test_only_an_override_that_stays_below_the_band_is_a_danger() -> None:
    hold = Hold()
    assert not any(hold.stays_below(is_below=True) for _ in range(BELOW))
    assert not hold.stays_below(is_below=False)
    assert not hold.stays_below(is_below=True)
    hold.below = BELOW
    assert hold.stays_below(is_below=True)
