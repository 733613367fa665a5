"""The verb ``simulate``: a program on the virtual machine."""

from contextlib import nullcontext
from dataclasses import dataclass, replace
from enum import StrEnum
from pathlib import Path

from service.files import require_place
from service.progress import Ticker
from service.reading import Tell, one_of, silent
from service.simulation_setup import CodeRequest, Prepared, from_code, from_program
from service.timeline_file import TimelineFile
from simulator.errors import SimulationError
from simulator.machine.disturbance import Disturbance, Disturbed, NoiseKind
from simulator.machine.episode import Episode
from simulator.machine.interpreter import interpret
from simulator.machine.sensing import Sampler
from simulator.machine.tooth_loads import Teeth
from simulator.machine.totals import Total, added
from simulator.machine.transients import Response
from simulator.machine.travel import Zero, zero_of
from simulator.machine.virtual import LoadedTool, Setup, VirtualMachine
from simulator.motion.control import DEVIATION, Control, control_model
from simulator.motion.fir import FixedTimeFilter
from simulator.motion.motion import ControlModel, axis_limits
from simulator.spec import Machine, MachineKind
from stepnc_model.errors import Finding, StepNcError
from stepnc_model.units import mm_from_um

MOST_RATE = 10_000.0
"""1/s"""

MOST_RUNOUT_UM = 500.0


class ForceView(StrEnum):
    """How forces are shown."""

    MEAN = "mean"
    """over a revolution"""
    TOOTH = "tooth"
    """of the teeth that cut at each time"""


@dataclass(frozen=True, slots=True, kw_only=True)
class SimulationRequest:
    """What the user asks of ``simulate``, in the user's units."""

    file: Path | None = None
    code: CodeRequest | None = None
    machine: str = ""
    material: str = ""
    units: str = "iso"
    rate: float = 10.0
    control: str = Control.FIR.value
    filter_s: str = ""
    """times of the fixed-time filter, "T1,T2"; by the axes when empty"""
    deviation: float = DEVIATION
    """mm, of the junctions"""
    zero: str = ""
    noise: str = NoiseKind.NONE.value
    missing: float = 0.0
    has_lag: bool = False
    """the main drive answers late and too far"""
    has_wear: bool = False
    """tools wear while they cut"""
    force: str = ForceView.MEAN.value
    runout_um: float = 0.0
    seed: int = 0
    output: Path | None = None
    report: Path | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Simulation:
    """What ``simulate`` found."""

    program: str
    machine: Machine
    control: Control
    totals: tuple[tuple[str, Total], ...]
    """by workingstep in the order of their beginning; the first is what comes before them"""
    findings: tuple[Finding, ...]
    samples: int = 0
    """that were written"""

    @property
    def whole(self) -> Total:
        """Of the whole run."""
        total = Total()
        for _, part in self.totals:
            total = total.plus(part)
        return total


def simulate(request: SimulationRequest, *, tell: Tell = silent) -> Simulation:
    """Run a program on the virtual machine.

    Raises
    ------
    StepNcError
        For everything that is wrong with file, names, numbers or output.
    """
    _require(request)
    control = _control_kind(request)
    prepared = _prepared(request, tell)
    machine = prepared.machine
    _require_axes(machine)
    virtual = VirtualMachine(
        Setup(
            machine=machine,
            control=_control(request, machine),
            tools=_tools(request, prepared),
            stock=prepared.stock,
            teeth=_teeth(request),
            zero=_zero(request.zero, prepared),
        )
    )
    episodes = virtual.run(interpret(prepared.blocks, machine))
    run = _Run(machine, _disturbance(request), rate=request.rate)
    ticker = Ticker(tell)
    with _timeline(request, virtual) as file:
        for episode in episodes:
            run.add(episode, file)
            ticker(lambda: f"{prepared.done():4.0%}  {virtual.now:.0f} s of machining")
    if request.output is not None:
        tell(f"written: {request.output} ({run.samples} samples)")
    return Simulation(
        program=prepared.name,
        machine=machine,
        control=control,
        totals=tuple(zip(("", *virtual.workingsteps), run.totals, strict=True)),
        findings=(*prepared.findings, *virtual.findings),
        samples=run.samples,
    )


