"""Removal volumes of the shaft."""

from collections.abc import Callable

import pytest

from stepnc_model.toolpath.task import ToolPathTask
from stepnc_model.toolpath.turning.outline import outline_of
from stepnc_model.toolpath.turning.profile import HalfPlane
from stepnc_model.toolpath.turning.region import TurningRegion, bar_of, edges_of, region_of
from stepnc_model.units import deg_from_rad


def region(
    job: Callable[..., ToolPathTask], name: str, *edits: tuple[str, str]
) -> TurningRegion:
    at = job(name, *edits)
    outlines = tuple(outline_of(at, ref, 30.0) for ref in at.step.features)
    bar = bar_of(at, outlines)
    plane = HalfPlane(is_across="FACE" in name)
    return region_of(at, bar, outlines, plane=plane, allowance=0.5, overcut=1.0)


def test_the_part_beside_the_features_is_a_wall(job: Callable[..., ToolPathTask]) -> None:
    contour = region(job, "ROUGH CONTOUR")
    assert (contour.low, contour.own_high, contour.floor) == (-110.0, 0.0, 13.5)
    assert contour.wall == 30.0


def test_the_centre_stops_beside_the_wall_and_goes_up_it(
    job: Callable[..., ToolPathTask],
) -> None:
    chain = region(job, "ROUGH CONTOUR").chain(0.5)
    assert chain[-1].is_upright
    assert chain[-1].end == pytest.approx((-110.0 + 0.8 + 0.5, 30.0))


def test_a_sharp_insert_starts_nearer_to_the_stock_by_its_nose(
    job: Callable[..., ToolPathTask],
) -> None:
    rounded = region(job, "ROUGH CONTOUR")
    sharp = region(job, "ROUGH CONTOUR", ("ROUNDED_CORNER(0.8)", "ROUNDED_CORNER(0.)"))
    assert (rounded.nose, sharp.nose) == (0.8, 0.0)
    assert rounded.front - sharp.front == pytest.approx(0.8)


def test_a_face_has_no_wall_at_the_axis(job: Callable[..., ToolPathTask]) -> None:
    face = region(job, "ROUGH FACE")
    assert (face.low, face.own_high, face.wall) == (0.0, 30.0, None)


def test_edges_are_those_of_the_insert(job: Callable[..., ToolPathTask]) -> None:
    """95 and 80 degrees: 5 behind the nose along the axis, 5 across it."""
    at = job("ROUGH CONTOUR")
    assert deg_from_rad(edges_of(at, HalfPlane()).behind) == pytest.approx(5.0)
    assert deg_from_rad(edges_of(at, HalfPlane(is_across=True)).behind) == pytest.approx(5.0)
    left = job("ROUGH CONTOUR", ("#401,.RIGHT.", "#401,.LEFT."))
    assert deg_from_rad(edges_of(left, HalfPlane()).ahead) == pytest.approx(5.0)
