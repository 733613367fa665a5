"""Measured targets of runs, from recordings as ``stepnc record`` or ``simulate`` write them.

A table of runs without the target may name a recording for each run in its column
``recording``, relative to the table. Powers are integrated between samples along straight
lines, from the start of the program to its end where the file tells them. Units s, W, J.
"""

from pathlib import Path

import numpy as np
import pyarrow as pa

from service.learning.table import Floats
from service.recording.table import batches, headings
from simulator.client.columns import EXECUTION, RUNNING, TIME
from stepnc_model.errors import StepNcError

RECORDING = "recording"
POWER = "electric_wattage"
"""Column of the total power."""

RECORDED = ("time_s", "energy_j", "total_power_w", "peak_power_w")
"""Targets that a recording tells."""


def with_recorded(table: pa.Table, target: str, *, folder: Path) -> pa.Table:
    """Table with its target, from recordings if it has none itself.

    Parameters
    ----------
    table : pa.Table
    target : str
    folder : Path
        What paths of recordings are relative to.

    Raises
    ------
    StepNcError
        When a recording cannot be read, or does not tell the target.
    """
    if target in table.column_names or RECORDING not in table.column_names:
        return table
    if target not in RECORDED:
        raise StepNcError(f"recordings do not tell {target}, only {', '.join(RECORDED)}")
    column = RECORDED.index(target)
    values = [_told(folder / str(name))[column] for name in table[RECORDING].to_pylist()]
    return table.append_column(target, pa.array(values, pa.float64()))


def _told(path: Path) -> Floats:
    """Time, energy, mean and greatest power of a recording, as ``RECORDED``."""
    names = headings(path)
    for needed in (TIME, POWER):
        if needed not in names:
            raise StepNcError(f"{path}: no column {needed}")
    kinds = {TIME: pa.float64(), POWER: pa.float64()}
    if EXECUTION in names:
        kinds[EXECUTION] = pa.string()
    times, powers = [], []
    for batch in batches(path, kinds):
        time, power = (
            batch.column(name).to_numpy(zero_copy_only=False) for name in (TIME, POWER)
        )
        is_known = np.isfinite(time) & np.isfinite(power)
        if EXECUTION in kinds:
            words = batch.column(EXECUTION).to_pylist()
            is_known &= np.array([word in RUNNING for word in words])
        times.append(time[is_known])
        powers.append(power[is_known])
    time, power = (np.concatenate([np.zeros(0), *each]) for each in (times, powers))
    steps = np.diff(time)
    if len(time) < 2 or not (steps >= 0.0).all() or not steps.sum() > 0.0:
        raise StepNcError(f"{path}: needs rising times of a run with {POWER}")
    energy = float(steps @ (power[1:] + power[:-1])) / 2.0
    duration = float(steps.sum())
    return np.array([duration, energy, energy / duration, float(power.max())])
