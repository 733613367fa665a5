"""The trace is bounded, keeps every peak, and does not see how samples come in chunks."""

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from service.simulation_trace import FINEST, MOST, Signal, Trace, TraceKeeper
from simulator.machine.samples import Samples
from simulator.motion.segments import Floats
from tests.service.conftest import made_samples

SampleMaker = Callable[[Floats, Floats], Samples]
HOUR = 3600.0


def traced(time: Floats, force: Floats, cuts: list[int]) -> Trace:
    keeper = TraceKeeper()
    ends = [0, *sorted(cut % (len(time) + 1) for cut in cuts), len(time)]
    for begin, end in zip(ends[:-1], ends[1:], strict=True):
        keeper.add(made_samples(time[begin:end], force[begin:end]))
    return keeper.trace()
