"""Remaining stock of each setup, and simulated contact of tool paths with it.

Stock assumed for given tool paths in a program that describes no raw part. Unit mm.

A given path does not say how much it removes. Where all workingsteps of a setup have given
paths, the raw part is taken to be the box that their tools sweep at a feed, up to the highest
feature, or without features as high as a tool moves at a feed of cuts: every path then removes
what those before it left. A path that comes down at the edge of this box is taken to come down
beside the part, and the box ends where the tool stands.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from math import inf
from typing import Protocol

from optimiser.cuts.hardest_places import PathContacts
from simulator.errors import SimulationError
from simulator.motion.tool_path import ToolPathRun
from simulator.removal.cutter import Insert, shape_of
from simulator.removal.engage import MillingStock
from simulator.removal.lathe import BarRadii, TurningStock
from simulator.removal.stations import stretch_lengths
from simulator.removal.trial import PathTrial, StockPatch
from simulator.removal.zmap import cell_size
from simulator.spec import Machine, MachineKind
from stepnc_model.entities.entity import Entity
from stepnc_model.entities.executables import Setup
from stepnc_model.entities.features import ToolpathFeature
from stepnc_model.entities.turning import TurningMachiningOperation
from stepnc_model.errors import SchemaError
from stepnc_model.part21.values import Ref
from stepnc_model.programs.program import Program, ResolvedWorkingstep, Stock
from stepnc_model.programs.technology import programmed
from stepnc_model.programs.tool import tool_of
from stepnc_model.toolpath.frame import feature_frame
from stepnc_model.toolpath.generate import workingstep_path
from stepnc_model.toolpath.omissions import TOUCHING, swept_box
from stepnc_model.toolpath.path import Move, MoveType, Point, Step, ToolPath
from stepnc_model.toolpath.task import stock_of

LEAST_HEIGHT = 0.1
"""Least height of a stock that is assumed, mm."""

FAST = 4.0
"""Ratio to the feed of the cuts from which a move at a feed is no cut."""

ASSUMED = "no stock is known: assumed is the box that the given tool paths sweep, {0} mm"


def words_of(stock: Stock) -> str:
    """Sentence that states an assumed stock."""
    low, high = (",".join(f"{value:.4g}" for value in at) for at in (stock.low, stock.high))
    return ASSUMED.format(f"{low} to {high}")


def assumed_stock(program: Program, setup: Ref[Setup] | None) -> Stock | None:
    """Box that the given tool paths of a setup sweep; None where a path is not given.

    Parameters
    ----------
    setup : Ref or None

    Returns
    -------
    Stock or None
    """
    steps = [step for step in program.workingsteps if step.setup == setup]
    if not steps or any(step.operation.its_toolpath is None for step in steps):
        return None
    paths = [path for step in steps if (path := _path(program, step)) is not None]
    boxes = [box for path in paths if (box := swept_box(program, path)) is not None]
    if not boxes:
        return None
    slow = [_without_fast(program, path) for path in paths]
    cuts = [box for path in slow if (box := swept_box(program, path)) is not None]
    tops = [
        feature_frame(program, setup, feature).origin[2]
        for step in steps
        for feature in step.features
        if not isinstance(program.get(feature), ToolpathFeature)
    ]
    # Without a feature, material may reach as high as a tool moves at a feed, and no higher.
    tops = tops or [box.high[2] for box in cuts]
    x0, y0, low = (min(box.low[axis] for box in boxes) for axis in range(3))
    x1, y1 = (max(box.high[axis] for box in boxes) for axis in range(2))
    around = _Edges(x0, y0, x1, y1)
    for path in paths:
        around = _clear_edges(program, path, around)
    top = max(tops, default=low)
    if top - low < LEAST_HEIGHT:
        top = max(box.high[2] for box in boxes)
    if top - low < LEAST_HEIGHT or around.area <= 0.0:
        return None
    return Stock(low=(around.x0, around.y0, low), high=(around.x1, around.y1, top))


def _without_fast(program: Program, path: ToolPath) -> ToolPath:
    """Path whose moves at several times the feed of its cuts are rapids.

    Writers give positioning moves a technology with a high feed, others a speed profile. The
    way down from the security plane is none of the file.
    """
    feeds: dict[Ref[Entity], float] = {}
    for step in path.steps:
        if isinstance(step, Move) and step.feed is not None:
            feeds.setdefault(step.feed.technology, 0.0)
    for technology in feeds:
        try:
            feeds[technology] = programmed(program, technology).feed.value
        except SchemaError:
            continue
    usual = feeds.get(path.technology_ref, 0.0) if path.technology_ref else 0.0
    steps: list[Step] = []
    height, top = path.start[2], inf if path.safe_z is None else path.safe_z
    for step in path.steps:
        kept = step
        if isinstance(step, Move):
            is_from_above = step.type is MoveType.APPROACH and height >= top
            is_fast = step.feed and feeds[step.feed.technology] > FAST * usual > 0.0
            kept = replace(step, feed=None) if is_from_above or is_fast else step
            height = step.end[2]
        steps.append(kept)
    return replace(path, steps=tuple(steps))


@dataclass(frozen=True, slots=True)
class _Edges:
    """Edges of a stock in plan, mm."""

    x0: float
    y0: float
    x1: float
    y1: float

    @property
    def area(self) -> float:
        """Area, mm²; 0 where nothing is left."""
        return max(0.0, self.x1 - self.x0) * max(0.0, self.y1 - self.y0)


def _clear_edges(program: Program, path: ToolPath, edges: _Edges) -> _Edges:
    """Edges that leave out the tool where a path comes down within its radius of an edge."""
    begin = next(iter(_starts(path)), None)
    if begin is None or path.tool_ref is None:
        return edges
    radius = 0.5 * tool_of(program, path.tool_ref).diameter
    x, y, _ = begin
    reach = radius + TOUCHING
    others = [
        replace(edges, **{name: at})
        for name, at, is_near in (
            ("x0", x + radius, x - edges.x0 < reach),
            ("y0", y + radius, y - edges.y0 < reach),
            ("x1", x - radius, edges.x1 - x < reach),
            ("y1", y - radius, edges.y1 - y < reach),
        )
        if is_near
    ]
    # A tool as wide as the box comes down within it, as a drill between two slots does.
    others = [each for each in others if each.area > 0.0]
    is_inside = edges.x0 - reach < x < edges.x1 + reach and (
        edges.y0 - reach < y < edges.y1 + reach
    )
    return max(others, key=lambda each: each.area) if others and is_inside else edges


def _starts(path: ToolPath) -> Iterator[Point]:
    """Start of the first move at a feed."""
    at = path.start
    for move in path.steps:
        if isinstance(move, Move):
            if move.feed is not None:
                yield at
                return
            at = move.end


def _path(program: Program, step: ResolvedWorkingstep) -> ToolPath | None:
    """Path of a workingstep; None where it cannot be made."""
    try:
        return workingstep_path(program, step)
    except SchemaError:
        return None


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
