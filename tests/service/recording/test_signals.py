"""Signals of recorded runs."""

from pathlib import Path

import numpy as np
import pytest

from service.recording.table import read_signals
from stepnc_model.errors import StepNcError
from tests.every_case import every_case

HEAD = "time_s,x_axis_position_actual,path_feedrate_actual,cutting_force,execution\n"


def written(folder: Path, text: str) -> Path:
    file = folder / "run.csv"
    file.write_text(text, encoding="utf-8")
    return file


def test_a_run_reaches_from_its_start_to_its_completion(tmp_path: Path) -> None:
    rows = (
        "0,0,0,0,READY", "1,1,0,0,WAIT", "2,2,10,nan,ACTIVE", "3,3,10,50,FEED_HOLD",
        "4,4,0,60,PROGRAM_COMPLETED", "5,5,0,0,READY", "6,6,0,0,ACTIVE",
    )  # fmt: skip
    found = read_signals(written(tmp_path, HEAD + "\n".join(rows)))
    assert found.time.tolist() == [1.0, 2.0, 3.0, 4.0]
    assert found.position[:, 0].tolist() == [1.0, 2.0, 3.0, 4.0]
    assert np.isnan(found.position[:, 1:]).all()
    assert np.isnan(found.power).all()
    assert np.isnan(found.force[1])
    assert found.force[2:].tolist() == [50.0, 60.0]


def test_without_execution_all_rows_are_the_run(tmp_path: Path) -> None:
    text = (
        "time_s;z_axis_position_actual;path_feedrate_actual;spindle_power\n0,5;1;2;3\n1;1;2;4\n"
    )
    found = read_signals(written(tmp_path, text))
    assert found.time.tolist() == [0.5, 1.0]
    assert found.power.tolist() == [3.0, 4.0]


@every_case(
    ("text", "message"),
    [
        ("x\n1\n", "no column time_s"),
        ("time_s,cutting_force,path_feedrate_actual\n1,2,3\n", "x_axis_position_actual or y_"),
        (HEAD.replace("cutting_force", "smell"), "no column cutting_force or force_measured"),
        (HEAD.replace("path_feedrate_actual", "smell"), "no column path_feedrate_actual"),
        (
            HEAD + "0,0,0,0,ACTIVE\n2,0,0,0,ACTIVE\n1,0,0,0,ACTIVE\n",
            "row 3: time 1 s: it must not be before 2 s",
        ),
    ],
)
def test_a_file_that_cannot_be_evaluated_is_refused(
    tmp_path: Path, text: str, message: str
) -> None:
    with pytest.raises(StepNcError, match=message):
        read_signals(written(tmp_path, text))


def test_another_kind_of_file_is_refused(tmp_path: Path) -> None:
    with pytest.raises(StepNcError, match=r"expected a \.parquet or \.csv file"):
        read_signals(tmp_path / "run.xml")
