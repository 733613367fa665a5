"""Calibration of a machine's parameters to measured runs, for the command ``calibrate``."""

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
"""Most samples of a run that are fitted; more add little to the few parameters."""

RATE = 100.0
"""Sampling rate of the simulation that the runs are compared with, in Hz."""

MOST_TIME_ERROR = 0.05
"""Relative error of the cycle time above which a warning is given."""


@dataclass(frozen=True, slots=True, kw_only=True)
class CalibrationRequest:
    """Request of ``calibrate``."""

    runs: tuple[Path, ...]
    simulation: SimulationRequest
    """Machine as far as it is known, and options of its runs."""
    files: RunFiles
    """Program or NC code that was run."""
    output: Path | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class CycleTime:
    """Time of one run, measured and simulated."""

    name: str
    measured: float
    """Measured time, in s."""
    simulated: float
    """Simulated time, in s."""

    @property
    def error(self) -> float:
        """Relative error of the simulated time; positive if it is longer."""
        return self.simulated / self.measured - 1.0


@dataclass(frozen=True, slots=True, kw_only=True)
class CalibrationResult:
    """Result of ``calibrate``."""

    machine: Machine
    """Calibrated machine."""
    calibration: Calibration
    delay: Delay
    """Delay of the main drive."""
    held_out: tuple[HeldOut, ...]
    times: tuple[CycleTime, ...]
    findings: tuple[Finding, ...]

    @property
    def kc_factor(self) -> float | None:
        """Factor on the specific cutting force; None if the runs do not determine it."""
        (found,) = (
            each for each in self.calibration.estimates if each.parameter is Parameter.CUTTING
        )
        return found.value if found.is_identified else None


def calibrate(request: CalibrationRequest, *, tell: Tell = silent) -> CalibrationResult:
    """Fit a machine to measured runs and, if an output is named, write its machine file.

    Raises
    ------
    StepNcError
        When the program, a run, a name or an output is invalid.
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
    """Refuse an output that is not writable, or is an input, before the long calculation."""
    if output.suffix.lower() != ".toml":
        raise WriteError("the name of a machine file must end with .toml", path=str(output))
    asked, files = request.simulation, request.files
    inputs: list[Path | None] = [*request.runs, files.file]
    # A plain name is a library entry; a name with a suffix is a file.
    inputs += [Path(name) for name in (asked.machine, asked.material) if Path(name).suffix]
    if files.code is not None:
        inputs += [files.code.code, files.code.tools]
    for other in inputs:
        if other is not None:
            require_place(output, apart_from=other)
    if output.exists() and not output.is_file():
        raise WriteError("is not a regular file", path=str(output))


def _simulated(request: CalibrationRequest, tell: Tell) -> tuple[Samples, Machine]:
    """Simulate the program on the uncalibrated machine."""
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
    """Return a warning for a run whose measured time differs from the simulated one."""
    return Finding(
        severity=Severity.WARNING,
        message=(
            f"measured {time.measured:.1f} s, simulated {time.simulated:.1f} s: differ by more"
            f" than {MOST_TIME_ERROR:.0%}; check program, unit of time and length of the run"
        ),
        entity=time.name,
        attribute=TIME,
    )


def _origin(runs: list[MeasuredRun]) -> str:
    names = ", ".join(run.name for run in runs)
    return f"calibrated on measured runs: {names}"
