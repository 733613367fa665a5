"""Calibration on a real mill: four runs fitted, five others predicted.

Blocks are rebuilt from commanded positions, block numbers and the shown feed rate (which tells
rapid from feed) of the calibration runs, without times; the feed is that of the data set's
table. The calibration runs are the first of each feed rate in that table. A run's time is 0.1 s
a sample, as its readme says. The baseline knows no physics: mean power of the calibration runs
times the measured time.
"""

import argparse
import csv
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from benchmarks.logged_path.cycle_time import (
    NO_PAUSES,
    ObservedTime,
    Pauses,
    ProgramRun,
    fitted_pauses,
)
from benchmarks.logged_path.rebuild import Rebuilt, rebuilt
from benchmarks.logged_path.sampled_path import shifted, stations
from benchmarks.logged_path.smart_mill import RAPID, SAMPLE_TIME, SmartRun, read_smart_run
from extras.calibration.model.features import (
    Calibration,
    Parameter,
    ParameterPrior,
    RunFeatures,
    design,
    powers,
)
from extras.calibration.model.fit import fitted
from extras.calibration.model.measured_run import Component
from extras.calibration.model.simulated_features import (
    Skill,
    compared,
    estimated_lag,
    mean_power,
    skill,
)
from simulator.machine.spindle_course import SpindleCourse, ramped, standing
from simulator.motion.control import ExactStop
from simulator.motion.segments import AxisLimits, Floats, Ints

DATA = Path(__file__).parents[2] / "shared" / "data" / "umich_smart"
MEASURED = (Component.SPINDLE, Component.X, Component.Y)
FINE_STEP = 0.01  # s, of the sum that is the predicted energy
MOST_LAG = 1.0  # s
CUTTING_ENERGY = 0.25  # J per mm of path in wax: some 1.5 W at 6 mm/s, an estimate
EFFICIENCY = 1.0
"""of the spindle; unknown, and idle power and inertia are as seen from the mains"""
PRIORS = {
    Parameter.BASE: ParameterPrior(value=0.0, scale=500.0),
    Parameter.COOLANT: ParameterPrior(value=0.0, scale=500.0),
    Parameter.IDLE: ParameterPrior(value=0.0, scale=100.0),
    Parameter.IDLE_PER_SPEED: ParameterPrior(value=0.0, scale=10.0),
    Parameter.IDLE_PER_SPEED_SQUARED: ParameterPrior(value=0.0, scale=0.05),
    Parameter.INERTIA: ParameterPrior(value=0.0, scale=0.01),
    Parameter.CUTTING: ParameterPrior(value=1.0, scale=0.5),
    **{
        name: ParameterPrior(value=0.0, scale=500.0)
        for name in Parameter
        if name.endswith(" friction")
    },
    **{name: ParameterPrior(value=0.0, scale=5.0) for name in Parameter if "viscous" in name},
    **{name: ParameterPrior(value=0.0, scale=100.0) for name in Parameter if "mass" in name},
}
"""wide: what a small mill might have"""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Log:
    """Logged samples of a run, in the order of the path."""

    name: str
    feed: float
    rows: Ints
    """(N,) rows of the file"""
    station: Floats
    """(N,) mm along the path, ascending"""
    run: SmartRun

    @property
    def seconds(self) -> float:
        """Measured time."""
        return SAMPLE_TIME * len(self.rows)

    def watts(self, part: Component) -> Floats:
        """(N,) measured."""
        return self.run.power[part][self.rows]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Mill:
    """Program and machine as found from four runs."""

    program: Rebuilt
    acceleration: float
    """mm/s² along the path"""
    spindle_speed: float
    spindle_acceleration: float
    pauses: Pauses
    calibration: Calibration
    baseline: Mapping[Component, float]
    """W"""
    runs: tuple[str, ...]
    cutting_energy: float = CUTTING_ENERGY
    """J per mm of path in feed, for a factor of 1"""


