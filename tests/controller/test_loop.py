from math import inf, nan

import numpy as np
import pytest

from controller.errors import MachineLost
from controller.guard import OverrideBand, OverrideReason
from controller.laws.law import Plant
from controller.orders import Criterion, CriterionTo, EventKind, MotorPowerTo, SwitchTo
from controller.reference import ForceBound, Reference
from controller.signals.ports import Reading
from controller.states.loop_settings import LoopSettings, LoopStep
from optimiser.solver.problem import LimitName
from tests.controller.plugged import (
    PERIOD,
    SET_POINT,
    TEETH,
    Plugged,
    Told,
    Wishing,
    plugged,
    reading,
    step,
)
from tests.every_case import every_case

BLIND = OverrideBand().sensor_timeout
"""s"""


def even(revolutions: int, force: float = 300.0, **more: object) -> list[Reading]:
    return [reading(force, **more)] * (revolutions * TEETH)


def holdings(of: Plugged) -> set[OverrideReason]:
    return {cycle.allowed.holding for cycle in of.cycles}


def test_the_override_is_commanded_each_cycle_and_the_law_asked_each_revolution() -> None:
    law = Wishing(wish=1.1)
    run = plugged(even(10), law=law).run()
    assert run.port.overrides == [cycle.allowed.override for cycle in run.cycles]
    assert len(run.port.overrides) == 10 * TEETH
    assert len(law.told) == 10
    assert run.loop.state.override == 1.1
    assert {each.force for each in law.told} == {300.0}
    assert {each.set_point for each in law.told} == {SET_POINT}


def test_the_law_may_not_raise_the_override_in_the_revolution_in_which_it_enters() -> None:
    run = plugged([*even(3, 0.0), *even(2)], law=Wishing(wish=1.2)).run()
    entry, second = run.cycles[4 * TEETH - 1], run.cycles[5 * TEETH - 1]
    assert (entry.allowed.override, second.allowed.override) == (1.0, 1.2)


def test_what_the_last_revolution_of_a_cut_raised_is_not_kept_in_the_air() -> None:
    law = Wishing(wish=0.6)
    run = plugged([*even(5), *even(1, 20.0), *even(3, 0.0)], law=law)
    run.run(5 * TEETH)
    assert run.loop.state.override == 0.6
    object.__setattr__(law, "wish", 0.7)
    run.run(TEETH)
    assert run.loop.state.override == 0.7
    assert run.run().loop.state.override == 0.6


def test_a_law_is_tuned_for_the_process_and_tuned_once() -> None:
    plants: list[Plant] = []

    def law(plant: Plant) -> Wishing:
        plants.append(plant)
        return Wishing(wish=1.0)

    plugged([*even(3), *even(3, 0.0), *even(3)], law=law).run()
    assert plants == [Plant(exponent=0.8, lag=3.0)]


def test_a_preview_is_told_when_it_is_asked_for() -> None:
    law = Wishing(wish=1.0)
    plugged(even(3), law=law, settings=LoopSettings(look_ahead=5)).run()
    assert law.told[-1].expected == SET_POINT
    assert law.told[-1].ahead == (SET_POINT,) * 5


def test_an_overload_holds_the_feed_within_its_tooth_period() -> None:
    run = plugged([*even(5), reading(601.0)], law=Wishing(wish=1.0)).run()
    assert run.cycles[-1].allowed == run.cycles[-1].allowed._replace(
        override=0.0, holding=OverrideReason.OVERLOAD
    )
    assert run.kinds == [EventKind.WORKINGSTEP, EventKind.HOLD]


def test_a_hold_ends_when_a_whole_revolution_is_below_the_set_point() -> None:
    held = [reading(700.0, override=0.9), reading(300.0, override=0.5)]
    low = [reading(500.0, override=0.4), reading(300.0, override=0.3)]
    run = plugged([*even(5), *held, *low, reading(300.0, override=0.2)]).run()
    assert run.kinds[-2:] == [EventKind.HOLD, EventKind.RESUME]
    # 0.8 times the set point, had it been kept from where the feed was held.
    expected = 0.9 * (0.8 * SET_POINT / 700.0) ** (1.0 / 0.8)
    assert run.loop.state.override == pytest.approx(expected)


