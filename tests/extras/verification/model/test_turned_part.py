"""Turned parts: a shoulder, by a sharp right-hand insert."""

from dataclasses import replace
from math import pi

import numpy as np
import pytest

from extras.verification.model.deviation import SurfacePlaces
from extras.verification.model.logged_bar import LoggedBar
from extras.verification.model.path import ProgrammedRun, programmed_path
from extras.verification.model.turned_part import turned_part, turned_places, turned_volumes
from simulator.motion.segments import Floats, lines
from simulator.removal.cutter import Insert
from stepnc_model.programs.program import Stock
from tests.extras.verification.model.block import sampled, samples_at

BAR = Stock(low=(-20.0, -20.0, -50.0), high=(20.0, 20.0, 0.0), radius=20.0)
INSERT = Insert(nose_radius=0.0)
WAY = ((15.0, 0.0, 2.0), (15.0, 0.0, -30.0), (25.0, 0.0, -30.0))
RUN = ProgrammedRun(
    cutter=INSERT,
    tool=1,
    workingstep=0,
    segments=lines([list(each) for each in WAY], speed=5.0),
)
PART = turned_part(programmed_path([RUN]), BAR)


def logged(points: Floats) -> LoggedBar:
    left = LoggedBar(PART.bar, BAR, {1: INSERT})
    left.add(samples_at(points))
    return left


def places_of(points: Floats) -> SurfacePlaces:
    return turned_places(PART, logged(points))


def test_a_log_without_errors_stays_within_its_uncertainty() -> None:
    assert not places_of(sampled(WAY, 0.4371)).is_beyond.any()


@pytest.mark.parametrize("size", [0.15, 0.0254])
def test_an_offset_in_radius_is_an_excess_on_the_diameter(size: float) -> None:
    places = places_of(sampled(WAY, 0.0437123) + np.array([size, 0.0, 0.0]))
    own = places[~places.is_wall & (places.workingstep == 0) & (places.position[:, 2] > -29.0)]
    assert own.deviation == pytest.approx(size, abs=1e-6)
    assert own.is_beyond.all()


def test_an_offset_along_the_axis_is_a_gouge_on_the_face_to_a_cell() -> None:
    places = places_of(sampled(WAY, 0.0437123) + np.array([0.0, 0.0, -0.15]))
    face = places[places.is_wall & places.is_beyond]
    assert len(face)
    assert -face.deviation.min() == pytest.approx(0.15, abs=PART.bar.cell)


def plunge(*, measured: bool) -> SurfacePlaces:
    """Places of a groove in whose bottom one sample lies 0.1 mm too deep."""
    way = ((22.0, 0.0, -20.0), (15.0, 0.0, -20.0), (22.0, 0.0, -20.0))
    blade = Insert(width=3.0)
    run = ProgrammedRun(
        cutter=blade, tool=1, workingstep=0,
        segments=lines([list(each) for each in way], speed=5.0),
    )  # fmt: skip
    part = turned_part(programmed_path([run]), BAR)
    points = np.array([[22.0, 0.0, -20.0], [14.9001, 0.0, -20.0], [22.0, 0.0, -20.0]])
    samples = samples_at(points)
    left = LoggedBar(part.bar, BAR, {1: blade})
    left.add(replace(samples, is_measured=np.full(3, measured)))
    return turned_places(part, left)


def test_a_gouge_is_certain_where_the_tool_was() -> None:
    places = plunge(measured=True)
    bottom = places[~places.is_wall & (places.position[:, 0] == 15.0)]
    assert bottom.uncertainty.min() > 1.0
    assert bottom.deviation.min() == pytest.approx(-0.0999)
    assert bottom.certain.max() == pytest.approx(0.1, abs=2e-3)
    assert bottom.is_beyond.any()
    assert bottom.least.max() == bottom.certain.max()


def test_an_interpolated_position_makes_nothing_certain() -> None:
    places = plunge(measured=False)
    assert places.certain.max() == 0.0
    assert not places.is_beyond.any()


def test_a_face_is_known_between_its_ends_however_far_the_tool_moves_there() -> None:
    """Ten samples make a face in one cell; before and behind it the steps are long."""
    way = ((35.0, 0.0, -0.4), (25.0, 0.0, -0.4), (-0.4, 0.0, -0.4), (-0.4, 0.0, 9.6))
    run = ProgrammedRun(
        cutter=INSERT, tool=1, workingstep=0,
        segments=lines([list(each) for each in way], speed=5.0),
    )  # fmt: skip
    part = turned_part(programmed_path([run]), BAR)
    points = [sampled(way[:2], 9.0), sampled(way[1:3], 1.7)[1:], sampled(way[2:], 9.0)[1:]]
    left = LoggedBar(part.bar, BAR, {1: INSERT})
    left.add(samples_at(np.concatenate(points) + np.array([0.0, 0.0, 0.15])))
    places = turned_places(part, left)
    face = places[places.is_wall & (places.position[:, 2] > -1.0)]
    is_between = (face.position[:, 0] > 6.0) & (face.position[:, 0] < 14.0)
    assert face[is_between].uncertainty.max() < 2.0 * part.bar.cell
    assert face[is_between].deviation == pytest.approx(0.15, abs=part.bar.cell)
    # At the centre the tool may have turned away before.
    assert face[face.position[:, 0] < 1.0].uncertainty.min() > 1.0


def test_volumes_are_those_of_rings() -> None:
    found = turned_volumes(PART.bar, logged(sampled(WAY, 0.4) + np.array([0.5, 0.0, 0.0])))
    assert found.programmed == pytest.approx(pi * (20.0**2 - 15.0**2) * 30.0, rel=1e-6)
    ring = pi * (15.5**2 - 15.0**2) * 30.0
    assert found.excess == pytest.approx(ring, rel=1e-3)
    assert found.gouge == pytest.approx(0.0, abs=1e-6)
