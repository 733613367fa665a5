"""Numbers of what AIM instances stand for."""

from stepnc_model.ap238.numbering import AimNumbering, what


def test_the_first_kind_keeps_the_number_and_others_get_new_ones() -> None:
    numbers = AimNumbering(100)
    line, scaled = what("LINE", 1.0), what("LINE", 25.4)
    assert 7 not in numbers
    assert numbers.known(7, line) is None
    assert numbers.new(7, line) == 7
    assert numbers.new(7, scaled) == 100
    assert 7 in numbers
    assert (numbers.known(7, line), numbers.known(7, scaled)) == (7, 100)
    assert numbers.next == 101


def test_a_kind_is_one_object() -> None:
    assert what("LINE", 25.4) is what("LINE", 25.4)
