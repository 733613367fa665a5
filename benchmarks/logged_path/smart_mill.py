"""Runs of the three-axis mill of the University of Michigan's SMART lab, as they were logged.

The files hold ten samples a second and no time; numbers are rounded to three digits. A log is
a sequence of packets of about ten samples, the first of which shows the number of a block of
the logger's own; in all but one file the packets are out of order. What belongs to the program
is told by block numbers and by the commanded speed of the spindle.

References
----------
.. [1] System-level Manufacturing and Automation Research Testbed, "CNC milling dataset",
   University of Michigan, 2018, CC0.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from benchmarks.logged_path.sampled_path import PathSamples
from extras.calibration.model.measured_run import Component, read_columns
from simulator.errors import CalibrationError
from simulator.motion.segments import Bools, Floats
from stepnc_model.units import watts_from_kw

SAMPLE_TIME = 0.1  # s, [1]
RAPID = 50.0  # mm/s, the feed rate that is shown in rapid
DIGITS = 3
LOGGER_BLOCK = 2
APPROACH = (4, 9)
"""blocks before the spindle turns"""
_POSITION = tuple(f"{axis}1_CommandPosition" for axis in "XYZ")
_VELOCITY = tuple(f"{axis}1_CommandVelocity" for axis in "XYZS")
_ACCELERATION = tuple(f"{axis}1_CommandAcceleration" for axis in "XYZS")
_KILOWATTS = {
    Component.X: "X1_OutputPower",
    Component.Y: "Y1_OutputPower",
    Component.SPINDLE: "S1_OutputPower",
}
_BLOCK, _FEED = "M1_sequence_number", "M1_CURRENT_FEEDRATE"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SmartRun:
    """N samples, 0.1 s apart, in the order of the file."""

    name: str
    samples: PathSamples
    velocity: Floats
    """(N, 3) mm/s, commanded"""
    acceleration: Floats
    """(N, 3) mm/s², commanded, mean over some milliseconds"""
    spindle_speed: Floats
    """(N,) rev/s, commanded"""
    spindle_acceleration: Floats
    """(N,) rev/s², commanded"""
    power: Mapping[Component, Floats]
    """each (N,) W"""
    is_program: Bools
    """(N,) whether the program runs; else the machine stands, or is moved by hand"""


def read_smart_run(path: Path) -> SmartRun:
    """Run of one of the data set's files.

    Raises
    ------
    CalibrationError
        A column is missing, or holds no numbers.
    """
    wanted = (*_POSITION, *_VELOCITY, *_ACCELERATION, *_KILOWATTS.values(), _BLOCK, _FEED)
    columns, _ = read_columns(path, wanted=wanted)
    missing = [name for name in wanted if name not in columns]
    if missing:
        raise CalibrationError("missing", path=str(path), column=missing[0])
    position = np.stack([columns[name] for name in _POSITION], axis=1)
    velocity = np.stack([columns[name] for name in _VELOCITY], axis=1)
    acceleration = np.stack([columns[name] for name in _ACCELERATION], axis=1)
    block = _program_blocks(columns[_BLOCK])
    is_approach = (block >= APPROACH[0]) & (block <= APPROACH[1])
    return SmartRun(
        name=path.stem,
        samples=PathSamples(
            position=position,
            block=block,
            is_rapid=columns[_FEED] == RAPID,
            half_step=_half_step(position),
        ),
        velocity=velocity[:, :3],
        acceleration=acceleration[:, :3],
        spindle_speed=velocity[:, 3],
        spindle_acceleration=acceleration[:, 3],
        power={part: watts_from_kw(1.0) * columns[name] for part, name in _KILOWATTS.items()},
        is_program=is_approach | (velocity[:, 3] > 0.0),
    )


def _program_blocks(block: Floats) -> Floats:
    """Block numbers, the logger's own replaced by that of the next sample of its packet."""
    after = np.append(block[1:], block[-1:])
    return np.where(block == LOGGER_BLOCK, after, block)


def _half_step(position: Floats) -> Floats:
    """Half of the last digit that the file shows."""
    magnitude = np.floor(np.log10(np.maximum(np.abs(position), 1e-3)))
    return 0.5 * 10.0 ** (magnitude - (DIGITS - 1))
