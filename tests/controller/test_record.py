from math import inf, log, nan

import pytest

from controller.cycle import LoopCycle
from controller.guard import AllowedOverride
from controller.record import EXCESS_RATIO, Recorder, RunRecord
from tests.controller.plugged import reading
from tests.controller.shown import REVOLUTION

FORCES = (100.0, 420.0, 500.0)
OVERRIDES = (1.0, 0.8, 0.6)


def cycle(number: int, **more: float) -> LoopCycle:
    """A cycle of 20 ms that completes a revolution of 20 mm/s."""
    revolution = REVOLUTION._replace(**more)  # type: ignore[arg-type]
    ratio = log(revolution.force / 400.0) if revolution.force > 0.0 else None
    return LoopCycle(
        reading=reading(0.0, workingstep=number, period=0.02),
        allowed=AllowedOverride(override=1.0),
        set_point=400.0,
        revolution=revolution,
        expected=400.0,
        ratio=ratio,
        sharp_ratio=ratio,
        events=(),
    )


def recorded(*cycles: LoopCycle) -> dict[int, RunRecord]:
    recorder = Recorder(10.0)
    for each in cycles:
        recorder.add(each)
    return recorder.records


def test_a_workingstep_is_summed_up_in_closed_form() -> None:
    cycles = [
        cycle(1, force=force, override=override)
        for force, override in zip(FORCES, OVERRIDES, strict=True)
    ]
    record = recorded(*cycles)[1]
    assert (record.revolutions, record.lost) == (3, 0)
    assert record.time == record.cutting_time == pytest.approx(0.06)
    assert record.way == pytest.approx(20.0 * 0.06)
    assert record.feed == pytest.approx(20.0)
    lasting = [0.0]
    for force in FORCES:
        lasting.append(0.8 * lasting[-1] + 0.2 * force)
    assert record.peak == pytest.approx(max(lasting))
    assert record.impulse == pytest.approx(0.02 * 1020.0)
    assert record.force == pytest.approx(340.0)
    assert record.excess == pytest.approx(0.02 * (20.0 + 100.0))
    # 420 N are the set point and its twentieth.
    assert pytest.approx(420.0) == EXCESS_RATIO * 400.0
    assert record.over_time == pytest.approx(0.02)
    assert record.override == pytest.approx(0.8)
    assert (record.least, record.greatest) == (0.6, 1.0)
    assert record.set_point == 400.0
    assert record.ratio.readings == 3
    assert record.ratio.log_mean == pytest.approx(
        sum(log(force / 400.0) for force in FORCES) / 3.0
    )


def test_what_lasts_counts_and_not_one_revolution() -> None:
    steady = [cycle(1, force=380.0)] * 60
    record = recorded(*steady, cycle(1, force=600.0), *steady)[1]
    assert record.peak == pytest.approx(380.0 + 0.2 * 220.0, rel=1e-3)
    assert record.set_point == 400.0


def test_air_takes_time_and_nothing_else() -> None:
    record = recorded(cycle(1, force=9.0), cycle(1, force=-3.0))[1]
    assert record.time == pytest.approx(0.04)
    assert (record.cutting_time, record.way, record.revolutions) == (0.0, 0.0, 0)
    assert (record.feed, record.force, record.override) == (0.0, 0.0, 1.0)
    assert (record.least, record.greatest) == (inf, 0.0)


def test_a_revolution_without_a_force_is_lost() -> None:
    record = recorded(cycle(1, force=nan, coverage=0.2), cycle(1))[1]
    assert (record.lost, record.revolutions) == (1, 1)


def test_without_a_set_point_nothing_exceeds_it() -> None:
    free = cycle(1)._replace(set_point=inf)
    record = recorded(free)[1]
    assert (record.excess, record.over_time) == (0.0, 0.0)
    assert record.set_point == inf


def test_cycles_without_a_revolution_take_time() -> None:
    record = recorded(cycle(3)._replace(revolution=None, ratio=None))[3]
    assert (record.time, record.cutting_time) == (0.02, 0.0)


def test_workingsteps_come_in_the_order_of_their_beginning() -> None:
    assert list(recorded(cycle(2), cycle(1), cycle(2))) == [2, 1]
