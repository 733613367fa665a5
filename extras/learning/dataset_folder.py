"""Folder of a data set: partitions of rows in Parquet, and a manifest of what made them.

A partition is written under another name and moved into place, so that it is there with all its
rows or not at all. What is there is never made again.

Rows of a data set: each is a run of the virtual machine with its own settings.

The energy with deviation is that of a run whose motor powers deviate at random; its random
numbers are those of the row's number. The total power is the mean over the machining time, and
so is the cutting power: what the spindle drive needs for the cut, over its efficiency.
"""

import json
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import Any

import pyarrow as pa
from pyarrow import parquet

from extras.factory.cycles import part_cycle
from extras.factory.model.cycle import PartCycle, drawn_energies
from extras.factory.model.design import DesignRow, ExperimentDesign, RowSettings
from extras.factory.model.streams import Streams
from service.files import read_bytes, write_atomically
from service.outputs.parquet_pieces import parquet_file, parquet_pieces
from service.outputs.run_file import ColumnKind, RunColumn, RunFile, arrow_schema, words_of
from service.progress import Tell, silent
from service.rendering.columns import dump
from simulator.spec import Machine, MaterialMatch
from stepnc_model.editing.cut_settings import CutSettings, with_settings, with_tool_diameter
from stepnc_model.errors import StepNcError, WriteError
from stepnc_model.programs.program import Program
from stepnc_model.units import rad_s_from_rev_s

UNITS = {
    "feed_mm_s": "mm/s",
    "spindle_rad_s": "rad/s",
    "depth_mm": "mm",
    "tool_diameter_mm": "mm",
    "flank_wear_mm": "mm",
    "time_s": "s",
    "energy_j": "J",
    "energy_exact_j": "J",
    "total_power_w": "W",
    "total_power_exact_w": "W",
    "cutting_power_w": "W",
    "peak_power_w": "W",
}
"""Units of the columns."""


@dataclass(frozen=True, slots=True, kw_only=True)
class DatasetRow:
    """One row, in the units of the names; fields are the columns."""

    row: int
    """Number, from 1."""
    part: str
    machine: str
    material: str
    feed_mm_s: float | None
    spindle_rad_s: float | None
    depth_mm: float | None
    tool_diameter_mm: float | None
    flank_wear_mm: float | None
    time_s: float
    energy_j: float
    energy_exact_j: float
    """Energy without deviation."""
    total_power_w: float
    """Energy over time."""
    total_power_exact_w: float
    cutting_power_w: float
    """Mean power of the spindle drive that goes into the cut; proportional to k_c."""
    peak_power_w: float
    """Greatest total power, without deviation."""


def _kind(name: str) -> ColumnKind:
    """Type of a column."""
    if name in UNITS:
        return ColumnKind.EXACT
    return ColumnKind.INTEGER if name == "row" else ColumnKind.TEXT


COLUMNS = tuple(
    RunColumn(name=each.name, kind=_kind(each.name), unit=UNITS.get(each.name, ""))
    for each in fields(DatasetRow)
)
"""Columns of a data set."""

SCHEMA = arrow_schema(COLUMNS)


