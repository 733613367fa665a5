"""Use case of ``stepnc dataset``: rows of a design, made by an executor, in partitions.

Partitions are committed in order. A run that ends early keeps those that are whole; started
again it goes on behind them. The same happens within a run whose processes are ended by the
system: what is not committed is submitted again, to a new executor.
"""

import time
from collections import deque
from collections.abc import Iterator, Mapping
from concurrent.futures import Executor, Future
from dataclasses import dataclass
from hashlib import sha256
from importlib.metadata import version
from pathlib import Path
from shutil import disk_usage
from typing import Any

import pyarrow as pa

from extras.factory.model.design_file import DesignFile, read_design
from extras.learning.dataset_folder import (
    PARTITION,
    UNITS,
    DatasetFolder,
    DatasetRow,
    DatasetSource,
    table_of,
)
from service.execution.executors import LOST, Losses, Pools, processes
from service.files import write_atomically
from service.programs.machine_choice import material_for
from service.programs.reading import read_program
from service.progress import Tell, Ticker
from service.rendering.columns import clock
from stepnc_model.errors import StepNcError

AT_ONCE = 10
"""Rows that a process makes before it answers."""

AHEAD = 4
"""Partitions that are made at the same time."""

MOST_ROWS = 10_000_000
MOST_PROGRAMS = 100_000
"""Rows of which programs are written."""

PARQUET_BYTES, CSV_BYTES, BLOCK_BYTES = 200, 300, 4096
"""Bytes of a row on the disk, measured and rounded up, and of the end of a file."""


@dataclass(frozen=True, slots=True, kw_only=True)
class DatasetFiles:
    """Files written beside the partitions."""

    has_csv: bool = False
    """Whether to write ``data.csv``."""
    has_programs: bool = False
    """Whether to write the program of each row."""


@dataclass(frozen=True, slots=True, kw_only=True)
class DatasetResult:
    """A data set that is whole."""

    folder: Path
    rows: int
    """Number of rows that were asked for."""
    made: int
    """Number of rows that were made in this run."""
    seconds: float
    """Wall-clock time, s."""
    csv: Path | None


@dataclass(frozen=True, slots=True, kw_only=True)
class Partition:
    """A partition on its way: rows that are there, and rows that are being made."""

    number: int
    known: int
    waiting: tuple[Future[list[DatasetRow]], ...]


