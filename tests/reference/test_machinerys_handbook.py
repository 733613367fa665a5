"""Machinery's Handbook, 31st edition, pp. 1152-1153: thrust and torque of twist drills.

``T = 0.05·K_d·F_f·F_T·B + 0.007·K_d·D²·J`` in N, ``M = 0.000025·K_d·F_f·F_M·A`` in N·m, with
the factors of tables 7, 8 and 9 as printed. K_d of the material cancels in thrust over torque.
"""

import pytest

from simulator.physics.drilling import (
    LIPS_ONLY,
    DrillingCut,
    drilling_torque,
)
from simulator.spec import Kienzle
from simulator.tool_windows import DrillPoint
from stepnc_model.units import nm_from_nmm
from tests.every_case import every_case
from tests.oracles.cutting import drilling_thrust

FEED_FACTORS = {0.10: 0.158, 0.15: 0.219, 0.20: 0.276, 0.25: 0.330, 0.30: 0.382, 0.40: 0.480}
"""table 8, mm: F_f"""

DIAMETER_FACTORS = {
    4.0: (3.03, 12.12),
    8.0: (5.28, 42.22),
    12.5: (7.54, 94.28),
    16.0: (9.19, 147.0),
    24.0: (12.71, 305.1),
}
"""table 9, mm: F_T and F_M"""

CHISEL_FACTORS = {
    0.03: (1.000, 1.100, 0.001),
    0.10: (1.020, 1.235, 0.010),
    0.18: (1.085, 1.355, 0.030),
    0.30: (1.235, 1.500, 0.090),
}
"""table 7, c/D: A, B and J; 0.18 standard design, 0.03 split points"""

STEEL = Kienzle(k_c11=1500.0, m_c=0.22)


@every_case("ratio", CHISEL_FACTORS)
@every_case("diameter", DIAMETER_FACTORS)
@every_case("feed", FEED_FACTORS)
def test_thrust_over_torque_is_that_of_the_handbook(
    ratio: float, diameter: float, feed: float
) -> None:
    """Within 2 %: its force goes with f^0.8, Kienzle's with f^0.78."""
    torque_factor, thrust_factor, constant = CHISEL_FACTORS[ratio]
    for_thrust, for_torque = DIAMETER_FACTORS[diameter]
    printed_thrust = 0.05 * FEED_FACTORS[feed] * for_thrust * thrust_factor
    printed_thrust += 0.007 * diameter**2 * constant
    printed_torque = 0.000025 * FEED_FACTORS[feed] * for_torque * torque_factor
    cut = DrillingCut(
        feed_per_revolution=feed,
        tool_diameter=diameter,
        point=DrillPoint(thrust_share=LIPS_ONLY.thrust_share, chisel_ratio=ratio),
    )
    torque = nm_from_nmm(drilling_torque(STEEL, cut))
    found = drilling_thrust(STEEL, cut) / torque
    assert found == pytest.approx(printed_thrust / printed_torque, rel=0.02)
