"""The printed table adds up, and what a file says cannot steer a terminal."""

from dataclasses import replace

import pytest

from service.cli.commands import print_result
from service.simulation.facts import WORLD, CarbonFactor
from service.simulation.run import Simulation
from service.verbs.simulate.result import SimulateResult
from simulator.machine.totals import Total


def printed(
    simulation: Simulation,
    capsys: pytest.CaptureFixture[str],
    carbon: CarbonFactor = WORLD,
) -> list[str]:
    print_result(SimulateResult(simulation=simulation, carbon=carbon))
    return capsys.readouterr().out.splitlines()


def test_columns_add_up_to_the_last_row(
    simulation: Simulation, capsys: pytest.CaptureFixture[str]
) -> None:
    lines = printed(simulation, capsys)
    numbers = [[float(word) for word in line.split()[-10:]] for line in lines[4:8]]
    for place in (0, 1, 2, 3, 4, 5, 9):
        column = [line[place] for line in numbers]
        assert sum(column[:-1]) == pytest.approx(column[-1], abs=0.2)
    assert numbers[-1][6:9] == [4.5, 950.0, 23.4]


def test_shares_and_carbon_are_said(
    simulation: Simulation, capsys: pytest.CaptureFixture[str]
) -> None:
    text = "\n".join(
        printed(simulation, capsys, carbon=CarbonFactor(grams_per_kwh=36.0, source="our roof"))
    )
    assert "energy 0.08661 kWh: X axis 0.4%, Y axis 0.3%, Z axis 0.1%, spindle 44.9%" in text
    assert "carbon 3.118 g CO₂ at 36 g/kWh (our roof)" in text


def test_limits_and_findings_follow(
    simulation: Simulation, capsys: pytest.CaptureFixture[str]
) -> None:
    lines = printed(simulation, capsys)
    assert sum(line.startswith("limit exceeded: <script>") for line in lines) == 1
    assert lines[-1] == "warning: line 7: spares <b>no</b> tool"


def test_control_characters_of_a_name_are_not_printed(
    simulation: Simulation, capsys: pytest.CaptureFixture[str]
) -> None:
    evil = replace(simulation, program="\x1b[2J", totals=(("", Total()), ("\x1b]0;", Total())))
    assert "\x1b" not in "\n".join(printed(evil, capsys))
