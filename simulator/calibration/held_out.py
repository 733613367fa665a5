"""Prediction errors on data not used for fitting: other runs, or the end of a single run."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from simulator.calibration.features import (
    Calibration,
    Parameter,
    ParameterPrior,
    RunFeatures,
    design,
    powers,
)
from simulator.calibration.fit import fitted
from simulator.calibration.measured_run import Component
from simulator.calibration.skill import Skill, compared, mean_power

FITTED_SHARE = 0.7
"""Share of a single run's samples used for fitting; the rest is held out."""


@dataclass(frozen=True, slots=True, kw_only=True)
class HeldOut:
    """Prediction errors of a run, or part of a run, that was not used for fitting."""

    name: str
    skills: Mapping[Component, Skill]


def held_out(
    runs: Sequence[RunFeatures],
    priors: Mapping[Parameter, ParameterPrior],
    *,
    efficiency: float,
) -> tuple[HeldOut, ...]:
    """Errors of each run predicted from the others; of a single run from its first part.

    Parameters
    ----------
    runs : sequence of RunFeatures
        Runs with measured powers.
    priors : mapping of ParameterPrior
    efficiency : float
        Efficiency of the spindle.
    """
    if len(runs) == 1:
        cut = int(FITTED_SHARE * len(runs[0]))
        pairs = [([_rows(runs[0], slice(0, cut))], _rows(runs[0], slice(cut, None)))]
    else:
        pairs = [([other for other in runs if other is not run], run) for run in runs]
    return tuple(
        HeldOut(
            name=run.name,
            skills=skills(
                run, others, fitted(others, priors, efficiency=efficiency), efficiency
            ),
        )
        for others, run in pairs
    )


def skills(
    run: RunFeatures, others: Sequence[RunFeatures], calibration: Calibration, efficiency: float
) -> dict[Component, Skill]:
    """Prediction errors of each measured power of a run, with a calibration from other runs."""
    values = calibration.values
    table = design(run, efficiency=efficiency)
    model = powers(table, values)
    idle = powers(
        design(replace(run, cutting_power=np.zeros(len(run))), efficiency=efficiency), values
    )
    known = [part for part in run.measured if all(part in other.measured for other in others)]
    return {
        part: compared(
            run.measured[part],
            model[part],
            duration=run.duration,
            model_energy=float(model[part] @ run.duration),
            idle=idle[part],
            baseline=mean_power(
                [other.measured[part] for other in others], [other.duration for other in others]
            ),
        )
        for part in known
    }


def _rows(run: RunFeatures, rows: slice) -> RunFeatures:
    """Select a range of the samples of a run."""
    return RunFeatures(
        name=run.name,
        duration=run.duration[rows],
        spindle_speed=run.spindle_speed[rows],
        spindle_acceleration=run.spindle_acceleration[rows],
        velocity=run.velocity[rows],
        acceleration=run.acceleration[rows],
        cutting_power=run.cutting_power[rows],
        coolant=run.coolant[rows],
        measured={part: watts[rows] for part, watts in run.measured.items()},
    )
