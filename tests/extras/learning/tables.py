"""Data sets of a known law, for tests of learning."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pyarrow as pa
from pyarrow import parquet

from extras.learning.dataset_folder import SCHEMA


def law_table(
    count: int, *, noise: float = 0.0, machines: Sequence[str] = ("mill",)
) -> pa.Table:
    """Rows with power ``10 · feed ** 0.5 · speed ** 0.3``, twice that on a second machine."""
    rng = np.random.default_rng(1)
    feed, speed, depth = rng.uniform((30, 75, 2), (90, 226, 4), (count, 3)).T
    machine = rng.integers(0, len(machines), count)
    exact = 10.0 * feed**0.5 * speed**0.3 * (1.0 + machine)
    power = exact * (1.0 + noise * rng.uniform(-1, 1, count))
    columns = {
        "row": np.arange(1, count + 1),
        "part": ["slot"] * count,
        "machine": [machines[each] for each in machine],
        "material": ["steel"] * count,
        "feed_mm_s": feed,
        "spindle_rad_s": speed,
        "depth_mm": depth,
        "tool_diameter_mm": pa.nulls(count, pa.float64()),
        "flank_wear_mm": pa.nulls(count, pa.float64()),
        "time_s": np.full(count, 10.0),
        "energy_j": 10.0 * power,
        "energy_exact_j": 10.0 * exact,
        "total_power_w": power,
        "total_power_exact_w": exact,
        "cutting_power_w": 0.1 * feed * depth,
        "peak_power_w": 2.0 * exact,
    }
    return pa.table(columns, schema=SCHEMA)


def written(folder: Path, table: pa.Table) -> Path:
    path = folder / "data.parquet"
    parquet.write_table(table, path)
    return path


def changed(table: pa.Table, name: str, values: object) -> pa.Table:
    """Table with other values in a column."""
    return table.set_column(table.column_names.index(name), name, pa.array(values))
