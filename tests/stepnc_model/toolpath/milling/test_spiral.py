"""Rings joined to a spiral: one pass, every ring whole, no stop along the normal."""

import pytest

from stepnc_model.toolpath.milling.contour import chain_length, circle, line, polygon
from stepnc_model.toolpath.milling.cover import MillingPass, rings, swept
from stepnc_model.toolpath.milling.strokes import spirals

SQUARE = polygon([0j, 40 + 0j, 40 + 40j, 40j])
FOUND = rings([SQUARE], distance=5.0, radius=5.0, step=5.0)


def test_rings_of_a_square_become_one_pass_that_runs_all_of_each() -> None:
    """Sides of 10, 20 and 30 mm, and two slants."""
    (cut,) = spirals(FOUND, [FOUND[-1].chain], step=5.0)
    assert not cut.is_closed
    slants = chain_length(cut.chain) - 4.0 * (10.0 + 20.0 + 30.0)
    assert 2.0 * 5.0 < slants < 2.0 * 20.0
    assert swept([cut], 5.0).covers(swept(FOUND, 5.0).buffer(-1e-3))


def test_slant_goes_on_along_the_way_rather_than_across_it() -> None:
    (cut,) = spirals(FOUND, [FOUND[-1].chain], step=5.0)
    for before, after in zip(cut.chain, cut.chain[1:], strict=False):
        assert after.start == pytest.approx(before.end)
    slants = [edge for edge in cut.chain if edge.length not in {10.0, 20.0, 30.0}]
    assert any(abs(edge.along(0.0).real * edge.along(0.0).imag) > 0.1 for edge in slants)


def test_rings_with_a_wall_between_them_stay_apart() -> None:
    apart = [MillingPass(circle(complex(x, 0), 2.0), is_closed=True) for x in (0, 5)]
    loops = [cut.chain for cut in apart]
    assert spirals(apart, loops, step=2.0) == tuple(apart)


def test_strokes_stay_what_they_are() -> None:
    stroke = MillingPass((line(0j, 1 + 0j),), is_closed=False)
    assert spirals([stroke, *FOUND[:1]], [SQUARE], step=5.0) == (stroke, FOUND[0])