class _Run:
    """What is gathered on the way. Running state."""

    def __init__(self, machine: Machine, disturbance: Disturbance, *, rate: float) -> None:
        self.totals = [Total()]
        self.samples = 0
        self._machine = machine
        self._sampler = Sampler(machine, rate=rate)
        self._disturbed = Disturbed(
            disturbance=disturbance, rate=rate, efficiency=machine.spindle.efficiency
        )

    def add(self, episode: Episode, file: TimelineFile | None) -> None:
        """One more episode."""
        at = episode.state.workingstep
        self.totals += [Total() for _ in range(len(self.totals), at + 1)]
        self.totals[at] = added(self.totals[at], episode, self._machine)
        if file is not None:
            for samples in self._sampler.samples(episode):
                file.add(self._disturbed.shown(samples))
                self.samples += len(samples)


def _timeline(
    request: SimulationRequest, virtual: VirtualMachine
) -> TimelineFile | nullcontext[None]:
    if request.output is None:
        return nullcontext()
    return TimelineFile(request.output, virtual.workingsteps)


def _prepared(request: SimulationRequest, tell: Tell) -> Prepared:
    if request.code is not None:
        return from_code(
            request.code,
            program=request.file,
            units=request.units,
            machine=request.machine,
            material=request.material,
        )
    if request.file is None:
        raise StepNcError("name a STEP-NC program, or NC code with --nc")
    return from_program(
        request.file,
        units=request.units,
        machine=request.machine,
        material=request.material,
        tell=tell,
    )


def _require_axes(machine: Machine) -> None:
    """A machine that can be run says how fast its axes are."""
    known = {axis.name for axis in machine.axes}
    needed = {"X", "Z"} if machine.kind is MachineKind.LATHE else {"X", "Y", "Z"}
    if missing := sorted(needed - known):
        text = f"machine '{machine.name}' says nothing of its axes {', '.join(missing)}"
        raise SimulationError(f"{text}: it cannot be run")


def _require(request: SimulationRequest) -> None:
    """Refuse what cannot be, before anything is read."""
    if not 1.0 <= request.rate <= MOST_RATE:
        raise StepNcError(f"rate {request.rate:g} Hz: it must be 1 to {MOST_RATE:g} Hz")
    inputs = [request.file, request.code.code if request.code else None]
    outputs = [request.output, request.report]
    for row, place in enumerate(outputs):
        for other in (*inputs, *outputs[:row]):
            if place is not None and other is not None:
                require_place(place, apart_from=other)


def _control_kind(request: SimulationRequest) -> Control:
    return one_of(Control, request.control, "control")


def _control(request: SimulationRequest, machine: Machine) -> ControlModel:
    """How the control runs the path."""
    kind = _control_kind(request)
    try:
        if kind is Control.FIR and request.filter_s:
            first, second = (float(word) for word in request.filter_s.split(","))
            return FixedTimeFilter(first=first, second=second)
        return control_model(kind, axis_limits(machine), deviation=request.deviation)
    except ValueError as error:
        raise StepNcError(f"control {kind.value}: {error}") from error


def _tools(request: SimulationRequest, prepared: Prepared) -> dict[int, LoadedTool] | None:
    """The tools; they wear only when asked for."""
    if prepared.tools is None or request.has_wear:
        return prepared.tools
    return {number: replace(tool, taylor=None) for number, tool in prepared.tools.items()}


def _teeth(request: SimulationRequest) -> Teeth | None:
    view = one_of(ForceView, request.force, "force")
    if not 0.0 <= request.runout_um <= MOST_RUNOUT_UM:
        bound = f"0 to {MOST_RUNOUT_UM:g} µm"
        raise StepNcError(f"runout {request.runout_um:g} µm: it must be {bound}")
    if view is ForceView.MEAN:
        return None
    return Teeth(eccentricity=mm_from_um(request.runout_um))


def _disturbance(request: SimulationRequest) -> Disturbance:
    if not 0.0 <= request.missing < 1.0:
        raise StepNcError(f"missing {request.missing:g}: it must be at least 0 and below 1")
    if request.seed < 0:
        raise StepNcError(f"seed {request.seed}: it must be at least 0")
    return Disturbance(
        noise=one_of(NoiseKind, request.noise, "noise"),
        missing=request.missing,
        response=Response() if request.has_lag else None,
        seed=request.seed,
    )


def _zero(text: str, prepared: Prepared) -> Zero | None:
    """Place of the program's zero: as the user says, or by the stock."""
    if not text:
        return None if prepared.raw is None else zero_of(prepared.machine, prepared.raw)
    try:
        x, y, z = (float(word) for word in text.split(","))
    except ValueError:
        raise StepNcError(f"--zero {text}: three numbers in mm with commas") from None
    return x, y, z
