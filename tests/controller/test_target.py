from dataclasses import replace
from math import inf, log

import pytest

from controller.aims import Aims
from controller.conditioning import RISE
from controller.hold import EASING
from controller.orders import Criterion
from controller.reference import Reference
from controller.target import Target, approached, introduction, kept, wanted
from tests.controller.plugged import SET_POINT, step

AIMS = Aims()
REFERENCE = step().reference
FREE = Reference(workingstep="FREE")


def test_what_was_asked_for_counts_before_the_plan() -> None:
    assert wanted(AIMS, REFERENCE) == SET_POINT
    assert wanted(replace(AIMS, set_point=123.0), REFERENCE) == 123.0
    assert wanted(replace(AIMS, power_factor=0.5), REFERENCE) == 0.5 * SET_POINT
    assert wanted(AIMS, FREE) == inf


def test_a_set_point_begins_at_once_and_rises_slowly() -> None:
    first = approached(Target(), replace(AIMS, power_factor=0.5), REFERENCE)
    assert first.set_point == 0.5 * SET_POINT
    second = approached(first, AIMS, REFERENCE)
    assert log(second.set_point / first.set_point) == pytest.approx(RISE)


def test_a_set_point_falls_at_once_and_what_is_an_overload_slowly() -> None:
    settled = Target(set_point=SET_POINT, settled=SET_POINT)
    lower = approached(settled, replace(AIMS, power_factor=0.5), REFERENCE)
    assert lower.set_point == 0.5 * SET_POINT
    assert log(SET_POINT / lower.settled) == pytest.approx(RISE)
    for _ in range(10):
        lower = approached(lower, replace(AIMS, power_factor=0.5), REFERENCE)
    assert lower.settled == lower.set_point


def test_where_nothing_bounds_the_force_there_is_no_set_point() -> None:
    free = approached(Target(), AIMS, FREE)
    assert free.set_point == inf
    assert approached(free, AIMS, REFERENCE).set_point == SET_POINT
    assert kept(free, AIMS, step(bounds=(), breakage=inf)).threshold(AIMS.band) == inf


def test_the_strength_of_the_tool_is_room_for_a_sudden_rise() -> None:
    weak = replace(REFERENCE, breakage=600.0)
    assert approached(Target(), AIMS, weak).set_point == 240.0
    assert introduction(AIMS, weak).endswith("; 240 N, for the tool to bear a sudden rise")


def test_quality_keeps_the_override_at_one() -> None:
    target = approached(Target(), AIMS, REFERENCE)
    assert kept(target, AIMS, step()).ceiling == AIMS.band.ceiling
    assert kept(target, replace(AIMS, criterion=Criterion.QC), step()).ceiling == 1.0


def test_a_workingstep_is_introduced_with_what_bounds_it() -> None:
    assert (
        introduction(AIMS, REFERENCE)
        == "SLOT: force bound 400 N by motor power, where the plan cuts hardest"
    )
    assert introduction(AIMS, FREE) == "FREE: nothing bounds the force"


def test_what_a_hold_has_taught_is_eased_little_by_little() -> None:
    capped = Target(cap=0.7)
    assert kept(capped, AIMS, step()).ceiling == 0.7
    for reference in (REFERENCE, FREE) * 50:
        capped = approached(capped, AIMS, reference)
    assert capped.cap == pytest.approx(0.7 * (1.0 + EASING) ** 100)
