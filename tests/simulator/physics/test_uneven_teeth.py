"""Runout moves chips from tooth to tooth, and takes nothing away."""

from math import pi, sin, tan

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from simulator.physics.flutes import CuttingEdges, ForceLaw
from simulator.physics.tooth_forces import Floats, Forces, forces, one_place
from simulator.physics.uneven_teeth import Runout, eccentric_runout

LINEAR = ForceLaw(exponent=1.0)


def uneven(offsets: list[float], rotation: Floats, *, helix: float = 0.0) -> Forces:
    edges = CuttingEdges(teeth=len(offsets), diameter=10.0, helix_angle=helix)
    runout = Runout(offsets=np.array(offsets), feed_per_tooth=np.full(1, 0.1))
    slot = one_place(0.0, pi, axial_depth=2.0)
    return forces(edges, slot, LINEAR, rotation=rotation[None, :], runout=runout)


@settings(max_examples=30)
@given(
    runout=st.lists(st.floats(-0.2, 0.2), min_size=1, max_size=6),
    angle=st.floats(0.01, pi - 0.01),
)
def test_whatever_the_runout_a_revolution_removes_its_feed(
    runout: list[float], angle: float
) -> None:
    """Each tooth in turn passes the same angle; what one leaves another takes."""
    teeth = len(runout)
    passing = angle + 2.0 * pi / teeth * np.arange(teeth, dtype=np.float64)
    # A tooth at a time: an arc of which the others are not on it.
    near = 0.4 * min(angle, pi - angle, pi / teeth)
    edges = CuttingEdges(teeth=teeth, diameter=10.0)
    found = forces(
        edges,
        one_place(angle - near, angle + near, axial_depth=2.0),
        LINEAR,
        rotation=passing[None, :],
        runout=Runout(offsets=np.array(runout), feed_per_tooth=np.full(1, 0.1)),
    )
    assert found.tangential.sum() == pytest.approx(2.0 * teeth * sin(angle), rel=1e-4)


@settings(max_examples=30)
@given(
    runout=st.lists(st.floats(-0.1, 0.1), min_size=1, max_size=5),
    helix=st.floats(0.05, 1.0),
)
def test_whatever_runout_and_helix_the_mean_is_that_of_even_teeth(
    runout: list[float], helix: float
) -> None:
    """Over N even rotations the mean of a sum of humps is off by half its variation over N.

    Along the edge a chip has kinks; Gauss is off by Peano's kernel times their turns.
    """
    teeth, count = len(runout), 4000
    rotation = (np.arange(count) + 0.5) * 2.0 * pi / count
    found = uneven(runout, rotation, helix=helix).tangential.mean()
    highest = 1.0 + (max(runout) - min(runout)) / 0.1
    variation = 2.0 * teeth * 2.0 * teeth * highest
    lag = min(2.0 * 2.0 * tan(helix) / 10.0, pi)
    kinks = 2.0 * lag * peano() * teeth * 4.0 * teeth
    mean = teeth / (2.0 * pi) * 2.0 * 2.0
    assert found == pytest.approx(mean, abs=0.5 * variation / count + kinks + 1e-6)


def peano() -> float:
    """Greatest of Peano's kernel of the second order of six Gauss points on 0 … 1."""
    nodes, weights = np.polynomial.legendre.leggauss(6)
    nodes, weights = 0.5 * (nodes + 1.0), 0.5 * weights
    at = np.linspace(0.0, 1.0, 2001)
    quadrature = (np.maximum(nodes - at[:, None], 0.0) * weights).sum(axis=1)
    return float(np.abs(0.5 * (1.0 - at) ** 2 - quadrature).max())


def test_one_high_tooth_takes_the_feed_of_a_revolution() -> None:
    found = uneven([0.5, 0.0, 0.0, 0.0], np.array([0.5 * pi, pi - 1e-3]))
    assert found.tangential[0, 0] == pytest.approx(2.0 * 4.0)
    # The second tooth is at 90° in its turn, and has nothing left to cut.
    assert found.tangential[0, 1] == pytest.approx(2.0 * 4.0 * 1e-3, rel=0.01)


def test_a_tooth_follows_the_one_before_it() -> None:
    """Tooth 1, a high one, is at 90° a quarter of a turn later."""
    found = uneven([0.0, 0.5, 0.0, 0.0], np.array([0.5 * pi, pi - 1e-3, pi, 1.5 * pi]))
    assert found.tangential[0].argmax() in {1, 2}


def test_an_eccentric_cutter_has_no_runout_in_the_mean() -> None:
    runout = eccentric_runout(0.01, 4)
    np.testing.assert_allclose(runout, [0.01, 0.0, -0.01, 0.0], atol=1e-15)
    assert (runout - np.roll(runout, 1)).sum() == pytest.approx(0.0)


def test_an_eccentricity_out_of_range_is_refused() -> None:
    with pytest.raises(ValueError, match="number of teeth 0"):
        eccentric_runout(0.01, 0)
    with pytest.raises(ValueError, match="eccentricity -1 mm must not be negative"):
        eccentric_runout(-1.0, 2)


def test_a_runout_is_wanted_for_each_tooth() -> None:
    edges = CuttingEdges(teeth=4, diameter=10.0)
    runout = Runout(offsets=np.zeros(3), feed_per_tooth=np.full(1, 0.1))
    slot = one_place(0.0, pi, axial_depth=2.0)
    with pytest.raises(ValueError, match=r"runout has shape \(3,\) and must have \(4,\)"):
        forces(edges, slot, LINEAR, rotation=np.zeros((1, 1)), runout=runout)
