"""Calibration of a machine's parameters to measured runs, or of tool life to lives."""

from dataclasses import fields, replace
from pathlib import Path

from extras.calibration.model.calibrated_machine import calibrated, fitted_delay, notes, priors
from extras.calibration.model.fit import fitted, held_out
from extras.calibration.model.measured_run import TIME, MeasuredRun, read_run, thinned
from extras.calibration.model.simulated_features import features
from extras.calibration.verbs.calibrate.cuts import CutsResult, calibrated_cuts
from extras.calibration.verbs.calibrate.request import CalibrationFiles, CalibrationRequest
from extras.calibration.verbs.calibrate.result import CalibrationResult, CycleTime
from extras.calibration.verbs.calibrate.tool_life import ToolLifeResult, tool_life_fit
from service.errors import MissingArgument
from service.files import require_place, write_atomically
from service.progress import Tell, silent
from service.requests.runs import MotionRequest, SimulationRequest
from service.simulation.run import RunFiles, waiting_machine
from service.simulation.run_files import placed_run
from simulator.files.machine_file import machine_toml
from simulator.machine.interpreter import interpret
from simulator.machine.samples import Samples, joined
from simulator.machine.sensing import Sampler
from simulator.spec import Machine
from stepnc_model.errors import Finding, Severity, StepNcError, WriteError

MOST_SAMPLES = 10_000
"""Most samples of a run that are fitted; more add little to the few parameters."""

RATE = 100.0
"""Sampling rate of the simulation that the runs are compared with, in Hz."""

MOST_TIME_ERROR = 0.05
"""Relative error of the cycle time above which a warning is given."""


def run(
    request: CalibrationRequest, files: CalibrationFiles, *, tell: Tell = silent
) -> CalibrationResult | CutsResult | ToolLifeResult:
    """Fit a machine, a material or a tool life and, if an output is named, write its file.

    Raises
    ------
    StepNcError
        When the program, a run, a pair, a name or an output is invalid.
    """
    if files.table is not None:
        if files.runs or files.file is not None or request.life or files.tool_life is not None:
            raise StepNcError(
                "calibrate runs, pairs of tool life and a table in separate calls"
            )
        return calibrated_cuts(
            request, files.table, files.output, is_forced=request.anyway, tell=tell
        )
    if not request.life and files.tool_life is None:
        return _machine_fit(request, files, tell)
    if files.runs or files.file is not None:
        raise StepNcError("calibrate measured runs and tool lives in separate calls")
    return tool_life_fit(request, files, tell)


def _machine_fit(
    request: CalibrationRequest, files: CalibrationFiles, tell: Tell
) -> CalibrationResult:
    """Fit a machine to measured runs and, if an output is named, write its machine file."""
    if not files.runs:
        raise MissingArgument(
            "name the measured runs, or a table of cuts with --table, or tool lives with --life"
        )
    simulation = _simulation(request)
    placed = placed_run(files, simulation)
    of_run = replace(placed.files, output=None)
    if files.output is not None:
        _require_output(request, files, files.output)
    runs = [thinned(read_run(path), most=MOST_SAMPLES) for path in files.runs]
    samples, machine = _simulated(placed.request, of_run, tell)
    known = [features(samples, run) for run in runs]
    efficiency = machine.spindle.efficiency
    before = priors(machine)
    count = sum(len(run) * len(run.power) for run in runs)
    tell(f"fitting {count} measured powers")
    calibration = fitted(known, before, efficiency=efficiency)
    errors = held_out(known, before, efficiency=efficiency)
    delay = fitted_delay(known, calibration, efficiency=efficiency)
    found = calibrated(machine, calibration, delay)
    if files.output is not None:
        text = machine_toml(found, notes=(_origin(runs), *notes(calibration, delay)))
        write_atomically(files.output, text.encode())
        tell(f"machine file: {files.output}")
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


def _simulation(request: CalibrationRequest) -> SimulationRequest:
    """Run to compare with."""
    return SimulationRequest(**{
        each.name: getattr(request, each.name) for each in fields(MotionRequest)
    })


def _require_output(request: CalibrationRequest, files: CalibrationFiles, output: Path) -> None:
    """Refuse an output that is not writable, or is an input, before the long calculation."""
    if output.suffix.lower() != ".toml":
        raise WriteError("the name of a machine file must end with .toml", path=str(output))
    # A plain name is a library entry; a name with a suffix is a file.
    named = [Path(name) for name in (request.machine, request.material) if Path(name).suffix]
    for other in (*files.runs, files.file, files.nc, files.tools, *named):
        if other is not None:
            require_place(output, apart_from=other)
    if output.exists() and not output.is_file():
        raise WriteError("is not a regular file", path=str(output))


def _simulated(
    request: SimulationRequest, files: RunFiles, tell: Tell
) -> tuple[Samples, Machine]:
    """Simulate the program on the uncalibrated machine."""
    prepared, virtual = waiting_machine(request, files, tell=tell)
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
