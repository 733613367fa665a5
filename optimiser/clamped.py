"""Remaining stock of each setup, and simulated contact of tool paths with it."""

from dataclasses import dataclass
from math import inf
from typing import Protocol

from optimiser.assumed_stock import assumed_stock, words_of
from optimiser.hardest import PathContacts
from simulator.errors import SimulationError
from simulator.motion.tool_path import ToolPathRun
from simulator.removal.cutter import Insert
from simulator.removal.engage import MillingStock
from simulator.removal.lathe import BarRadii, TurningStock
from simulator.removal.stations import stretch_lengths
from simulator.removal.tool_shape import shape_of
from simulator.removal.trial import PathTrial, StockPatch
from simulator.removal.zmap import cell_size
from simulator.spec import Machine, MachineKind
from stepnc_model.entities.executables import Setup
from stepnc_model.entities.turning import TurningMachiningOperation
from stepnc_model.errors import SchemaError
from stepnc_model.part21.values import Ref
from stepnc_model.program import Program, ResolvedWorkingstep
from stepnc_model.tool import tool_of
from stepnc_model.toolpath.task import stock_of

StockMap = MillingStock | TurningStock

Change = StockPatch | BarRadii
"""Change that a path makes to a stock."""


@dataclass(frozen=True, slots=True, kw_only=True)
class TrialContacts:
    """Simulated contacts of a path with a stock that is left unchanged."""

    met: PathContacts | None = None
    """Contacts along the path; None when they are not known."""
    why: str = ""
    """Reason why the contacts are not known; empty when they are."""
    change: Change | None = None
    """Change that the path would make to the stock; None when it changes nothing."""
    trial: PathTrial | None = None
    """Milling trial with its contacts and the changed cells; None for turning."""


@dataclass(frozen=True, slots=True)
class StockPlace:
    """Key of a stock map: setup and process of the workingsteps that cut it."""

    setup: Ref[Setup] | None
    is_turning: bool


class BodyMaps(Protocol):
    """Maker of stock maps of raw parts that are bodies of any shape."""

    def __call__(
        self,
        program: Program,
        setup: Ref[Setup] | None,
        *,
        is_turning: bool,
        cell: float | None,
    ) -> StockMap | None:
        """Return the map of a raw part; None if it is a box or a bar.

        Raises
        ------
        ValueError
            When it cannot be turned.
        """
        ...


class ClampedStocks:
    """Stock maps of a program, one per setup and process (mutable state).

    Parameters
    ----------
    program : Program
    machine : Machine
    body_map : BodyMaps, optional
        Without it, the box or bar around a body counts.
    """

    def __init__(
        self, program: Program, machine: Machine, body_map: BodyMaps | None = None
    ) -> None:
        self.program = program
        self.machine = machine
        self._body_map = body_map
        self.stocks: dict[StockPlace, StockMap | None] = {}
        self.assumed: dict[StockPlace, str] = {}
        """What is assumed of raw parts that are not known."""
        self._changes: dict[StockPlace, Change] = {}
        """Pending changes by stock, applied when the next workingstep asks for its stock."""

    def before(self, step: ResolvedWorkingstep) -> StockMap | None:
        """Return the stock as it is before a workingstep; None when the stock is unknown."""
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
        """Record the change of a workingstep, replacing any pending change of its stock."""
        place = self.place(step)
        self._changes.pop(place, None)
        if change is not None:
            self._changes[place] = change

    def place(self, step: ResolvedWorkingstep) -> StockPlace:
        """Return the setup and process of a workingstep, which select its stock."""
        is_turned = isinstance(step.operation, TurningMachiningOperation)
        return StockPlace(step.setup, is_turned or self.machine.kind is MachineKind.LATHE)

    def _raw(self, place: StockPlace) -> StockMap | None:
        """Build the stock map of the raw stock; None when the stock is unknown."""
        try:
            raw = stock_of(self.program, place.setup)
            if raw is None and not place.is_turning:
                raw = assumed_stock(self.program, place.setup)
                if raw is not None:
                    self.assumed[place] = words_of(raw)
            if raw is None:
                return None
            # The map is as fine as that of the run: slivers thinner than a cell are met alike.
            smallest = min(self._diameters(), default=inf)
            cell = None if place.is_turning else cell_size(raw, smallest_diameter=smallest)
            body = self._body(place, cell) if raw.is_around else None
            if body is not None:
                return body
            if place.is_turning:
                return TurningStock(raw)
            return MillingStock(raw, cell=cell)
        except (SchemaError, ValueError):
            return None

    def _body(self, place: StockPlace, cell: float | None) -> StockMap | None:
        """Map of a raw part that is a body; None where the box or bar around it counts."""
        if self._body_map is None:
            return None
        try:
            return self._body_map(
                self.program, place.setup, is_turning=place.is_turning, cell=cell
            )
        except ValueError as error:
            self.assumed[place] = f"the bar around the raw part counts as solid: {error}"
            return None

    def _diameters(self) -> list[float]:
        """Diameters of the usable rotating tools of the program, mm."""
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
    """Simulate a tool path in a stock; return its contacts, or why there are none."""
    change: Change
    trial = None
    if stock is None:
        return TrialContacts(why="the stock is not known")
    try:
        shape = shape_of(program, step.tool_ref)
        if shape is None:
            return TrialContacts(why="threads and knurls are not simulated in the stock")
        if isinstance(stock, TurningStock):
            stations, change = stock.tried(run.segments, shape)
            cell = stock.cell
        elif isinstance(shape, Insert):
            return TrialContacts(why="a turning insert cannot mill")
        else:
            stations, trial = stock.tried(run.segments, shape, is_clockwise=run.is_clockwise)
            change, cell = trial.after, stock.map.cell
    except (SimulationError, SchemaError, ValueError) as error:
        return TrialContacts(why=str(error))
    met = PathContacts(stations=stations, length=stretch_lengths(stations), cell=cell)
    return TrialContacts(met=met, change=change, trial=trial)
