"""What the paper's simulator shows in its Fig. 9, by the real loop on the virtual machine."""

from dataclasses import dataclass
from math import isnan
from statistics import fmean
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from controller.laws.choice import LawName
from controller.orders import Criterion, EventKind, LoopEvent
from service.control.holding import OFF
from service.live.runner import Moment
from service.trial.inputs import FIELDS, InputField, Inputs, MillingType, changed
from service.trial.run import SET_UP, TrialRun
from stepnc_model.errors import StepNcError
from tests.service.trial.test_cut import PAPER

SETTLED = 6.0
"""s after which a change is over, its level told as safe again"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Steady:
    """Means over the last second, as a reader of the plots of Fig. 9 sees them."""

    force: float
    chip_load: float
    removal_rate: float
    power_kw: float


def change(run: TrialRun, **changes: Any) -> None:
    run.change(changed(run.inputs, **changes))


def steady(run: TrialRun, **changes: Any) -> Steady:
    """Change something, and look when it is over."""
    change(run, **changes)
    assert run.advance(run.time + SETTLED)
    rows = [row for row in run.taken().moments if row.time > run.time - 1.0]
    inputs = run.inputs
    spindle = inputs.cutting_speed_m_min / 0.06 / (3.14159265 * inputs.tool_diameter_mm)
    return Steady(
        force=fmean(row.force_measured for row in rows if not isnan(row.force_measured)),
        chip_load=fmean(row.feed_actual for row in rows) / (inputs.teeth * spindle),
        removal_rate=fmean(row.removal_rate for row in rows),
        power_kw=fmean(row.spindle_power_true for row in rows) / 1000.0,
    )


@pytest.fixture
def run() -> TrialRun:
    return TrialRun(Inputs())


def test_the_default_is_safe_and_bounded_by_the_chip_load(run: TrialRun) -> None:
    now = steady(run)
    status = run.status()
    assert now.chip_load == pytest.approx(0.2, rel=1e-3)
    assert (status.holding, status.is_overloaded, status.level) == (
        "chip load",
        False,
        "safe",
    )
    assert status.override_percent == pytest.approx(100.0)
    assert status.motor_power_kw is not None
    assert status.power_kw < 0.7 * status.motor_power_kw


def test_a_depth_that_doubles_is_over_for_a_moment_and_then_safe(run: TrialRun) -> None:
    before = steady(run)
    change(run, axial_depth_mm=4.0)
    run.advance(run.time + 0.3)
    jumped = run.taken()
    assert max(row.force_measured for row in jumped.moments) > 1.8 * before.force
    assert run.status().is_overloaded
    run.advance(run.time + SETTLED)
    status, settled = run.status(), run.taken()
    assert not status.is_overloaded
    assert status.power_kw == pytest.approx(status.motor_power_kw, rel=0.03)
    assert status.feed_per_tooth_mm < 0.75 * 0.2
    assert status.holding == "motor power"
    events = (*jumped.events, *settled.events)
    lamp = [event for event in events if event.text.startswith("power limit")]
    assert [event.kind for event in lamp] == [EventKind.OVER, EventKind.SAFE]
    assert [event.kind for event in events if event not in lamp] == [
        EventKind.ORDER,
        EventKind.WARNING,
        EventKind.HARDNESS,
        EventKind.OVER,
        EventKind.SAFE,
    ]
    assert [event.text for event in jumped.events[:2]] == [
        "depth 2 -> 4 mm",
        "depth 4 mm exceeds allowed 3 mm",
    ]


def test_a_smaller_depth_raises_the_chip_load_at_the_same_force(run: TrialRun) -> None:
    """Points 1 to 2."""
    deep = steady(run, axial_depth_mm=6.0)
    less = steady(run, axial_depth_mm=5.0)
    assert less.chip_load > 1.15 * deep.chip_load
    assert less.force == pytest.approx(deep.force, rel=0.02)
    assert less.power_kw == pytest.approx(7.5, rel=0.02)


def test_a_stronger_motor_raises_force_chip_load_and_removal(run: TrialRun) -> None:
    """Points 3 to 4: the paper says that they fall, which eqs. (4) to (6) forbid."""
    weak = steady(run, axial_depth_mm=6.0)
    strong = steady(run, motor_power_kw=9.0)
    assert strong.force == pytest.approx(1.2 * weak.force, rel=0.02)
    assert strong.chip_load > 1.2 * weak.chip_load
    assert strong.removal_rate > 1.2 * weak.removal_rate


def test_aluminium_raises_chip_load_and_removal_at_the_same_force(run: TrialRun) -> None:
    """Points 5 to 6."""
    steel = steady(run, axial_depth_mm=10.0)
    aluminium = steady(run, material="al7075")
    assert aluminium.chip_load > 1.5 * steel.chip_load
    assert aluminium.removal_rate > 1.5 * steel.removal_rate
    assert aluminium.force == pytest.approx(steel.force, rel=0.02)


def test_quality_keeps_the_chip_load_whatever_is_cut(run: TrialRun) -> None:
    """Points 7 to 9; the paper says that the removal rate stays, which is depth times feed."""
    aluminium = steady(run, mode="QC", material="al7075")
    steel = steady(run, material="c45")
    deeper = steady(run, axial_depth_mm=3.0)
    for now in (aluminium, steel, deeper):
        assert now.chip_load == pytest.approx(0.2, rel=1e-3)
    assert steel.force > 1.5 * aluminium.force
    assert steel.removal_rate == pytest.approx(aluminium.removal_rate, rel=1e-3)
    assert deeper.force == pytest.approx(1.5 * steel.force, rel=0.02)
    assert deeper.removal_rate == pytest.approx(1.5 * steel.removal_rate, rel=1e-3)


def test_quality_does_not_heed_the_motor_s_power_while_it_suffices(run: TrialRun) -> None:
    """Points 9 to 10; a motor that is too weak is still not overloaded."""
    usual = steady(run, mode="QC")
    for power in (5.5, 30.0):
        now = steady(run, motor_power_kw=power)
        assert now.chip_load == pytest.approx(usual.chip_load, rel=1e-3)
        assert now.removal_rate == pytest.approx(usual.removal_rate, rel=1e-3)
        assert now.force == pytest.approx(usual.force, rel=0.02)
    weak = steady(run, motor_power_kw=3.0)
    assert weak.power_kw == pytest.approx(3.0, rel=0.03)
    assert weak.chip_load < 0.6 * usual.chip_load


def test_the_paper_s_worked_case() -> None:
    """0.4685 mm by a motor of 0.29 kW (tests/reference/test_ridwan_2010.py)."""
    run = TrialRun(PAPER)
    run.advance(20.0)
    assert steady(run).chip_load == pytest.approx(0.4685, rel=0.02)
    assert steady(run, axial_depth_mm=2.0).chip_load == pytest.approx(0.5, rel=1e-3)


def test_off_nothing_holds_the_feed(run: TrialRun) -> None:
    now = steady(run, is_on=False, axial_depth_mm=4.0)
    status = run.status()
    assert now.chip_load == pytest.approx(0.2, rel=1e-3)
    assert now.power_kw > 1.2 * 7.5
    assert status.is_overloaded
    assert (status.holding, status.is_on) == (OFF, False)


@pytest.mark.parametrize(
    "changes",
    [{}, {"axial_depth_mm": 5.0}, {"material": "ti6al4v"}, {"material": "paper002"}],
)
def test_what_is_predicted_is_what_is_measured(
    run: TrialRun, changes: dict[str, object]
) -> None:
    run.advance(3.0)
    now, status = steady(run, **changes), run.status()
    assert status.force_predicted == pytest.approx(now.force, rel=0.02)
    assert status.power_predicted_kw == pytest.approx(now.power_kw, rel=0.02)
    assert status.force_measured == pytest.approx(now.force, rel=0.05)
    assert status.removal_rate_cm3_min == pytest.approx(0.06 * now.removal_rate, rel=0.02)
    assert status.chip_thickness_mm == pytest.approx(2.0 / 3.1416 * now.chip_load, rel=0.02)
    assert status.specific_cutting_force is not None


OTHERS: dict[str, object] = {
    "milling_type": "down",
    "material": "st37",
    "tool_diameter_mm": 63.0,
    "teeth": 5,
    "cutting_edge_angle_deg": 45.0,
    "radial_width_mm": 30.0,
    "cutting_speed_m_min": 200.0,
    "efficiency": 0.8,
    "feed_per_tooth_mm": 0.15,
    "axial_depth_mm": 2.5,
    "motor_power_kw": 6.0,
    "axial_depth_max_mm": 5.0,
    "mode": "QC",
    "is_on": False,
}


@pytest.mark.parametrize("name", Inputs.__dataclass_fields__)
def test_every_input_can_be_changed_while_it_runs(run: TrialRun, name: str) -> None:
    run.advance(3.0)
    before = run.taken().moments
    at = run.time
    change(run, **{name: OTHERS[name]})
    assert run.time == at
    assert run.advance(at + SETTLED)
    taken = run.taken()
    assert run.status().inputs == changed(Inputs(), **{name: OTHERS[name]})
    assert taken.events[0].time == at
    assert "->" in taken.events[0].text
    has_entered = any(event.kind is EventKind.WORKINGSTEP for event in taken.events)
    assert has_entered == (name in SET_UP)
    times = [row.time for row in (*before, *taken.moments)]
    assert times == sorted(set(times))
    assert not run.status().is_stopped


def test_another_set_up_knows_the_inputs_as_they_are(run: TrialRun) -> None:
    steady(run, axial_depth_mm=2.8, material="st37")
    change(run, teeth=5)
    run.advance(run.time + SETTLED)
    taken = run.taken()
    assert taken.moments[-1].force_ratio == pytest.approx(1.0, abs=0.05)
    assert EventKind.HARDNESS not in {event.kind for event in taken.events}
    # It came from the air, not from where the last cutter was.
    assert min(row.force_true for row in taken.moments) == 0.0


def test_what_does_not_differ_changes_nothing(run: TrialRun) -> None:
    run.advance(2.0)
    run.taken()
    run.change(run.inputs)
    assert run.taken().events == ()


def test_rows_tell_what_was_changed(run: TrialRun) -> None:
    run.advance(2.0)
    run.taken()
    change(run, axial_depth_mm=4.0)
    run.advance(2.1)
    (row,) = [row for row in run.taken().moments if row.event and "depth" in row.event]
    assert row.event is not None
    assert "order: depth 2 -> 4 mm" in row.event


def test_a_depth_beyond_the_allowed_one_is_told_and_cut() -> None:
    run = TrialRun(Inputs(axial_depth_mm=3.5))
    assert [event.text for event in run.taken().events] == ["depth 3.5 mm exceeds allowed 3 mm"]
    run.advance(3.0)
    assert run.status().depth_warning == "depth 3.5 mm exceeds allowed 3 mm"
    assert run.taken().moments[-1].axial_depth == pytest.approx(3.5)
    change(run, axial_depth_max_mm=4.0)
    assert run.status().depth_warning == ""


def stopped() -> TrialRun:
    """A motor that is far too weak: the loop gives up."""
    run = TrialRun(Inputs(axial_depth_mm=8.0, motor_power_kw=0.2))
    assert not run.advance(60.0)
    return run


def test_a_run_that_is_stopped_stands_until_it_is_begun_anew() -> None:
    run = stopped()
    at, status = run.time, run.status()
    assert status.is_stopped
    assert "times in quick succession" in status.stopped_by
    assert (status.feed_actual_mm_min, status.force_measured, status.is_overloaded) == (
        0.0, None, False,
    )  # fmt: skip
    assert not run.advance(at + 10.0)
    assert run.time == at
    change(run, axial_depth_mm=2.0, motor_power_kw=7.5, teeth=3)
    assert not run.advance(at + 10.0)
    run.taken()
    run.restart()
    assert run.advance(at + SETTLED)
    status = run.status()
    assert not status.is_stopped
    assert status.stopped_by == ""
    assert status.feed_per_tooth_mm == pytest.approx(0.2, rel=1e-3)
    taken = run.taken()
    assert taken.events[0].kind is EventKind.RESUME
    assert taken.moments[0].time > at


def test_before_the_first_cycle_nothing_is_known(run: TrialRun) -> None:
    status = run.status()
    assert (status.time, status.force_measured, status.set_point) == (0.0, None, None)
    assert status.specific_cutting_force is None
    assert status.feed_programmed_mm_min == pytest.approx(1120.0, rel=1e-3)
    assert run.taken().moments == ()


@pytest.mark.parametrize("law", LawName)
def test_every_law_keeps_the_motor_s_power(law: LawName) -> None:
    run = TrialRun(Inputs(axial_depth_mm=4.0), law=law)
    run.advance(8.0)
    most = 1.0 if law is not LawName.NONE else 1.4
    assert run.status().power_kw < 1.05 * most * 7.5


def test_the_seed_makes_the_run() -> None:
    def rows(seed: int) -> list[Moment]:
        run = TrialRun(Inputs(), seed=seed)
        run.advance(2.0)
        change(run, teeth=3)
        run.advance(4.0)
        return list(run.taken().moments)

    assert repr(rows(7)) == repr(rows(7))
    assert repr(rows(7)) != repr(rows(8))


def values(field: InputField) -> st.SearchStrategy[float]:
    if field.is_whole:
        return st.integers(int(field.low), int(field.high))
    return st.floats(field.low, field.high)


CHANGES = st.one_of(
    *(st.tuples(st.just(field.name), values(field)) for field in FIELDS),
    st.tuples(st.just("milling_type"), st.sampled_from(list(MillingType))),
    st.tuples(st.just("material"), st.sampled_from(["c45", "al7075", "ti6al4v", "paper002"])),
    st.tuples(st.just("mode"), st.sampled_from(list(Criterion))),
    st.tuples(st.just("is_on"), st.booleans()),
)


@settings(max_examples=30, deadline=None)
@given(st.lists(CHANGES, max_size=8), st.integers(0, 9))
def test_whatever_is_changed_the_run_holds_its_promises(
    changes: list[tuple[str, Any]], seed: int
) -> None:
    run = TrialRun(Inputs(), seed=seed)
    rows: list[Moment] = []
    events: list[LoopEvent] = []
    for name, value in [("is_on", True), *changes]:
        try:
            change(run, **{name: value})
        except StepNcError:
            # A cutter that is too small for the width or the speed.
            continue
        if not run.advance(run.time + 0.4):
            run.restart()
        status = run.status()
        assert 0.0 <= status.override_percent <= 100.0 + 1e-9
        assert status.feed_per_tooth_mm <= run.inputs.feed_per_tooth_mm * 1.001
        taken = run.taken()
        rows += taken.moments
        events += taken.events
    for times in ([row.time for row in rows], [event.time for event in events]):
        assert times == sorted(times)
    assert len({row.time for row in rows}) == len(rows)
    assert all(0.0 <= row.override_commanded <= 1.0 + 1e-9 for row in rows)