def test_a_hold_ends_when_the_axes_stand_whatever_is_read() -> None:
    run = plugged([*even(5), reading(700.0), reading(nan, override=0.5), reading(nan)])
    assert EventKind.RESUME not in run.run().kinds
    standing = plugged([*even(5), reading(700.0), reading(nan, override=0.01)])
    assert EventKind.RESUME in standing.run().kinds


def test_a_hold_goes_on_over_the_end_of_a_workingstep() -> None:
    two = [step(), step()]
    run = plugged([*even(5), reading(700.0), reading(650.0, workingstep=2)], steps=two).run()
    assert run.port.overrides[-2:] == [0.0, 0.0]


def test_too_many_holds_stop_the_program_for_good() -> None:
    overload = [reading(700.0), *even(1, 100.0, override=0.0)]
    run = plugged([*even(3), *overload * 4, *even(3), *even(3, 0.0, workingstep=0)]).run()
    assert run.kinds.count(EventKind.HOLD) == 4
    assert run.kinds[-1] is EventKind.STOP
    assert run.loop.state.is_stopped
    assert set(run.port.overrides[-6 * TEETH :]) == {0.0}


def test_holds_of_one_workingstep_do_not_count_in_the_next() -> None:
    overload = [reading(700.0), *even(1, 100.0, override=0.0)]
    second = [each._replace(workingstep=2) for each in [*even(3), *overload * 3]]
    run = plugged([*even(3), *overload * 3, *second], steps=[step(), step()]).run()
    assert run.kinds.count(EventKind.HOLD) == 6
    assert not run.loop.state.is_stopped


def test_a_workingstep_begins_at_the_programs_feed_or_below_its_ceiling() -> None:
    steps = [step(), step(ceiling=0.6), step()]
    readings = [*even(5), *even(1, 0.0, workingstep=2), *even(1, 0.0, workingstep=3)]
    run = plugged(readings, law=Wishing(wish=0.7), steps=steps).run()
    assert run.port.overrides[5 * TEETH - 1 :: TEETH] == [0.7, 0.6, 1.0]
    assert run.kinds == [EventKind.WORKINGSTEP] * 3


def test_an_inhibited_override_is_never_touched() -> None:
    """Neither in air, nor in silence, nor at an overload, nor when the machine is lost."""
    inhibited = step(inhibition="inhibit_feedrate_override", ceiling=0.5)
    readings = [*even(3, 0.0), *even(3), *even(3, 900.0), *even(50, nan)]
    run = plugged(readings, law=Wishing(wish=0.3), steps=[inhibited], is_lost=True)
    with pytest.raises(MachineLost):
        run.run()
    assert set(run.port.overrides) == {1.0}
    assert run.kinds[:2] == [EventKind.WORKINGSTEP, EventKind.INHIBITED]
    assert run.events[1].text == "feed left as it is: inhibit_feedrate_override"


def test_what_belongs_to_no_workingstep_is_left_alone() -> None:
    run = plugged([*even(5, 0.0, workingstep=0), *even(5, 500.0, workingstep=9)]).run()
    assert set(run.port.overrides) == {1.0}
    assert run.kinds == []


def test_switched_off_the_program_runs_at_its_own_feed_until_switched_on() -> None:
    run = plugged(even(60), law=Wishing(wish=0.5))
    run.run(10).loop.order(SwitchTo(is_on=False))
    assert run.run(20).loop.state.override == 1.0
    assert run.cycles[-1].allowed.holding is OverrideReason.OFF
    run.loop.order(SwitchTo(is_on=True))
    assert run.run(20).loop.state.override == 0.5
    assert run.kinds.count(EventKind.ORDER) == 2


def test_switched_off_the_loop_holds_no_feed() -> None:
    run = plugged(even(9, 3000.0), settings=LoopSettings(is_on=False)).run()
    assert set(run.port.overrides) == {1.0}


