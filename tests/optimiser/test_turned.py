"""What turning paths make of a bar: sections, where they cut, and how fast it turns there."""

from itertools import pairwise

import pytest

from optimiser.advice import Plan
from optimiser.cuts.cut import TurnedBar
from tests.optimiser.plans import advice_of


def turned(plan: Plan, name: str) -> TurnedBar:
    cut = advice_of(plan, name).cut
    assert cut is not None
    assert cut.turned is not None
    return cut.turned


def test_the_bar_is_as_thin_as_the_finished_contour(shaft: Plan) -> None:
    """Ø60 at the chuck, Ø54 of the collar, Ø30 of the seat in front; stock from -150 mm on."""
    found = turned(shaft, "FINISH CONTOUR")
    assert found.back == pytest.approx(-150.0)
    at = {
        z: next(each for each in found.sections if each.start <= z - found.back <= each.end)
        for z in (-140.0, -100.0, -20.0)
    }
    assert at[-140.0].outer == pytest.approx(60.0)
    assert at[-100.0].outer == pytest.approx(54.0, abs=0.05)
    assert at[-20.0].outer == pytest.approx(30.0, abs=0.05)
    assert all(each.inner == 0.0 for each in found.sections)
    assert found.high <= 0.1
    assert found.low == pytest.approx(-110.0, abs=1.0)


def test_sections_join_and_end_with_the_bar(shaft: Plan) -> None:
    sections = turned(shaft, "FINISH CONTOUR").sections
    assert sections[0].start == 0.0
    assert all(one.end == other.start for one, other in pairwise(sections))
    assert sections[-1].end == pytest.approx(150.0, abs=1.0)


def test_facing_to_the_axis_reaches_the_clamp_of_the_speed(shaft: Plan) -> None:
    """Constant surface speed up to 3000 rpm, 50 rev/s."""
    found = turned(shaft, "ROUGH FACE")
    assert found.greatest_speed == pytest.approx(50.0)
    assert found.fastest(13.0) == pytest.approx(50.0)
    assert found.fastest(60.0) == 60.0


def test_a_contour_turns_faster_where_it_is_thin(shaft: Plan) -> None:
    found = turned(shaft, "FINISH CONTOUR")
    speed = 10.0
    assert 10.0 < found.fastest(speed) <= 10.0 * 60.0 / 27.0
