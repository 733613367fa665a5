"""Calibration on a real mill: four runs fitted, five others predicted.

Blocks are rebuilt from commanded positions, block numbers and the rapid flag of the calibration
runs, without times; feeds are those of the data set's table. The calibration runs are the first
of each feed rate. Prints cycle times, energies and the skill over the baseline that knows no
physics: mean power of the calibration runs times the measured time.
"""

import argparse
import csv
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from simulator.calibration.cycle_time import (
    NO_PAUSES,
    Observed,
    Pauses,
    ProgramRun,
    fitted_pauses,
)
from simulator.calibration.features import RunFeatures, design, powers
from simulator.calibration.fit import Calibration, Prior, fitted
from simulator.calibration.features import Parameter
from simulator.calibration.measured_run import Component
from simulator.calibration.rebuild import Rebuilt, rebuilt
from simulator.calibration.skill import Skill, compared, estimated_lag, mean_power
from simulator.calibration.smart_mill import RAPID, SAMPLE_TIME, SmartRun, read_smart_run
from simulator.calibration.thread import shifted, stations
from simulator.motion.exact_stop import ExactStop
from simulator.motion.motion import AxisLimits
from simulator.motion.segments import Floats

DATA = Path(__file__).parents[2] / "shared" / "data" / "umich_smart"
