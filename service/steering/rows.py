"""The rows of a run under control as others read them: in the user's units, named with them."""

from collections.abc import Mapping, Sequence

import numpy as np

from service.control.trace import Moment
from simulator.motion.segments import Floats
from stepnc_model.units import mm_min_from_speed

FEED, RATE = mm_min_from_speed(1.0), 0.001 * mm_min_from_speed(1.0)
"""mm/min in one mm/s, cm³/min in one mm³/s"""

PER_CENT = 100.0

COLUMNS: Mapping[str, tuple[str, float]] = {
    "time_s": ("time", 1.0),
    "progress_s": ("progress", 1.0),
    "x_mm": ("x", 1.0),
    "y_mm": ("y", 1.0),
    "z_mm": ("z", 1.0),
    "feed_programmed_mm_min": ("feed_programmed", FEED),
    "feed_actual_mm_min": ("feed_actual", FEED),
    "override_commanded_percent": ("override_commanded", PER_CENT),
    "override_actual_percent": ("override_actual", PER_CENT),
    "force_set_point_n": ("set_point", 1.0),
    "force_measured_n": ("force_measured", 1.0),
    "force_expected_n": ("force_expected", 1.0),
    "force_true_n": ("force_true", 1.0),
    "force_ratio": ("force_ratio", 1.0),
    "spindle_power_w": ("spindle_power", 1.0),
    "spindle_power_true_w": ("spindle_power_true", 1.0),
    "removal_rate_cm3_min": ("removal_rate", RATE),
    "axial_depth_mm": ("axial_depth", 1.0),
    "flank_wear_mm": ("flank_wear", 1.0),
}
"""name of each column, what of a moment it shows, how many of its unit are in one of ours"""

_PLACES = [Moment._fields.index(name) for name, _ in COLUMNS.values()]
_SCALES = np.array([scale for _, scale in COLUMNS.values()])


def rows_of(moments: Sequence[Moment]) -> Floats:
    """(M, C) rows of as many moments."""
    rows = [[moment[place] for place in _PLACES] for moment in moments]
    values: Floats = np.array(rows, dtype=np.float64).reshape(-1, len(_PLACES)) * _SCALES
    return values
