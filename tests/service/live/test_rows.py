"""Rows of a run under control: names tell the unit, and the numbers are in it."""

import numpy as np
import pytest

from service.live.runner import COLUMNS, Moment, rows_of

NUMBERS = {name: float(place + 1) for place, name in enumerate(Moment._fields)}
MOMENT = Moment(**{**NUMBERS, "workingstep": "", "level": "", "holding": "", "event": None})  # type: ignore[arg-type]

UNITS = {"_mm_min": 60.0, "_cm3_min": 0.06, "_percent": 100.0}
"""by the end of a name; all others are canonical"""


def test_each_column_is_in_the_unit_of_its_name() -> None:
    [row] = rows_of([MOMENT])
    assert len(row) == len(COLUMNS)
    for value, (name, (field, _)) in zip(row, COLUMNS.items(), strict=True):
        factor = next((each for end, each in UNITS.items() if name.endswith(end)), 1.0)
        assert value == pytest.approx(factor * NUMBERS[field]), name


def test_the_time_comes_first_and_what_is_not_known_stays_so() -> None:
    assert next(iter(COLUMNS)) == "time_s"
    [row] = rows_of([MOMENT._replace(force_true=float("nan"))])
    assert np.isnan(row[list(COLUMNS).index("force_true_n")])


def test_no_moments_are_no_rows() -> None:
    assert rows_of([]).shape == (0, len(COLUMNS))
