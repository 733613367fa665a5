"""``taptest``: from a measured response to the modes of a machine file."""

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import stepnc
from extras.calibration.verbs.taptest.result import TapTestResult
from service.cli.main import main
from simulator.files.machine_file import machine_toml
from simulator.library import load_machine
from simulator.spec import ModeDirection, VibratingPart, VibrationMode
from stepnc_model.errors import StepNcError
from tests.every_case import every_case

OK, USAGE, BAD_INPUT = 0, 2, 3


@pytest.fixture
def response(tmp_path: Path) -> Path:
    """One mode: 922 Hz, ζ 0.03, 12 N/µm."""
    frequency = np.arange(10.0, 3_000.0, 5.0)
    ratio = frequency / 922.0
    give = 1e3 / 12_000.0 / (1.0 - ratio**2 + 0.06j * ratio)
    rows = [f"{f:g},{g.real:.8g},{g.imag:.8g}" for f, g in zip(frequency, give, strict=True)]
    path = tmp_path / "tap.csv"
    path.write_text("\n".join(["frequency_hz,real_um_n,imag_um_n", *rows]), encoding="utf-8")
    return path


def tapped(response: Path, **changes: Any) -> TapTestResult:
    return stepnc.taptest(response, **{"direction": "x", "tool": "MILL"} | changes)


def test_the_mode_is_found_and_named(response: Path) -> None:
    (mode,) = tapped(response).modes
    assert mode == VibrationMode(
        part=VibratingPart.TOOL,
        tool="MILL",
        direction=ModeDirection.X,
        natural_frequency=922.0,
        damping_ratio=0.03,
        stiffness=12_000.0,
        source="tap test tap.csv",
    )


def test_a_machine_file_keeps_what_was_measured_elsewhere(
    response: Path, tmp_path: Path
) -> None:
    (mode,) = tapped(response).modes
    other = replace(mode, tool="DRILL")
    along_y = replace(mode, direction=ModeDirection.Y, natural_frequency=800.0)
    old = replace(mode, natural_frequency=700.0)
    machine = replace(load_machine("vmc15"), modes=(other, along_y, old))
    mine = tmp_path / "mine.toml"
    mine.write_text(machine_toml(machine), encoding="utf-8")
    tapped(response, machine=mine, output=mine)
    assert load_machine(str(mine)).modes == (other, along_y, mode)


def test_a_round_tool_that_is_tapped_again_along_x_keeps_its_y(
    response: Path, tmp_path: Path
) -> None:
    (mode,) = tapped(response).modes
    old = replace(mode, direction=ModeDirection.XY, natural_frequency=700.0)
    mine = tmp_path / "mine.toml"
    mine.write_text(
        machine_toml(replace(load_machine("vmc15"), modes=(old,))), encoding="utf-8"
    )
    tapped(response, machine=mine, output=mine)
    assert load_machine(str(mine)).modes == (replace(old, direction=ModeDirection.Y), mode)


def test_a_workpiece_belongs_to_no_tool(response: Path) -> None:
    (mode,) = tapped(response, tool="", workpiece=True, source="by hand").modes
    assert (mode.part, mode.tool, mode.source) == (VibratingPart.WORKPIECE, "", "by hand")


@every_case(
    ("changes", "message"),
    [
        ({"tool": ""}, "what was tapped"),
        ({"workpiece": True}, "what was tapped"),
        ({"direction": "w"}, "direction 'w'"),
        ({"tool_diameter_mm": -1.0}, "tool diameter -1 mm: it must be 0.01 to 2000 mm"),
        ({"modes": 0}, "modes 0: it must be 1"),
        ({"modes": 4}, "1 peaks found"),
        ({"machine": "vmc15"}, "name a file with -o"),
        ({"output": Path("mine.toml")}, "name the machine with --machine"),
    ],
)
def test_what_cannot_be_done_is_told(
    changes: dict[str, Any], message: str, response: Path
) -> None:
    with pytest.raises(StepNcError, match=message):
        tapped(response, **changes)


def test_another_unit_is_noticed(response: Path) -> None:
    text = response.read_text().replace("real_um_n,imag_um_n", "real_m_n,imag_m_n")
    response.write_text(text)
    with pytest.raises(
        StepNcError, match=r"stiffness: 1\.2e-05 N/µm is below .*check the unit"
    ):
        tapped(response)


def test_modes_that_explain_little_are_doubted(response: Path) -> None:
    lines = response.read_text().splitlines()
    random = np.random.default_rng(2)
    noisy = [lines[0]]
    for line in lines[1:]:
        f, real, imag = map(float, line.split(","))
        noisy.append(f"{f},{real + 0.3 * random.normal()},{imag + 0.03 * random.normal()}")
    response.write_text("\n".join(noisy))
    (finding,) = tapped(response, modes=1).findings
    assert "of the response unexplained" in finding.message


def test_the_command_prints_tables_that_a_machine_file_takes(
    response: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["taptest", str(response), "--direction", "xy", "--tool", "MILL"]
    with pytest.raises(SystemExit) as stopped:
        main(words)
    assert stopped.value.code == OK
    printed = capsys.readouterr().out
    tables = printed[printed.index("[[mode]]") :]
    mine = tmp_path / "mine.toml"
    mine.write_text(machine_toml(load_machine("vmc15")) + tables, encoding="utf-8")
    (mode,) = load_machine(str(mine)).modes
    assert (mode.direction, mode.natural_frequency) == (ModeDirection.XY, 922.0)


def test_json_has_the_units_of_the_machine_file(
    response: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["taptest", str(response), "--direction", "x", "--tool-diameter-mm", "12", "--json"]
    with pytest.raises(SystemExit) as stopped:
        main(words)
    assert stopped.value.code == OK
    found = json.loads(capsys.readouterr().out)
    (mode,) = found["modes"]
    assert mode["stiffness_n_um"] == 12.0
    assert (mode["tool"], mode["tool_diameter_mm"]) == (None, 12.0)
    assert found["residual"] < 1e-3


def test_the_command_tells_a_bad_file_without_a_traceback(
    response: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    response.write_text("x,y\n1,2\n")
    with pytest.raises(SystemExit) as stopped:
        main(["taptest", str(response), "--direction", "x", "--tool", "MILL"])
    assert stopped.value.code == BAD_INPUT
    assert "error: " in capsys.readouterr().err
    with pytest.raises(SystemExit) as stopped:
        main(["taptest", str(response)])
    assert stopped.value.code == USAGE
