"""Program prepared for verification: its moves by tool and workingstep, tools and stock."""

from dataclasses import dataclass, replace
from pathlib import Path

from service.reading import Tell, silent
from service.requests.verification import VerificationRequest
from service.simulation.setup import PreparedRun, from_program
from service.verification.log import ProgramNames
from simulator.machine.acts import MoveStretch, ToolTo, WorkingstepTo
from simulator.machine.interpreter import interpret
from simulator.motion.segments import Floats
from simulator.removal.cutter import Cutter, Insert
from simulator.spec import Machine, MachineKind, MaterialMatch
from simulator.tool_table import read_tool_table
from simulator.verification.path import ProgrammedPath, ProgrammedRun, programmed_path
from stepnc_model.errors import StepNcError
from stepnc_model.program import Program, Stock


@dataclass(frozen=True, slots=True, kw_only=True)
class StepName:
    """Workingstep with the feature that it makes."""

    workingstep: str
    feature: str


@dataclass(frozen=True, slots=True, kw_only=True)
class PreparedProgram:
    """Program whose log is verified."""

    program: Program
    name: str
    machine: Machine
    material: MaterialMatch
    stock: Stock
    path: ProgrammedPath
    steps: tuple[StepName, ...]
    cutters: dict[int, Cutter | Insert | None]
    """Shapes of the tools by number."""
    required: Floats | None = None
    """Triangles of the required part, (T, 3, 3), mm; None: the nominal features count."""

    @property
    def is_turned(self) -> bool:
        """Whether the part is turned."""
        return self.machine.kind is MachineKind.LATHE

    @property
    def names(self) -> ProgramNames:
        """Names that a log may use."""
        tool_of = {run.workingstep: run.tool for run in self.path.runs}
        return ProgramNames(
            workingsteps={each.workingstep: row for row, each in enumerate(self.steps)},
            tool_of=tool_of,
            tools=frozenset(tool_of.values()),
        )


def prepared(
    program: Path, request: VerificationRequest, *, tell: Tell = silent
) -> PreparedProgram:
    """Prepare a program for verification.

    Raises
    ------
    StepNcError
        When the program cannot be run, has several setups, or has no stock.
    """
    run = from_program(
        program, units=request.units, machine=request.machine, material=request.material,
        tell=tell,
    )  # fmt: skip
    if run.program is None or run.raw is None or run.material is None:
        raise StepNcError(f"{program}: the program has no stock")
    if len({step.setup for step in run.program.workingsteps}) > 1:
        raise StepNcError(f"{program}: several setups: only one can be verified at a time")
    features = {step.id: _feature(run, step.features) for step in run.program.workingsteps}
    runs, names = _runs(run)
    return PreparedProgram(
        program=run.program,
        name=run.name,
        machine=run.machine,
        material=run.material,
        stock=run.raw,
        path=programmed_path(runs),
        steps=tuple(StepName(workingstep=name, feature=features[name]) for name in names),
        cutters={number: _cutter(run, number) for number in run.tools or {}},
    )


def with_tools(program: PreparedProgram, path: Path) -> PreparedProgram:
    """Replace tools by those of a tool table, which were measured, by their numbers.

    Raises
    ------
    StepNcError
        When the table is invalid, or has other tools.
    """
    found: dict[int, Cutter | Insert | None] = {}
    for tool in read_tool_table(path):
        if tool.number not in program.cutters:
            known = ", ".join(f"T{number}" for number in sorted(program.cutters))
            raise StepNcError(
                f"{path}: T{tool.number} is not in the program, which has {known}"
            )
        if type(tool.shape) is not type(program.cutters[tool.number]):
            raise StepNcError(f"{path}: T{tool.number} is another kind of tool in the program")
        found[tool.number] = tool.shape
    return replace(program, cutters=program.cutters | found)


def _runs(run: PreparedRun) -> tuple[list[ProgrammedRun], list[str]]:
    """Moves of the program by tool and workingstep, and the ids of the workingsteps."""
    runs: list[ProgrammedRun] = []
    names: list[str] = []
    tool = 0
    for step in interpret(run.blocks, run.machine):
        match step.act:
            case WorkingstepTo(id=name):
                names.append(name)
            case ToolTo(number=number):
                tool = number
            case MoveStretch(segments=segments):
                runs.append(
                    ProgrammedRun(
                        cutter=_cutter(run, tool),
                        tool=tool,
                        workingstep=len(names) - 1,
                        segments=segments,
                    )
                )
    return runs, names


def _cutter(run: PreparedRun, number: int) -> Cutter | Insert | None:
    tool = (run.tools or {}).get(number)
    return None if tool is None else tool.shape


def _feature(run: PreparedRun, refs: tuple[object, ...]) -> str:
    """Name of the first feature of a workingstep."""
    if run.program is None or not refs:
        return ""
    return str(getattr(run.program.get(refs[0]), "its_id", ""))  # type: ignore[arg-type]
