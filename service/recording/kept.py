"""Latest run of a monitored machine, from the observations that its agent still keeps.

Of several runs the latest whole one is taken, else the latest. An agent that does not tell
when programs run gives all that it keeps.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from service.reading import Tell, silent
from service.recording.run import file_columns, file_values
from service.recording.signals import POSITIONS
from service.run_file import RunFile
from simulator.client.columns import EXECUTION, RUNNING, TIME, Cell, RowMaker, columns_of
from simulator.client.connection import AgentClient, ClientObservation
from simulator.errors import AgentError

KEPT = frozenset({*POSITIONS, "tool_number", "workingstep", "program"})
"""Columns that are kept."""

MOST_ROWS = 1_000_000
"""Most rows of one run; a longer one is cut off at its beginning."""

PARTS = ("the agent no longer keeps its beginning", "it is still going on")
"""What a run may lack."""


@dataclass(frozen=True, slots=True, kw_only=True)
class AgentRun:
    """Run that was read from an agent."""

    rows: int
    program: str
    """Program that the machine named; empty: none."""
    missing: tuple[str, ...]
    """What it lacks; empty for a whole run."""


@dataclass(kw_only=True)
class KeptRows:
    """Rows of one run. Running state."""

    is_begun: bool
    """Whether its beginning was seen."""
    is_ended: bool = False
    rows: list[Mapping[str, Cell]] = field(default_factory=list)

    @property
    def is_whole(self) -> bool:
        """Whether it was seen from its beginning to its end."""
        return self.is_begun and self.is_ended

    def add(self, row: Mapping[str, Cell]) -> None:
        """Keep a row; beyond the bound the older half is given up."""
        if len(self.rows) == MOST_ROWS:
            del self.rows[: MOST_ROWS // 2]
            self.is_begun = False
        self.rows.append(row)


@dataclass(kw_only=True)
class RunFinder:
    """Finds the runs among observations. Running state."""

    maker: RowMaker
    execution: str
    """Id of the data item that tells when a program runs; empty: none does."""
    current: KeptRows | None = None
    last: KeptRows | None = None
    """Run that has ended: the latest whole one, or else the latest."""

    def take(self, each: ClientObservation, *, is_first: bool) -> None:
        """Take an observation; the first ones hold since before the agent's oldest."""
        self._add(self.maker.rows([each]))
        if each.id != self.execution:
            return
        is_running = each.value in RUNNING
        if is_running and self.current is None:
            self.current = KeptRows(is_begun=not is_first)
        elif not is_running and self.current is not None:
            self.current.is_ended = True
            if self.current.is_whole or self.last is None or not self.last.is_whole:
                self.last = self.current
            self.current = None

    def interrupt(self) -> None:
        """Note that observations were lost: what is known no longer holds."""
        self.maker.last()
        self.maker.interrupt()
        if self.current is not None:
            self.current = KeptRows(is_begun=False)

    def chosen(self) -> KeptRows | None:
        """Return the latest whole run, else the latest; None without any."""
        self._add(self.maker.last())
        is_whole = self.last is not None and self.last.is_whole
        return self.last if is_whole or self.current is None else self.current

    def _add(self, rows: Iterable[Mapping[str, Cell]]) -> None:
        for row in rows:
            if self.current is not None:
                self.current.add(row)


def keep_run(url: str, output: Path, *, tell: Tell = silent) -> AgentRun:
    """Write the latest run that an agent keeps as Parquet or CSV; its time begins at 0.

    Raises
    ------
    StepNcError
        When the agent does not answer or tells of no run, or the file cannot be written.
    """
    client = AgentClient(url)
    found = [each for each in columns_of(client.items()) if each.name in KEPT | {EXECUTION}]
    columns = tuple(each for each in found if each.name in KEPT)
    if not any(each.name in POSITIONS for each in columns):
        raise AgentError(f"{url}: the device model has no positions of axes")
    execution = next((each.id for each in found if each.name == EXECUTION), "")
    runs = RunFinder(maker=RowMaker(columns=tuple(found)), execution=execution)
    if not execution:
        runs.current = KeptRows(is_begun=True, is_ended=True)
    try:
        # What changed before the oldest observation, such as the tool, is held.
        state = client.oldest_state()
    except AgentError:
        client.rewind()
        state = ()
    for each in state:
        runs.take(each, is_first=True)
    count = 0
    for part in client.kept():
        if part.lost:
            runs.interrupt()
        for each in part.observations:
            runs.take(each, is_first=False)
        count += len(part.observations)
        tell(f"{count} observations read")
    run = runs.chosen()
    if run is None or not run.rows:
        raise AgentError(f"{url}: the agent keeps no positions of a run of a program")
    begin = float(run.rows[0][TIME] or 0.0)
    rows = [{**row, TIME: round(float(row[TIME] or 0.0) - begin, 6)} for row in run.rows]
    file = RunFile(output, file_columns(columns))
    with file.closing(is_whole=True):
        file.write(file_values(rows, columns))
    program = next((str(row["program"]) for row in rows if row.get("program")), "")
    lacks = (not run.is_begun, not run.is_ended)
    return AgentRun(
        rows=len(rows),
        program=program,
        missing=tuple(text for text, does in zip(PARTS, lacks, strict=True) if does),
    )
