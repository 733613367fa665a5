import numpy as np
import pytest

from simulator.library import load_machine
from simulator.motion.segments import AxisLimits, axis_limits
from tests.every_case import every_case


def test_limits_of_a_mill_are_those_of_its_axes() -> None:
    machine = load_machine("vmc15")
    limits = axis_limits(machine)
    x, y, z = machine.axes
    assert limits.acceleration.tolist() == [x.acceleration, y.acceleration, z.acceleration]
    assert limits.rapid.tolist() == [x.rapid, y.rapid, z.rapid]
    assert limits.feed.tolist() == [x.max_feed, y.max_feed, z.max_feed]
    assert limits.jerk.tolist() == [x.jerk, y.jerk, z.jerk]
    assert limits.block_time == machine.block_time


def test_axis_that_a_lathe_has_not_does_not_limit() -> None:
    limits = axis_limits(load_machine("lathe22"))
    for limit in (limits.acceleration, limits.rapid, limits.feed):
        assert np.isfinite(limit).tolist() == [True, False, True]


@every_case("name", ["acceleration", "rapid", "feed", "jerk"])
def test_limit_that_is_not_positive_is_refused(name: str) -> None:
    columns = {each: np.ones(3) for each in ("acceleration", "rapid", "feed")}
    with pytest.raises(ValueError, match=f"{name} of X, Y and Z must be positive"):
        AxisLimits(**(columns | {name: np.array([1.0, 0.0, 1.0])}))


def test_negative_block_time_is_refused() -> None:
    one = np.ones(3)
    with pytest.raises(ValueError, match="block time -1 s"):
        AxisLimits(acceleration=one, rapid=one, feed=one, block_time=-1.0)
