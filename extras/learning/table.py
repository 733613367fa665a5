"""Tables to learn from: settings and names of rows, and the target.

Measured targets of runs, from recordings as ``stepnc record`` or ``simulate`` write them.

A table of runs without the target may name a recording for each run in its column
``recording``, relative to the table. Powers are integrated between samples along straight
lines, from the start of the program to its end where the file tells them. Units s, W, J.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray
from pyarrow import compute

from service.recording.table import batches, headings
from simulator.client.columns import EXECUTION, RUNNING, TIME
from stepnc_model.errors import StepNcError

Floats = NDArray[np.float64]

NUMBERS = ("feed_mm_s", "spindle_rad_s", "depth_mm")
MORE_NUMBERS = ("tool_diameter_mm", "flank_wear_mm")
"""Settings whose columns a table may lack."""

MAY_BE_ZERO = frozenset({"flank_wear_mm"})
"""Settings that may be 0; a power law has an exponential of them."""

NAMES = ("part", "machine", "material")
PHYSICS = {"total_power_w": "total_power_exact_w", "energy_j": "energy_exact_j"}
"""Columns of the physics without deviation, by the target that deviates."""

CUTTING = "cutting_power_w"
"""Column of the power that goes into the cut, part of the total power."""

TARGETS = (
    "time_s", "energy_j", "energy_exact_j", "total_power_w", "total_power_exact_w",
    "cutting_power_w", "peak_power_w",
)  # fmt: skip
"""Columns that can be learned."""

MOST_NAMES = 1_000
"""Different names in a column at most."""

UNITS = {"mm_s": "mm/s", "rad_s": "rad/s", "mm": "mm", "s": "s", "j": "J", "w": "W"}
"""Units by the ends of column names."""


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
    cutting: Floats | None = None
    """Power that goes into the cut by the physics, (N,), W; None if the table has none."""

    def __len__(self) -> int:
        return len(self.target)

    @property
    def over_physics(self) -> "LearningTable":
        """Rows whose target is divided by the physics."""
        if self.physics is None:
            raise ValueError("the table has no physics")
        return replace(self, target=self.target / self.physics)


def unit_of(column: str) -> str:
    """Unit of a column, by its name."""
    ends = ("_".join(column.split("_")[-count:]) for count in (2, 1))
    return next((UNITS[each] for each in ends if each in UNITS), "")


def learning_table(
    table: pa.Table, features: Features, target: str, *, place: str, first: int = 0
) -> LearningTable:
    """Features and target of rows.

    Parameters
    ----------
    table : pa.Table
    place : str
        Where the rows are from, for messages.
    first : int
        Number of rows before them.

    Raises
    ------
    StepNcError
        When a column is missing, or has a value that is no number.
    """
    exact = PHYSICS.get(target)
    return LearningTable(
        features=features,
        values=feature_values(table, features, place=place, first=first),
        target=positive_of(table, target, place=place, first=first),
        physics=(
            positive_of(table, exact, place=place, first=first)
            if exact is not None and exact in table.column_names
            else None
        ),
        cutting=(
            numbers_of(table, CUTTING, place=place, first=first)
            if target == "total_power_w" and CUTTING in table.column_names
            else None
        ),
    )


def joined(tables: Sequence[LearningTable]) -> LearningTable:
    """Rows of several tables as one."""
    physics, cutting = (
        [found for each in tables if (found := getattr(each, name)) is not None]
        for name in ("physics", "cutting")
    )
    return LearningTable(
        features=tables[0].features,
        values=np.concatenate([each.values for each in tables]),
        target=np.concatenate([each.target for each in tables]),
        physics=np.concatenate(physics) if physics else None,
        cutting=np.concatenate(cutting) if cutting else None,
    )


def features_of(
    tables: Iterable[pa.Table], *, place: str
) -> tuple[Features, Mapping[str, tuple[str, ...]]]:
    """Settings that vary and names of which there are several; and all names by column.

    Raises
    ------
    StepNcError
        When a column is missing, nothing varies, or a column has too many names.
    """
    low: dict[str, float] = {}
    high: dict[str, float] = {}
    names: dict[str, set[str]] = {name: set() for name in NAMES}
    first = 0
    for table in tables:
        require_columns(table, (*NUMBERS, *NAMES), place=place)
        for name in (*NUMBERS, *MORE_NUMBERS):
            if name not in table.column_names or table[name].null_count == table.num_rows:
                continue
            values = numbers_of(table, name, place=place, first=first)
            low[name] = min(low.get(name, np.inf), float(values.min()))
            high[name] = max(high.get(name, -np.inf), float(values.max()))
        for name, found in names.items():
            found.update(map(str, compute.unique(table[name]).to_pylist()))
            if len(found) > MOST_NAMES:
                raise StepNcError(f"{place}: {name}: more than {MOST_NAMES} different names")
        first += table.num_rows
    numbers = tuple(
        name for name in (*NUMBERS, *MORE_NUMBERS) if name in low and high[name] > low[name]
    )
    if not numbers:
        raise StepNcError(f"{place}: none of {', '.join((*NUMBERS, *MORE_NUMBERS))} varies")
    every = {name: tuple(sorted(found)) for name, found in names.items()}
    several = {name: found for name, found in every.items() if len(found) > 1}
    return Features(numbers=numbers, names=several), every


def feature_values(
    table: pa.Table, features: Features, *, place: str, first: int = 0
) -> Floats:
    """Values of the features, (N, F).

    Raises
    ------
    StepNcError
        When a column is missing, or has a value that the features do not have.
    """
    require_columns(table, features.columns, place=place)
    columns = [
        (numbers_of if name in MAY_BE_ZERO else positive_of)(
            table, name, place=place, first=first
        )
        for name in features.numbers
    ]
    for name, known in features.names.items():
        values = table[name].cast(pa.string())
        codes = compute.index_in(values, value_set=pa.array(known))
        if codes.null_count:
            row = codes.to_pylist().index(None)
            text = f"{place}: row {first + row + 1}: {name} '{values[row]}' was not trained"
            raise StepNcError(f"{text}; known: {', '.join(known)}")
        columns.append(codes.to_numpy().astype(np.float64))
    return np.stack(columns, axis=1)


def require_columns(table: pa.Table, names: Sequence[str], *, place: str) -> None:
    """Refuse a table that lacks columns, or has them in other units.

    Raises
    ------
    StepNcError
        With the missing columns, and those that are there; or with both units.
    """
    missing = [name for name in names if name not in table.column_names]
    if missing:
        raise StepNcError(
            f"{place}: column {', '.join(missing)} is missing; "
            f"the table has {', '.join(table.column_names)}"
        )
    for name in names:
        told = (table.schema.field(name).metadata or {}).get(b"unit", b"").decode()
        unit = unit_of(name) if name not in NAMES else ""
        if told and told != unit:
            raise StepNcError(f"{place}: column {name} is in {told}; expected {unit}")


def positive_of(table: pa.Table, name: str, *, place: str, first: int = 0) -> Floats:
    """A column of positive numbers, (N,).

    Raises
    ------
    StepNcError
        When it is missing or has something else.
    """
    values = numbers_of(table, name, place=place, first=first)
    if (values <= 0.0).any():
        row = int(np.flatnonzero(values <= 0.0)[0])
        text = f"{place}: row {first + row + 1}: {name} {values[row]:g} {unit_of(name)}"
        raise StepNcError(f"{text}: it must be positive")
    return values


def numbers_of(table: pa.Table, name: str, *, place: str, first: int = 0) -> Floats:
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
        row = first + int(np.flatnonzero(~np.isfinite(values))[0]) + 1
        raise StepNcError(f"{place}: row {row}: {name} is no finite number")
    return np.asarray(values, dtype=np.float64)


RECORDING = "recording"
POWER = "electric_wattage"
"""Column of the total power."""

RECORDED = ("time_s", "energy_j", "total_power_w", "peak_power_w")
"""Targets that a recording tells."""


def with_recorded(table: pa.Table, target: str, *, folder: Path) -> pa.Table:
    """Table with its target, from recordings if it has none itself.

    Parameters
    ----------
    table : pa.Table
    folder : Path
        What paths of recordings are relative to.

    Raises
    ------
    StepNcError
        When a recording cannot be read, or does not tell the target.
    """
    if target in table.column_names or RECORDING not in table.column_names:
        return table
    if target not in RECORDED:
        raise StepNcError(f"recordings do not tell {target}, only {', '.join(RECORDED)}")
    column = RECORDED.index(target)
    values = [
        _recorded_totals(folder / str(name))[column] for name in table[RECORDING].to_pylist()
    ]
    return table.append_column(target, pa.array(values, pa.float64()))


def _recorded_totals(path: Path) -> Floats:
    """Time, energy, mean and greatest power of a recording, as ``RECORDED``."""
    names = headings(path)
    for needed in (TIME, POWER):
        if needed not in names:
            raise StepNcError(f"{path}: no column {needed}")
    kinds = {TIME: pa.float64(), POWER: pa.float64()}
    if EXECUTION in names:
        kinds[EXECUTION] = pa.string()
    times, powers = [], []
    for batch in batches(path, kinds):
        time, power = (
            batch.column(name).to_numpy(zero_copy_only=False) for name in (TIME, POWER)
        )
        is_known = np.isfinite(time) & np.isfinite(power)
        if EXECUTION in kinds:
            words = batch.column(EXECUTION).to_pylist()
            is_known &= np.array([word in RUNNING for word in words])
        times.append(time[is_known])
        powers.append(power[is_known])
    time, power = (np.concatenate([np.zeros(0), *each]) for each in (times, powers))
    steps = np.diff(time)
    if len(time) < 2 or not (steps >= 0.0).all() or not steps.sum() > 0.0:
        raise StepNcError(f"{path}: needs rising times of a run with {POWER}")
    energy = float(steps @ (power[1:] + power[:-1])) / 2.0
    duration = float(steps.sum())
    return np.array([duration, energy, energy / duration, float(power.max())])