@dataclass(frozen=True, slots=True, kw_only=True)
class DatasetSource:
    """Source of the rows of a data set."""

    design: ExperimentDesign
    programs: tuple[Program, ...]
    machines: tuple[Machine, ...]
    materials: Mapping[tuple[int, int], MaterialMatch]
    """Material by the places of program and material."""
    has_deviation: bool

    def require_possible(self, *, tell: Tell) -> None:
        """Run each program on each machine at the ends of the ranges.

        Raises
        ------
        StepNcError
            When a machine cannot run a part; with its settings.
        """
        for ends in self.design.ends:
            for row, program in enumerate(self.programs):
                for machine in self.machines:
                    material = self.materials[row, 0]
                    _cycle(_with_row_settings(program, ends), machine, material, ends, tell)

    def rows(self, first: int, last: int) -> list[DatasetRow]:
        """Rows from number ``first``, counted from 0, to before ``last``.

        Raises
        ------
        StepNcError
            When a machine cannot run a part; with its settings.
        """
        return [self._made(row) for row in self.design.rows(first, last)]

    def program(self, row: DesignRow) -> Program:
        """Program of a row, with its settings.

        Raises
        ------
        StepNcError
            When the program cannot take them.
        """
        return _with_row_settings(self.programs[row.program], row.settings)

    def _made(self, row: DesignRow) -> DatasetRow:
        machine, settings = self.machines[row.machine], row.settings
        material, program = self.materials[row.program, row.material], self.program(row)
        cycle = _cycle(program, machine, material, settings, silent)
        energy = cycle.energy
        if self.has_deviation and machine.deviation is not None:
            streams = Streams(seed=self.design.seed, replication=row.number)
            stream = streams.generator("design", "deviation")
            energy = float(drawn_energies(cycle, machine.deviation, stream, 1)[0])
        cut = settings.cut
        return DatasetRow(
            row=row.number + 1,
            part=program.name,
            machine=machine.name,
            material=material.material.name,
            feed_mm_s=cut.feed,
            spindle_rad_s=_turning(cut),
            depth_mm=cut.depth,
            tool_diameter_mm=settings.tool_diameter,
            flank_wear_mm=settings.flank_wear,
            time_s=cycle.time,
            energy_j=energy,
            energy_exact_j=cycle.energy,
            total_power_w=energy / cycle.time,
            total_power_exact_w=cycle.energy / cycle.time,
            cutting_power_w=(cycle.cutting_energy or 0.0) / cycle.time,
            peak_power_w=cycle.peak_power,
        )


def _with_row_settings(program: Program, settings: RowSettings) -> Program:
    """Program with settings of a row."""
    try:
        diameter = settings.tool_diameter
        sized = program if diameter is None else with_tool_diameter(program, diameter)
        return with_settings(sized, settings.cut)
    except StepNcError as error:
        raise StepNcError(f"{_shown(settings)}: {program.name}: {error}") from error


def _cycle(
    program: Program,
    machine: Machine,
    material: MaterialMatch,
    settings: RowSettings,
    tell: Tell,
) -> PartCycle:
    """Cycle of a program that has its settings."""
    worn = settings.flank_wear or 0.0
    try:
        return part_cycle(program, machine, material, flank_wear=worn, tell=tell)
    except StepNcError as error:
        raise StepNcError(f"{_shown(settings)}: {error}") from error


def table_of(rows: list[DatasetRow]) -> pa.Table:
    """Rows as an Arrow table."""
    return pa.Table.from_pylist([asdict(each) for each in rows], schema=SCHEMA)


def _shown(settings: RowSettings) -> str:
    """Settings for messages."""
    named = (
        ("feed", settings.cut.feed, "mm/s"),
        ("spindle", _turning(settings.cut), "rad/s"),
        ("depth", settings.cut.depth, "mm"),
        ("tool diameter", settings.tool_diameter, "mm"),
        ("flank wear", settings.flank_wear, "mm"),
    )
    return ", ".join(
        f"{name} {value:g} {unit}" for name, value, unit in named if value is not None
    )


def _turning(cut: CutSettings) -> float | None:
    """Size of the spindle speed, rad/s."""
    speed = cut.spindle_speed
    return None if speed is None else rad_s_from_rev_s(abs(speed))


MANIFEST = "manifest.json"
CSV = "data.csv"
PROGRAMS = "programs"
"""Folder of the programs of the rows."""

IN_METADATA = b"stepnc_manifest"
"""Key of the manifest in the metadata of each partition."""

PARTITION = 100
"""Rows of a partition."""


