"""Logs that cannot be read say where and why; those that can lack values are completed."""

from pathlib import Path

import numpy as np
import pytest

from extras.verification.log import LogFile, ProgramNames, thinned
from simulator.library import load_machine
from stepnc_model.errors import StepNcError
from tests.every_case import every_case

HEAD = "time_s,x_axis_position_actual,y_axis_position_actual,z_axis_position_actual"
NAMES = ProgramNames(
    workingsteps={"A": 0, "B": 1}, tool_of={0: 3, 1: 4}, tools=frozenset({3, 4})
)
ONE = ProgramNames(workingsteps={"A": 0}, tool_of={0: 3}, tools=frozenset({3}))


def log_of(folder: Path, text: str, names: ProgramNames = ONE) -> LogFile:
    path = folder / "log.csv"
    path.write_text(text, encoding="utf-8")
    return LogFile(path=path, names=names)


@every_case(
    ("text", "message"),
    [
        (f"{HEAD}\n", "no rows"),
        ("time_s,x_axis_position_actual\n0,1\n", "no column y_axis_position_actual"),
        (f"{HEAD}\n0,1,1,1\n2,1,1,1\n1,1,1,1\n", r"row 3: time 1 s: it must not be before 2 s"),
        (f"{HEAD}\n0,1,1,\n1,1,1,\n", "z_axis_position_actual has no values"),
        (f"{HEAD}\n0,1,one,1\n", "cannot be read"),
    ],
)
def test_a_bad_log_is_refused(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(StepNcError, match=message):
        list(log_of(tmp_path, text).pieces())


def test_a_log_that_does_not_show_tool_changes_is_refused(tmp_path: Path) -> None:
    with pytest.raises(StepNcError, match="there are 2 tools"):
        log_of(tmp_path, f"{HEAD}\n0,1,1,1\n", NAMES)


def test_a_file_of_another_kind_is_refused(tmp_path: Path) -> None:
    with pytest.raises(StepNcError, match="expected positions in a file of"):
        LogFile(path=tmp_path / "log.txt", names=ONE)


def test_axes_stamped_separately_are_interpolated(tmp_path: Path) -> None:
    rows = ("0,0,0,5", "1,,2,", "2,4,,5", "3,,6,", "4,8,8,5")
    file = log_of(tmp_path, "\n".join((HEAD, *rows)))
    (samples,) = file.pieces()
    assert samples.position[:, 0].tolist() == [0.0, 2.0, 4.0, 6.0, 8.0]
    assert samples.position[:, 1].tolist() == [0.0, 2.0, 4.0, 6.0, 8.0]
    assert file.unknown == 3


def test_tools_follow_from_workingsteps(tmp_path: Path) -> None:
    rows = ("0,0,0,5,", "1,1,2,5,A", "1,2,2,5,B")
    file = log_of(tmp_path, "\n".join((f"{HEAD},workingstep", *rows)), NAMES)
    (samples,) = file.pieces()
    assert samples.tool.tolist() == [0, 3, 4]
    assert samples.workingstep.tolist() == [-1, 0, 1]
    assert file.equal_times == 1


def test_the_zero_is_taken_off(tmp_path: Path) -> None:
    file = log_of(tmp_path, f"{HEAD}\n0,1,2,3\n1,2,2,3\n")
    file.zero = (1.0, 2.0, -3.0)
    (samples,) = file.pieces()
    assert samples.position[0].tolist() == [0.0, 0.0, 6.0]


def test_a_survey_is_bounded_and_spread(tmp_path: Path) -> None:
    rows = "\n".join(f"{row},{row},0,0" for row in range(5000))
    parts = thinned(log_of(tmp_path, f"{HEAD}\n{rows}").pieces(), most=10_000)
    assert all(part.base is None for part in parts), "a view keeps its whole piece"
    kept = np.concatenate(thinned(log_of(tmp_path, f"{HEAD}\n{rows}").pieces(), most=100))
    assert 50 <= len(kept) <= 100
    assert np.ptp(kept[:, 0]) > 4800.0


def test_programs_are_counted_by_the_states_of_execution(tmp_path: Path) -> None:
    words = ("READY", "ACTIVE", "PROGRAM_COMPLETED", "PROGRAM_COMPLETED", "ACTIVE", "WAIT", "")
    rows = "\n".join(f"{row},{row},0,0,{word}" for row, word in enumerate(words))
    file = log_of(tmp_path, f"{HEAD},execution\n{rows}\n")
    list(file.pieces())
    assert (file.completed, file.is_running) == (1, False)
    path = tmp_path / "log.csv"
    path.write_text(path.read_text("utf-8") + "9,9,0,0,ACTIVE\n", encoding="utf-8")
    list(file.pieces())
    assert (file.completed, file.is_running) == (1, True)


def test_a_lathe_without_y_stays_in_its_plane(tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    path.write_text(f"{HEAD.replace('y_axis_position_actual,', '')}\n0,1,3\n1,2,3\n", "utf-8")
    file = LogFile(path=path, names=ONE, machine=load_machine("lathe22"))
    (samples,) = file.pieces()
    assert samples.position.tolist() == [[1.0, 0.0, 3.0], [2.0, 0.0, 3.0]]


WORK = ",path_position_x,path_position_y,path_position_z"


def test_work_coordinates_of_the_log_are_used(tmp_path: Path) -> None:
    file = log_of(tmp_path, f"{HEAD}{WORK}\n0,301,202,403,1,2,3\n1,302,202,403,2,2,3\n")
    (samples,) = file.pieces()
    assert samples.position.tolist() == [[1.0, 2.0, 3.0], [2.0, 2.0, 3.0]]
    assert "PATH_POSITION" in file.zero_source
    given = LogFile(path=file.path, names=ONE, zero=(300.0, 200.0, 400.0), is_zero_stated=True)
    (samples,) = given.pieces()
    assert samples.position.tolist() == [[1.0, 2.0, 3.0], [2.0, 2.0, 3.0]]
    assert given.zero_source == ""


def test_work_coordinates_without_values_are_not_used(tmp_path: Path) -> None:
    (samples,) = log_of(tmp_path, f"{HEAD}{WORK}\n0,1,2,3,,,\n1,2,2,3,,,\n").pieces()
    assert samples.position[0].tolist() == [1.0, 2.0, 3.0]


def test_offsets_of_the_log_are_taken_off(tmp_path: Path) -> None:
    more = ",work_offset_x_mm,work_offset_y_mm,work_offset_z_mm,tool_length_offset_mm"
    rows = "0,1,2,3,100,0,-300,50\n1,2,2,3,101,0,-300,60\n"
    file = log_of(tmp_path, f"{HEAD}{more}\n{rows}")
    (samples,) = file.pieces()
    assert samples.position.tolist() == [[-99.0, 2.0, 253.0], [-99.0, 2.0, 243.0]]
    assert "work_offset_x_mm, _y_mm, _z_mm and tool_length_offset_mm" in file.zero_source


def test_work_offsets_are_noted_in_their_order(tmp_path: Path) -> None:
    rows = "\n".join(
        f"{row},{row},0,0,{name}" for row, name in enumerate(("", "1", "1", "2", "1"))
    )
    file = log_of(tmp_path, f"{HEAD},work_offset\n{rows}\n")
    list(file.pieces())
    assert file.work_offsets == ["1", "2", "1"]
