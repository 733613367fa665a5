"""``stepnc calibrate``: what was put into a run comes back, and rude runs are refused."""

import csv
import json
import re
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

import stepnc
from extras.calibration.model.features import Parameter
from extras.calibration.verbs.calibrate.result import CalibrationResult
from service.cli.main import main
from service.errors import MissingArgument
from service.simulation.code_simulation import CodeRequest
from service.simulation.run import simulate
from simulator.files.machine_file import machine_toml
from simulator.library import load_machine
from simulator.machine.transients import USUAL_DELAY
from stepnc_model.errors import WriteError
from tests.asking import AskedSimulation, asked_simulation
from tests.every_case import every_case

BAD_INPUT, OK = 3, 0
FACTOR = 1.25

CODE = """G17 G21 G40 G49 G54 G80 G90 G94
T1 M6
S3000 M3
M8
G0 X-10 Y10 Z5
Z-2
G1 X60 F600
G0 Z5
S6000
X-10 Y25
Z-1
G1 X60 F900
G0 Z5
M9
S1500
X-10 Y40
Z-3
G1 X60 F400
G0 Z5
Y10 X60
X-10
M30
"""
"""three slots at three speeds, half a minute"""

TABLE = '[[tool]]\nnumber = 1\nkind = "endmill"\ndiameter_mm = 10\nteeth = 4\n'

TRUTH = replace(
    load_machine("vmc15"),
    base_power=1560.0,
    spindle=replace(load_machine("vmc15").spindle, idle_power=350.0, idle_power_per_speed=4.8),
)

