"""König and Essel, after Klocke, "Manufacturing Processes 1: Cutting", 2011: C45.

``F_i = k_i1.1·b·h^(1−m_i)`` with 1659 N/mm² and 0.79 (cutting), 521 and 0.51 (feed), 309 and
0.60 (back force).
"""

import pytest

from simulator.library import load_material
from simulator.physics.turning import TurningCut, cutting_force, turning_forces
from simulator.spec import Kienzle


@pytest.mark.parametrize("feed", [0.1, 0.25, 0.4])
def test_c45_has_the_three_forces_of_its_pairs(feed: float) -> None:
    material, depth = load_material("c45"), 2.5
    cut = TurningCut(feed_per_revolution=feed, depth=depth)
    for k_c in (material.kienzle, Kienzle(k_c11=1659.0, m_c=0.21)):
        forces = turning_forces(
            cutting_force(k_c, cut),
            cut.chip_thickness,
            cutting=k_c,
            feed=material.feed_force,
            back=material.back_force,
        )
        # Of their own, whatever source the cutting force is from.
        assert forces.feed == pytest.approx(521.0 * depth * feed**0.51)
        assert forces.back == pytest.approx(309.0 * depth * feed**0.60)
