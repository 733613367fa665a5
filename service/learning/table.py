"""Tables to learn from: settings and names of rows, and the target."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray
from pyarrow import csv, parquet

from service.dataset.folder import MANIFEST, DatasetFolder
from service.files import read_bytes
from stepnc_model.errors import StepNcError

Floats = NDArray[np.float64]

NUMBERS = ("feed_mm_s", "spindle_rad_s", "depth_mm")
NAMES = ("part", "machine", "material")
PHYSICS = {"total_power_w": "total_power_exact_w", "energy_j": "energy_exact_j"}
"""Columns of the physics without deviation, by the target that deviates."""

TARGETS = (
    "time_s", "energy_j", "energy_exact_j", "total_power_w", "total_power_exact_w",
    "peak_power_w",
)  # fmt: skip
"""Columns that can be learned."""

MOST_ROWS = 10_000_000


@dataclass(frozen=True, slots=True, kw_only=True)
class Features:
    """Columns that a model takes, in order: numbers, then names as places in their lists."""

    numbers: tuple[str, ...]
    names: Mapping[str, tuple[str, ...]]
    """Values by column; only columns with several."""

    @property
    def columns(self) -> tuple[str, ...]:
        """Names of all columns."""
        return (*self.numbers, *self.names)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class LearningTable:
    """Rows to learn from."""

    features: Features
    values: Floats
    """Of the features, (N, F)."""
    target: Floats
    """(N,)"""
    physics: Floats | None
    """The target without deviation, (N,); None if the table has none."""


def read_table(path: Path) -> pa.Table:
    """Read a data set: its folder, a Parquet file or a CSV file.

    Raises
    ------
    StepNcError
        When it is none of them.
    """
    if path.is_dir():
        if not (path / MANIFEST).exists():
            raise StepNcError(f"{path}: has no {MANIFEST}, so it is no data set")
        tables = list(DatasetFolder(path).tables(MOST_ROWS))
        if not tables:
            raise StepNcError(f"{path}: no rows yet")
        return pa.concat_tables(tables)
    try:
        source = pa.BufferReader(read_bytes(path))
        return csv.read_csv(source) if path.suffix == ".csv" else parquet.read_table(source)
    except pa.ArrowInvalid as error:
        kind = "a CSV" if path.suffix == ".csv" else "a Parquet"
        text = str(error).split("\n", maxsplit=1)[0]
        raise StepNcError(f"{path}: is not {kind} file: {text}") from error


def learning_table(table: pa.Table, target: str, *, place: str) -> LearningTable:
    """Features and target of a data set.

    Raises
    ------
    StepNcError
        When a column is missing, or has a value that is no number.
    """
    features = features_of(table, place=place)
    exact = PHYSICS.get(target)
    return LearningTable(
        features=features,
        values=feature_values(table, features, place=place),
        target=numbers_of(table, target, place=place),
        physics=(
            numbers_of(table, exact, place=place)
            if exact is not None and exact in table.column_names
            else None
        ),
    )


def features_of(table: pa.Table, *, place: str) -> Features:
    """Settings that vary, and names of which there are several.

    Raises
    ------
    StepNcError
        When a column is missing, or nothing varies.
    """
    require_columns(table, (*NUMBERS, *NAMES), place=place)
    numbers = tuple(
        name
        for name in NUMBERS
        if table[name].null_count < table.num_rows
        and np.ptp(numbers_of(table, name, place=place)) > 0.0
    )
    if not numbers:
        raise StepNcError(f"{place}: none of {', '.join(NUMBERS)} varies")
    found = {
        name: tuple(sorted({str(each) for each in table[name].to_pylist()})) for name in NAMES
    }
    return Features(
        numbers=numbers,
        names={name: values for name, values in found.items() if len(values) > 1},
    )


def feature_values(table: pa.Table, features: Features, *, place: str) -> Floats:
    """Values of the features, (N, F).

    Raises
    ------
    StepNcError
        When a column is missing, or has a value that the features do not have.
    """
    require_columns(table, features.columns, place=place)
    columns = [numbers_of(table, name, place=place) for name in features.numbers]
    for name, known in features.names.items():
        codes = {value: float(code) for code, value in enumerate(known)}
        values = [str(each) for each in table[name].to_pylist()]
        for row, value in enumerate(values, start=1):
            if value not in codes:
                text = f"{place}: row {row}: {name} '{value}' was not trained"
                raise StepNcError(f"{text}; known: {', '.join(known)}")
        columns.append(np.array([codes[value] for value in values]))
    return np.stack(columns, axis=1)


def require_columns(table: pa.Table, names: tuple[str, ...], *, place: str) -> None:
    """Refuse a table that lacks columns.

    Raises
    ------
    StepNcError
        With the missing columns, and those that are there.
    """
    missing = [name for name in names if name not in table.column_names]
    if missing:
        raise StepNcError(
            f"{place}: column {', '.join(missing)} is missing; "
            f"the table has {', '.join(table.column_names)}"
        )


def numbers_of(table: pa.Table, name: str, *, place: str) -> Floats:
    """A column of finite numbers, (N,).

    Raises
    ------
    StepNcError
        When it is missing or has something else.
    """
    require_columns(table, (name,), place=place)
    try:
        values = table[name].cast(pa.float64()).to_numpy()
    except (pa.ArrowInvalid, pa.ArrowNotImplementedError) as error:
        raise StepNcError(f"{place}: column {name} is not of numbers") from error
    if not np.isfinite(values).all():
        row = int(np.flatnonzero(~np.isfinite(values))[0]) + 1
        raise StepNcError(f"{place}: row {row}: {name} is no finite number")
    return np.asarray(values, dtype=np.float64)
