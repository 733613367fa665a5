"""One set-up: the machine in the run's time, and what the loop is not told."""

import pytest

from controller.laws.choice import LawName
from controller.orders import EventKind
from service.control.holding import OFF, PROGRAMMED
from service.live.runner import Moment
from service.trial.inputs import Inputs, changed
from service.trial.run import TrialSetup

INPUTS = Inputs()


def begun(rows: list[Moment], inputs: Inputs = INPUTS, *, begin: float = 100.0) -> TrialSetup:
    return TrialSetup(inputs, begin=begin, seed=1, law=LawName.LOG_PI, sink=rows.append)


def run(set_up: TrialSetup, seconds: float) -> list[EventKind]:
    end = set_up.time + seconds
    kinds: list[EventKind] = []
    while set_up.time < end:
        kinds += [event.kind for event in set_up.cycle().events]
    return kinds


def test_time_is_that_of_the_run() -> None:
    rows: list[Moment] = []
    set_up = begun(rows)
    assert set_up.time == 100.0
    assert run(set_up, 3.0) == [EventKind.WORKINGSTEP]
    assert rows[0].time == pytest.approx(100.0, abs=0.1)
    assert rows[-1].time == pytest.approx(103.0, abs=0.1)
    assert {row.workingstep for row in rows} == {"trial cut"}


def test_power_is_that_of_the_motor() -> None:
    rows: list[Moment] = []
    set_up = begun(rows)
    run(set_up, 4.0)
    last = rows[-1]
    assert last.spindle_power_true * 0.9 == pytest.approx(
        last.force_true * 220.0 / 60.0, rel=1e-3
    )
    assert last.spindle_power == pytest.approx(last.spindle_power_true, rel=0.03)
    set_up.change(changed(INPUTS, efficiency=0.6))
    run(set_up, 4.0)
    assert rows[-1].spindle_power_true == pytest.approx(1.5 * last.spindle_power_true, rel=0.02)


def test_depth_and_material_are_hidden_from_the_loop() -> None:
    rows: list[Moment] = []
    set_up = begun(rows)
    run(set_up, 4.0)
    expected = rows[-1].force_expected
    set_up.change(changed(INPUTS, axial_depth_mm=3.0))
    assert EventKind.HARDNESS in run(set_up, 4.0)
    assert rows[-1].force_expected == pytest.approx(expected, rel=0.02)
    assert rows[-1].force_ratio == pytest.approx(1.5, rel=0.03)
    assert rows[-1].axial_depth == pytest.approx(3.0)
    set_up.change(changed(INPUTS, axial_depth_mm=3.0, material="al7075"))
    run(set_up, 4.0)
    # Kienzle at h_m = 0.1273 mm: 800·h^−0.25 over 1500·h^−0.22.
    assert rows[-1].force_ratio == pytest.approx(1.5 * 800 / 1500 * 0.1273**-0.03, rel=0.03)


def test_what_holds_the_feed_is_told_in_words() -> None:
    rows: list[Moment] = []
    set_up = begun(rows)
    words = []
    for changes in ({}, {"axial_depth_mm": 4.0}, {"is_on": False}, {"mode": "QC"}):
        set_up.change(changed(INPUTS, **changes))
        kinds = run(set_up, 4.0)
        assert EventKind.ORDER not in kinds
        words.append(set_up.holdings.words)
    assert words == ["chip load", "motor power", OFF, PROGRAMMED]


def test_of_two_changes_before_a_cycle_the_last_one_counts() -> None:
    rows: list[Moment] = []
    set_up = begun(rows)
    run(set_up, 3.0)
    other = {"axial_depth_mm": 4.0, "mode": "QC", "is_on": False, "motor_power_kw": 1.0}
    set_up.change(changed(INPUTS, material="al7075", **other))
    set_up.change(INPUTS)
    run(set_up, 2.0)
    assert rows[-1].axial_depth == 2.0
    assert rows[-1].force_ratio == pytest.approx(1.0, abs=0.03)
    assert set_up.loop.state.settings.is_on
    assert set_up.loop.state.settings.criterion is INPUTS.mode
    assert set_up.loop.state.settings.power_factor == 1.0
