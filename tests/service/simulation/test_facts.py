"""Rows follow one another without a gap, and add up to the whole."""

from dataclasses import replace

import pytest

from service.simulation.facts import COMPONENTS, exceeded, ratio, rows
from service.simulation.run import Simulation
from simulator.machine.totals import Total


def test_each_row_begins_where_the_one_before_ends(simulation: Simulation) -> None:
    found = rows(simulation)
    assert [row.begin for row in found] == [0.0, 1.0, 61.0]
    assert [row.id for row in found] == [None, simulation.totals[1][0], "FINISH"]
    last = found[-1]
    assert last.begin + last.total.duration == simulation.whole.duration


def test_what_takes_no_time_before_the_first_has_no_row(simulation: Simulation) -> None:
    bare = replace(simulation, totals=(("", Total()), *simulation.totals[1:]))
    assert [row.begin for row in rows(bare)] == [0.0, 60.0]


def test_components_add_up(simulation: Simulation) -> None:
    energy = simulation.whole.energy
    assert sum(getattr(energy, name) for name in COMPONENTS) == pytest.approx(energy.total)


def test_times_add_up(simulation: Simulation) -> None:
    whole = simulation.whole
    parts = whole.cutting_time + whole.air_time + whole.rapid_time + whole.waiting_time
    assert parts == pytest.approx(whole.duration)


def test_only_what_is_above_a_limit_is_said(simulation: Simulation) -> None:
    (sentence,) = exceeded(simulation, rows(simulation))
    assert sentence.startswith(f"{simulation.totals[1][0]}: 2.5 s above ")
    strong = replace(simulation, machine=replace(simulation.machine, max_cutting_force=800.0))
    assert "permitted force of 800 N" in exceeded(strong, rows(strong))[0]


def test_nothing_has_a_ratio_of_0() -> None:
    assert ratio(1.0, 0.0) == 0.0
