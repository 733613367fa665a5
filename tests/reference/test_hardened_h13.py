"""Turning of hardened AISI H13, two series of force measurements: what wear adds.

At VB 0.1 and 0.3 mm the cutting force is 1.22 and 1.54 times that of a new edge, the feed force
1.54 and 3.29 times, the back force 1.67 and 3.54 times. With a new edge feed and back force are
0.33 to 0.58 and 0.48 to 0.89 of the cutting force. Wear adds 490 ± 80 N to the cutting force
for each mm of width and of VB at 0.3 mm, 617 ± 443 at 0.1 mm; at a depth of 0.25 mm 42 N,
whatever the feed.
"""

import pytest

from simulator.library import load_material
from simulator.physics import flank
from simulator.physics.turning import force_share

FEED_SHARES, BACK_SHARES = (0.33, 0.58), (0.48, 0.89)


def test_wear_of_0_3_mm_adds_42_n_at_a_depth_of_0_25_mm() -> None:
    found = flank.land_force(flank.CUTTING, 0.3, 0.25)
    spread = 80.0 / flank.CUTTING * found
    assert found == pytest.approx(42.0, abs=spread)


def test_coefficient_of_the_cutting_force_is_within_both_measurements() -> None:
    assert flank.CUTTING == 490.0
    assert pytest.approx(617.0, abs=443.0) == flank.CUTTING


@pytest.mark.parametrize(
    ("coefficient", "gain", "shares"),
    [(flank.FEED, 3.29 - 1.0, FEED_SHARES), (flank.BACK, 3.54 - 1.0, BACK_SHARES)],
)
def test_coefficients_across_follow_from_what_wear_multiplied(
    coefficient: float, gain: float, shares: tuple[float, float]
) -> None:
    """``c_i = c · s_i·(K_i − 1)/(K_c − 1)``: what was added of each over that of F_c."""
    low, high = (flank.CUTTING * share * gain / 0.54 for share in shares)
    assert low < coefficient < high
    assert coefficient == pytest.approx(0.5 * (low + high), rel=0.01)


@pytest.mark.parametrize(
    ("coefficient", "gain", "shares"),
    [(flank.FEED, 1.54 - 1.0, FEED_SHARES), (flank.BACK, 1.67 - 1.0, BACK_SHARES)],
)
def test_at_0_1_mm_they_lie_within_the_wide_spread_of_that_measurement(
    coefficient: float, gain: float, shares: tuple[float, float]
) -> None:
    least = (617.0 - 443.0) * shares[0] * gain / 0.22
    most = (617.0 + 443.0) * shares[1] * gain / 0.22
    assert least < coefficient < most


def test_hardened_steel_has_the_measured_shares() -> None:
    steel = load_material("hardened_55hrc")
    assert steel.feed_force is not None
    assert steel.back_force is not None
    feed = force_share(steel.feed_force, steel.kienzle, 0.1)
    back = force_share(steel.back_force, steel.kienzle, 0.1)
    assert FEED_SHARES[0] < feed < FEED_SHARES[1]
    assert BACK_SHARES[0] < back < BACK_SHARES[1]
