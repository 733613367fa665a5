"""Tables on a terminal: data to stdout, colours only where they are wanted."""

import re
from dataclasses import replace
from pathlib import Path

import pytest

from service.cli.commands import print_result
from service.verbs.optimise import program as advising
from simulator.files.machine_file import machine_toml
from simulator.library import load_machine
from simulator.spec import ModeDirection, VibratingPart, VibrationMode
from tests.asking import asked_advice

PARTS = Path(__file__).parents[4] / "examples" / "parts"
ESCAPE = "\x1b"


def test_a_plan_shows_both_feeds_and_the_limit_that_binds(
    capsys: pytest.CaptureFixture[str],
) -> None:
    request = asked_advice(file=PARTS / "paper002.stpnc", machine="paper002", dry_run=True)
    print_result(advising.advise_program(*request))
    shown, told = capsys.readouterr()
    assert "123.8 -> 290.0" in shown
    assert "618.9" in shown
    assert "motor power 0.29 kW reaches its bound of 0.29 kW" in shown
    assert not told


def test_columns_of_a_plan_are_aligned(capsys: pytest.CaptureFixture[str]) -> None:
    request = asked_advice(file=PARTS / "bracket.stpnc", dry_run=True)
    print_result(advising.advise_program(*request))
    lines = capsys.readouterr().out.splitlines()
    header = next(line for line in lines if line.startswith("workingstep"))
    rule = lines[lines.index(header) + 1]
    assert set(rule) == {"-", " "}
    for name in ("operation", "tool", "rpm"):
        assert rule[header.index(name) - 1 : header.index(name) + 1] == " -"


MODE = VibrationMode(
    part=VibratingPart.TOOL,
    tool="END MILL 20MM",
    direction=ModeDirection.XY,
    natural_frequency=1_150.0,
    damping_ratio=0.03,
    stiffness=5_000.0,
    source="tap test",
)


def test_a_plan_tells_what_is_stable_or_why_that_is_not_asked(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    machine = tmp_path / "tapped.toml"
    text = machine_toml(replace(load_machine("vmc15"), modes=(MODE,)))
    machine.write_text(text, encoding="utf-8")
    request = asked_advice(
        file=PARTS / "bracket.stpnc",
        machine=str(machine),
        material="al7075",
        free="feed,depth,speed",
        workingsteps=("ROUGH CONTOUR", "FINISH CONTOUR", "MILL SLOT"),
        dry_run=True,
    )
    print_result(advising.advise_program(*request))
    lines = capsys.readouterr().out.splitlines()
    (bounded,) = (line for line in lines if line.startswith("  ROUGH CONTOUR: "))
    (thin,) = (line for line in lines if line.startswith("  FINISH CONTOUR: "))
    (unknown,) = (line for line in lines if line.startswith("  MILL SLOT: "))
    assert re.search(
        r"; stable to \S+ mm at this speed, \S+ mm at any \(1 measured mode\)", bounded
    )
    assert re.search(r"stability not bounded: a_e/D \S+ is below 0\.1, where the zero", thin)
    assert "stab" not in unknown
    notes = [line for line in lines if "no modes are measured" in line]
    assert len(notes) == 1
    assert "'END MILL 12MM'" in notes[0]
