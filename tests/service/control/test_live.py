"""A program under control, piece by piece: the same run, and one that can be changed."""

from collections.abc import Callable
from math import inf, nan
from pathlib import Path

import pytest
from pyarrow import parquet

from controller.monitoring import monitor
from controller.orders import Criterion, EventKind, LoopEvent
from service.control.facts import exceeded, rows
from service.control.holding import OFF
from service.control.live import LiveControl
from service.control.run import control, prepare
from service.live.runner import RunUpdate
from service.requests.runs import ControlChanges
from stepnc_model.errors import StepNcError
from tests.asking import AskedControl

Controlled = Callable[..., AskedControl]

IN_CUT = 7.5
"""s, when the slot is being cut"""


def begun(request: AskedControl, *, until: float = IN_CUT) -> LiveControl:
    live = LiveControl(prepare(*request))
    assert live.advance(until)
    return live


def through(live: LiveControl) -> RunUpdate:
    while live.advance(live.time + 1.0):
        pass
    return live.taken()


def test_after_the_end_nothing_moves(controlled: Controlled) -> None:
    """The last row is a rapid: its feed was shown for good."""
    live = begun(controlled())
    assert live.status().feed_actual_mm_min > 0.0
    through(live)
    status = live.status()
    assert status.is_done
    assert (status.feed_actual_mm_min, status.feed_programmed_mm_min) == (0.0, 0.0)
    assert (status.power_kw, status.removal_rate_cm3_min) == (0.0, 0.0)
    assert status.force_measured is None
    assert status.over_set_point_percent is None


def test_a_force_above_its_set_point_is_told_with_number_and_time(
    controlled: Controlled, monkeypatch: pytest.MonkeyPatch
) -> None:
    """At 109 % for minutes the sign was a green SAFE. The slot lasts less than 3 s."""
    monkeypatch.setattr(monitor, "LASTS", 0.5)
    live = begun(controlled(law="none", disturbances=("kc:1.6",)), until=2.0)
    told = []
    while live.advance(live.time + 0.1):
        status = live.status()
        if status.over_set_point_percent is not None:
            told.append((status.over_set_point_percent, status.over_set_point_s, status.level))
    assert told
    assert {level for _, _, level in told} == {"over"}
    assert all(percent > 105.0 and seconds >= 0.5 for percent, seconds, _ in told)
    run = live.finish()
    assert any(
        "without a break above the set point" in each for each in exceeded(run, rows(run))
    )


@pytest.mark.parametrize("piece", [0.3, inf])
def test_in_pieces_it_is_the_same_run(
    controlled: Controlled, tmp_path: Path, piece: float
) -> None:
    words = ("hardness:+40%@7.5s", "mode:QC@8s")
    once, live_file = tmp_path / "once.parquet", tmp_path / "live.parquet"
    whole = control(*controlled(disturbances=words, output=once))
    live = LiveControl(prepare(*controlled(disturbances=words, output=live_file)))
    rows = 0
    events: list[LoopEvent] = []
    while True:
        goes_on = live.advance(live.time + piece)
        taken = live.taken()
        rows += len(taken.moments)
        events += taken.events
        if not goes_on:
            break
    found = live.finish()
    rows += len(live.taken().moments)
    assert live_file.read_bytes() == once.read_bytes()
    assert rows == found.samples == whole.samples
    assert tuple(events) == found.events == whole.events
    assert found.time == whole.time
    assert live.status().is_done
    assert live.status().progress == pytest.approx(1.0)


def test_a_run_that_is_not_done_is_left_as_partial(
    controlled: Controlled, tmp_path: Path
) -> None:
    live = begun(controlled(output=tmp_path / "run.parquet"))
    found = live.finish()
    assert [each.name for each in tmp_path.iterdir()] == ["run.partial.parquet"]
    table = parquet.read_table(tmp_path / "run.partial.parquet")
    assert table.num_rows == found.samples
    assert found.time == pytest.approx(IN_CUT, abs=0.3)