@dataclass(frozen=True, slots=True, kw_only=True)
class PredictedRun:
    """One held-out run."""

    name: str
    feed: float
    measured_time: float
    predicted_time: float
    skills: Mapping[Component, Skill]
    """TOTAL is what was measured: spindle, X and Y"""
    lag: float

    @property
    def time_error(self) -> float:
        """Signed share of the measured time."""
        return self.predicted_time / self.measured_time - 1.0


def main(arguments: list[str] | None = None) -> None:
    """Print parameters and errors."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--data", type=Path, default=DATA)
    options = parser.parse_args(arguments)
    if not (options.data / "train.csv").exists():
        print(f"skipped: no data in {options.data}")
        return
    feeds = read_feeds(options.data)
    chosen = calibration_runs(feeds)
    mill = calibrate({name: feeds[name] for name in chosen}, options.data)
    _print_mill(mill)
    held_out = [name for name in feeds if name not in chosen]
    _print_predictions([predict(mill, name, feeds[name], options.data) for name in held_out])


def read_feeds(data: Path) -> dict[str, float]:
    """Feed in mm/s by the name of the file, of the runs that are there."""
    with (data / "train.csv").open(encoding="utf-8", newline="") as stream:
        rows = {f"experiment_{int(row['No']):02d}": row for row in csv.DictReader(stream)}
    return {
        name: float(row["feedrate"])
        for name, row in rows.items()
        if (data / f"{name}.csv").exists()
    }


def calibration_runs(feeds: Mapping[str, float]) -> list[str]:
    """The first run of each feed rate."""
    return [name for name in feeds if name == next(n for n in feeds if feeds[n] == feeds[name])]


def calibrate(feeds: Mapping[str, float], data: Path) -> Mill:
    """Program, motion and powers from some runs, the first of them whole and in order."""
    runs = {name: read_smart_run(data / f"{name}.csv") for name in feeds}
    whole, *others = runs.values()
    rows = np.flatnonzero(whole.is_program)
    # The sample before the first move shows where the program starts from.
    skeleton = whole.samples[np.arange(rows[0] - 1, rows[-1] + 1)]
    parts = [run.samples[run.is_program] for run in others]
    program = rebuilt(skeleton, parts, rapid=RAPID)
    sizes = np.concatenate([np.linalg.norm(run.acceleration, axis=1) for run in runs.values()])
    turning = np.concatenate([run.spindle_speed for run in runs.values()])
    ramps = np.concatenate([run.spindle_acceleration for run in runs.values()])
    logs = [logged(run, program, feeds[name]) for name, run in runs.items()]
    mill = Mill(
        program=program,
        acceleration=float(np.round(sizes.max(), -1)),
        spindle_speed=float(turning.max()),
        spindle_acceleration=float(ramps.max()),
        pauses=NO_PAUSES,
        calibration=fitted([_features(log) for log in logs], PRIORS, efficiency=EFFICIENCY),
        baseline={part: _mean(logs, (part,)) for part in MEASURED}
        | {Component.TOTAL: _mean(logs, MEASURED)},
        runs=tuple(feeds),
    )
    return replace(mill, pauses=fitted_pauses([_observed(mill, log) for log in logs]))


def logged(run: SmartRun, program: Rebuilt, feed: float) -> Log:
    """A run's samples of the program in the order of the path."""
    course = program.course()
    rows = np.flatnonzero(run.is_program)
    station = stations(shifted(run.samples[rows], course), course)
    order = np.lexsort((run.spindle_speed[rows], station))
    return Log(name=run.name, feed=feed, rows=rows[order], station=station[order], run=run)


