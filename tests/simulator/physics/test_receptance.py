"""How a structure gives by frequency."""

from dataclasses import replace
from math import pi

import numpy as np
import pytest

from simulator.physics.stability import ModalStructure, chatter_frequencies, receptance
from simulator.spec import ModeDirection, VibratingPart, VibrationMode

MODE = VibrationMode(
    part=VibratingPart.TOOL,
    tool="mill",
    direction=ModeDirection.X,
    natural_frequency=600.0,
    damping_ratio=0.03,
    stiffness=10_000.0,
    source="test",
)


def test_receptance_is_the_flexibility_at_rest_and_a_peak_of_half_over_damping() -> None:
    at_rest, at_peak = receptance((MODE,), np.array([1e-6, 2.0 * pi * 600.0]))
    assert at_rest == pytest.approx(1e-4)
    assert at_peak == pytest.approx(-1j / (2.0 * 0.03 * 10_000.0))


def test_the_least_real_part_is_that_of_the_textbook() -> None:
    """``−1/(4kζ(1 + ζ))``, and it is met by the frequencies that are tried."""
    found = receptance((MODE,), chatter_frequencies((MODE,))).real.min()
    assert found == pytest.approx(-1.0 / (4.0 * 10_000.0 * 0.03 * 1.03), rel=1e-4)


def test_modes_add_up_and_none_is_rigid() -> None:
    other = replace(MODE, natural_frequency=900.0)
    at = chatter_frequencies((MODE, other))
    both = receptance((MODE, other), at)
    assert both == pytest.approx(receptance((MODE,), at) + receptance((other,), at))
    assert not receptance((), at).any()


def test_chatter_frequencies_ascend_and_reach_beyond_all_modes() -> None:
    found = chatter_frequencies((MODE, replace(MODE, natural_frequency=2_000.0)))
    assert (np.diff(found) > 0.0).all()
    assert found[0] < 0.1 * 2.0 * pi * 600.0
    assert found[-1] > 5.0 * 2.0 * pi * 2_000.0


def test_a_structure_without_modes_is_refused() -> None:
    with pytest.raises(ValueError, match="at least one mode"):
        ModalStructure(x=(), y=())