def test_the_status_is_that_of_the_cut(controlled: Controlled) -> None:
    live = begun(controlled())
    status = live.status()
    assert status.workingstep == "MILL SLOT"
    assert 0.0 < status.progress < 1.0
    assert status.feed_programmed_mm_min == pytest.approx(600.0)
    assert status.feed_advised_mm_min == pytest.approx(6.0 * status.override_percent)
    assert status.feed_actual_mm_min == pytest.approx(status.feed_advised_mm_min, rel=0.1)
    assert status.force_measured is not None
    assert status.force_expected == pytest.approx(status.force_measured, rel=0.1)
    assert status.set_point is not None
    assert status.axial_depth_mm == pytest.approx(2.0)
    # 2 mm deep and 8 mm wide.
    assert status.removal_rate_cm3_min == pytest.approx(
        0.016 * status.feed_actual_mm_min, rel=0.05
    )
    # 15 kW from 1500 to 8000 rpm.
    assert status.motor_power_kw == pytest.approx(15.0)
    assert 0.0 < status.power_kw < 15.0
    assert (status.is_overloaded, status.is_stopped, status.is_done) == (False, False, False)
    assert (status.criterion, status.is_on) == (Criterion.TC, True)
    assert status.holding
    assert status.level == "safe"


def test_before_it_begins_nothing_is_known(controlled: Controlled) -> None:
    status = LiveControl(prepare(*controlled())).status()
    assert (status.time, status.workingstep, status.force_measured) == (0.0, "", None)
    assert status.power_kw == 0.0


def test_a_spindle_that_stands_has_no_power(controlled: Controlled) -> None:
    live = LiveControl(prepare(*controlled()))
    live.advance(0.1)
    assert live.status().motor_power_kw is None
    assert not live.status().is_overloaded


@pytest.mark.parametrize(
    ("changes", "factor"),
    [
        (ControlChanges(depth_percent=130.0), 1.3),
        (ControlChanges(hardness_percent=80.0), 0.8),
        # k_c1.1 of an aluminium over that of the program's steel is about a half.
        (ControlChanges(material="al7075"), None),
    ],
)
def test_what_the_loop_is_not_told_it_finds_by_the_force(
    controlled: Controlled, changes: ControlChanges, factor: float | None
) -> None:
    live = begun(controlled(law="none"))
    before = live.status().force_measured
    live.taken()
    live.change(changes)
    live.advance(live.time + 0.5)
    status = live.status()
    assert before is not None
    assert status.force_measured is not None
    ratio = status.force_measured / before
    assert ratio == pytest.approx(factor, rel=0.05) if factor else 0.3 < ratio < 0.8
    assert status.force_expected == pytest.approx(before, rel=0.1)
    first = live.taken().events[0]
    assert first.kind is EventKind.ORDER
    assert first.time == pytest.approx(IN_CUT, abs=0.1)


def test_hardness_and_material_go_together(controlled: Controlled) -> None:
    live = begun(controlled(law="none"))
    own = live.session.plan.material.material.name
    before = live.status().force_measured
    live.change(ControlChanges(hardness_percent=120.0))
    live.change(ControlChanges(material=own))
    live.advance(live.time + 0.5)
    after = live.status().force_measured
    assert before is not None
    assert after == pytest.approx(1.2 * before, rel=0.05)


def test_what_the_operator_switches_is_obeyed(controlled: Controlled) -> None:
    live = begun(controlled(set_point=300.0))
    live.change(ControlChanges(mode=Criterion.QC, is_on=False, motor_power_percent=50.0))
    live.advance(live.time + 0.5)
    status = live.status()
    assert (status.criterion, status.is_on) == (Criterion.QC, False)
    assert status.holding == OFF
    assert status.override_percent == 100.0
    assert status.motor_power_kw == pytest.approx(7.5)
    texts = [event.text for event in live.taken().events]
    assert {"mode QC", "OFF: the programmed feed runs", "motor power 50 %"} <= set(texts)


def test_a_held_feed_stands_until_it_is_resumed(controlled: Controlled) -> None:
    live = begun(controlled())
    live.taken()
    live.change(ControlChanges(is_held=True))
    live.advance(live.time + 2.0)
    share = live.status().progress
    live.advance(live.time + 30.0)
    held = live.status()
    assert (held.is_held, held.override_percent) == (True, 0.0)
    assert held.feed_actual_mm_min == pytest.approx(0.0, abs=1e-6)
    assert held.holding == "held by the operator"
    assert held.progress == pytest.approx(share, abs=1e-6)
    assert not held.is_stopped
    assert {live.is_waiting} == {True}
    live.change(ControlChanges(is_held=False))
    live.advance(live.time + 0.5)
    assert live.status().progress > share
    assert {live.is_waiting} == {False}
    through(live)
    assert live.status().is_done
    assert not live.status().is_stopped
    assert live.status().remaining_s == pytest.approx(0.0, abs=1e-6)


