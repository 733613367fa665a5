"""Feed of a control by point spacing, after Vijayaraghavan et al. (2009), Table 2.

Beside print: the block time that its slope means, and what the motion of the library's
machining centre makes of the paper's circle. ``python examples/07_paper004_feed.py``.
"""

from dataclasses import replace
from math import asin

import numpy as np

from simulator.library import load_machine
from simulator.motion.control import control_model
from simulator.motion.model_name import ControlModelName
from simulator.motion.segments import axis_limits, lines

SPACINGS = np.array([0.0001, 0.00025, 0.0005, 0.00075, 0.001, 0.0025, 0.005, 0.0075, 0.01])
"""in"""
FEEDS = np.array([0.7, 3.6, 7.2, 10.5, 14.6, 35.6, 71.2, 106.7, 147.68])
"""in/min"""
SLOPE = 14_847.0
"""1/min"""
INCH, COUNT = 25.4, 400
LIMITS = replace(axis_limits(load_machine("vmc15")), block_time=60.0 / SLOPE)


def feed(spacing: float, control: ControlModelName) -> float:
    """in/min in the middle of points on a circle of 1 in, 200 in/min commanded."""
    angles = 2.0 * asin(0.5 * spacing) * np.arange(COUNT + 1)
    points = INCH * np.stack((np.cos(angles), np.sin(angles), 0.0 * angles), axis=1)
    path = lines(list(points), speed=200.0 * INCH / 60.0)
    ends = control_model(control, LIMITS).plan(path, LIMITS).ends
    first, last = COUNT // 2, 3 * COUNT // 4
    return (last - first) * spacing * 60.0 / (ends[last] - ends[first])


print("     in  print in/min  ms a block     law  law/print     fir  junction")
for spacing, printed in zip(SPACINGS, FEEDS, strict=True):
    law = SLOPE * spacing
    print(
        f"{spacing:7} {printed:13} {60e3 * spacing / printed:11.3f} {law:7.2f} "
        f"{law / printed:10.3f} {feed(spacing, ControlModelName.FIR):7.2f} "
        f"{feed(spacing, ControlModelName.JUNCTION):9.2f}"
    )
s, v = SPACINGS[1:], FEEDS[1:]
for words, slope in (("print", SLOPE), ("least squares without row 1", s @ v / (s @ s))):
    off = 100.0 * (slope * s / v - 1.0)
    print(
        f"{words:27} {slope:6.0f} /min, {60e3 / slope:.3f} ms: {off.min():+.1f} to "
        f"{off.max():+.1f} % beside rows 2 to 9"
    )
