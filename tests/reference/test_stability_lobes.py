"""Lobes against print, and against a judge that is itself held against print.

The cutter is the benchmark of milling stability: two teeth, 922 Hz, ζ = 0.011, 0.03993 kg,
K_t = 6·10⁸ and K_n = 2·10⁸ N/m² (T. Insperger, G. Stépán, "Updated semi-discretization method
for periodic delay-differential equations with discrete delay", Int. J. Numer. Meth. Eng. 61
(2004) 117-141). The judge keeps all harmonics of the cut; zero order keeps none.
"""

from dataclasses import replace
from math import pi

import numpy as np
import pytest

from simulator.physics.engagement import (
    Engagement,
    conventional,
    full_immersion,
    unidirectional,
)
from simulator.physics.stability import DynamicCut, ModalStructure, stable_depths
from simulator.physics.turning_stability import orthogonal_limit
from simulator.spec import ModeDirection, VibratingPart, VibrationMode
from tests.reference.semidiscretisation import Case, is_border, multiplier, with_engagement

MASS, FREQUENCY, DAMPING = 0.03993, 922.0, 0.011
ONE = Case(
    mass=(MASS,),
    frequency=(FREQUENCY,),
    damping=(DAMPING,),
    tangential=6e8,
    radial=2e8,
    teeth=2,
    entry=0.0,
    exit=pi,
)
TWO = replace(ONE, mass=(MASS,) * 2, frequency=(FREQUENCY,) * 2, damping=(DAMPING,) * 2)
MODE = VibrationMode(
    part=VibratingPart.TOOL,
    tool="benchmark",
    direction=ModeDirection.XY,
    natural_frequency=FREQUENCY,
    damping_ratio=DAMPING,
    stiffness=MASS * (2.0 * pi * FREQUENCY) ** 2 / 1e3,
    source="Insperger and Stépán 2004",
)
SPEEDS = np.geomspace(70.0, 420.0, 6000)


@pytest.mark.parametrize(("depth_mm", "printed"), [(0.2, 0.8192), (0.5, 1.0726), (1.0, 1.4040)])
def test_the_judge_meets_the_printed_multipliers(depth_mm: float, printed: float) -> None:
    """Y. Ding, L. M. Zhu, X. J. Zhang, H. Ding, "A full-discretization method for prediction of
    milling stability", Int. J. Mach. Tools Manuf. 50 (2010) 502-509, and papers after it: the
    multipliers of the benchmark in a slot at 5000 rpm against which convergence is told. They
    are those of some 200 steps; the judge's own limit of many steps lies 0.2 % higher."""
    found = multiplier(ONE, rpm=5000.0, depth=depth_mm / 1e3, steps=200)
    assert found == pytest.approx(printed, abs=3e-4)


def zero_order(
    engagement: Engagement, *, mode: VibrationMode = MODE, teeth: int = 2
) -> ModalStructure:
    return ModalStructure(x=(mode,), y=(mode,))


def depths_at(rpm: list[float], engagement: Engagement) -> list[float]:
    """Stable depths by zero order, mm."""
    cut = DynamicCut(engagement=engagement, teeth=2, stiffness=600.0, radial_ratio=1.0 / 3.0)
    depths = stable_depths(cut, ModalStructure(x=(MODE,), y=(MODE,)), SPEEDS)
    return [float(np.interp(each / 60.0, SPEEDS, depths)) for each in rpm]


CUTS = {
    "slot": full_immersion(),
    "three quarters, down": unidirectional(7.5, 10.0),
    "half, up": conventional(5.0, 10.0),
    "half, down": unidirectional(5.0, 10.0),
}


@pytest.mark.parametrize("name", CUTS)
def test_the_floor_of_the_lobes_agrees_with_the_judge(name: str) -> None:
    """Between the peaks, where most speeds lie, within 5 %."""
    cut = CUTS[name]
    case = with_engagement(TWO, entry=cut.entry_angle, exit=cut.exit_angle)
    speeds = [5_000.0, 11_000.0, 18_000.0]
    for rpm, found in zip(speeds, depths_at(speeds, cut), strict=True):
        assert is_border(case, rpm=rpm, depth=found / 1e3, within=0.05), f"{rpm} rpm"


@pytest.mark.parametrize("name", CUTS)
def test_the_flanks_of_the_peaks_agree_with_the_judge(name: str) -> None:
    """Near the peaks the harmonics that zero order leaves out weigh most: within 15 %."""
    cut = CUTS[name]
    case = with_engagement(TWO, entry=cut.entry_angle, exit=cut.exit_angle)
    speeds = [7_000.0, 9_000.0, 14_000.0, 24_000.0]
    for rpm, found in zip(speeds, depths_at(speeds, cut), strict=True):
        assert is_border(case, rpm=rpm, depth=found / 1e3, within=0.15), f"{rpm} rpm"


def test_below_a_tenth_of_the_diameter_zero_order_is_far_off() -> None:
    """Which is why it is not used there."""
    cut = unidirectional(0.5, 10.0)
    case = with_engagement(TWO, entry=cut.entry_angle, exit=cut.exit_angle)
    (found,) = depths_at([18_000.0], cut)
    assert not is_border(case, rpm=18_000.0, depth=found / 1e3, within=0.3)


@pytest.mark.parametrize("damping", [0.02, 0.05])
def test_a_usual_end_mill_agrees_with_the_judge_within_a_few_per_cent(damping: float) -> None:
    """Four teeth and the damping of a tool in its holder: harmonics hardly matter."""
    frequency, stiffness, cut = 1_150.0, 14_000.0, full_immersion()
    mass = stiffness * 1e3 / (2.0 * pi * frequency) ** 2
    case = replace(
        TWO,
        mass=(mass,) * 2,
        frequency=(frequency,) * 2,
        damping=(damping,) * 2,
        tangential=767e6,
        radial=168.8e6,
        teeth=4,
    )
    mode = replace(
        MODE, natural_frequency=frequency, damping_ratio=damping, stiffness=stiffness
    )
    dynamic = DynamicCut(engagement=cut, teeth=4, stiffness=767.0, radial_ratio=168.8 / 767.0)
    depths = stable_depths(dynamic, ModalStructure(x=(mode,), y=(mode,)), SPEEDS)
    for rpm in (7_000.0, 8_500.0, 10_500.0, 12_000.0, 17_000.0):
        found = float(np.interp(rpm / 60.0, SPEEDS, depths))
        assert is_border(case, rpm=rpm, depth=found / 1e3, within=0.05), f"{rpm} rpm"


def test_turning_meets_the_printed_closed_form() -> None:
    """``b_lim = 2kζ(1 + ζ)/K_f``: Tlusty's limit as Altintas, "Manufacturing Automation", 2012,
    ch. 4, and Schmitz and Smith, "Machining Dynamics", 2009, ch. 3, print it; by hand for
    k = 22.6 N/µm, ζ = 0.012, K_f = 1000 N/mm²: 0.549 mm."""
    mode = replace(
        MODE,
        direction=ModeDirection.Z,
        natural_frequency=250.0,
        damping_ratio=0.012,
        stiffness=22_600.0,
    )
    assert orthogonal_limit((), (mode,), stiffness=1_000.0) == pytest.approx(0.549, abs=5e-4)