def test_the_operator_lowers_the_override_but_never_raises_it_above_the_guard(
    controlled: Controlled,
) -> None:
    live = begun(controlled())
    free = live.status().override_percent
    live.change(ControlChanges(override_most_percent=10.0))
    live.advance(live.time + 0.5)
    assert live.status().override_percent == pytest.approx(10.0)
    assert live.status().holding == "the operator"
    # Below the floor of the band, the operator is the reason: the loop does not give up.
    live.advance(live.time + 1.0)
    assert not live.status().is_stopped
    live.change(ControlChanges(override_most_percent=120.0))
    live.advance(live.time + 0.5)
    assert live.status().override_percent <= free * 1.05
    with pytest.raises(StepNcError, match="200 %: the guard allows at most 120 %"):
        live.change(ControlChanges(override_most_percent=200.0))


def test_off_the_feed_can_still_be_held_and_lowered(controlled: Controlled) -> None:
    live = begun(controlled(law="none"))
    live.change(ControlChanges(override_most_percent=50.0))
    live.advance(live.time + 0.3)
    assert live.status().override_percent == pytest.approx(50.0)
    live.change(ControlChanges(is_held=True))
    live.advance(live.time + 1.0)
    assert live.status().feed_actual_mm_min < 0.01


def test_a_drive_that_draws_too_much_is_told(controlled: Controlled) -> None:
    live = begun(controlled(law="none"))
    live.change(ControlChanges(motor_power_percent=1.0))
    live.advance(live.time + 0.5)
    assert live.status().is_overloaded
    through(live)
    assert not live.status().is_overloaded


def test_changes_stand_in_the_rows(controlled: Controlled) -> None:
    live = begun(controlled())
    live.taken()
    live.change(ControlChanges(depth_percent=150.0))
    live.advance(live.time + 0.2)
    told = [row.event for row in live.taken().moments if row.event]
    assert "order: depth 150 % of the programmed depth" in told[0]


def test_a_lost_machine_ends_the_run(controlled: Controlled) -> None:
    live = LiveControl(prepare(*controlled(disturbances=("line:off@8s",))))
    taken = through(live)
    assert taken.events[-1].kind is EventKind.LOST
    assert live.status().is_stopped
    assert live.finish().is_stopped


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"depth_percent": 0.0}, "depth 0 %: it must be above 0 to 1000 %"),
        ({"hardness_percent": 2000.0}, "hardness 2000 %: it must be above 0 to 1000 %"),
        ({"motor_power_percent": nan}, "motor power nan %: it must be above 0 to 1000 %"),
        ({"material": "butter"}, "unknown material 'butter'; known: "),
        ({"material": "/etc/passwd.toml"}, "unknown material '/etc/passwd.toml'; known: "),
    ],
)
def test_what_cannot_be_is_refused_and_changes_nothing(
    controlled: Controlled, changes: dict[str, object], message: str
) -> None:
    live = begun(controlled())
    live.taken()
    with pytest.raises(StepNcError) as caught:
        live.change(ControlChanges(**{"is_on": False, **changes}))  # type: ignore[arg-type]
    assert message in str(caught.value)
    live.advance(live.time + 0.1)
    assert live.status().is_on


@pytest.mark.parametrize("order", [{"mode": "EC"}, {"speed": 1.0}, {"is_on": "perhaps"}])
def test_an_order_that_is_none_is_refused(
    controlled: Controlled, order: dict[str, object]
) -> None:
    live = begun(controlled())
    with pytest.raises(StepNcError, match=next(iter(order))):
        live.obey(order)
    live.obey({"is_on": False})
    assert live.snapshot()["inputs"]["is_on"]
    live.advance(live.time + 0.1)
    assert not live.snapshot()["inputs"]["is_on"]