def predict(mill: Mill, name: str, feed: float, data: Path) -> PredictedRun:
    """Time and energy of a run of which only its feed and what part it did are looked at."""
    log = logged(read_smart_run(data / f"{name}.csv"), mill.program, feed)
    program = _run(mill, feed)
    begin, seconds = program.time_at(log.station[0]), program.time_at(log.station[-1])
    spindle = _spindle(mill, program)
    time = begin + SAMPLE_TIME * np.arange(len(log.rows), dtype=np.float64)
    total = sum((log.watts(part) for part in MEASURED), np.zeros(len(time)))
    lag = estimated_lag(
        time,
        total,
        lambda times: _watts(mill, program, spindle, times)[Component.TOTAL],
        most=MOST_LAG,
    )
    shown = _watts(mill, program, spindle, time - lag)
    fine: Floats = np.arange(begin, seconds, FINE_STEP)
    idle = _watts(replace(mill, cutting_energy=0.0), program, spindle, time - lag)
    whole = _watts(mill, program, spindle, fine)
    skills = {
        part: compared(
            total if part is Component.TOTAL else log.watts(part),
            shown[part],
            duration=np.full(len(time), SAMPLE_TIME),
            model_energy=float(whole[part].sum()) * FINE_STEP,
            idle=idle[part],
            baseline=mill.baseline[part],
        )
        for part in (*MEASURED, Component.TOTAL)
    }
    return PredictedRun(
        name=name,
        feed=feed,
        measured_time=log.seconds,
        predicted_time=seconds - begin,
        skills=skills,
        lag=lag,
    )


def _run(mill: Mill, feed: float) -> ProgramRun:
    """The program at a feed."""
    segments = mill.program.at_feed(feed)
    bound = np.full(3, np.inf)
    limits = AxisLimits(acceleration=np.full(3, mill.acceleration), rapid=bound, feed=bound)
    return ProgramRun(
        segments=segments,
        motion=ExactStop().plan(segments, limits),
        pauses=mill.pauses,
        start_block=int(np.argmin(segments.is_rapid)),
    )


def _observed(mill: Mill, log: Log) -> ObservedTime:
    """Measured time of a run beside that of its motion."""
    program = _run(mill, log.feed)
    begin, end = float(log.station[0]), float(log.station[-1])
    return ObservedTime(
        seconds=log.seconds,
        motion=program.time_at(end) - program.time_at(begin),
        blocks=program.blocks_before(end) - program.blocks_before(begin),
    )


def _spindle(mill: Mill, program: ProgramRun) -> SpindleCourse:
    """Speed of the spindle by time."""
    return ramped(
        standing(0.0),
        program.spindle_start,
        mill.spindle_speed,
        acceleration=mill.spindle_acceleration,
    )


def _watts(
    mill: Mill, program: ProgramRun, spindle: SpindleCourse, times: Floats
) -> Mapping[Component, Floats]:
    """Predicted powers at times; the total is that of what was measured."""
    state = program.at(np.maximum(times, 0.0))
    is_feed = ~program.segments.is_rapid[state.segment]
    run = RunFeatures(
        name="predicted",
        duration=np.full(len(times), 1.0),
        spindle_speed=spindle.speed(times),
        spindle_acceleration=spindle.acceleration(times),
        velocity=state.velocity,
        acceleration=state.acceleration,
        cutting_power=mill.cutting_energy * is_feed * np.linalg.norm(state.velocity, axis=1),
        coolant=np.zeros(len(times)),
        measured={},
    )
    watts = powers(design(run, efficiency=EFFICIENCY), mill.calibration.values)
    total = sum((watts[part] for part in MEASURED), np.zeros(len(times)))
    return {**watts, Component.TOTAL: total}


def _features(log: Log) -> RunFeatures:
    """A calibration run by its commanded motion."""
    rows, run = log.rows, log.run
    is_feed = ~run.samples.is_rapid[rows]
    return RunFeatures(
        name=log.name,
        duration=np.full(len(rows), SAMPLE_TIME),
        spindle_speed=run.spindle_speed[rows],
        spindle_acceleration=run.spindle_acceleration[rows],
        velocity=run.velocity[rows],
        acceleration=run.acceleration[rows],
        cutting_power=CUTTING_ENERGY * is_feed * np.linalg.norm(run.velocity[rows], axis=1),
        coolant=np.zeros(len(rows)),
        measured={part: log.watts(part) for part in MEASURED},
    )