def test_quality_never_exceeds_the_programs_feed() -> None:
    run = plugged(even(60), law=Wishing(wish=1.2))
    assert run.run(20).loop.state.override == 1.2
    run.loop.order(CriterionTo(criterion=Criterion.QC))
    assert run.run(TEETH).loop.state.override == 1.0
    run.loop.order(CriterionTo(criterion=Criterion.TC))
    assert run.run(TEETH).loop.state.override == 1.2


def test_a_share_of_the_power_is_that_share_of_the_set_point_where_power_binds() -> None:
    run = plugged(even(30, 100.0))
    run.run(10).loop.order(MotorPowerTo(factor=0.5))
    assert run.run(TEETH).cycles[-1].set_point == 0.5 * SET_POINT
    other = ForceBound(name=LimitName.CUTTING_FORCE, words="force", force=300.0)
    bounded = step(bounds=(other, *step().reference.bounds))
    run = plugged(even(30, 100.0), steps=[bounded])
    run.run(10).loop.order(MotorPowerTo(factor=0.8))
    assert run.run(TEETH).cycles[-1].set_point == 300.0


def test_less_power_is_no_overload_of_a_force_that_was_none() -> None:
    run = plugged(even(30, 390.0))
    run.run(10).loop.order(MotorPowerTo(factor=0.3))
    run.run(2 * TEETH)
    assert EventKind.HOLD not in run.kinds
    assert run.cycles[-1].set_point == pytest.approx(0.3 * SET_POINT)


def test_more_power_comes_slowly() -> None:
    run = plugged(even(60, 100.0), settings=LoopSettings(look_ahead=0, power_factor=0.5))
    run.run(10).loop.order(MotorPowerTo(factor=1.0))
    assert run.run(TEETH).cycles[-1].set_point < 0.56 * SET_POINT
    assert run.run(8 * TEETH).cycles[-1].set_point == SET_POINT


def test_a_set_point_that_was_asked_for_counts_instead_of_the_plans() -> None:
    run = plugged(even(5), settings=LoopSettings(look_ahead=0, set_point=250.0)).run()
    assert run.cycles[-1].set_point == 250.0
    assert "250 N as requested" in run.events[0].text


def test_a_set_point_leaves_room_for_a_sudden_rise() -> None:
    run = plugged(even(5), steps=[step(breakage=600.0)]).run()
    assert run.cycles[-1].set_point == 0.8 * 600.0 / 2.0
    assert "reduced to 240 N so that the tool withstands a sudden rise" in run.events[0].text


def test_where_nothing_bounds_the_force_the_law_is_not_asked() -> None:
    law = Wishing(wish=0.3)
    run = plugged(even(5), law=law, steps=[step(bounds=(), breakage=inf)]).run()
    assert law.told == []
    assert set(run.port.overrides) == {1.0}


def test_silence_is_said_once_and_means_the_safe_override() -> None:
    count = round(BLIND / PERIOD)
    silent = [reading(nan)] * (2 * count)
    run = plugged([*even(5), *silent, *even(3)]).run()
    assert run.kinds.count(EventKind.SILENCE) == 1
    first = 5 * TEETH + count
    assert set(run.port.overrides[: first - 1]) == {1.0}
    assert set(run.port.overrides[first + 1 : first + count - 1]) == {0.5}
    assert run.loop.state.override == pytest.approx(0.5 * 1.25**3)


def test_a_sensor_that_repeats_itself_is_silent() -> None:
    class Stuck(Told):
        last: Reading | None = None

        def read(self) -> Reading | None:
            self.last = super().read() or self.last
            return self.last

    run = plugged([], sensor=Stuck(even(5))).run(2.0 * BLIND / PERIOD)
    assert run.loop.state.override == 0.5
    assert EventKind.SILENCE in run.kinds


def test_teeth_that_never_make_a_revolution_are_silence_as_well() -> None:
    # Each reading begins where it should, but half of the time is missing between them.
    every_other = [each._replace(period=0.4 * PERIOD) for each in even(100)]
    run = plugged([*even(5), *every_other]).run()
    assert holdings(run) >= {OverrideReason.SILENCE}
    assert run.loop.state.override == 0.5


