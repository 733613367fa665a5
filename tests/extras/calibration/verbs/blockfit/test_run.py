"""``blockfit``: from tables, runs of the virtual machine and its agent."""

import logging
from dataclasses import replace
from pathlib import Path

import pyarrow as pa
import pytest
from pyarrow import csv

import stepnc
from extras.calibration.model.block_fit import FeedCause
from service.requests.runs import SimulationRequest
from service.simulation.code_simulation import CodeRequest
from service.simulation.run import RunFiles, simulate
from simulator.files.machine_file import machine_toml
from simulator.library import load_machine
from simulator.motion.model_name import ControlModelName
from stepnc_model.errors import StepNcError
from tests.every_case import every_case

TABLE_2 = (
    "spacing_in,feed_in_min\n0.0001,0.7\n0.00025,3.6\n0.0005,7.2\n0.00075,10.5\n0.001,14.6\n"
    "0.0025,35.6\n0.005,71.2\n0.0075,106.7\n0.01,147.68\n"
)
BLOCK_TIME = 0.0063


def test_paper_s_table_gives_its_fits(tmp_path: Path) -> None:
    log = tmp_path / "table.csv"
    log.write_text(TABLE_2, encoding="utf-8")
    fit = stepnc.blockfit(log).fit
    assert [round(60.0 * each.slope.value) for each in fit.fits[:2]] == [14_516, 14_600]


def test_millimetres_are_read_as_inches_are(tmp_path: Path) -> None:
    log = tmp_path / "table.csv"
    log.write_text(
        "spacing_mm;feed_mm_min;radius_mm\n0,1;1500;25\n0,2;3000;25\n0,4;6000;25\n",
        encoding="utf-8",
    )
    fit = stepnc.blockfit(log).fit
    assert fit.block_time.value == pytest.approx(0.004)
    assert fit.points[0].radius == 25.0


def hidden(folder: Path, name: str = "vmc15") -> Path:
    """The library's machine with another block time, as a file."""
    path = folder / "hidden.toml"
    machine = replace(load_machine(name), block_time=BLOCK_TIME)
    path.write_text(machine_toml(machine), encoding="utf-8")
    return path


def run(
    folder: Path,
    program: str,
    *,
    machine: str = "vmc15",
    control: ControlModelName = ControlModelName.FIR,
    rate: float = 50.0,
) -> tuple[Path, Path]:
    """Test program and its log on a machine with a hidden block time."""
    code, log = folder / program, folder / "log.csv"
    stepnc.blocktest(
        output=code, machine=machine, unit="mm", spacing=(0.03, 0.1, 0.3),
        radius=(20.0, 40.0), lines=400,
    )  # fmt: skip
    simulate(
        SimulationRequest(machine=str(hidden(folder, machine)), rate_hz=rate, control=control),
        RunFiles(code=CodeRequest(code=code), output=log),
    )
    return code, log


@pytest.mark.parametrize("control", [ControlModelName.FIR, ControlModelName.JUNCTION])
@pytest.mark.parametrize(("program", "machine"), [("a.ngc", "vmc15"), ("a.nc", "lathe22")])
def test_the_block_time_of_a_hidden_machine_is_found(
    tmp_path: Path, program: str, machine: str, control: ControlModelName
) -> None:
    code, log = run(tmp_path, program, machine=machine, control=control)
    output = tmp_path / "found.toml"
    result = stepnc.blockfit(log, program=code, machine=machine, output=output)
    assert result.findings == ()
    assert set(result.fit.causes) == {FeedCause.BLOCK_RATE}
    assert result.fit.block_time.value == pytest.approx(BLOCK_TIME, rel=0.01)
    found = load_machine(str(output))
    assert found.block_time == pytest.approx(BLOCK_TIME, rel=0.01)
    assert found.block_time_source.startswith("stepnc blockfit of log.csv: 6 points")
    assert found.source == load_machine(machine).source


def test_the_zero_of_machine_coordinates_is_searched_and_told(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    code, log = run(tmp_path, "a.ngc")
    _moved(log, scale=1.0, shift={"x": 312.5, "y": -40.0, "z": 88.25})
    with caplog.at_level(logging.INFO, logger="stepnc"):
        result = stepnc.blockfit(log, program=code)
    assert caplog.messages == ["zero of the program found at 312.500, -40.000, 88.250 mm"]
    assert result.findings == ()
    assert result.fit.block_time.value == pytest.approx(BLOCK_TIME, rel=0.01)


def _moved(log: Path, *, scale: float, shift: dict[str, float]) -> None:
    """Write a log with positions in another unit or from another zero."""
    table = csv.read_csv(log).to_pydict()
    for axis, by in shift.items():
        name = f"{axis}_axis_position_actual"
        table[name] = [scale * each + by for each in table[name]]
    csv.write_csv(pa.table(table), log)


def test_another_zero_and_inches_are_told(tmp_path: Path) -> None:
    code, log = run(tmp_path, "a.ngc")
    with pytest.raises(StepNcError, match=r"none of the 6 circles .* where is its zero"):
        stepnc.blockfit(log, program=code, zero="100,0,0")
    _moved(log, scale=1.0 / 25.4, shift={"x": 0.0, "y": 0.0, "z": 0.0})
    with pytest.raises(StepNcError, match="its positions are in inches"):
        stepnc.blockfit(log, program=code)


def failed(folder: Path, text: str, **rest: object) -> None:
    log = folder / "log.csv"
    log.write_text(text, encoding="utf-8")
    stepnc.blockfit(log, **rest)  # type: ignore[arg-type]


@every_case(
    ("text", "rest", "message"),
    [
        ("spacing_in,feed_in_min\n0.1,0\n", {}, "row 2: feed_in_min 0: expected 1e-06"),
        ("spacing_in,feed_in_min\n0.1,\n", {}, "feed_in_min empty"),
        ("spacing_in,feed\n0.1,1\n", {}, "no column feed_in_min"),
        ("spacing_in,feed_in_min\n0.1,1\n", {}, "1 different spacings"),
        ("time_s\n0\n", {}, "test program"),
        (TABLE_2, {"machine": "vmc15"}, "name a file with -o"),
        (TABLE_2, {"output": Path("x.toml")}, "name the machine"),
        (TABLE_2.replace("_in", "_mm"), {"machine": "no", "output": Path("x.toml")}, "no"),
    ],
)
def test_bad_input_is_told(
    tmp_path: Path, text: str, rest: dict[str, object], message: str
) -> None:
    with pytest.raises(StepNcError, match=message):
        failed(tmp_path, text, **rest)


def test_a_program_without_circles_is_told(tmp_path: Path) -> None:
    code = tmp_path / "a.ngc"
    code.write_text("G21\nG0 X0 Z0\nG1 X1 F100\nM2\n", encoding="utf-8")
    with pytest.raises(StepNcError, match="no circles of short lines"):
        failed(tmp_path, "time_s\n0\n", program=code)
