"""Working hours: over midnight, and over the end of the week."""

from extras.factory.model.calendar import WEEK, calendar_of


def test_shifts_over_midnight_and_the_end_of_the_week() -> None:
    calendar = calendar_of(["Sun 22:00-06:00", "Mon 06:00-07:00"])
    assert calendar.is_open(0.0)
    assert calendar.is_open(7 * 3600.0 - 1.0)
    assert not calendar.is_open(7 * 3600.0)
    assert calendar.is_open(WEEK - 1.0)
    assert calendar.next_change(3600.0) == 7 * 3600.0
    assert calendar.next_change(8 * 3600.0) == WEEK - 2 * 3600.0
    assert calendar.weekly == 9 * 3600.0