def test_a_lost_machine_was_commanded_the_safe_override_before_it_is_told() -> None:
    run = plugged(even(5), is_lost=True)
    with pytest.raises(MachineLost):
        run.run()
    assert run.port.overrides[-1] == 0.5
    slow = plugged(even(5), law=Wishing(wish=0.3), is_lost=True)
    with pytest.raises(MachineLost):
        slow.run()
    assert slow.port.overrides[-1] == 0.3


def test_a_law_that_fails_leaves_the_machine_at_the_safe_override() -> None:
    class Failing(Wishing):
        __slots__ = ()

        def decide(self, state: None, at: object) -> tuple[None, float]:
            raise ZeroDivisionError

    run = plugged(even(5), law=Failing(wish=1.0))
    with pytest.raises(ZeroDivisionError):
        run.run()
    assert run.port.overrides[-1] == 0.5


@pytest.mark.parametrize("wish", [nan, inf, -inf, -1.0, 0.0])
def test_no_wish_stops_the_feed_or_is_no_number(wish: float) -> None:
    run = plugged(even(20), law=Wishing(wish=wish)).run()
    assert all(0.2 <= override <= 1.2 for override in run.port.overrides)


def test_forces_that_are_no_chips_do_not_reach_the_law() -> None:
    law = Wishing(wish=0.5)
    run = plugged([*even(5, 9.0), *even(5, -400.0), *even(5, nan)], law=law).run()
    assert law.told == []
    assert set(run.port.overrides) == {1.0}


def test_noise_in_the_air_teaches_nothing_of_the_teeth() -> None:
    """Otherwise a tooth would count less or more than it takes when the cut begins."""
    noise = [reading(force) for force in (3.0, -2.9)] * 200
    run = plugged([*noise, *even(3, 550.0), reading(610.0)]).run()
    assert run.kinds.count(EventKind.HOLD) == 1
    assert run.cycles[-1].allowed.holding is OverrideReason.OVERLOAD


def test_a_broken_tooth_stops_the_program() -> None:
    whole = [reading(300.0 + noise) for noise in np.sin(np.arange(60))]
    broken = [reading(0.0), reading(560.0)] * 10
    run = plugged([*whole, *broken]).run()
    assert run.kinds[-2:] == [EventKind.BREAKAGE, EventKind.STOP]
    assert run.loop.state.is_stopped
    assert run.port.overrides[-1] == 0.0


def test_rapids_forget_the_cut() -> None:
    law = Wishing(wish=0.6)
    rapid = reading(0.0, can_override=False, period=0.25)
    run = plugged([*even(5), *[rapid] * 8, *even(1, 0.0)], law=law).run()
    assert run.kinds == [EventKind.WORKINGSTEP]
    assert run.loop.state.override == 0.6


@every_case(
    "change",
    [{"power_factor": 0.0}, {"set_point": nan}, {"servo_lag": 0.0}, {"chips": -1.0}],
)
def test_impossible_settings_are_refused(change: dict[str, float]) -> None:
    with pytest.raises(ValueError, match="must be positive"):
        LoopSettings(**change)  # type: ignore[arg-type]


def test_a_look_ahead_into_the_past_is_refused() -> None:
    with pytest.raises(ValueError, match="look-ahead"):
        LoopSettings(look_ahead=-1)


def test_an_exponent_of_nothing_is_refused() -> None:
    with pytest.raises(ValueError, match="exponent"):
        LoopStep(reference=Reference(workingstep="x"), exponent=0.0)


def test_no_force_is_compared_where_the_place_is_not_known() -> None:
    """A recording knows its places less exactly than forces change at an entry."""
    known = plugged(even(6)).run()
    unknown = plugged(even(6, is_placed=False)).run()
    assert any(cycle.ratio is not None for cycle in known.cycles)
    assert all(cycle.ratio is None for cycle in unknown.cycles)
    life = unknown.loop.state.monitor.life
    assert life is None or life.readings == 0
