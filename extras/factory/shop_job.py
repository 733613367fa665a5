"""Job ``factory``: run a shop, live at a pace or as fast as possible with replications."""

from collections.abc import Mapping
from contextlib import ExitStack
from pathlib import Path
from typing import Any

from extras.factory.cycles import PartCycles
from extras.factory.live import LiveShop
from extras.factory.model.measures import over_replications
from extras.factory.model.records import Listeners
from extras.factory.model.shop_figures import measures_of
from extras.factory.parts_file import PartTables
from extras.factory.plan import machining_plan
from extras.factory.replications import PartBound, ShopRun
from extras.factory.requests import FactoryOrder, FactoryRequest
from extras.factory.run import STATES, FactoryResult, require_folder, run_source
from extras.factory.shop_sources import (
    MOST_PARTS,
    ShopSource,
    checked_shop,
    require_small,
    source_of_order,
)
from extras.factory.state_log import COLUMNS
from extras.factory.states_file import ShownStates, StateFile
from extras.factory.verbs.factory.result import ShopResult
from service.files import write_atomically
from service.jobs.task import RunningJob
from service.live.runner import LiveRunner
from service.live.series import SeriesWriter
from stepnc_model.errors import StepNcError
from stepnc_model.units import hours_from_seconds

TABLES = "tables"
"""Folder of the tables of parts and the states, below that of the job."""

FIGURES = "figures.csv"

STATE_LOG = "states.bin"
"""Changes of state of a live run, see :mod:`extras.factory.state_log`."""


def run(task: RunningJob) -> None:
    """Run a shop and store tables, report and result.

    Raises
    ------
    StepNcError
        When the shop or a program is invalid, or its machines wait for each other.
    """
    order = task.request(FactoryOrder)
    source = source_of_order(task.data_folder, order)
    if order.pace:
        result = _live(task, order, source)
    else:
        request = FactoryRequest(
            hours=order.hours,
            warm_up_hours=order.warm_up_hours,
            seed=order.seed,
            replications=order.replications,
            sweep=order.sweep,
            has_energy=True,
        )
        result = run_source(
            source,
            request,
            folder=task.folder / TABLES,
            tell=task.tell,
            most_parts=MOST_PARTS,
            require=require_small,
        )
    shown = ShopResult(factory=result)
    task.keep_report(shown.page())
    write_atomically(task.folder / FIGURES, shown.csv().encode())
    task.keep(shown.record())


def _live(task: RunningJob, order: FactoryOrder, source: ShopSource) -> FactoryResult:
    """Run a shop at a pace, and obey orders."""
    shop = checked_shop(source, order)
    task.progress(0.0, "running the programs of the shop")
    plan = machining_plan(shop, PartCycles(tell=task.tell), place=source.name)
    folder = task.folder / TABLES
    require_folder(folder, shop)
    shown = ShownStates()
    with ExitStack() as stack:
        tables = stack.enter_context(PartTables(folder, shop, plan.materials, has_energy=True))
        states = stack.enter_context(StateFile(folder / STATES, shop))
        log = stack.enter_context(SeriesWriter(task.folder / STATE_LOG, COLUMNS))
        live = LiveShop(
            shop,
            plan,
            seed=order.seed,
            programs=source.programs,
            listeners=Listeners(
                part=(tables.part,),
                count=(PartBound(MOST_PARTS).count,),
                state=(shown.state, states.state),
            ),
        )

        def tell(status: Mapping[str, Any]) -> None:
            log.add(live.changes())
            hours = hours_from_seconds(live.time)
            task.progress(live.time / shop.duration, f"{hours:.1f} of {status['hours']:g} h")

        LiveRunner(
            run=live, folder=task.live, columns=live.columns, pace=order.pace, tell=tell
        ).go()
        measures = measures_of(live.floor)
    if not measures:
        raise StepNcError("the run ended before its warm-up did: nothing was counted")
    return FactoryResult(
        shop=shop,
        seed=order.seed,
        replications=1,
        measures=over_replications([measures]),
        first=ShopRun(
            measures=measures,
            tally=live.floor.tally,
            ended=live.time,
            is_finished=live.floor.is_finished,
        ),
        states=shown.rows,
        parts_written=tables.count,
    )


def table_of(folder: Path, machine: str) -> Path | None:
    """File of the table of parts of a machine in the folder of a job; None: there is none."""
    file = folder / TABLES / f"{machine}.csv"
    is_name = Path(machine).name == machine
    return file if is_name and file.is_file() else None
