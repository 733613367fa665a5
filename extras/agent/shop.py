"""The agent of the service: a device for each machine, and its runs under control, live.

Rows of runs come from the files through which their processes report. They are stamped with the
clock: a run at another pace than that of a real machine keeps its own time in ACCUMULATED_TIME.
"""

import asyncio
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
import structlog

from extras.agent.model.agent import Agent
from extras.agent.model.buffer import Value
from extras.agent.model.machine_feed import beginning
from extras.agent.model.machine_model import MachineModel, machine_model, shop_model
from extras.agent.play import now
from service.live.journal import LiveFolder
from service.live.series import open_series
from service.optional_packages import has_package
from service.storage import jobs, library
from service.storage.folder import DataFolder
from service.storage.jobs import Job, JobKind, JobState
from service.storage.library import LibrarySection
from service.storage.pages import PageCursor
from simulator.spec import Machine
from stepnc_model.errors import StepNcError
from stepnc_model.units import speed_from_mm_min

if TYPE_CHECKING:
    from extras.agent.runs import RunKeeper, RunRepository

LOG = structlog.get_logger("agent")

LOOK = 0.2
"""Time between two looks at the files of runs, in s."""

MOST_RUNS = 50
"""Most running jobs that are looked at; a machine shows one of them."""

ROWS = 500
"""Most rows of a run that one look takes; of more, evenly chosen ones."""

FEED = speed_from_mm_min(1.0)

SOURCES: Mapping[str, tuple[str, float]] = {
    "xpos": ("x_mm", 1.0),
    "ypos": ("y_mm", 1.0),
    "zpos": ("z_mm", 1.0),
    "feed": ("feed_actual_mm_min", FEED),
    "feed_prog": ("feed_programmed_mm_min", FEED),
    "feed_over": ("override_commanded_percent", 1.0),
    "cutforce": ("force_measured_n", 1.0),
    "cwatt": ("spindle_power_w", 1.0),
    "run_time": ("time_s", 1.0),
}
"""Columns of a run's rows that data items show, and units of the item per unit of the row."""

DIGITS = 4


@dataclass(kw_only=True)
class _Tail:
    """A run that a machine shows. Running state."""

    job: str
    machine: str
    row: int = 0
    stamp: int = 0
    """Stamp of the last row, in µs since 1970."""
    workingstep: str = ""
    held: dict[str, float] = field(default_factory=dict)


_News = Sequence[tuple[str, int, Value]]
"""Id of the data item, stamp and value of observations, in the order of time."""


