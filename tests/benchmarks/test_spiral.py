"""Cycle times of the spiral on machines whose numbers the prediction does not see."""

from pathlib import Path

import pytest

from benchmarks.spiral import FEEDS_IN_MIN, SpiralResult, drawn, found_on, main
from simulator.errors import CalibrationError
from simulator.motion.model_name import ControlModelName


@pytest.mark.parametrize(
    ("seed", "control"), [(0, ControlModelName.JUNCTION), (4, ControlModelName.FIR)]
)
def test_spirals_on_a_hidden_machine_are_predicted_within_one_per_cent(
    tmp_path: Path, seed: int, control: ControlModelName
) -> None:
    hidden = drawn(seed, control)
    result = found_on(hidden, tmp_path)
    assert result.block_time == pytest.approx(hidden.machine.block_time, rel=1e-3)
    assert [each.feed_in_min for each in result.spirals] == list(FEEDS_IN_MIN)
    for each in result.spirals:
        assert abs(each.error) < 0.01
    slow, _, fast = result.spirals
    gained = slow.actual / fast.actual
    assert gained < FEEDS_IN_MIN[-1] / FEEDS_IN_MIN[0]


def test_a_control_that_stops_at_each_block_has_no_block_time(tmp_path: Path) -> None:
    with pytest.raises(CalibrationError, match="4 stop at each block"):
        found_on(drawn(0, ControlModelName.EXACT_STOP), tmp_path)


def test_errors_count_from_the_actual_time() -> None:
    spiral = SpiralResult(feed_in_min=100.0, theoretical=8.0, predicted=10.1, actual=10.0)
    assert spiral.error == pytest.approx(0.01)


def test_the_table_has_a_row_for_each_machine(capsys: pytest.CaptureFixture[str]) -> None:
    main(["--seeds", "1"])
    lines = capsys.readouterr().out.splitlines()
    assert sum(line.startswith("junction     0") for line in lines) == 1
    assert sum(line.startswith("fir: 1 machines") for line in lines) == 1
