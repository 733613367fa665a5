"""A chain of motions is the motions one after another."""

import numpy as np
import pytest

from simulator.motion.control import ExactStop
from simulator.motion.fir import Chain
from simulator.motion.segments import AxisLimits, chained, lines

FIRST = lines([(0, 0, 0), (10, 0, 0), (10, 5, 0)], speed=20.0)
SECOND = lines([(10, 5, 0), (10, 5, 30)])


def test_a_chain_of_exact_stops_is_one_exact_stop(limits: AxisLimits) -> None:
    control = ExactStop()
    chain = Chain(motions=[control.plan(part, limits) for part in (FIRST, SECOND)])
    whole = control.plan(chained([FIRST, SECOND]), limits)
    assert chain.duration == pytest.approx(whole.duration)
    assert chain.ends == pytest.approx(whole.ends)
    assert chain.ends[-1] == chain.duration == chain.knots[-1]
    assert set(np.round(whole.knots, 9)) <= set(np.round(chain.knots, 9))
    times = np.linspace(0.0, chain.duration, 997)
    one, other = chain.at(times), whole.at(times)
    assert one.position == pytest.approx(other.position, abs=1e-9)
    assert one.velocity == pytest.approx(other.velocity, abs=1e-6)
    assert one.segment.tolist() == other.segment.tolist()
    assert one.station == pytest.approx(other.station, abs=1e-9)


def test_no_motion_is_no_chain() -> None:
    with pytest.raises(ValueError, match="at least one motion"):
        Chain(motions=[])