class ShopAgent:
    """Agent of all machines that the service knows. Running state."""

    def __init__(self, data_folder: DataFolder) -> None:
        self._data_folder = data_folder
        machines = list(_machines(data_folder))
        self._shown: dict[str, MachineModel] = {
            machine.name: machine_model(machine) for machine in machines
        }
        model = shop_model(self._shown.values())
        self.agent = Agent(model=model, clock=now)
        self.repository: RunRepository | None = None
        self._keeper: RunKeeper | None = None
        if has_package("pyarrow"):
            from extras.agent import runs  # noqa: PLC0415 (an extra)

            self.repository = runs.RunRepository(data_folder.root / "runs")
            self._keeper = runs.RunKeeper(self.agent, self.repository, tell=_warn)
        self._tails: dict[str, _Tail] = {}
        for shown in self._shown.values():
            ids = [item.id for item in shown.model.items if item.type == "AVAILABILITY"]
            self.agent.tell(dict.fromkeys(ids, "AVAILABLE"))
            self.agent.tell({f"{_name(shown)}_exec": "READY"})

    async def run(self) -> None:
        """Publish what runs report, until cancelled."""
        try:
            while True:
                try:
                    for news in await asyncio.to_thread(self._look):
                        self._add(news)
                except (StepNcError, OSError) as error:
                    _warn(str(error))
                await asyncio.sleep(LOOK)
        finally:
            if self._keeper is not None:
                self._keeper.close()

    def _add(self, news: _News) -> None:
        index = self.agent.model.index
        known = [row for row in news if row[0] in index]
        self.agent.add(
            np.array([index[id] for id, _, _ in known], dtype=np.int64),
            np.array([stamp for _, stamp, _ in known], dtype=np.int64),
            [value for *_, value in known],
        )

    def _look(self) -> list[_News]:
        """Return what is new of all runs."""
        cursor = PageCursor(limit=MOST_RUNS, cursor=None)
        running = jobs.listed(
            self._data_folder, cursor, kind=JobKind.CONTROL, state=JobState.RUNNING
        )
        news = [self._ended(tail) for tail in list(self._tails.values())
                if tail.job not in {job.id for job in running.items}]  # fmt: skip
        for job in reversed(running.items):
            news += self._looked_at(job)
        return news

    def _looked_at(self, job: Job) -> Iterator[_News]:
        folder = LiveFolder(path=self._data_folder.job_folder(job.id))
        status = folder.read_status()
        if status is None or status.get("machine") not in self._shown:
            return
        tail = self._tails.get(status["machine"])
        if tail is None:
            tail = _Tail(job=job.id, machine=status["machine"], stamp=now())
            self._tails[tail.machine] = tail
            yield self._begun(tail, status)
        if tail.job == job.id:
            yield self._rows(tail, folder, status)

    def _begun(self, tail: _Tail, status: Mapping[str, Any]) -> _News:
        first = beginning(
            self._shown[tail.machine], program=str(status.get("program", "")), part_count=0
        )
        first |= {f"{tail.machine}_exec": "ACTIVE"}
        return [(id, tail.stamp, value) for id, value in first.items()]

    def _rows(
        self, tail: _Tail, folder: LiveFolder, status: Mapping[str, Any]
    ) -> list[tuple[str, int, Value]]:
        found: list[tuple[str, int, Value]] = []
        series = open_series(folder.series)
        clock = now()
        if series is not None and len(series) > tail.row:
            count = len(series) - tail.row
            chosen = np.linspace(tail.row, len(series) - 1, min(count, ROWS)).astype(int)
            values = np.asarray(series.values[chosen], dtype=np.float64)
            # Rows since the last look, spread over the time since then.
            stamps = np.linspace(tail.stamp, clock, len(values) + 1)[1:].astype(int)
            tail.row, tail.stamp = len(series), clock
            for row, stamp in zip(values, stamps.tolist(), strict=True):
                found += self._changes(tail, dict(zip(series.columns, row, strict=True)), stamp)
        if status["workingstep"] != tail.workingstep:
            tail.workingstep = status["workingstep"]
            found.append((f"{tail.machine}_workingstep", clock, tail.workingstep or None))
        return found

    def _changes(
        self, tail: _Tail, row: Mapping[str, float], stamp: int
    ) -> Iterator[tuple[str, int, Value]]:
        for short, (column, scale) in SOURCES.items():
            value = float(np.round(scale * row.get(column, np.nan), DIGITS))
            if np.isfinite(value) and tail.held.get(short) != value:
                tail.held[short] = value
                yield f"{tail.machine}_{short}", stamp, value

    def _ended(self, tail: _Tail) -> _News:
        """Return the end of a run whose job is over."""
        del self._tails[tail.machine]
        job = jobs.get(self._data_folder, tail.job)
        is_completed = job.state is JobState.SUCCEEDED
        words: dict[str, Value] = {
            "exec": "PROGRAM_COMPLETED" if is_completed else "PROGRAM_STOPPED",
            "workingstep": None,
            "feed": 0,
        }
        stamp = max(now(), tail.stamp)
        return [(f"{tail.machine}_{short}", stamp, value) for short, value in words.items()]


def _name(shown: MachineModel) -> str:
    return shown.model.devices[-1].name


def _machines(data_folder: DataFolder) -> Iterator[Machine]:
    """Yield the machines of library and shop that can be read, each name once."""
    names: set[str] = set()
    for each in library.entries_of(data_folder, LibrarySection.MACHINES):
        if each.problem:
            continue
        entry = library.one(data_folder, LibrarySection.MACHINES, each.name).entry
        if isinstance(entry, Machine) and entry.name not in names:
            names.add(entry.name)
            yield entry


def _warn(message: str) -> None:
    LOG.warning("machines are not published as they should be", reason=message)
