"""Runs of the three-axis mill of the University of Michigan's SMART lab, as measured.

The files hold ten samples a second and no time; positions in mm are rounded to three digits.
A log is a sequence of packets of about ten samples, the first of which carries the number of
the logging block instead of the program's; in most files the packets are out of order. Which
rows belong to the program is told by block numbers and by the commanded spindle speed.

References
----------
.. [1] System-level Manufacturing and Automation Research Testbed, "CNC milling dataset",
   University of Michigan, 2018, CC0.
"""

import csv
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from simulator.calibration.measured_run import Component, MeasuredRun, read_columns
from simulator.errors import CalibrationError
from simulator.motion.segments import Bools, Floats, Ints

SAMPLE_TIME = 0.1  # s, [1]
LOGGING_BLOCK = 2
RAPID = 50.0  # mm/s, the feed rate shown in rapid
APPROACH = (4, 9)
"""blocks that run before the spindle turns"""
DIGITS = 3
"""significant digits of every number"""
_POSITION = tuple(f"{axis}1_CommandPosition" for axis in "XYZ")
_ACTUAL = tuple(f"{axis}1_ActualPosition" for axis in "XYZ")
_ACCELERATION = tuple(f"{axis}1_CommandAcceleration" for axis in "XYZ")
_POWER = {
    Component.X: "X1_OutputPower",
    Component.Y: "Y1_OutputPower",
    Component.SPINDLE: "S1_OutputPower",
}
_BLOCK, _FEED, _SPINDLE = "M1_sequence_number", "M1_CURRENT_FEEDRATE", "S1_CommandVelocity"
