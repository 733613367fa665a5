"""Run of a shop file, for the command ``factory``."""

from collections.abc import Callable, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from math import inf
from pathlib import Path

from extras.factory.cycles import PartCycles
from extras.factory.documents import ChosenPart, FirstParts, PartDocuments
from extras.factory.model.machining import MachiningPlan
from extras.factory.model.measures import MeasureInterval, over_replications
from extras.factory.model.records import Listeners, StateSpent
from extras.factory.model.shop import Shop
from extras.factory.model.streams import Streams
from extras.factory.parts_file import PartTables
from extras.factory.plan import machining_plan
from extras.factory.replications import (
    PartBound,
    Replications,
    ShopRun,
    run_shop,
)
from extras.factory.requests import FactoryRequest
from extras.factory.shop_sources import (
    ShopSource,
    SweptCase,
    chosen_shop,
    combinations,
    source_of_file,
    swept_keys,
)
from extras.factory.states_file import ShownStates, StateFile
from service.execution.executors import Pools, processes
from service.outputs.staged_folder import staged_folder
from service.progress import Tell, Ticker, bar, silent
from service.requests.fields import require_bounds
from stepnc_model.errors import StepNcError, WriteError
from stepnc_model.units import hours_from_seconds

STATES = "states.parquet"

DOCUMENTS = "mtconnect"
"""Folder of the documents of parts."""


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
    documents_written: int = 0
    """MTConnect documents of parts."""
    cases: tuple[SweptCase, ...] = ()
    """Combinations of a sweep; the figures above are those of the file itself."""


def run_factory(
    file: Path,
    request: FactoryRequest,
    *,
    folder: Path | None = None,
    pools: Pools = processes,
    tell: Tell = silent,
) -> FactoryResult:
    """Run a shop file.

    Parameters and errors are those of :func:`run_source`.
    """
    return run_source(source_of_file(file), request, folder=folder, pools=pools, tell=tell)


def run_source(  # noqa: PLR0913 (each is a choice of the caller)
    source: ShopSource,
    request: FactoryRequest,
    *,
    folder: Path | None = None,
    tell: Tell = silent,
    most_parts: float = inf,
    pools: Pools = processes,
    require: Callable[[Shop], None] = lambda _: None,
) -> FactoryResult:
    """Run a shop.

    Parameters
    ----------
    folder : Path, optional
        Folder for the tables of parts and the states of the first replication.
    most_parts : float
        Most parts that the machines of a run may make together.
    pools : callable
        Makes the executors of all replications but the first.
    require : callable
        Check of the shop, and of each that a sweep makes of it.

    Raises
    ------
    StepNcError
        When the file, a program or an option is invalid: nothing is started. Or when the
        machines of the shop wait for each other.
    """
    require_bounds(request)
    keys = swept_keys(request.sweep)
    shop = chosen_shop(source, request)
    swept = [
        (changes, chosen_shop(source, request, changes))
        for changes in (combinations(keys) if keys else ())
    ]
    for each in (shop, *(each for _, each in swept)):
        require(each)
    cycles = PartCycles(tell=tell)
    plan = machining_plan(shop, cycles, place=source.name)
    plans = [machining_plan(each, cycles, place=source.name) for _, each in swept]
    with ExitStack() as stack:
        stage = (
            None if folder is None else stack.enter_context(staged_folder(folder, tell=tell))
        )
        made = _first(shop, plan, request, stage, most_parts=most_parts, tell=tell)
        written = 0
        if stage is not None and request.documents:
            maker = PartDocuments(shop, plan, Streams(seed=request.seed), tell=tell)
            written = maker.write(made.chosen, stage / DOCUMENTS)
    numbers = range(request.replications)
    work = Replications(pools=pools, seed=request.seed, tell=tell, most_parts=most_parts)
    others, *found = work.measures([
        (shop, plan, numbers[1:]),
        *((case, own, numbers) for (_, case), own in zip(swept, plans, strict=True)),
    ])
    cases = tuple(
        SweptCase(changes=tuple(changes.items()), measures=over_replications(runs))
        for (changes, _), runs in zip(swept, found, strict=True)
    )
    return FactoryResult(
        shop=shop,
        seed=request.seed,
        replications=request.replications,
        measures=over_replications([made.run.measures, *others]),
        first=made.run,
        states=made.states,
        parts_written=made.parts_written,
        documents_written=written,
        cases=cases,
    )


def require_folder(folder: Path, shop: Shop) -> None:
    """Make the folder of the outputs.

    Raises
    ------
    StepNcError
        When it cannot be made, or a machine's name cannot name a file.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise WriteError(error.strerror or str(error), path=str(folder)) from error
    for machine in shop.machines:
        if Path(machine.name).name != machine.name:
            raise StepNcError(f"machine '{machine.name}': its name cannot name a file")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class FirstReplication:
    """First replication, and what was kept of it."""

    run: ShopRun
    states: Sequence[StateSpent]
    """First states, for a picture."""
    chosen: Sequence[ChosenPart]
    """Parts of which documents are asked for."""
    parts_written: int


def _first(
    shop: Shop,
    plan: MachiningPlan,
    request: FactoryRequest,
    folder: Path | None,
    *,
    most_parts: float,
    tell: Tell,
) -> FirstReplication:
    """First replication, with its outputs."""
    ticker = Ticker(tell)
    hours = hours_from_seconds(shop.duration)
    shown, chosen = ShownStates(), FirstParts(request.documents)
    listeners = Listeners(state=(shown.state,))
    if request.documents:
        listeners = listeners.plus(Listeners(part=(chosen.part,)))
    if most_parts < inf:
        listeners = listeners.plus(Listeners(count=(PartBound(most_parts).count,)))

    def progress(share: float) -> None:
        ticker(lambda: f"{bar(share)}  {share * hours:.0f} of {hours:g} h")

    tables = None
    with ExitStack() as stack:
        if folder is not None:
            require_folder(folder, shop)
            tables = stack.enter_context(
                PartTables(folder, shop, plan.materials, has_energy=request.has_energy)
            )
            states = stack.enter_context(StateFile(folder / STATES, shop))
            files = Listeners(part=(tables.part,), state=(states.state,))
            # Tables first: what a bound refuses was made.
            listeners = files.plus(listeners)
        run = run_shop(
            shop, plan, Streams(seed=request.seed), listeners=listeners, progress=progress
        )
    return FirstReplication(
        run=run,
        states=shown.rows,
        chosen=chosen.parts,
        parts_written=0 if tables is None else tables.count,
    )