def _mean(logs: Sequence[Log], parts: Sequence[Component]) -> float:
    """Mean power of some components over all runs, W."""
    watts = [sum((log.watts(part) for part in parts), np.zeros(len(log.rows))) for log in logs]
    return mean_power(watts, [np.full(len(log.rows), SAMPLE_TIME) for log in logs])


def _print_mill(mill: Mill) -> None:
    """Print the fitted parameters."""
    segments = mill.program.segments
    print(f"calibration runs: {', '.join(mill.runs)}")
    arcs = int((segments.turn != 0.0).sum())
    print(
        f"rebuilt: {len(segments) - arcs} lines, {arcs} arcs; {segments.length.sum():.1f} mm,"
        f" of which {segments.length[~segments.is_rapid].sum():.1f} mm in feed"
    )
    print(f"acceleration {mill.acceleration:.0f} mm/s²", end="; ")
    print(
        f"pause per block {1e3 * mill.pauses.per_block:.1f} ± "
        f"{1e3 * mill.pauses.per_block_half:.1f} ms, at spindle start "
        f"{mill.pauses.at_start:.2f} ± {mill.pauses.at_start_half:.2f} s"
    )
    print(f"{'parameter':34}{'value':>10}{'95 % interval':>24}")
    for each in mill.calibration.estimates:
        span = f"{each.low:.4g} … {each.high:.4g}"
        print(f"{each.parameter:34}{each.value:10.4g}{span:>24} {each.unit:10} {each.reason}")


def _print_predictions(predictions: Sequence[PredictedRun]) -> None:
    """Errors on runs that were not fitted, model and baseline side by side."""
    print(
        f"\n{'held-out run':16}{'feed':>6}{'measured s':>12}{'predicted s':>12}{'error %':>9}"
    )
    for run in predictions:
        print(
            f"{run.name:16}{run.feed:6.0f}{run.measured_time:12.1f}{run.predicted_time:12.2f}"
            f"{100 * run.time_error:9.2f}"
        )
    heads = ("measured J", "model J", "error %", "base J", "error %", "skill")
    print(f"\n{'energy':26}" + "".join(f"{head:>12}" for head in heads))
    for part in (*MEASURED, Component.TOTAL):
        for run in predictions:
            _print_energy(run.name, part, run.skills[part])
        model = sum(abs(run.skills[part].energy_error) for run in predictions)
        base = sum(abs(run.skills[part].baseline_energy_error) for run in predictions)
        print(f"{_TITLES[part]:26}{'skill over all':>60}{skill(model, base):12.2f}")
    print(f"\n{'net cutting energy':26}{'measured J':>12}{'model J':>12}{'error %':>12}")
    for run in predictions:
        each = run.skills[Component.TOTAL]
        print(
            f"{'total':10}{run.name:16}{each.measured_net:12.1f}{each.model_net:12.1f}"
            f"{100 * each.net_error:12.1f}"
        )
    print(
        "measured less idle and axes as fitted: idle differs more from run to run than wax asks"
    )
    print(f"\n{'power, RMSE':26}{'lag s':>12}{'model W':>12}{'base W':>12}{'skill':>12}")
    for part in (*MEASURED, Component.TOTAL):
        for run in predictions:
            each = run.skills[part]
            print(
                f"{_TITLES[part]:10}{run.name:16}{run.lag:12.2f}{each.model_rmse:12.3f}"
                f"{each.baseline_rmse:12.3f}{each.power_skill:12.2f}"
            )


def _print_energy(name: str, part: Component, each: Skill) -> None:
    """One row."""
    print(
        f"{_TITLES[part]:10}{name:16}{each.measured_energy:12.1f}{each.model_energy:12.1f}"
        f"{100 * each.energy_error:12.2f}{each.baseline_energy:12.1f}"
        f"{100 * each.baseline_energy_error:12.2f}{each.energy_skill:12.2f}"
    )


_TITLES = {
    Component.SPINDLE: "spindle",
    Component.X: "X axis",
    Component.Y: "Y axis",
    Component.TOTAL: "total",
}


if __name__ == "__main__":
    main()
