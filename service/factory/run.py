"""Run of a shop file, for the command ``factory``."""

from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import dataclass, replace
from pathlib import Path

from service.factory.cycles import PartCycles
from service.factory.parts_file import PartTables
from service.factory.plan import machining_plan
from service.factory.replications import Replications, ShopRun, processes, run_shop
from service.factory.states_file import ShownStates, StateFile
from service.factory.sweep import SweptCase, combinations, swept_keys
from service.progress import Ticker, bar
from service.reading import Tell, silent
from service.requests.factory import FactoryRequest
from service.requests.fields import require_bounds
from simulator.factory.machining import MachiningPlan
from simulator.factory.measures import MeasureInterval, over_replications
from simulator.factory.records import Listeners, StateSpent
from simulator.factory.shop import Shop
from simulator.factory.shop_file import read_shop
from simulator.factory.streams import Streams
from stepnc_model.errors import StepNcError, WriteError
from stepnc_model.units import hours_from_seconds, seconds_from_hours

STATES = "states.parquet"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class FactoryResult:
    """Result of ``factory``."""

    shop: Shop
    seed: int
    replications: int
    measures: tuple[MeasureInterval, ...]
    """Figures over the replications."""
    first: ShopRun
    """First replication."""
    states: Sequence[StateSpent]
    """First states of the first replication, for a picture."""
    parts_written: int = 0
    cases: tuple[SweptCase, ...] = ()
    """Combinations of a sweep; the figures above are those of the file itself."""


def run_factory(
    file: Path, request: FactoryRequest, *, folder: Path | None = None, tell: Tell = silent
) -> FactoryResult:
    """Run a shop file.

    Parameters
    ----------
    file : Path
        Shop file.
    request : FactoryRequest
    folder : Path, optional
        Folder for the tables of parts and the states of the first replication.
    tell : callable

    Raises
    ------
    StepNcError
        When the file, a program or an option is invalid: nothing is started. Or when the
        machines of the shop wait for each other.
    """
    require_bounds(request)
    keys = swept_keys(request.sweep)
    shop = chosen_shop(file, request)
    swept = [
        (changes, chosen_shop(file, request, changes))
        for changes in (combinations(keys) if keys else ())
    ]
    cycles = PartCycles(tell=tell)
    plan = machining_plan(shop, cycles, place=file.name)
    plans = [machining_plan(each, cycles, place=file.name) for _, each in swept]
    if folder is not None:
        _require_folder(folder, shop)
    shown = ShownStates()
    with ExitStack() as stack:
        listeners = Listeners(state=(shown.state,))
        tables = None
        if folder is not None:
            tables = stack.enter_context(
                PartTables(folder, shop, plan.materials, has_energy=request.has_energy)
            )
            states = stack.enter_context(StateFile(folder / STATES, shop))
            listeners = listeners.plus(Listeners(part=(tables.part,), state=(states.state,)))
        first = _first(shop, plan, request, listeners, tell)
    runs = [first.measures]
    cases: list[SweptCase] = []
    others = request.replications - 1 + request.replications * len(swept)
    if others:
        with processes(others) as pool:
            numbers = range(1, request.replications)
            work = Replications(pool=pool, seed=request.seed, tell=tell)
            runs += work.measures(shop, plan, numbers)
            for (changes, case), own in zip(swept, plans, strict=True):
                found = work.measures(case, own, range(request.replications))
                cases.append(
                    SweptCase(changes=tuple(changes.items()), measures=over_replications(found))
                )
    return FactoryResult(
        shop=shop,
        seed=request.seed,
        replications=request.replications,
        measures=over_replications(runs),
        first=first,
        states=shown.rows,
        parts_written=0 if tables is None else tables.count,
        cases=tuple(cases),
    )


def chosen_shop(
    file: Path, request: FactoryRequest, changes: dict[str, float | str] | None = None
) -> Shop:
    """Read a shop file with the times and changes of a request.

    Raises
    ------
    StepNcError
        When the file or a change is invalid.
    """
    shop = read_shop(file, changes=changes)
    if request.hours is not None:
        shop = replace(shop, duration=seconds_from_hours(request.hours))
    if request.warm_up_hours is not None:
        shop = replace(shop, warm_up=seconds_from_hours(request.warm_up_hours))
    if shop.warm_up >= shop.duration:
        raise StepNcError(
            f"{file.name}: warm-up {hours_from_seconds(shop.warm_up):g} h: it must be below "
            f"{hours_from_seconds(shop.duration):g} h, the whole time"
        )
    return shop


def _require_folder(folder: Path, shop: Shop) -> None:
    """Make the folder of the outputs."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise WriteError(error.strerror or str(error), path=str(folder)) from error
    for machine in shop.machines:
        if Path(machine.name).name != machine.name:
            raise StepNcError(f"machine '{machine.name}': its name cannot name a file")


def _first(
    shop: Shop, plan: MachiningPlan, request: FactoryRequest, listeners: Listeners, tell: Tell
) -> ShopRun:
    """First replication, with its outputs."""
    ticker = Ticker(tell)
    hours = hours_from_seconds(shop.duration)

    def told(share: float) -> None:
        ticker(lambda: f"{bar(share)}  {share * hours:.0f} of {hours:g} h")

    return run_shop(shop, plan, Streams(seed=request.seed), listeners=listeners, told=told)