@dataclass(frozen=True, slots=True)
class DatasetFolder:
    """Partitions of rows in a folder."""

    path: Path
    rows: int = PARTITION
    """Rows of a partition."""

    @property
    def is_made(self) -> bool:
        """True if there is a manifest."""
        return (self.path / MANIFEST).exists()

    def prepare(self, manifest: Mapping[str, Any]) -> None:
        """Make the folder and its manifest, or check that what is there is of the same design.

        Raises
        ------
        StepNcError
            When the folder holds another data set, with the first key that differs.
        WriteError
            When the disk refuses.
        """
        try:
            self.path.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise WriteError(error.strerror or str(error), path=str(self.path)) from error
        file = self.path / MANIFEST
        wanted = json.loads(dump(manifest))
        if not self.is_made:
            if any(self.path.iterdir()):
                raise StepNcError(
                    f"{self.path}: not empty, and without {MANIFEST}: name another folder"
                )
            write_atomically(file, dump(manifest).encode())
            return
        found = self.manifest()
        for key in {**wanted, **found}:
            if found.get(key) != wanted.get(key):
                raise StepNcError(
                    f"{file}: {key}: the rows there were made with "
                    f"{_short(found.get(key))}, not {_short(wanted.get(key))}: name another "
                    "folder"
                )

    def manifest(self) -> dict[str, Any]:
        """Manifest of the rows that are there.

        Raises
        ------
        StepNcError
            When it cannot be read.
        """
        file = self.path / MANIFEST
        try:
            found = json.loads(read_bytes(file))
        except ValueError as error:
            raise StepNcError(f"{file}: is not JSON: {error}") from error
        if not isinstance(found, dict):
            raise StepNcError(f"{file}: is not the manifest of a data set")
        return found

    def place(self, number: int) -> Path:
        """Path of a partition, counted from 0."""
        return self.path / f"part-{number:06d}.parquet"

    def size(self, number: int, count: int) -> int:
        """Number of rows that a partition has among the first ``count``."""
        return min(self.rows, count - number * self.rows)

    def count(self, number: int) -> int:
        """Number of rows of a partition that are there."""
        path = self.place(number)
        if not path.exists():
            return 0
        with _opened(path) as file:
            rows: int = file.metadata.num_rows
        return rows

    def partition(self, number: int) -> pa.Table:
        """Rows of a partition."""
        place = self.place(number)
        with _opened(place) as file:
            schema = file.schema_arrow
        found = list(parquet_pieces(place, rows=self.rows))
        return pa.Table.from_batches(found, schema=schema)

    def write(self, number: int, rows: pa.Table) -> None:
        """Write a partition, whole or not at all.

        Raises
        ------
        WriteError
            When the disk refuses.
        """
        sink = pa.BufferOutputStream()
        told = {IN_METADATA: json.dumps(self.manifest()).encode()}
        parquet.write_table(rows.replace_schema_metadata(told), sink, compression="zstd")
        write_atomically(self.place(number), sink.getvalue().to_pybytes())

    def program(self, number: int) -> Path:
        """Path of the program of a row, by its number from 1."""
        return self.path / PROGRAMS / f"row-{number:06d}.stpnc"

    def tables(self, rows: int) -> Iterator[pa.Table]:
        """The first rows that are there, partition by partition."""
        number = 0
        while rows > 0 and self.place(number).exists():
            table = self.partition(number).slice(0, rows)
            yield table
            rows -= table.num_rows
            number += 1

    def write_csv(self, rows: int) -> Path:
        """Write the first rows as one CSV file.

        Raises
        ------
        WriteError
            When the disk refuses.
        """
        path = self.path / CSV
        file = RunFile(path, COLUMNS)
        with file.closing(is_whole=True):
            for table in self.tables(rows):
                for batch in table.to_batches():
                    file.write([
                        words_of(each.to_pylist())
                        if pa.types.is_string(each.type)
                        else each.to_numpy(zero_copy_only=False)
                        for each in batch.columns
                    ])
        return path


def _opened(path: Path) -> parquet.ParquetFile:
    """A partition that is there.

    Raises
    ------
    StepNcError
        When it is no Parquet file with the columns of a data set.
    """
    try:
        file = parquet_file(path)
    except pa.ArrowInvalid as error:
        text = f"{path}: is no Parquet file: delete it, and its rows are made again"
        raise StepNcError(text) from error
    if not file.schema_arrow.equals(SCHEMA):
        raise StepNcError(f"{path}: has other columns than a data set: delete it")
    return file


def _short(value: object) -> str:
    text = json.dumps(value, ensure_ascii=False)
    return text if len(text) <= 60 else f"{text[:59]}…"
