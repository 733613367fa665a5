"""Plans for least cost: rates of the machine file, edge lives, and what is written."""

import json
from pathlib import Path

import pytest

import stepnc
from service.cli.main import main
from simulator.library import load_machine
from simulator.machine_file import machine_toml, read_machine

SHAFT = "examples/parts/shaft.stpnc"
WORDS = ("--machine", "lathe22", "--free", "feed,depth,speed", "--dry-run")


def test_least_cost_is_cheaper_than_least_time() -> None:
    plans = [
        stepnc.optimise(
            SHAFT, mode=mode, machine="lathe22", free=("feed", "depth", "speed"), dry_run=True
        ).plan
        for mode in ("TC", "CC")
    ]
    time, money = plans
    assert sum(each.after.money for each in money.advices if each.after) < sum(
        each.after.money for each in time.advices if each.after
    )
    assert money.time_after > time.time_after


def test_plan_prints_cost_lives_and_what_is_left_out(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert main(["optimise", SHAFT, "--mode", "CC", *WORDS]) == 0
    text = capsys.readouterr().out
    assert "EUR of machine time and worn edges" in text
    assert "left out: set-up, programming, material" in text
    assert "edge lives used" in text


def test_machine_without_rates_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    words = ["optimise", "examples/parts/paper002.stpnc", "--mode", "CC", "--machine"]
    assert main([*words, "paper002", "--dry-run"]) != 0
    assert "machine paper002 has no [cost] table" in capsys.readouterr().err


def test_rates_of_a_machine_read_back(tmp_path: Path) -> None:
    machine = load_machine("vmc15")
    place = tmp_path / "vmc15.toml"
    place.write_text(machine_toml(machine), encoding="utf-8")
    assert read_machine(place).costs == machine.costs


def test_json_has_cost_and_lives(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["optimise", SHAFT, "--mode", "TC", *WORDS, "--json"]) == 0
    steps = json.loads(capsys.readouterr().out)["workingsteps"]
    assert all(step["cost"] > 0.0 and step["tool_lives_used"] > 0.0 for step in steps)