def make_dataset(  # noqa: PLR0913 (each is a choice of the caller)
    path: Path,
    folder: Path,
    *,
    rows: int | None,
    tell: Tell,
    files: DatasetFiles = DatasetFiles(),
    pools: Pools = processes,
    partition: int = PARTITION,
) -> DatasetResult:
    """Make the rows of a design file that are not there yet.

    Parameters
    ----------
    path : Path
        Design file.
    folder : Path
        Where partitions and manifest are, or will be.
    rows : int or None
        Number of rows; None: all combinations of a full factorial.
    tell : callable
        Receives progress and findings.
    files : DatasetFiles
        What to write beside the partitions.
    pools : callable
        Makes the executor that runs the parts; processes of this machine unless another is
        given.
    partition : int
        Rows of a partition.

    Raises
    ------
    StepNcError
        When the design, the folder or a part is not usable, or processes are ended again and
        again; whole partitions stay.
    """
    began = time.monotonic()
    file = read_design(path)
    count = _row_count(file, rows, path)
    source = dataset_source(file, path)
    _require_space(folder, count, source, files)
    home = DatasetFolder(folder, partition)
    if not home.is_made:
        source.require_possible(tell=tell)
    home.prepare(_manifest(file, source, partition))
    numbers = range(-(-count // partition))
    missing = [each for each in numbers if home.count(each) < home.size(each, count)]
    maker = Maker(home=home, source=source, count=count, tell=tell)
    made = maker.run(pools, missing) if missing else 0
    if files.has_programs:
        write_programs(home, source, count, tell=tell)
    return DatasetResult(
        folder=folder,
        rows=count,
        made=made,
        seconds=time.monotonic() - began,
        csv=home.write_csv(count) if files.has_csv else None,
    )


def write_programs(
    home: DatasetFolder, source: DatasetSource, count: int, *, tell: Tell
) -> None:
    """Write the programs of the first rows that are not there yet.

    Raises
    ------
    WriteError
        When the disk refuses.
    """
    home.program(1).parent.mkdir(exist_ok=True)
    ticker = Ticker(tell)
    for row in source.design.rows(0, count):
        place = home.program(row.number + 1)
        if not place.exists():
            write_atomically(place, source.program(row).file.data)
        ticker(lambda row=row: f"{row.number + 1} of {count} programs")  # type: ignore[misc]


@dataclass(frozen=True, slots=True, kw_only=True)
class Maker:
    """Makes the missing partitions of a folder."""

    home: DatasetFolder
    source: DatasetSource
    count: int
    tell: Tell

    def run(self, pools: Pools, missing: list[int]) -> int:
        """Make partitions in order; returns the number of rows made.

        Raises
        ------
        StepNcError
            When a part cannot run, or executors are lost again and again.
        """
        left, losses, made = deque(missing), Losses(self.tell), 0
        while left:
            try:
                with pools() as pool:
                    for rows in self._partitions(pool, list(left)):
                        left.popleft()
                        losses.got_on()
                        made += rows
            except LOST as error:
                first = left[0] * self.home.rows
                last = first + self.home.size(left[0], self.count)
                losses.lost(error, what=f"rows {first + 1} to {last}")
        return made

    def _partitions(self, pool: Executor, missing: list[int]) -> Iterator[int]:
        """Commit partitions in order, some made ahead; yields the new rows of each."""
        known = {number: self.home.count(number) for number in missing}
        total = sum(self.home.size(number, self.count) - known[number] for number in missing)
        begun, done, ticker = time.monotonic(), 0, Ticker(self.tell)
        ahead: deque[Partition] = deque()
        rest = deque(missing)
        while rest or ahead:
            while rest and len(ahead) < AHEAD:
                number = rest.popleft()
                ahead.append(self._begun(pool, number, known[number]))
            part = ahead.popleft()
            rows: list[DatasetRow] = []
            for each in part.waiting:
                new = each.result()
                rows += new
                done += len(new)
                left = (time.monotonic() - begun) * (total - done) / done
                ticker(
                    lambda done=done, left=left: (  # type: ignore[misc]
                        f"{done} of {total} rows, {clock(left)} left"
                    )
                )
            self.home.write(part.number, self._joined(part, rows))
            yield len(rows)

    def _begun(self, pool: Executor, number: int, known: int) -> Partition:
        first = number * self.home.rows
        last = first + self.home.size(number, self.count)
        starts = range(first + known, last, AT_ONCE)
        return Partition(
            number=number,
            known=known,
            waiting=tuple(
                pool.submit(self.source.rows, start, min(start + AT_ONCE, last))
                for start in starts
            ),
        )

    def _joined(self, part: Partition, rows: list[DatasetRow]) -> pa.Table:
        """Rows that were there, and the new ones behind them."""
        new = table_of(rows)
        return pa.concat_tables([self.home.partition(part.number), new]) if part.known else new


def dataset_source(file: DesignFile, path: Path) -> DatasetSource:
    """Read programs and materials of a design.

    Parameters
    ----------
    path : Path
        Its place, for messages.

    Raises
    ------
    StepNcError
        With the key whose value is not usable.
    """
    if file.has_deviation:
        for machine in file.machines:
            if machine.deviation is None:
                raise StepNcError(
                    f"{path}: deviation: machine '{machine.name}' has no [deviation]"
                )
    try:
        programs = tuple(read_program(each, units="iso") for each in file.programs)
    except StepNcError as error:
        raise StepNcError(f"{path}: program: {error}") from error
    try:
        materials = {
            (row, column): material_for(name, program)
            for row, program in enumerate(programs)
            for column, name in enumerate(file.materials)
        }
    except StepNcError as error:
        raise StepNcError(f"{path}: material: {error}") from error
    return DatasetSource(
        design=file.design,
        programs=programs,
        machines=file.machines,
        materials=materials,
        has_deviation=file.has_deviation,
    )


def _row_count(file: DesignFile, rows: int | None, path: Path) -> int:
    """Number of rows to make.

    Raises
    ------
    StepNcError
        When there is no such number of rows.
    """
    size, kind = file.design.size, file.design.kind
    if rows is None and size is None:
        raise StepNcError(f"{path}: design '{kind}' has no end: give -n ROWS")
    count = rows if rows is not None else size or 0
    if not 1 <= count <= MOST_ROWS:
        what = f"-n {count}" if rows is not None else f"levels: {count} combinations"
        raise StepNcError(f"{path}: {what}: it must be 1 to {MOST_ROWS}")
    if size is not None and count != size:
        raise StepNcError(
            f"{path}: -n {count}: the full factorial has {size} combinations: leave -n out, or "
            "change levels"
        )
    return count


def _require_space(
    folder: Path, count: int, source: DatasetSource, files: DatasetFiles
) -> None:
    """Refuse more rows than the disk can hold.

    Raises
    ------
    StepNcError
        With the space that is needed and that is free.
    """
    if files.has_programs and count > MOST_PROGRAMS:
        raise StepNcError(
            f"-n {count} with --programs: it must be at most {MOST_PROGRAMS}, a file each"
        )
    size = PARQUET_BYTES + CSV_BYTES * files.has_csv
    if files.has_programs:
        size += BLOCK_BYTES + max(len(each.file.data) for each in source.programs)
    place = next((each for each in (folder, *folder.absolute().parents) if each.exists()), None)
    try:
        free = disk_usage(place or Path("/")).free
    except OSError as error:
        raise StepNcError(f"{place}: {error.strerror}") from error
    if count * size > free:
        raise StepNcError(
            f"-n {count}: the data set needs about {count * size / 1e9:.2g} GB, and "
            f"{free / 1e9:.2g} GB are free for {folder}"
        )


def _manifest(file: DesignFile, source: DatasetSource, partition: int) -> Mapping[str, Any]:
    """Everything that determines the rows."""
    design = file.design
    ranges = {
        "feed_mm_s": design.feed,
        "spindle_rev_s": design.spindle_speed,
        "depth_mm": design.depth,
        "tool_diameter_mm": design.tool_diameter,
        "flank_wear_mm": design.flank_wear,
    }
    return {
        "design": design.kind.value,
        "seed": design.seed,
        "levels": design.levels,
        "deviation": file.has_deviation,
        **{
            key: None if each is None else [each.low, each.high] for key, each in ranges.items()
        },
        "programs": {each.name: sha256(each.file.data).hexdigest() for each in source.programs},
        "machines": {each.name: _digest(each) for each in source.machines},
        "materials": {
            each.material.name: _digest(each.material) for each in source.materials.values()
        },
        "units": UNITS,
        "rows_per_partition": partition,
        "versions": {name: version(name) for name in ("stepnc-optimiser", "numpy")},
    }


def _digest(value: object) -> str:
    """Digest of the values of a machine or material."""
    return sha256(repr(value).encode()).hexdigest()
