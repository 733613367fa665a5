"""Profiles of meshes that are bodies of revolution, and logs compared with them."""

import numpy as np
import pytest

from extras.verification.model.deviation import SurfacePlaces
from extras.verification.model.logged_bar import LoggedBar
from extras.verification.model.path import ProgrammedRun, programmed_path
from extras.verification.model.required_bar import profile_deviation, required_turned_places
from extras.verification.model.turned_part import turned_part, turned_places, turned_volumes
from simulator.motion.segments import Floats, lines
from simulator.removal.cutter import Insert
from simulator.removal.mesh_stock import RequiredBar, required_bar
from stepnc_model.programs.program import Stock
from tests.extras.verification.model.block import sampled, samples_at
from tests.extras.verification.model.meshes import revolved

BAR = Stock(low=(-20.0, -20.0, -50.0), high=(20.0, 20.0, 0.5), radius=20.0)
INSERT = Insert(nose_radius=0.0)
WAY = (
    (21.0, 0.0, 0.0), (-0.1, 0.0, 0.0), (-0.1, 0.0, 2.0), (15.0, 0.0, 2.0), (15.0, 0.0, -20.0),
    (18.0, 0.0, -30.0), (18.0, 0.0, -45.0), (25.0, 0.0, -45.0),
)  # fmt: skip
PROFILE = ((0.0, 0.0), (0.0, 15.0), (-20.0, 15.0), (-30.0, 18.0), (-45.0, 18.0), (-45.0, 0.0))


def required(profile: tuple[tuple[float, float], ...] = PROFILE) -> RequiredBar:
    return required_bar(revolved(profile), BAR)


def places_of(points: Floats) -> SurfacePlaces:
    part = required()
    left = LoggedBar(part.bar, BAR, {1: INSERT})
    left.add(samples_at(points))
    return required_turned_places(part, left)


def test_the_profile_is_that_of_the_corners() -> None:
    part = required()
    z = part.bar.z
    assert part.bar.outer[(z > -20.0) & (z < 0.0)] == pytest.approx(15.0)
    assert np.interp(-25.0, z, part.bar.outer) == pytest.approx(16.5)
    assert (part.low, part.bar.outer[z > 0.0].max()) == (-45.0, 0.0)
    assert part.sag == pytest.approx(18.0 * (1.0 - np.cos(np.pi / 96.0)))


def test_a_bore_is_found() -> None:
    ring = ((0.0, 5.0), (0.0, 15.0), (-45.0, 15.0), (-45.0, 8.0), (-10.0, 8.0), (0.0, 5.0))
    part = required(ring)
    z = part.bar.z
    assert part.bar.inner[(z > -44.0) & (z < -10.1)] == pytest.approx(8.0)
    assert np.interp(-5.0, z, part.bar.inner) == pytest.approx(6.5)
    assert part.bar.outer[(z > -44.0) & (z < -0.1)] == pytest.approx(15.0)


def test_a_log_without_errors_stays_within_its_uncertainty() -> None:
    for step in (0.04, 0.4371):
        assert not places_of(sampled(WAY, step)).is_beyond.any()


@pytest.mark.parametrize("size", [0.15, 0.0254])
def test_an_offset_in_radius_is_an_excess_on_the_diameter(size: float) -> None:
    places = places_of(sampled(WAY, 0.0437) + np.array([size, 0.0, 0.0]))
    z = places.position[:, 2]
    own = places[~places.is_wall & (z < -0.5) & (z > -19.0)]
    assert own.deviation == pytest.approx(size, abs=1e-6)
    assert own.is_beyond.all()
    assert not places.is_beyond[z < -45.0].any()


def test_what_lies_behind_the_part_does_not_count() -> None:
    part = required()
    left = LoggedBar(part.bar, BAR, {1: INSERT})
    left.add(samples_at(sampled(WAY, 0.1)))
    found = turned_volumes(part.bar, left, low=part.low)
    assert found.excess == pytest.approx(0.0, abs=1.0)
    assert found.programmed == pytest.approx(found.logged, rel=1e-4)


@pytest.mark.parametrize(
    ("mesh", "message"),
    [
        (revolved(PROFILE) * [1.01, 1.0, 1.0], "outer radius goes from 17.99 to 18.18 mm"),
        (revolved(PROFILE) + np.array([0.1, 0.0, 0.0]), "no body of revolution about Z"),
        (revolved(PROFILE)[1:], "3 edges do not belong to two triangles"),
    ],
)
def test_other_bodies_are_refused(mesh: Floats, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        required_bar(mesh, BAR)


def test_a_programmed_profile_is_compared_with_the_mesh() -> None:
    run = ProgrammedRun(
        cutter=INSERT, tool=1, workingstep=0, segments=lines([list(p) for p in WAY], speed=5.0)
    )
    part = turned_part(programmed_path([run]), BAR)
    left = LoggedBar(part.bar, BAR, {1: INSERT})
    left.add(samples_at(sampled(WAY, 0.1)))
    places = turned_places(part, left)
    wider = tuple((z, r - 0.1 if r else 0.0) for z, r in PROFILE)
    found = profile_deviation(places, np.zeros(len(places), dtype=bool), required(wider))
    z = places.position[:, 2]
    assert found[~places.is_wall & (z < -1.0) & (z > -19.0)] == pytest.approx(0.1, abs=1e-6)
    assert np.isnan(found[z < -45.0]).all()
