"""The verb ``simulate``: a program on the virtual machine."""

from collections.abc import Callable, Iterator
from contextlib import ExitStack
from dataclasses import dataclass, field
from pathlib import Path

from service.files import read_bytes, require_place
from service.progress import Ticker
from service.reading import Tell, one_of, read_program, silent
from service.timeline_file import TimelineFile
from service.toolpaths import paths_of, with_feeds
from service.usecases import machine_for, material_for
from simulator.machine.interpreter import Numbered, interpret
from simulator.machine.sensing import Sampler
from simulator.machine.tooling import loaded_tool
from simulator.machine.totals import Total, added
from simulator.machine.virtual import LoadedTool, Setup, VirtualMachine
from simulator.motion.control import Control, control_model
from simulator.motion.motion import axis_limits
from simulator.spec import Machine, Material
from stepnc_model.errors import Finding, StepNcError
from stepnc_model.post.neutral import blocks_of, tool_numbers
from stepnc_model.program import Program

MOST_RATE = 10_000.0
"""1/s"""


@dataclass(frozen=True, slots=True, kw_only=True)
class SimulationRequest:
    """What the user asks of ``simulate``, in the user's units."""

    file: Path
    machine: str = ""
    material: str = ""
    units: str = "iso"
    rate: float = 10.0
    control: str = "fir"
    output: Path | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Simulation:
    """What ``simulate`` found."""

    program: str
    machine: Machine
    material: Material
    totals: tuple[tuple[str, Total], ...]
    """by workingstep in the order of their beginning; the first is what comes before them"""
    findings: tuple[Finding, ...]
    written: Path | None = None
    samples: int = 0

    @property
    def total(self) -> Total:
        """Of the whole run."""
        whole = Total()
        for _, part in self.totals:
            whole = whole.plus(part)
        return whole


def simulate(request: SimulationRequest, *, tell: Tell = silent) -> Simulation:
    """Run a program on the virtual machine.

    Raises
    ------
    StepNcError
        For everything that is wrong with file, names, numbers or output.
    """
    _require_rate(request.rate)
    control = one_of(Control, request.control, "control")
    if request.output is not None:
        require_place(request.output, apart_from=request.file)
    program = read_program(request.file, units=request.units)
    machine = machine_for(request.machine, program)
    match = material_for(request.material, program)
    tell(f"material: {match.reason}")
    paths = with_feeds(paths_of(program, tell=tell), keep_going=False)
    numbers = tool_numbers(paths.paths)
    tools = {
        number: loaded_tool(program, ref, number, match.material)
        for ref, number in numbers.items()
    }
    blocks = enumerate(blocks_of(program, paths.items, name=request.file.stem), 1)
    virtual = VirtualMachine(
        Setup(
            machine=machine,
            control=control_model(control, axis_limits(machine)),
            tools=tools,
        )
    )
    ticker = Ticker(tell)
    totals = [Total()]
    sampler = Sampler(machine, rate=request.rate)
    with ExitStack() as stack:
        file = None
        if request.output is not None:
            file = stack.enter_context(TimelineFile(request.output, virtual.workingsteps))
        for episode in virtual.run(interpret(blocks, machine)):
            while len(totals) <= episode.state.workingstep:
                totals.append(Total())
            at = episode.state.workingstep
            totals[at] = added(totals[at], episode, machine)
            if file is not None:
                for samples in sampler.samples(episode):
                    file.add(samples)
            ticker(lambda: f"{episode.end:.0f} s of machining, line {episode.state.line}")
    return Simulation(
        program=program.name,
        machine=machine,
        material=match.material,
        totals=tuple(zip(("", *virtual.workingsteps), totals, strict=True)),
        findings=(*paths.findings, *virtual.findings),
        written=request.output,
        samples=0 if file is None else file.rows,
    )


def _require_rate(rate: float) -> None:
    if not 1.0 <= rate <= MOST_RATE:
        raise StepNcError(f"rate {rate:g} Hz: it must be 1 to {MOST_RATE:g} Hz")
