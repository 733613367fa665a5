"""All measured powers in one vector."""

import numpy as np
import pytest

from extras.calibration.model.features import PARAMETERS, RunFeatures
from extras.calibration.model.fit import jacobian, predicted, stacked
from extras.calibration.model.measured_run import Component


def run(seconds: float, watts: float) -> RunFeatures:
    count = int(10 * seconds)
    return RunFeatures(
        name="run",
        duration=np.full(count, 0.1),
        spindle_speed=np.full(count, 50.0),
        spindle_acceleration=np.zeros(count),
        velocity=np.zeros((count, 3)),
        acceleration=np.zeros((count, 3)),
        cutting_power=np.zeros(count),
        coolant=np.zeros(count),
        measured={
            Component.BASE: np.full(count, watts),
            Component.TOTAL: np.full(count, 500.0),
        },
    )


def test_rows_are_run_by_run_and_part_by_part() -> None:
    stack = stacked([run(2.0, 300.0), run(1.0, 310.0)], 0.9)
    assert len(stack.watts) == 60
    assert stack.watts[0] == 300.0
    assert stack.watts[20] == 500.0
    assert stack.watts[40] == 310.0
    np.testing.assert_array_equal(np.bincount(stack.run), [40, 20])


def test_blocks_are_consecutive_and_no_run_shares_one() -> None:
    stack = stacked([run(400.0, 300.0), run(200.0, 310.0)], 0.9)
    first, second = (set(stack.block[stack.run == row].tolist()) for row in (0, 1))
    assert len(first) == pytest.approx(40, abs=1)
    assert not first & second


def test_prediction_is_linear_where_nothing_is_cut_off() -> None:
    stack = stacked([run(2.0, 300.0)], 0.9)
    values = np.full(len(PARAMETERS), 2.0)
    np.testing.assert_allclose(predicted(stack, values), jacobian(stack, values) @ values)
