"""Cycle times of the spiral on machines whose numbers the prediction does not see."""

from contextlib import redirect_stdout
from io import StringIO
from pathlib import Path

import pytest

from benchmarks import spiral
from benchmarks.spiral import FEEDS_IN_MIN, HiddenMachine, MachineResult, SpiralResult
from simulator.motion.model_name import ControlModelName

Results = dict[ControlModelName, MachineResult]


@pytest.fixture(scope="module")
def table() -> tuple[list[str], Results]:
    """Printed lines of the benchmark for a machine of each control, and its results."""
    results: Results = {}
    found_on = spiral.found_on

    def kept(hidden: HiddenMachine, folder: Path) -> MachineResult:
        results[hidden.control] = found_on(hidden, folder)
        return results[hidden.control]

    output = StringIO()
    with pytest.MonkeyPatch.context() as patch, redirect_stdout(output):
        patch.setattr(spiral, "found_on", kept)
        spiral.main(["--seeds", "1"])
    return output.getvalue().splitlines(), results


@pytest.mark.parametrize("control", [ControlModelName.JUNCTION, ControlModelName.FIR])
def test_spirals_on_a_hidden_machine_are_predicted_within_one_per_cent(
    table: tuple[list[str], Results], control: ControlModelName
) -> None:
    result = table[1][control]
    assert result.block_time == pytest.approx(result.hidden.machine.block_time, rel=1e-3)
    assert [each.feed_in_min for each in result.spirals] == list(FEEDS_IN_MIN)
    for each in result.spirals:
        assert abs(each.error) < 0.01
    slow, _, fast = result.spirals
    gained = slow.actual / fast.actual
    assert gained < FEEDS_IN_MIN[-1] / FEEDS_IN_MIN[0]


def test_a_control_that_stops_at_each_block_has_no_block_time(
    table: tuple[list[str], Results],
) -> None:
    lines, results = table
    assert ControlModelName.EXACT_STOP not in results
    assert "4 stop at each block" in next(each for each in lines if "exact-stop" in each)


def test_errors_count_from_the_actual_time() -> None:
    result = SpiralResult(feed_in_min=100.0, theoretical=8.0, predicted=10.1, actual=10.0)
    assert result.error == pytest.approx(0.01)


def test_the_table_has_a_row_for_each_machine(table: tuple[list[str], Results]) -> None:
    lines, _ = table
    assert sum(line.startswith("junction     0") for line in lines) == 1
    assert sum(line.startswith("fir: 1 machines") for line in lines) == 1
