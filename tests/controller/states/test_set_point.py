from dataclasses import replace
from math import inf, log

import pytest

from controller.orders import Criterion
from controller.reference import Reference
from controller.signals.conditioning import RISE
from controller.states.loop_settings import LoopSettings, LoopStep
from controller.states.set_point import EASING, approached, bounded, introduction, wanted
from tests.controller.plugged import SET_POINT, step

AIMS = LoopSettings()
HALF = replace(AIMS, power_factor=0.5)
STEP = step()
REFERENCE = STEP.reference
FREE = LoopStep(reference=Reference(workingstep="FREE"))


def test_what_was_asked_for_counts_before_the_plan() -> None:
    assert wanted(AIMS, REFERENCE) == SET_POINT
    assert wanted(replace(AIMS, set_point=123.0), REFERENCE) == 123.0
    assert wanted(HALF, REFERENCE) == 0.5 * SET_POINT
    assert wanted(AIMS, FREE.reference) == inf


def test_a_set_point_begins_at_once_and_rises_slowly() -> None:
    first = approached(bounded(HALF, STEP), HALF, STEP)
    assert first.set_point == 0.5 * SET_POINT
    second = approached(first, AIMS, STEP)
    assert log(second.set_point / first.set_point) == pytest.approx(RISE)


def test_a_set_point_falls_at_once_and_what_is_an_overload_slowly() -> None:
    settled = bounded(AIMS, STEP, set_point=SET_POINT, settled=SET_POINT)
    lower = approached(settled, HALF, STEP)
    assert lower.set_point == 0.5 * SET_POINT
    assert log(SET_POINT / lower.settled) == pytest.approx(RISE)
    for _ in range(10):
        lower = approached(lower, HALF, STEP)
    assert lower.settled == lower.set_point


def test_where_nothing_bounds_the_force_there_is_no_set_point() -> None:
    free = approached(bounded(AIMS, FREE), AIMS, FREE)
    assert free.set_point == inf
    assert free.threshold(AIMS.band) == inf
    assert approached(free, AIMS, STEP).set_point == SET_POINT


def test_the_strength_of_the_tool_is_room_for_a_sudden_rise() -> None:
    weak = step(breakage=600.0)
    assert approached(bounded(AIMS, weak), AIMS, weak).set_point == 240.0
    told = introduction(AIMS, weak.reference)
    assert told.endswith("; reduced to 240 N so that the tool withstands a sudden rise")


def test_the_band_is_narrowed_by_what_the_workingstep_allows() -> None:
    keep = bounded(AIMS, step(floor=0.4, ceiling=1.1, breakage=3000.0))
    assert (keep.floor, keep.ceiling, keep.breakage) == (0.4, 1.1, 3000.0)


def test_the_floor_of_the_band_holds_against_a_ceiling_of_the_plan() -> None:
    keep = bounded(AIMS, step(ceiling=0.1))
    assert (keep.floor, keep.ceiling) == (0.2, 0.2)


def test_quality_keeps_the_override_at_one() -> None:
    assert bounded(AIMS, STEP).ceiling == AIMS.band.ceiling
    assert bounded(replace(AIMS, criterion=Criterion.QC), STEP).ceiling == 1.0


def test_a_workingstep_is_introduced_with_what_bounds_it() -> None:
    assert (
        introduction(AIMS, REFERENCE)
        == "SLOT: force bound 400 N by motor power, where the plan cuts hardest"
    )
    assert introduction(AIMS, FREE.reference) == "FREE: nothing limits the force"


def test_what_a_hold_has_taught_is_eased_little_by_little() -> None:
    capped = bounded(AIMS, STEP, cap=0.7)
    assert capped.ceiling == 0.7
    for each in (STEP, FREE) * 50:
        capped = approached(capped, AIMS, each)
    assert capped.cap == pytest.approx(0.7 * (1.0 + EASING) ** 100)