Rows = list[list[str]]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Code, tools and the machine as it is."""
    folder = tmp_path_factory.mktemp("shop")
    (folder / "slots.ngc").write_text(CODE, encoding="ascii")
    (folder / "tools.toml").write_text(TABLE, encoding="ascii")
    (folder / "truth.toml").write_text(machine_toml(TRUTH), encoding="utf-8")
    return folder


def asked(folder: Path, machine: str, **more: Any) -> AskedSimulation:
    """The slots on a machine."""
    return asked_simulation(
        code=CodeRequest(
            code=folder / "slots.ngc", tools=folder / "tools.toml", stock="0,0,-20,50,50,0"
        ),
        material="c45",
        machine=machine,
        **more,
    )


def calibrated(
    runs: Sequence[Path], folder: Path, machine: str, output: Path | None = None
) -> CalibrationResult:
    """Calibration to runs of the slots on a machine."""
    result = stepnc.calibrate(
        runs, nc=folder / "slots.ngc", tools=folder / "tools.toml", stock="0,0,-20,50,50,0",
        material="c45", machine=machine, output=output,
    )  # fmt: skip
    assert isinstance(result, CalibrationResult)
    return result


@pytest.fixture(scope="module")
def measured(folder: Path) -> Path:
    """Spindle and total power of the slots, noisy and late."""
    whole = folder / "whole.csv"
    simulate(
        *asked(
            folder, str(folder / "truth.toml"),
            kc_factor=FACTOR, noise="normal", has_lag=True, rate=20.0, seed=3, output=whole,
        )
    )  # fmt: skip
    table = table_of(whole)
    names = ("time_s", "c_axis_wattage", "electric_wattage")
    columns = [table[0].index(name) for name in names]
    path = folder / "run.csv"
    write(path, [[row[column] for column in columns] for row in table])
    return path


def table_of(path: Path) -> Rows:
    """Headings and cells."""
    with path.open(encoding="utf-8", newline="") as stream:
        return list(csv.reader(stream))


def write(path: Path, rows: Rows, *, separator: str = ",") -> Path:
    text = "".join(separator.join(row) + "\n" for row in rows)
    path.write_text(text, encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def found(folder: Path, measured: Path) -> CalibrationResult:
    return calibrated((measured,), folder, "vmc15", folder / "mine.toml")


@pytest.mark.parametrize(
    ("parameter", "truth"),
    [
        (Parameter.BASE, 1560.0),
        (Parameter.COOLANT, 500.0),
        (Parameter.IDLE, 350.0),
        (Parameter.IDLE_PER_SPEED, 4.8),
        (Parameter.INERTIA, 0.02),
        (Parameter.CUTTING, FACTOR),
    ],
)
def test_what_was_put_in_comes_back(
    found: CalibrationResult, parameter: Parameter, truth: float
) -> None:
    (estimate,) = [each for each in found.calibration.estimates if each.parameter is parameter]
    assert estimate.is_identified
    assert estimate.low <= truth <= estimate.high
    assert estimate.value == pytest.approx(truth, rel=0.02)


def test_the_delay_comes_back_though_the_drive_overshoots(found: CalibrationResult) -> None:
    assert found.delay.low <= USUAL_DELAY <= found.delay.high
    assert found.delay.value == pytest.approx(USUAL_DELAY, rel=0.2)


def test_the_file_that_is_written_spends_the_measured_energy(
    found: CalibrationResult, folder: Path, measured: Path
) -> None:
    mine = folder / "mine.toml"
    loaded = load_machine(str(mine))
    assert loaded.base_power == pytest.approx(found.machine.base_power)
    assert "# calibrated on measured runs: run" in mine.read_text(encoding="utf-8")
    again = simulate(*asked(folder, str(mine), kc_factor=FACTOR)).whole
    table = table_of(measured)[1:]
    times, watts = [float(row[0]) for row in table], [float(row[2]) for row in table]
    energy = sum(
        0.5 * (watts[row] + watts[row + 1]) * (times[row + 1] - times[row])
        for row in range(len(times) - 1)
    )
    assert again.energy.total == pytest.approx(energy, rel=0.01)


def test_held_out_beats_the_baseline_and_times_agree(found: CalibrationResult) -> None:
    (held,) = found.held_out
    for skill in held.skills.values():
        assert skill.model_rmse < 0.2 * skill.baseline_rmse
    (time,) = found.times
    assert abs(time.error) < 0.01
    assert found.findings == ()


# ------------------------------------------------------------------ rude runs

Command = Callable[..., tuple[int, str, str]]


@pytest.fixture
def command(folder: Path, capsys: pytest.CaptureFixture[str]) -> Command:
    """Exit code of ``stepnc calibrate``, what it prints and what it tells."""

    def run(*words: object) -> tuple[int, str, str]:
        options = {
            "nc": folder / "slots.ngc",
            "tools": folder / "tools.toml",
            "stock": "0,0,-20,50,50,0",
            "material": "c45",
            "machine": "vmc15",
        }
        known = [f"--{name}={value}" for name, value in options.items()]
        with pytest.raises(SystemExit) as stopped:
            main(["calibrate", *map(str, words), *known])
        out, told = capsys.readouterr()
        assert isinstance(stopped.value.code, int)
        return stopped.value.code, out, told

    return run


def changed(rows: Rows, cell: Callable[[str], str], *, column: int, only: int = -1) -> Rows:
    """A table with cells of a column changed, or only the one of a row."""
    return [
        [
            cell(value) if place == column and row and only in {-1, row} else value
            for place, value in enumerate(values)
        ]
        for row, values in enumerate(rows)
    ]


def scaled(factor: float) -> Callable[[str], str]:
    return lambda cell: f"{float(cell) * factor:.9g}"


REFUSED: dict[str, tuple[Callable[[Rows], Rows], str]] = {
    "header only": (lambda rows: rows[:1], "0 complete samples; at least 10 are required"),
    "empty": (lambda _: [], "0 complete samples; at least 10 are required"),
    "no number": (
        lambda rows: changed(rows, lambda _: "nan", column=2, only=40),
        "line 41: electric_wattage: 'nan' is not a number",
    ),
    "infinite": (
        lambda rows: changed(rows, lambda _: "1e999", column=1, only=40),
        "line 41: c_axis_wattage: '1e999' is not a number",
    ),
    "word": (
        lambda rows: changed(rows, lambda _: "n/a", column=0, only=7),
        "line 8: time_s: 'n/a' is not a number",
    ),
    "reversed": (lambda rows: [rows[0], *rows[:0:-1]], "line 3: time_s: "),
    "twice": (
        lambda rows: [rows[0], *(row for row in rows[1:] for _ in range(2))],
        "line 3: time_s: 0 s after 0 s; time must ascend",
    ),
    "kW": (
        lambda rows: changed(rows, scaled(1e-3), column=2),
        "W, expected 30 to 1e+06 W; is the power in another unit, such as kW?",
    ),
    "another unit of time": (
        lambda rows: changed(rows, scaled(1e6), column=0),
        "time_s: sampling interval 50000 s, expected 1e-05 to 60 s; is the time in another",
    ),
    "constant": (
        lambda rows: changed(
            changed(rows, lambda _: "900", column=1), lambda _: "2000", column=2
        ),
        "c_axis_wattage: constant at 900 W, like all powers",
    ),
    "ragged": (
        lambda rows: [*rows[:50], rows[50][:-1], *rows[51:]],
        "line 51: 2 values in a table with 3 columns",
    ),
    "no time": (
        lambda rows: [row[1:] for row in rows],
        "time_s: column is missing; it must hold the time in s",
    ),
    "no power": (
        lambda rows: [row[:1] for row in rows],
        "no column with a power in W; one of x_axis_wattage",
    ),
}


@every_case("how", REFUSED)
def test_a_run_that_cannot_be_is_refused_in_one_line(
    command: Command, measured: Path, tmp_path: Path, how: str
) -> None:
    spoil, words = REFUSED[how]
    rows = table_of(measured)
    path = write(tmp_path / "rude.csv", spoil(rows))
    output = tmp_path / "mine.toml"
    code, out, told = command(path, "-o", output)
    assert (code, out) == (BAD_INPUT, "")
    (line,) = [line for line in told.splitlines() if line.startswith("error: ")]
    assert line.startswith(f"error: {path}: ")
    assert words in line
    assert not output.exists()


@every_case(
    ("data", "words"),
    [
        (bytes(range(256)), "not a UTF-8 text file"),
        (
            b"time_s,electric_wattage\n" + b"\0" * 300,
            "line 2: 1 values in a table with 2 columns",
        ),
        (b"time_s|electric_wattage\n0|900\n", "time_s: column is missing"),
        (b"time_s;electric_wattage\n0;900\n0,1;900\n0.1;901\n", "line 4: time_s: 0.1 s after"),
        (b'time_s,electric_wattage\n"1,2\n', "line 2: 1 values in a table with 2 columns"),
        (b"time_s,electric_wattage\n" + b"1" * 200_000 + b",3\n", "field larger than field"),
    ],
)
def test_what_is_no_table_of_numbers_is_refused(
    command: Command, tmp_path: Path, data: bytes, words: str
) -> None:
    if data.startswith((b"time_s|", b"time_s;")):
        data += data.splitlines(keepends=True)[-1] * 20
    path = tmp_path / "rude.csv"
    path.write_bytes(data)
    code, out, told = command(path)
    assert (code, out) == (BAD_INPUT, "")
    assert words in told.splitlines()[-1]


def test_files_that_are_none_are_refused(command: Command, tmp_path: Path) -> None:
    missing = tmp_path / "none.csv"
    assert command(missing) == (BAD_INPUT, "", f"error: {missing}: No such file or directory\n")
    assert command(tmp_path) == (
        BAD_INPUT,
        "",
        f"error: {tmp_path}: is a folder, not a regular file\n",
    )
    code, _, told = command("a\0b.csv")
    assert code == BAD_INPUT
    assert "invalid file name" in told


@pytest.mark.parametrize(
    ("output", "words"),
    [
        ("slots.toml/m.toml", "the folder does not exist"),
        ("run.csv", "the name of a machine file must end with .toml"),
        ("tools.toml", "is the same file as"),
        ("truth.toml", "is the same file as"),
    ],
)
def test_an_output_that_cannot_be_is_refused_first(
    folder: Path, measured: Path, output: str, words: str
) -> None:
    before = {path: path.read_bytes() for path in folder.iterdir()}
    machine = str(folder / "truth.toml")
    with pytest.raises(WriteError, match=re.escape(words)):
        calibrated((measured,), folder, machine, folder / output)
    assert {path: path.read_bytes() for path in folder.iterdir()} == before


def test_without_a_run_there_is_nothing_to_do(folder: Path) -> None:
    with pytest.raises(MissingArgument, match="name the measured runs"):
        calibrated((), folder, "vmc15")


def test_a_run_of_something_else_gaps_and_constants_are_said(
    command: Command, measured: Path, tmp_path: Path
) -> None:
    """The first third of the run, with a gap and a total that nobody measured."""
    rows = table_of(measured)[:200]
    rude = changed(rows[:80] + rows[100:], lambda _: "2000", column=2)
    code, out, _ = command(write(tmp_path / "rude.csv", rude), "--json")
    assert code == OK
    wire = json.loads(out)
    said = [finding["message"] for finding in wire["findings"]]
    assert said[0].startswith("gap of 1.05 s, above 0.15 s")
    assert said[1] == "constant at 2000 W; ignored"
    assert re.match(r"measured 9\.9 s, simulated 30\.6 s: differ by more than 5%", said[2])
    (held,) = wire["held_out"]
    assert held["power"] == "c_axis_wattage"
    base = next(each for each in wire["parameters"] if each["parameter"] == "base power")
    assert base["high"] is None
    assert base["reason"] == "no measured power depends on it"
