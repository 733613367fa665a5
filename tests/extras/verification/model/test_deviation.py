"""Deviations and their uncertainties against closed forms."""

from math import pi, sqrt

import numpy as np
import pytest

from extras.verification.model.deviation import (
    SurfacePlaces,
    arc_uncertainty,
    compared_volumes,
    corner_uncertainty,
    rounding_uncertainty,
    smallest_arc,
    surface_places,
)
from extras.verification.model.logged_part import LogFacts
from simulator.motion.segments import Floats
from tests.extras.verification.model.block import (
    SLOT,
    logged,
    part_of,
    round_path,
    sampled,
    samples_at,
    slot_path,
)

PART = part_of(slot_path())


def places_of(points: Floats) -> SurfacePlaces:
    return surface_places(PART, logged(PART, samples_at(points)))


@pytest.mark.parametrize("size", [0.3, 0.15, 0.0254])
def test_an_offset_is_a_gouge_on_one_wall_and_an_excess_on_the_other(size: float) -> None:
    places = places_of(sampled(SLOT, 0.0437123) + np.array([0.0, size, 0.0]))
    walls = places[places.is_wall & (places.position[:, 0] < 15.0)]
    upper = walls.position[:, 1] > 20.0
    assert walls.deviation[upper] == pytest.approx(-size, abs=1e-6)
    assert walls.deviation[~upper] == pytest.approx(size, abs=1e-6)
    assert walls.is_beyond.all()
    assert (walls.uncertainty < 0.0015).all()


def test_a_floor_shows_the_height() -> None:
    places = places_of(sampled(SLOT, 0.5) + np.array([0.0, 0.0, -0.1]))
    floor = places[~places.is_wall & (places.workingstep == 0)]
    assert floor.deviation == pytest.approx(-0.1, abs=1e-9)
    raw = places[~places.is_wall & (places.workingstep < 0)]
    assert raw.deviation == pytest.approx(0.0)


@pytest.mark.parametrize("step", [0.04, 0.7, 1.7])
def test_a_log_without_errors_stays_within_its_uncertainty(step: float) -> None:
    assert not places_of(sampled(SLOT, step)).is_beyond.any()


def test_a_square_corner_between_samples_is_as_uncertain_as_it_can_be_wrong() -> None:
    step = 1.0
    way = sampled(SLOT, step)
    # No sample at the corner: it lies in the middle between two.
    ends = np.array([[24.5, 20.0, -4.0], [25.0, 20.5, -4.0]])
    way = np.concatenate((way[way[:, 0] < 24.4], ends, way[way[:, 1] > 20.9]))
    places = places_of(way)
    worst = places.deviation[places.is_wall].max()
    assert worst == pytest.approx(corner_uncertainty(step), abs=1e-3)
    assert not places.is_beyond.any()
    assert corner_uncertainty(step) == pytest.approx(step / (2.0 * sqrt(2.0)))


def test_arcs_between_samples_are_wrong_by_their_sagitta() -> None:
    part = part_of(round_path())
    angles = np.linspace(0.0, 2.0 * pi, 41)
    ring = np.column_stack([
        20.0 + 10.0 * np.cos(angles), 20.0 + 10.0 * np.sin(angles), np.full(41, -4.0)
    ])  # fmt: skip
    places = surface_places(part, logged(part, samples_at(ring)))
    step = 10.0 * angles[1]
    assert smallest_arc(part.path) == pytest.approx(10.0)
    assert np.abs(places.deviation[places.is_wall]).max() == pytest.approx(
        arc_uncertainty(step, 10.0), rel=0.02
    )
    assert not places.is_beyond.any()


def test_volumes_add_up() -> None:
    found = compared_volumes(PART, logged(PART, samples_at(sampled(SLOT, 0.5)[:30])))
    assert found.programmed - found.logged == pytest.approx(found.excess - found.gouge)
    assert found.gouge == pytest.approx(0.0, abs=1e-9)
    assert found.excess > 0.0


def test_rounding_counts_in_both_coordinates() -> None:
    assert rounding_uncertainty(LogFacts(rounding=0.01)) == pytest.approx(0.01 / sqrt(2.0))
    assert arc_uncertainty(10.0, 0.1) == 5.0
