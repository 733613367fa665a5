"""Plans for least cost: rates of the machine file, edge lives, and what is written."""

import json
from pathlib import Path

import pytest

from optimiser.modes import Free, Mode
from service.cli.main import main
from service.requests.advice import AdviceRequest
from service.verbs.optimise.program import advise_program
from service.verbs.optimise.request import AdviceFiles
from simulator.files.machine_file import machine_toml, read_machine
from simulator.library import load_machine

SHAFT = "examples/parts/shaft.stpnc"
WORDS = ("--machine", "lathe22", "--free", "feed,depth,speed", "--dry-run")


def run(mode: str, *more: str) -> None:
    with pytest.raises(SystemExit) as end:
        main(["optimise", SHAFT, "--mode", mode, *WORDS, *more])
    assert end.value.code in {0, None}


@pytest.mark.slow
def test_least_cost_is_cheaper_than_least_time() -> None:
    plans = [
        advise_program(
            AdviceRequest(mode=mode, machine="lathe22", free=tuple(Free)),
            AdviceFiles(file=Path(SHAFT), dry_run=True),
        ).plan
        for mode in (Mode.TC, Mode.CC)
    ]
    time, money = plans
    cost, of_time = (
        sum(each.after.money or 0.0 for each in plan.advices if each.after)
        for plan in (money, time)
    )
    assert 0.0 < cost < of_time
    assert money.time_after > time.time_after


@pytest.mark.slow
def test_plan_prints_cost_lives_and_what_is_left_out(
    capsys: pytest.CaptureFixture[str],
) -> None:
    run("CC")
    text = capsys.readouterr().out
    assert "EUR of machine time and worn edges" in text
    assert "left out: set-up, programming, material" in text
    assert "edge lives used" in text


def test_machine_without_rates_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    words = ["optimise", "examples/parts/paper002.stpnc", "--mode", "CC", "--machine"]
    with pytest.raises(SystemExit) as stopped:
        main([*words, "paper002", "--dry-run"])
    assert stopped.value.code not in {0, None}
    assert "machine paper002 has no [cost] table" in capsys.readouterr().err


def test_rates_of_a_machine_read_back(tmp_path: Path) -> None:
    machine = load_machine("vmc15")
    place = tmp_path / "vmc15.toml"
    place.write_text(machine_toml(machine), encoding="utf-8")
    assert read_machine(place).costs == machine.costs


@pytest.mark.slow
def test_json_has_cost_and_lives(capsys: pytest.CaptureFixture[str]) -> None:
    run("TC", "--json")
    steps = json.loads(capsys.readouterr().out)["workingsteps"]
    advised = [step for step in steps if step["advised"]]
    assert advised
    assert all(step["cost"] > 0.0 and step["tool_lives_used"] > 0.0 for step in advised)
