"""The verb ``simulate``: a program on the virtual machine."""

from contextlib import nullcontext
from dataclasses import dataclass
from pathlib import Path

from service.files import require_place
from service.progress import Ticker
from service.reading import Tell, one_of, silent
from service.simulation_setup import CodeRequest, Prepared, from_code, from_program
from service.timeline_file import TimelineFile
from simulator.machine.episode import Episode
from simulator.machine.interpreter import interpret
from simulator.machine.sensing import Sampler
from simulator.machine.totals import Total, added
from simulator.machine.travel import Zero, zero_of
from simulator.machine.virtual import Setup, VirtualMachine
from simulator.motion.control import Control, control_model
from simulator.motion.motion import axis_limits
from simulator.spec import Machine
from stepnc_model.errors import Finding, StepNcError

MOST_RATE = 10_000.0
"""1/s"""


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
    zero: str = ""
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
    control = one_of(Control, request.control, "control")
    prepared = _prepared(request, tell)
    machine = prepared.machine
    virtual = VirtualMachine(
        Setup(
            machine=machine,
            control=control_model(control, axis_limits(machine)),
            tools=prepared.tools,
            stock=prepared.stock,
            zero=_zero(request.zero, prepared),
        )
    )
    episodes = virtual.run(interpret(prepared.blocks, machine))
    run = _Run(machine, rate=request.rate)
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

    def __init__(self, machine: Machine, *, rate: float) -> None:
        self.totals = [Total()]
        self.samples = 0
        self._machine = machine
        self._sampler = Sampler(machine, rate=rate)

    def add(self, episode: Episode, file: TimelineFile | None) -> None:
        """One more episode."""
        at = episode.state.workingstep
        self.totals += [Total() for _ in range(len(self.totals), at + 1)]
        self.totals[at] = added(self.totals[at], episode, self._machine)
        if file is not None:
            for samples in self._sampler.samples(episode):
                file.add(samples)
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


def _zero(text: str, prepared: Prepared) -> Zero | None:
    """Place of the program's zero: as the user says, or by the stock."""
    if not text:
        return None if prepared.raw is None else zero_of(prepared.machine, prepared.raw)
    try:
        x, y, z = (float(word) for word in text.split(","))
    except ValueError:
        raise StepNcError(f"--zero {text}: three numbers in mm with commas") from None
    return x, y, z
