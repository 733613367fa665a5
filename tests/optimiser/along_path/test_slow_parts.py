"""Sentences on parts of NC code that take longer than programmed."""

from dataclasses import replace

from optimiser.along_path.caps import CapName
from optimiser.along_path.filter_transfer import BrokenBound
from optimiser.along_path.free_profile import FreeProfile
from optimiser.along_path.plan import PartPlan
from optimiser.along_path.slow_parts import slower_part

PLAN = PartPlan(
    name="T1",
    length=100.0,
    programmed_time=10.0,
    time=12.0,
    unlimited_time=12.0,
    bound=12.0,
    window_change=0.0,
    free=FreeProfile(),
    feeds=1,
    shares={},
)


def test_a_part_that_takes_as_long_says_nothing() -> None:
    assert slower_part(PLAN, 10.0, 10.04) == ""


def test_a_program_that_keeps_every_bound_is_told_so() -> None:
    said = slower_part(PLAN, 10.0, 12.0)
    assert said == "T1 takes 12 s instead of 10 s: the program keeps every bound"


def test_the_bound_that_costs_most_time_is_told_with_what_would_help() -> None:
    broken = {
        name: BrokenBound(block=9, ratio=ratio, name=name)
        for name, ratio in ((CapName.ENTRY, 3.0), (CapName.PLUNGE, 1.5))
    }
    lost = {CapName.ENTRY: 0.1, CapName.PLUNGE: 1.9}
    said = slower_part(replace(PLAN, broken=broken, lost=lost), 10.0, 12.0)
    assert said == (
        "T1 takes 12 s instead of 10 s: as programmed on line 9 its feed is 1.5 times what "
        "plunge feed permits; more teeth, or a tool with a higher catalogue feed would help"
    )
