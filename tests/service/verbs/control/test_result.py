"""The printed table has what a person looks for, and cannot steer a terminal."""

import re
from dataclasses import replace

import pytest

from controller.orders import EventKind, LoopEvent
from controller.record import RunRecord
from service.cli.commands import print_result
from service.control.run import ControlRun
from service.verbs.control.result import ControlResult


def printed(run: ControlRun, capsys: pytest.CaptureFixture[str]) -> list[str]:
    print_result(ControlResult(run=run))
    return capsys.readouterr().out.splitlines()


def test_a_row_has_programmed_and_actual(
    control_run: ControlRun, capsys: pytest.CaptureFixture[str]
) -> None:
    lines = printed(control_run, capsys)
    slot = next(line for line in lines if line.startswith("MILL SLOT"))
    total = next(line for line in lines if line.startswith("total"))
    number = r"\d+\.\d"
    assert re.match(rf"MILL SLOT +{number} -> {number} +{number} ", slot)
    assert f"-> {control_run.time:.1f}" in total
    assert re.search(r" \d+ \(\d+–\d+\) +\d+, hardest \d+ +\d+\.\d [a-z ]+ +0\.\d\d ", slot)
    assert re.search(r" 1\.\d{3} ± 0\.\d{3}  0\.00 ± 0\.0\d$", slot)


def test_reasons_events_and_disturbances_follow(
    control_run: ControlRun, capsys: pytest.CaptureFixture[str]
) -> None:
    text = "\n".join(printed(control_run, capsys))
    assert "  MILL SLOT: override " in text
    assert "events: " in text
    assert "disturbed: hardness:+40%@7.5s, kc:1.1, mode:QC@900s (the run ended before)" in text


def test_a_failure_stands_out(
    control_run: ControlRun, capsys: pytest.CaptureFixture[str]
) -> None:
    stop = LoopEvent(time=7.5, kind=EventKind.STOP, text="a tooth is broken")
    lines = printed(replace(control_run, events=(stop,)), capsys)
    assert "limit exceeded: stopped at 7.50 s: a tooth is broken" in lines


def test_a_workingstep_without_chips_has_no_figures_of_the_cut(
    control_run: ControlRun, capsys: pytest.CaptureFixture[str]
) -> None:
    advice, record = control_run.steps[-1]
    idle = RunRecord(workingstep=record.workingstep, time=3.0)
    held = {number: replace(each, seconds={}) for number, each in control_run.held.items()}
    lines = printed(replace(control_run, steps=((advice, idle),), held=held), capsys)
    assert re.match(r"MILL SLOT +\d+\.\d -> 3\.0 +0\.0$", lines[3])
    assert "  MILL SLOT: no chips: nothing to control" in lines


def test_control_characters_are_not_printed(
    control_run: ControlRun, capsys: pytest.CaptureFixture[str]
) -> None:
    evil = replace(control_run, plan=replace(control_run.plan, program="\x1b[2J"))
    assert "\x1b" not in "\n".join(printed(evil, capsys))
