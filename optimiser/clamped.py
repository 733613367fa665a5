"""Remaining stock of each setup, and the contact of a path with it."""

from dataclasses import dataclass
from math import sqrt

from optimiser.hardest import PathContacts
from simulator.errors import SimulationError
from simulator.motion.tool_path import ToolPathRun
from simulator.removal.cutter import Insert
from simulator.removal.engage import MillingStock
from simulator.removal.lathe import BarRadii, TurningStock
from simulator.removal.stations import stretch_lengths
from simulator.removal.tool_shape import shape_of
from simulator.removal.trial import PathTrial, StockPatch
from simulator.removal.zmap import MOST_CELLS
from simulator.spec import Machine, MachineKind
from stepnc_model.entities.executables import Setup
from stepnc_model.entities.turning import TurningMachiningOperation
from stepnc_model.errors import SchemaError
from stepnc_model.part21.values import Ref
from stepnc_model.program import Program, ResolvedWorkingstep, Stock
from stepnc_model.tool import tool_of
from stepnc_model.toolpath.task import stock_of

USUAL_CELLS = 200_000
"""of a map: fewer than the virtual machine's, for most sections do not come from it"""

CELLS_PER_TOOL = 16.0
"""least number of cells over the diameter of the smallest tool"""

StockMap = MillingStock | TurningStock

Change = StockPatch | BarRadii
"""what a path makes of a stock"""


@dataclass(frozen=True, slots=True, kw_only=True)
class TrialContacts:
    """Contacts of a path with a stock that is left unchanged."""

    met: PathContacts | None = None
    """None where it is not known"""
    why: str = ""
    """it is not known"""
    change: Change | None = None
    """what the path makes of the stock; None: nothing"""
    trial: PathTrial | None = None
    """the same of a mill, with what it found"""


@dataclass(frozen=True, slots=True)
class StockPlace:
    """Stock that a workingstep cuts."""

    setup: Ref[Setup] | None
    is_turning: bool


class ClampedStocks:
    """Stocks of a program by setup. Running state."""

    def __init__(self, program: Program, machine: Machine) -> None:
        self.program = program
        self.machine = machine
        self.stocks: dict[StockPlace, StockMap | None] = {}
        self._changes: dict[StockPlace, Change] = {}
        """not made yet: another path may be asked for"""

    def before(self, step: ResolvedWorkingstep) -> StockMap | None:
        """Stock before a workingstep; None where no stock is known."""
        place = self.place(step)
        if place not in self.stocks:
            self.stocks[place] = self._raw(place)
        stock = self.stocks[place]
        match stock, self._changes.pop(place, None):
            case MillingStock() as box, StockPatch() as patch:
                box.take(patch)
            case TurningStock() as turned, BarRadii() as bar:
                turned.take(bar)
        return stock

    def leave(self, step: ResolvedWorkingstep, change: Change | None) -> None:
        """Change the stock as one path of a workingstep does, instead of any other of it."""
        place = self.place(step)
        self._changes.pop(place, None)
        if change is not None:
            self._changes[place] = change

    def place(self, step: ResolvedWorkingstep) -> StockPlace:
        """Setup and process of a workingstep, which select its stock."""
        is_turned = isinstance(step.operation, TurningMachiningOperation)
        return StockPlace(step.setup, is_turned or self.machine.kind is MachineKind.LATHE)

    def _raw(self, place: StockPlace) -> StockMap | None:
        """The stock as it was bought."""
        try:
            raw = stock_of(self.program, place.setup)
            if raw is None:
                return None
            if place.is_turning:
                return TurningStock(raw)
            return MillingStock(raw, cell=_cell(raw, self._diameters()))
        except (SchemaError, ValueError):
            return None

    def _diameters(self) -> list[float]:
        """Of the tools that rotate and can be used, mm."""
        found = []
        for tool in {step.tool_ref for step in self.program.workingsteps}:
            try:
                found.append(tool_of(self.program, tool).diameter)
            except SchemaError:
                continue
        return [diameter for diameter in found if diameter > 0.0]


def met_by(
    program: Program, step: ResolvedWorkingstep, run: ToolPathRun, stock: StockMap | None
) -> TrialContacts:
    """Contacts of a tool with a stock, and the changed stock; else the reason why not."""
    change: Change
    trial = None
    if stock is None:
        return TrialContacts(why="no stock is known")
    try:
        shape = shape_of(program, step.tool_ref)
        if shape is None:
            return TrialContacts(why="threads and knurls are not cut from the stock")
        if isinstance(stock, TurningStock):
            stations, change = stock.tried(run.segments, shape)
            cell = stock.cell
        elif isinstance(shape, Insert):
            return TrialContacts(why="an insert does not mill")
        else:
            stations, trial = stock.tried(run.segments, shape, is_clockwise=run.is_clockwise)
            change, cell = trial.after, stock.map.cell
    except (SimulationError, SchemaError, ValueError) as error:
        return TrialContacts(why=str(error))
    met = PathContacts(stations=stations, length=stretch_lengths(stations), cell=cell)
    return TrialContacts(met=met, change=change, trial=trial)


def _cell(raw: Stock, diameters: list[float]) -> float:
    """Cell of a map that tells engagements, mm."""
    x, y = raw.high[0] - raw.low[0], raw.high[1] - raw.low[1]
    wanted = min(sqrt(x * y / USUAL_CELLS), min(diameters, default=x) / CELLS_PER_TOOL)
    return max(wanted, sqrt(x * y / MOST_CELLS))
