"""The command ``cycletime``: predicted beside logged, and the modified program."""

import logging
import re
from dataclasses import replace
from math import cos, pi, sin
from pathlib import Path

import numpy as np
import pytest

import stepnc
from service.requests.runs import SimulationRequest
from service.simulation.code_simulation import CodeRequest
from service.simulation.run import RunFiles, simulate
from service.verbs.call import call, verbs
from simulator.files.machine_file import machine_toml
from simulator.library import load_machine
from simulator.machine.block_times import LossCause
from stepnc_model.errors import StepNcError
from tests.every_case import every_case

PARTS = Path(__file__).parents[4] / "examples" / "parts"
COUNT, SPACING = 1000, 0.1


def code(folder: Path) -> Path:
    """A straight of short lines at 6000 mm/min, which 4.2 ms a block do not allow."""
    path = folder / "part.ngc"
    lines = [f"G1 X{SPACING * (row + 1):.4f} F6000" for row in range(COUNT)]
    path.write_text("\n".join(["G21 G90", "G0 X0 Y0 Z0", *lines, "M2"]), encoding="utf-8")
    return path


def test_short_blocks_lose_time_and_a_hint_says_what_helps(tmp_path: Path) -> None:
    result = stepnc.cycletime(code(tmp_path), machine="vmc15")
    assert result.total.programmed == pytest.approx(COUNT * SPACING / 100.0)
    assert result.total.by_rate == pytest.approx(COUNT * 0.0042)
    assert result.total.predicted == pytest.approx(COUNT * 0.0042, rel=0.05)
    worst = result.stretches[0]
    assert worst.cause is LossCause.BLOCK_RATE
    assert worst.spacing == pytest.approx(SPACING)
    assert "points 0.42 mm apart would give it back" in result.hints[0]


def test_the_modified_program_has_reachable_feeds_and_takes_as_long(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    part, modified = code(tmp_path), tmp_path / "modified.ngc"
    with caplog.at_level(logging.INFO, logger="stepnc"):
        result = stepnc.cycletime(part, machine="vmc15", output=modified)
    told = caplog.messages
    assert "F1428" in modified.read_text()
    assert told[-1].endswith(f"feed lowered in {COUNT} blocks)")
    again = stepnc.cycletime(modified, machine="vmc15")
    assert again.total.programmed == pytest.approx(result.total.by_rate, rel=1e-3)
    assert again.total.predicted == pytest.approx(result.total.predicted, rel=0.01)


def test_the_modified_program_of_a_step_nc_part_has_reachable_feeds(tmp_path: Path) -> None:
    machine, modified = tmp_path / "slow.toml", tmp_path / "modified.ngc"
    slow = replace(load_machine("vmc15"), block_time=0.5, block_time_source="")
    machine.write_text(machine_toml(slow), encoding="utf-8")
    part = PARTS / "paper003_pocket.stpnc"
    result = stepnc.cycletime(part, machine=str(machine), output=modified)
    assert result.total.by_rate > 1.05 * result.total.programmed
    again = stepnc.cycletime(modified, machine=str(machine))
    assert again.total.programmed == pytest.approx(result.total.by_rate, rel=1e-3)


def test_a_log_of_the_same_machine_agrees_by_workingstep_and_tool(tmp_path: Path) -> None:
    log = tmp_path / "run.parquet"
    part = PARTS / "paper003_case1.stpnc"
    simulate(
        SimulationRequest(machine="paper003", rate_hz=20.0),
        RunFiles(file=part, output=log),
    )
    result = stepnc.cycletime(part, machine="paper003", log=str(log))
    assert result.total.actual == pytest.approx(result.total.predicted, abs=0.1)
    for row in result.rows:
        assert row.actual == pytest.approx(row.predicted, abs=0.15)
    assert sum(row.predicted for row in result.rows) == pytest.approx(result.total.predicted)


def test_nc_code_of_a_lathe_and_a_log_without_names(tmp_path: Path) -> None:
    part, log = code(tmp_path), tmp_path / "run.csv"
    simulate(
        SimulationRequest(machine="vmc15", rate_hz=50.0),
        RunFiles(code=CodeRequest(code=part), output=log),
    )
    result = stepnc.cycletime(part, machine="vmc15", log=str(log))
    assert result.total.actual == pytest.approx(result.total.predicted, rel=0.01)


def test_code_of_another_cam_keeps_all_but_its_feeds(tmp_path: Path) -> None:
    """Short chords of an arc, as Klartext with comments and a blank form."""
    turn = np.linspace(0.0, pi, 200)
    feeds = ["", " F6000", *[""] * 198]
    lines = [
        f"L X{-20.0 * cos(t):+.3f} Y{20.0 * sin(t):+.3f}{feed} ; {t:.2f}"
        for t, feed in zip(turn, feeds, strict=True)
    ]
    head = [
        "BEGIN PGM ARC MM",
        "BLK FORM 0.1 Z X-50. Y-30. Z-20.",
        "BLK FORM 0.2 X+50. Y+30. Z+1.",
    ]
    head += ["TOOL CALL 1 Z S3000", "L X-20. Y+0. R0 FMAX M3", "L Z+5. FMAX", "L Z-1. F400"]
    text = "\n".join(f"{n} {line}" for n, line in enumerate([*head, *lines, "END PGM ARC MM"]))
    part, output = tmp_path / "arc.h", tmp_path / "modified.h"
    part.write_text(text + "\n", encoding="ascii")
    before = stepnc.cycletime(part, machine="vmc15", output=output)
    assert before.total.predicted > before.total.programmed + 0.2
    old, new = (re.sub(r" F[0-9.]+", "", each.read_text("ascii")) for each in (part, output))
    assert new == old
    after = stepnc.cycletime(output, machine="vmc15")
    assert after.total.predicted == pytest.approx(before.total.predicted, rel=0.01)
    assert after.total.programmed == pytest.approx(after.total.predicted, rel=0.03)


def test_doubts_are_told(tmp_path: Path) -> None:
    plain = tmp_path / "plain.toml"
    machine = replace(load_machine("vmc15"), block_time=None, block_time_source="")
    plain.write_text(machine_toml(machine), encoding="utf-8")
    log = tmp_path / "other.csv"
    log.write_text(
        "time_s,x_axis_position_actual,z_axis_position_actual,workingstep\n0,1,2,A\n1,1,2,A\n",
        encoding="utf-8",
    )
    part = PARTS / "paper003_case1.stpnc"
    found = stepnc.cycletime(part, machine=plain, log=log)
    told = [each.message for each in found.findings]
    assert "has no block_time_s" in told[0]
    assert told[1].startswith("the log is of another program: it has workingsteps A,")


@every_case(
    ("change", "message"),
    [
        ({"machine": ""}, "--machine"),
        ({"file": Path("none.ngc")}, "none.ngc"),
        ({"machine": "paper002"}, "no data for its axes"),
        ({"log": "none.csv"}, "no such file"),
    ],
)
def test_bad_input_is_told(tmp_path: Path, change: dict[str, object], message: str) -> None:
    given = {"file": code(tmp_path), "machine": "vmc15", **change}
    with pytest.raises(StepNcError, match=message):
        call(verbs()["cycletime"], [], given)


def test_a_move_without_a_feed_is_left_out_and_told(tmp_path: Path) -> None:
    path = tmp_path / "bad.ngc"
    path.write_text("G21 G90\nG0 X0 Y0 Z0\nG95 G1 X10 F0.1\nM2\n", encoding="utf-8")
    found = stepnc.cycletime(path, machine="vmc15")
    assert "line 3 left out of the run: a feed per revolution" in "".join(
        map(str, found.findings)
    )
