"""Stations of a path."""

from dataclasses import replace
from math import acos, cos, pi, sin

import numpy as np
import pytest

from simulator.removal.stations import StationKind, Stations, air, single_arcs


def test_air_removes_nothing() -> None:
    found = air(np.array([0, 1]), np.array([2.0, 3.0]))
    assert found.kind.tolist() == [StationKind.AIR, StationKind.AIR]
    assert found.section.tolist() == [0.0, 0.0]


def test_columns_are_equally_long() -> None:
    found = air(np.array([0]), np.array([1.0]))
    with pytest.raises(ValueError, match="section"):
        replace(found, section=np.zeros(2))


def milled(
    *, section: float, entry: float, exit_: float, chip: float, depth: float = 4.0
) -> Stations:
    """One station of a cutter of 10 mm."""
    return Stations(
        segment=np.array([0]),
        station=np.array([1.0]),
        kind=np.array([int(StationKind.MILLING)]),
        section=np.array([section]),
        growth=np.zeros(1),
        axial_depth=np.array([depth]),
        radial_width=np.array([section / depth]),
        entry_angle=np.array([entry]),
        exit_angle=np.array([exit_]),
        contact_angle=np.array([exit_ - entry]),
        chip_ratio=np.array([chip]),
        diameter=np.array([10.0]),
    )


@pytest.mark.parametrize(("entry", "exit_"), [(0.0, pi), (0.0, 0.7), (2.3, pi), (0.9, 2.0)])
def test_one_arc_stays_what_it_is(entry: float, exit_: float) -> None:
    share = cos(entry) - cos(exit_)
    met = milled(section=20.0 * share, entry=entry, exit_=exit_, chip=share / (exit_ - entry))
    arcs = single_arcs(met)
    assert (arcs.entry_angle[0], arcs.exit_angle[0]) == (entry, exit_)
    assert arcs.depth[0] == pytest.approx(4.0)
    assert arcs.fill[0] == pytest.approx(1.0)


@pytest.mark.parametrize("length", [0.05, 0.4, 1.0, 1.9])
def test_of_several_arcs_the_mean_chip_tells_the_length_of_one(length: float) -> None:
    """(1 − cos β)/β at a wall, 2·sin φ_m·sin(β/2)/β elsewhere; the section tells its depth."""
    walled, centred = 1.0 - cos(length), 2.0 * sin(1.6) * sin(0.5 * length)
    for entry, exit_, share, start in (
        (0.0, 2.2, walled, 0.0),
        (pi - 2.2, pi, walled, pi - length),
        (0.5, 2.7, centred, 1.6 - 0.5 * length),
    ):
        # Half of the depth is filled.
        met = milled(section=10.0 * share, entry=entry, exit_=exit_, chip=share / length)
        arcs = single_arcs(met)
        assert arcs.entry_angle[0] == pytest.approx(start, abs=1e-6)
        assert arcs.exit_angle[0] - arcs.entry_angle[0] == pytest.approx(length, abs=1e-6)
        assert arcs.depth[0] == pytest.approx(2.0, rel=1e-5)
        assert arcs.fill[0] == pytest.approx(1.0)


def test_an_arc_is_long_enough_for_the_section_to_fit_the_depth() -> None:
    """A chip too thin for the section: ``1 − cos β = A/(r·a_p)``."""
    arcs = single_arcs(milled(section=10.0, entry=0.0, exit_=2.2, chip=0.05))
    assert arcs.exit_angle[0] == pytest.approx(acos(0.5))
    assert arcs.depth[0] == pytest.approx(4.0)
    assert arcs.fill[0] == pytest.approx(1.0)


def test_what_the_whole_arc_cannot_hold_is_a_share_of_it() -> None:
    arcs = single_arcs(milled(section=50.0, entry=0.0, exit_=pi, chip=2.0 / pi))
    assert (arcs.depth[0], arcs.exit_angle[0]) == (4.0, pi)
    assert arcs.fill[0] == pytest.approx(50.0 / 40.0)


def test_air_has_no_arc() -> None:
    arcs = single_arcs(air(np.array([0]), np.array([1.0])))
    for column in (arcs.entry_angle, arcs.exit_angle, arcs.depth, arcs.fill):
        assert column.tolist() == [0.0]
