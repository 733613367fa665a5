"""The reader of the laboratory mill's logs, and the mill itself where its data are."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

from benchmarks import umich
from benchmarks.logged_path.smart_mill import read_smart_run
from extras.calibration.model.measured_run import Component
from simulator.errors import CalibrationError

NAMES = (
    *(f"{axis}1_Command{what}" for what in ("Velocity", "Acceleration") for axis in "XYZS"),
    *(f"{axis}1_CommandPosition" for axis in "XYZ"),
    *(f"{axis}1_OutputPower" for axis in "XYS"),
    "M1_sequence_number",
    "M1_CURRENT_FEEDRATE",
    "Machining_Process",
)


def written(folder: Path, blocks: Sequence[int], missing: str = "") -> Path:
    rows = []
    for row, block in enumerate(blocks):
        values = dict.fromkeys(NAMES, "0")
        values |= {"X1_CommandPosition": "1.58E+02", "Y1_CommandPosition": f"{73.5 + row}"}
        values |= {"S1_CommandVelocity": "5.33E+01" if 7 <= row < 13 else "0"}
        values |= {"S1_OutputPower": f"{0.17 + 0.001 * row}", "M1_sequence_number": f"{block}"}
        values |= {"M1_CURRENT_FEEDRATE": "50" if block == 7 else "6", "Machining_Process": "?"}
        rows.append([values[name] for name in NAMES if name != missing])
    path = folder / "run.csv"
    heads = [name for name in NAMES if name != missing]
    path.write_text("\n".join(",".join(row) for row in [heads, *rows]) + "\n", encoding="utf-8")
    return path


BLOCKS = (0, 2, 0, 2, 7, 7, 7, 2, 14, 14, 14, 2, 14, 0)


def test_logger_block_takes_the_number_of_its_packet(tmp_path: Path) -> None:
    run = read_smart_run(written(tmp_path, BLOCKS))
    assert run.samples.block.tolist() == [0, 0, 0, 7, 7, 7, 7, 14, 14, 14, 14, 14, 14, 0]


def test_program_is_the_approach_and_the_turning_spindle(tmp_path: Path) -> None:
    run = read_smart_run(written(tmp_path, BLOCKS))
    assert np.flatnonzero(run.is_program).tolist() == list(range(3, 13))


def test_powers_are_watts_and_rounding_is_known(tmp_path: Path) -> None:
    run = read_smart_run(written(tmp_path, BLOCKS))
    assert run.power[Component.SPINDLE][0] == pytest.approx(170.0)
    np.testing.assert_allclose(run.samples.half_step[0, :2], [0.5, 0.05])
    assert run.samples.is_rapid[4]
    assert not run.samples.is_rapid[8]


def test_missing_column_is_named(tmp_path: Path) -> None:
    with pytest.raises(CalibrationError, match="S1_OutputPower: missing"):
        read_smart_run(written(tmp_path, BLOCKS, missing="S1_OutputPower"))


needs_data = pytest.mark.skipif(
    not (umich.DATA / "train.csv").exists(), reason=f"no data in {umich.DATA}"
)


@pytest.fixture(scope="module")
def mill() -> umich.Mill:
    feeds = umich.read_feeds(umich.DATA)
    chosen = umich.calibration_runs(feeds)
    return umich.calibrate({name: feeds[name] for name in chosen}, umich.DATA)


@needs_data
def test_four_runs_of_four_feeds_are_fitted(mill: umich.Mill) -> None:
    assert mill.runs == ("experiment_01", "experiment_05", "experiment_09", "experiment_11")


@needs_data
def test_held_out_cycle_times_are_within_one_per_cent(mill: umich.Mill) -> None:
    feeds = umich.read_feeds(umich.DATA)
    held_out = [name for name in feeds if name not in mill.runs]
    assert len(held_out) == 5
    runs = [umich.predict(mill, name, feeds[name], umich.DATA) for name in held_out]
    assert max(abs(run.time_error) for run in runs) < 0.01
    # What the axes draw follows the feed, which the mean power of other runs cannot know; the
    # spindle turns at one speed, and differs from run to run by more than anything here tells.
    for part, bound in ((Component.X, 0.03), (Component.Y, 0.12), (Component.SPINDLE, 0.06)):
        assert max(abs(run.skills[part].energy_error) for run in runs) < bound
    for part in (Component.X, Component.Y):
        errors = [abs(run.skills[part].energy_error) for run in runs]
        baseline = [abs(run.skills[part].baseline_energy_error) for run in runs]
        assert sum(errors) < 0.1 * sum(baseline)


@needs_data
def test_what_the_mill_does_not_tell_is_named(mill: umich.Mill) -> None:
    lost = {
        str(each.parameter) for each in mill.calibration.estimates if not each.is_identified
    }
    assert {"base power", "coolant power", "factor on specific cutting force"} <= lost


def test_bench_says_that_it_has_no_data(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    umich.main(["--data", str(tmp_path)])
    assert "skipped: no data" in capsys.readouterr().out
