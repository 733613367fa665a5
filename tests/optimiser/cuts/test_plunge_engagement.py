"""Plunges of a mill, from stations made by hand and along the paths of the bracket."""

from dataclasses import replace
from math import pi
from pathlib import Path

import numpy as np
import pytest

from optimiser.cuts.cut import Cut, CutKind
from optimiser.cuts.hardest_places import PathContacts
from optimiser.cuts.plunge_engagement import CORE, plunge_of
from optimiser.solver.problem import Setting
from simulator.physics.engagement import full_immersion
from simulator.removal.stations import StationKind, Stations
from simulator.spec import ToolKind
from stepnc_model.programs.tool import Tool

BRACKET = Path(__file__).parents[3] / "examples" / "parts" / "bracket.stpnc"
FULL = 0.25 * pi * 10.0**2
MILL = Cut(
    kind=CutKind.MILLING,
    tool=Tool(id="mill", keyword="TAPERED_ENDMILL", diameter=10.0, teeth=4),
    tool_kind=ToolKind.ENDMILL,
    diameter=10.0,
    programmed=Setting(feed=0.05, depth=4.0, passes=2, speed=50.0),
    length=100.0,
    total_depth=8.0,
    is_depth_free=True,
    engagement=full_immersion(),
)


def met(
    section: float, inner: float, *, kind: StationKind = StationKind.DRILLING
) -> PathContacts:
    """One stretch of 2 mm whose lips cut from an inner radius to the rim of 5 mm."""
    one = np.ones(1)
    stations = Stations(
        segment=np.zeros(1, dtype=np.int64),
        station=2.0 * one,
        kind=np.array([int(kind)]),
        section=section * one,
        growth=0.0 * one,
        axial_depth=(5.0 - inner) * one,
        radial_width=(5.0 - inner) * one,
        entry_angle=0.0 * one,
        exit_angle=0.0 * one,
        contact_angle=0.0 * one,
        chip_ratio=one,
        diameter=(5.0 + inner) * one,
    )
    return PathContacts(stations=stations, length=2.0 * one, cell=0.2)


BOUND = np.array([True])


def test_a_plunge_into_the_solid_is_a_hole_of_the_tools_diameter() -> None:
    plunge = plunge_of(MILL, met(FULL, 0.0), BOUND)
    assert plunge is not None
    assert plunge.kind is CutKind.DRILLING
    assert plunge.previous_diameter == 0.0
    assert plunge.tool.point_angle == pytest.approx(pi)
    assert (plunge.tool.teeth, plunge.engagement) == (4, None)


def test_a_pilot_hole_is_taken_off() -> None:
    plunge = plunge_of(MILL, met(0.9 * FULL, 1.0), BOUND)
    assert plunge is not None
    assert plunge.previous_diameter == pytest.approx(2.0)


@pytest.mark.parametrize(
    ("cut", "found", "bound"),
    [
        (MILL, met(0.5 * FULL, 5.0 * CORE + 0.1), True),
        (MILL, met(0.001 * FULL, 0.0), True),
        (MILL, met(FULL, 0.0, kind=StationKind.MILLING), True),
        (MILL, met(FULL, 0.0), False),
        (replace(MILL, kind=CutKind.DRILLING), met(FULL, 0.0), True),
    ],
    ids=["beside the core", "a sliver", "a ramp", "a feed of its own", "a drill"],
)
def test_what_is_no_plunge_at_the_feed_of_the_cut(
    cut: Cut, found: PathContacts, bound: bool
) -> None:
    assert plunge_of(cut, found, np.array([bound])) is None
