"""Use case of ``stepnc dataset``: rows of a design, made on processes, by partitions.

Partitions are committed in order. A run that ends early keeps those that are whole; started
again it goes on behind them.
"""

import time
from collections import deque
from collections.abc import Mapping
from concurrent.futures import Executor, Future
from dataclasses import dataclass
from hashlib import sha256
from importlib.metadata import version
from pathlib import Path
from typing import Any

import pyarrow as pa

from service.chosen import material_for
from service.dataset.folder import PARTITION, DatasetFolder
from service.dataset.rows import UNITS, DatasetRow, DatasetSource, table_of
from service.factory.replications import processes
from service.progress import Ticker
from service.reading import Tell, read_program
from service.rendering.columns import clock
from simulator.factory.design_file import DesignFile, read_design
from stepnc_model.errors import StepNcError

AT_ONCE = 10
"""Rows that a process makes before it answers."""

AHEAD = 4
"""Partitions that are made at the same time."""

MOST_ROWS = 10_000_000
MOST_PROCESSES = 64


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
    has_csv: bool = False,
    pool: Executor | None = None,
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
    has_csv : bool
        Whether to write ``data.csv`` as well.
    pool : Executor, optional
        What runs the parts; processes of this machine unless another is given.
    partition : int
        Rows of a partition.

    Raises
    ------
    StepNcError
        When the design, the folder or a part is not usable; whole partitions stay.
    """
    began = time.monotonic()
    file = read_design(path)
    count = _row_count(file, rows, path)
    source = dataset_source(file, path)
    home = DatasetFolder(folder, partition)
    if not home.is_made:
        source.require_possible(tell=tell)
    home.prepare(_manifest(file, source, partition))
    numbers = range(-(-count // partition))
    missing = [each for each in numbers if home.count(each) < home.size(each, count)]
    made = 0
    if missing:
        maker = Maker(home=home, source=source, count=count, tell=tell)
        if pool is not None:
            made = maker.run(pool, missing)
        else:
            with processes(MOST_PROCESSES) as own:
                made = maker.run(own, missing)
    return DatasetResult(
        folder=folder,
        rows=count,
        made=made,
        seconds=time.monotonic() - began,
        csv=home.write_csv(count) if has_csv else None,
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class Maker:
    """Makes the missing partitions of a folder."""

    home: DatasetFolder
    source: DatasetSource
    count: int
    tell: Tell

    def run(self, pool: Executor, missing: list[int]) -> int:
        """Make partitions in order, some ahead; returns the number of rows made."""
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
        return total

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
    file : DesignFile
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
    size = file.design.size
    if rows is None and size is None:
        raise StepNcError(f"{path}: design '{file.design.kind}' has no end: give -n ROWS")
    count = size if rows is None else rows
    most = MOST_ROWS if size is None else min(size, MOST_ROWS)
    if count is None or not 1 <= count <= most:
        what = "" if size is None else ", the combinations of the design"
        raise StepNcError(f"{path}: -n {count}: it must be 1 to {most}{what}")
    return count


def _manifest(file: DesignFile, source: DatasetSource, partition: int) -> Mapping[str, Any]:
    """What determines the rows."""
    design = file.design
    ranges = {"feed_mm_s": design.feed, "spindle_rev_s": design.spindle_speed,
              "depth_mm": design.depth}  # fmt: skip
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
