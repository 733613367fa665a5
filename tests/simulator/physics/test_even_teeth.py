"""Forces of equal teeth in closed form against Gauss along the edge and against quadrature."""

from math import cos, pi, radians, sin

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad

from simulator.physics.flutes import CuttingEdges, ForceLaw
from simulator.physics.tooth_forces import forces, one_place
from simulator.physics.uneven_teeth import Runout
from tests.every_case import every_case

ROTATION = np.linspace(0.0, 2.0 * pi, 97)[None, :]


@given(
    teeth=st.integers(1, 6),
    helix=st.floats(0.0, radians(60.0)),
    corner=st.sampled_from([0.0, 0.5, 5.0]),
    depth=st.floats(0.1, 60.0),
    entry=st.floats(0.0, 3.0),
    contact=st.floats(0.05, pi),
    exponent=st.floats(0.6, 1.0),
)
def test_closed_form_equals_gauss_along_the_edge(
    *,
    teeth: int,
    helix: float,
    corner: float,
    depth: float,
    entry: float,
    contact: float,
    exponent: float,
) -> None:
    """A runout of nothing is integrated by nodes, which miss the root of sin φ by a little."""
    edges = CuttingEdges(teeth=teeth, diameter=10.0, helix_angle=helix, corner_radius=corner)
    place = one_place(entry, min(entry + contact, pi), axial_depth=depth)
    none = Runout(offsets=np.zeros(teeth), feed_per_tooth=np.ones(1))
    law = ForceLaw(exponent=exponent)
    one = forces(edges, place, law, rotation=ROTATION)
    other = forces(edges, place, law, rotation=ROTATION, runout=none)
    for name in ("tangential", "feed", "normal"):
        found, expected = getattr(one, name), getattr(other, name)
        atol = 2e-3 * float(np.abs(other.tangential).max(initial=1e-9))
        np.testing.assert_allclose(found, expected, rtol=0.0, atol=atol)


@every_case("exponent", [0.65, 0.8, 1.0])
@every_case(("bottom", "top"), [(0.0, 0.05), (0.0, 0.6), (1.0, 2.2), (0.3, pi)])
def test_stretch_of_edge_is_that_of_quadrature(
    exponent: float, bottom: float, top: float
) -> None:
    """The edge of one tooth reaches all over the arc, whose ends cut it off."""
    edges = CuttingEdges(teeth=1, diameter=10.0, helix_angle=0.5)
    depth = (pi + 0.1) / edges.lag
    found = forces(
        edges,
        one_place(bottom, top, axial_depth=depth),
        ForceLaw(exponent=exponent, radial_share=0.0),
        rotation=np.array([[pi + 0.05]]),
    )
    share = depth / (edges.lag * depth)
    for values, of in (
        (found.tangential, lambda _: 1.0),
        (found.feed, cos),
        (found.normal, sin),
    ):
        exact, _ = quad(lambda phi, of=of: sin(phi) ** exponent * of(phi), bottom, top)
        assert float(values[0, 0]) == pytest.approx(share * exact, rel=1e-5)
