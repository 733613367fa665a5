"""The verb ``calibrate``: a machine's parameters from measured runs of a program."""

from dataclasses import dataclass
from pathlib import Path

from service.files import require_place, write_atomically
from service.reading import Tell, silent
from service.requests.runs import SimulationRequest
from service.simulation.run import RunFiles, waiting_machine
from simulator.calibration.calibrated import Delay, calibrated, fitted_delay, notes, priors
from simulator.calibration.features import Calibration, Parameter
from simulator.calibration.fit import fitted
from simulator.calibration.held_out import HeldOut, held_out
from simulator.calibration.measured_run import TIME, MeasuredRun, read_run, thinned
from simulator.calibration.simulated import features
from simulator.machine.interpreter import interpret
from simulator.machine.samples import Samples, joined
from simulator.machine.sensing import Sampler
from simulator.machine_file import machine_toml
from simulator.spec import Machine
from stepnc_model.errors import Finding, Severity, StepNcError, WriteError

MOST_SAMPLES = 10_000
"""of a run that are fitted: more say little more about so few parameters"""

RATE = 100.0
"""samples a second of the simulation that the runs are compared with"""

MOST_TIME_ERROR = 0.05
"""share of the measured time; what is further off may be another program"""


@dataclass(frozen=True, slots=True, kw_only=True)
class CalibrationRequest:
    """Request of ``calibrate``."""

    runs: tuple[Path, ...]
    simulation: SimulationRequest
    """the machine as far as it is known, and how it ran"""
    files: RunFiles
    """what was run"""
    output: Path | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class CycleTime:
    """Time of one run, measured and simulated."""

    name: str
    measured: float
    """Measured, s"""
    simulated: float
    """Simulated, s"""

    @property
    def error(self) -> float:
        """Share of the measured time, signed."""
        return self.simulated / self.measured - 1.0


@dataclass(frozen=True, slots=True, kw_only=True)
class CalibrationResult:
    """Result of ``calibrate``."""

    machine: Machine
    """as calibrated"""
    calibration: Calibration
    delay: Delay
    """Delay of the main drive"""
    held_out: tuple[HeldOut, ...]
    times: tuple[CycleTime, ...]
    findings: tuple[Finding, ...]

    @property
    def kc_factor(self) -> float | None:
        """On the specific cutting force, where the runs tell it."""
        (found,) = (
            each for each in self.calibration.estimates if each.parameter is Parameter.CUTTING
        )
        return found.value if found.is_identified else None


def calibrate(request: CalibrationRequest, *, tell: Tell = silent) -> CalibrationResult:
    """Fit a machine to measured runs, and write it as a machine file where one is named.

    Raises
    ------
    StepNcError
        For everything that is wrong with program, runs, names or output.
    """
    if not request.runs:
        raise StepNcError("name at least one measured run")
    if request.output is not None:
        _require_output(request, request.output)
    runs = [thinned(read_run(path), most=MOST_SAMPLES) for path in request.runs]
    samples, machine = _simulated(request, tell)
    known = [features(samples, run) for run in runs]
    efficiency = machine.spindle.efficiency
    before = priors(machine)
    count = sum(len(run) * len(run.power) for run in runs)
    tell(f"fitting {count} measured powers")
    calibration = fitted(known, before, efficiency=efficiency)
    errors = held_out(known, before, efficiency=efficiency)
    delay = fitted_delay(known, calibration, efficiency=efficiency)
    found = calibrated(machine, calibration, delay)
    if request.output is not None:
        text = machine_toml(found, notes=(_origin(runs), *notes(calibration, delay)))
        write_atomically(request.output, text.encode())
        tell(f"machine file: {request.output}")
    times = tuple(_time(run, samples) for run in runs)
    return CalibrationResult(
        machine=found,
        calibration=calibration,
        delay=delay,
        held_out=errors,
        times=times,
        findings=(
            *(finding for run in runs for finding in run.findings),
            *(_off(time) for time in times if abs(time.error) > MOST_TIME_ERROR),
        ),
    )


def _require_output(request: CalibrationRequest, output: Path) -> None:
    """Refuse an output that could not be written, or is an input, before the long work."""
    if output.suffix.lower() != ".toml":
        raise WriteError("a machine is written as .toml", path=str(output))
    asked, files = request.simulation, request.files
    inputs: list[Path | None] = [*request.runs, files.file]
    # A name is one of the library's; what ends in a suffix is a file.
    inputs += [Path(name) for name in (asked.machine, asked.material) if Path(name).suffix]
    if files.code is not None:
        inputs += [files.code.code, files.code.tools]
    for other in inputs:
        if other is not None:
            require_place(output, apart_from=other)
    if output.exists() and not output.is_file():
        raise WriteError("is no regular file", path=str(output))


def _simulated(request: CalibrationRequest, tell: Tell) -> tuple[Samples, Machine]:
    """The program on the machine as it is."""
    prepared, virtual = waiting_machine(request.simulation, request.files, tell=tell)
    sampler = Sampler(virtual.machine, rate=RATE)
    episodes = virtual.run(interpret(prepared.blocks, virtual.machine))
    parts = [part for episode in episodes for part in sampler.samples(episode)]
    return joined(parts), virtual.machine


def _time(run: MeasuredRun, samples: Samples) -> CycleTime:
    return CycleTime(
        name=run.name,
        measured=float(run.time[-1] - run.time[0]),
        simulated=float(samples.time[-1]),
    )


def _off(time: CycleTime) -> Finding:
    """A run that took another time than the program."""
    return Finding(
        severity=Severity.WARNING,
        message=(
            f"measured {time.measured:.1f} s, simulated {time.simulated:.1f} s: more than"
            f" {MOST_TIME_ERROR:.0%} apart; another program or unit of time, or not all of it?"
        ),
        entity=time.name,
        attribute=TIME,
    )


def _origin(runs: list[MeasuredRun]) -> str:
    names = ", ".join(run.name for run in runs)
    return f"calibrated on measured runs: {names}"
