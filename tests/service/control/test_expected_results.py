import numpy as np
import pytest

from service.control.expected_results import PlannedWorkingstep, planned_steps, with_hardest
from tests.simulator.plant.courses import EXPONENT, FEED, course, levels


def test_times_and_forces_of_a_workingstep_are_those_of_its_cells() -> None:
    can = np.ones(300, dtype=bool)
    can[:50] = False
    planned = planned_steps(course(levels(0.0, 100.0, 250.0), can_override=can))
    assert list(planned) == [1]
    assert planned[1].time == pytest.approx(3.0)
    assert planned[1].cutting_time == pytest.approx(2.0)
    assert planned[1].force == 250.0
    assert planned[1].feed == pytest.approx(FEED)
    assert planned[1].exponent == pytest.approx(EXPONENT)
    assert planned[1].diameter == 10.0


def test_what_cuts_nothing_takes_its_time_only() -> None:
    planned = planned_steps(course(levels(0.0)))[1]
    assert planned == PlannedWorkingstep(time=planned.time)
    assert planned.time == pytest.approx(1.0)


def test_the_hardest_place_is_where_the_force_counts_most() -> None:
    path = course(levels(100.0, 250.0))
    weight = np.where(np.arange(200) < 100, 4.0, 1.0)
    planned = planned_steps(path)
    assert with_hardest(planned, path, weight)[1].force == 100.0
    assert with_hardest(planned, path, None) == planned
