"""Units of the ``[cost]`` table."""

from simulator.files.cost_file import cost_table
from simulator.library import load_machine


def test_rate_is_per_hour_in_the_file_and_per_second_inside() -> None:
    rates = load_machine("vmc15").costs
    assert rates is not None
    assert rates.machine_rate == 75.0 / 3600.0
    table = cost_table(rates)
    assert table is not None
    assert table.rate_per_hour == 75.0
    assert table.rates == rates
