"""What an estimate says of itself."""

import numpy as np

from extras.calibration.model.features import Calibration, Estimate, Parameter


def test_reason_means_not_identified() -> None:
    known = Estimate(parameter=Parameter.BASE, value=300.0, low=280.0, high=320.0)
    lost = Estimate(
        parameter=Parameter.INERTIA, value=0.0, low=0.0, high=1.0, reason="too small"
    )
    assert known.is_identified
    assert not lost.is_identified
    assert (known.unit, lost.unit) == ("W", "kg·m²")
    both = Calibration(estimates=(known, lost), noise={}, blocks=1)
    np.testing.assert_array_equal(both.values, [300.0, 0.0])
